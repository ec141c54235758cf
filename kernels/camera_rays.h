// SPDX-License-Identifier: MIT
// Rays of the camera: which triangles they meet, and which of two is the nearer, exactly. Contract in camera.h.
#ifndef GN_CAMERA_RAYS_H
#define GN_CAMERA_RAYS_H

#include "bin_lists.h"
#include "camera.h"
#include "exact/det3_lanes.h"
#include "lanes.h"
#include "points.h"
#include "projection.h"
#include "triangle_setup.h"

typedef struct Ray {
    float3 column_high, column_low, row_high, row_low;
} Ray;

// By the entries of its column and its row in the table.
static Ray load_ray(__global const float* rays, uint column, uint row) {
    Ray ray;
    ray.column_high = vload3(0, rays + (size_t)RAY_FLOATS * column);
    ray.column_low = vload3(1, rays + (size_t)RAY_FLOATS * column);
    ray.row_high = vload3(0, rays + (size_t)RAY_FLOATS * row);
    ray.row_low = vload3(1, rays + (size_t)RAY_FLOATS * row);
    return ray;
}

// One coordinate of the ray. Two roundings instead of one: doubling the size covers the second.
static Wide ray_coordinate(float column_high, float column_low, float row_high, float row_low, Wide* size) {
    Wide column = wide_add(wide_of_float(column_high), wide_of_float(column_low));
    Wide row = wide_add(wide_of_float(row_high), wide_of_float(row_low));
    Wide sum_of_sizes = wide_add(wide_absolute(column), wide_absolute(row));
    *size = wide_add(sum_of_sizes, sum_of_sizes);
    return wide_add(column, row);
}

// The ray in double precision, with the sizes of what was added, as det3_wide wants it.
static Det3Row ray_row(Ray ray) {
    Det3Row row;
    row.x = ray_coordinate(ray.column_high.x, ray.column_low.x, ray.row_high.x, ray.row_low.x, &row.size_x);
    row.y = ray_coordinate(ray.column_high.y, ray.column_low.y, ray.row_high.y, ray.row_low.y, &row.size_y);
    row.z = ray_coordinate(ray.column_high.z, ray.column_low.z, ray.row_high.z, ray.row_low.z, &row.size_z);
    return row;
}

// Four determinants, so that no low part has to be negated in float, where a denormal could be flushed.
static void accumulate_with_ray(Accumulator* sum, float3 u1, float3 u0, float3 v1, float3 v0, Ray ray) {
    const float3 none = (float3)(0.0f);
    accumulator_clear(sum);
    accumulator_add_det3(sum, u1, u0, v1, v0, ray.column_high, none);
    accumulator_add_det3(sum, u1, u0, v1, v0, ray.column_low, none);
    accumulator_add_det3(sum, u1, u0, v1, v0, ray.row_high, none);
    accumulator_add_det3(sum, u1, u0, v1, v0, ray.row_low, none);
}

// The ray as the float level wants it. The low parts, at most half an ulp of the high ones, are left out, and the sum
// is rounded: an error of at most u (|column| + |row|) + u |r|, below u times this size.
static float3 ray_float(Ray ray, float3* size) {
    *size = 2.0f * (fabs(ray.column_high) + fabs(ray.row_high));
    return ray.column_high + ray.row_high;
}

// det(u1 - u0, v1 - v0, r): its sign for certain. `cross` is one whose product with r is the same in real arithmetic.
static int sign_with_ray(Det3FloatCross cross, float3 u1, float3 u0, float3 v1, float3 v0, Ray ray) {
    float3 size;
    float3 r = ray_float(ray, &size);
    float bound_float;
    float value_float = det3_float(cross, r, size, &bound_float);
    if (fabs(value_float) > bound_float) return value_float > 0.0f ? 1 : -1;
    Wide bound;
    Wide value = det3_wide(det3_cross(det3_row(u1, u0), det3_row(v1, v0)), ray_row(ray), &bound);
    if (wide_less(bound, wide_absolute(value))) return wide_sign(value);
    if (wide_is_zero(bound)) return 0;
    Accumulator sum;
    accumulate_with_ray(&sum, u1, u0, v1, v0, ray);
    return accumulator_sign(&sum);
}

// What all rays that may meet a triangle share.
typedef struct Outline {
    Triangle t;
    int orientation;  // as seen from the eye; 0: edge-on, and met by none
    Det3FloatCross ab, bc, ca;
} Outline;

static Outline outline_of(Triangle t, float3 eye) {
    Outline outline;
    int level = DET3_BY_FLOAT;
    outline.t = t;
    outline.orientation = det3_sign(t.a, eye, t.b, eye, t.c, eye, &level);
    // det(a - eye, b - eye, r) = det(a - eye, b - a, r): with the edge in it, the bound of a small triangle is small.
    outline.ab = det3_cross_float(t.a - eye, t.b - t.a);
    outline.bc = det3_cross_float(t.b - eye, t.c - t.b);
    outline.ca = det3_cross_float(t.c - eye, t.a - t.c);
    return outline;
}

// Does the closed triangle cover the ray, t > 0? Exactly.
static bool covers(const Outline* outline, float3 eye, Ray ray) {
    Triangle t = outline->t;
    int orientation = outline->orientation;
    return orientation != 0 && sign_with_ray(outline->ab, t.a, eye, t.b, eye, ray) * orientation >= 0 &&
           sign_with_ray(outline->bc, t.b, eye, t.c, eye, ray) * orientation >= 0 &&
           sign_with_ray(outline->ca, t.c, eye, t.a, eye, ray) * orientation >= 0;
}

// ---- Many rays at the float level -----------------------------------------------------------------------------------

// Directions side by side, with sizes as det3_float wants them.
typedef struct RayLanes {
    PointBlock direction, size;
} RayLanes;

static LaneFloat picture_coordinate(PictureRays picture, int i, LaneFloat x, LaneFloat y, LaneFloat* size) {
    // The constants, two fma: an error of at most u (|corner| + |x step_x| + |y step_y|) + u |corner + y step_y| +
    // u |r|, so 3u of the sum of magnitudes. The fourth is for the table's rounding and for what its rays are apart
    // from a plane's points between them, 2^-47 each.
    *size = 4.0f * (fabs(picture.corner[i]) + fabs(picture.step_x[i]) * x + fabs(picture.step_y[i]) * y);
    return fma(x, (LaneFloat)(picture.step_x[i]),
               fma(y, (LaneFloat)(picture.step_y[i]), (LaneFloat)(picture.corner[i])));
}

// The rays through these places of the picture (none negative).
static RayLanes rays_at(PictureRays picture, LaneFloat x, LaneFloat y) {
    RayLanes rays;
    rays.direction.x = picture_coordinate(picture, 0, x, y, &rays.size.x);
    rays.direction.y = picture_coordinate(picture, 1, x, y, &rays.size.y);
    rays.direction.z = picture_coordinate(picture, 2, x, y, &rays.size.z);
    return rays;
}

// Outlines side by side.
typedef struct OutlineLanes {
    LaneCross sides[3];
    LaneInt orientation;
} OutlineLanes;

static OutlineLanes same_outline(const Outline* one) {
    OutlineLanes outline = {{same_cross(one->ab), same_cross(one->bc), same_cross(one->ca)},
                            (LaneInt)(one->orientation)};
    return outline;
}

static OutlineLanes outlines_of(const TriangleBlock* t, float3 eye, LaneInt lanes) {
    PointBlock from = same_point(eye.x, eye.y, eye.z);
    LaneCross normals = triangle_normals(t);
    uint exact = 0;
    OutlineLanes outline;
    // det(b - a, c - a, a - eye) = det(a - eye, b - eye, c - eye)
    outline.orientation = lanes_side(t, &normals, &t->a, &from, lanes, &exact);
    outline.sides[0] = lanes_cross(difference(t->a, from), difference(t->b, t->a));
    outline.sides[1] = lanes_cross(difference(t->b, from), difference(t->c, t->b));
    outline.sides[2] = lanes_cross(difference(t->c, from), difference(t->a, t->c));
    return outline;
}

// Which of the rays meet the triangle for certain, by more than every error, and which may?
typedef struct Coverage {
    LaneInt certain, possible;
} Coverage;

static Coverage coverage_of(const OutlineLanes* outline, const RayLanes* rays) {
    Coverage coverage;
    coverage.certain = coverage.possible = LANE_COMPARE(outline->orientation, !=, (LaneInt)(0));
    for (int i = 0; i < 3; ++i) {
        LaneFloat bound;
        LaneFloat value = lanes_det3(&outline->sides[i], rays->direction, rays->size, &bound);
        value *= LANES_TO_FLOAT(outline->orientation);
        coverage.certain &= LANE_COMPARE(value, >, bound);
        coverage.possible &= ~LANE_COMPARE(value, <, -bound);
    }
    return coverage;
}

// ---- Planes ---------------------------------------------------------------------------------------------------------

// Is the error, at most `bound`, below 2^-30 of the value?
static bool is_good(Wide value, Wide bound) {
    const ulong relative = 0x3E0EEC7BD512B572ul;  // 9.0e-10
    return !wide_less(wide_mul(wide_of_bits(relative), wide_absolute(value)), bound);
}

// n . (w1 - w0) from the accumulator, n = (b - a) x (c - a).
static Wide exact_component(Triangle t, float3 w1, float3 w0) {
    Accumulator sum;
    accumulator_clear(&sum);
    accumulator_add_det3(&sum, t.b, t.a, t.c, t.a, w1, w0);
    return accumulator_to_wide(&sum);
}

// What all pixels of a triangle share.
typedef struct Plane {
    Det3Row normal;  // n, whose relative error is not bounded
    Wide depth;      // n . (a - eye), to a relative 2^-30
} Plane;

static Plane plane_of(Triangle t, float3 eye) {
    Plane plane;
    plane.normal = det3_cross(det3_row(t.b, t.a), det3_row(t.c, t.a));
    Wide bound;
    plane.depth = det3_wide(plane.normal, det3_row(t.a, eye), &bound);
    if (!is_good(plane.depth, bound)) plane.depth = exact_component(t, t.a, eye);
    return plane;
}

// 1 / t of the hit: (n . r) / (n . (a - eye)).
static Wide nearness(Plane plane, Triangle t, Ray ray) {
    Wide bound;
    Wide along = det3_wide(plane.normal, ray_row(ray), &bound);
    if (!is_good(along, bound)) {
        Accumulator sum;
        accumulate_with_ray(&sum, t.b, t.a, t.c, t.a, ray);
        along = accumulator_to_wide(&sum);
    }
    return wide_div(along, plane.depth);
}

// ---- Planes at the float level --------------------------------------------------------------------------------------

// Of triangles side by side.
typedef struct PlaneLanes {
    LaneCross normal;
    LaneFloat depth, relative_error;  // n . (a - eye)
    LaneInt good;
} PlaneLanes;

static PlaneLanes planes_of(const TriangleBlock* t, float3 eye) {
    PlaneLanes planes;
    PointBlock to_plane = difference(t->a, same_point(eye.x, eye.y, eye.z));
    LaneFloat bound;
    planes.normal = triangle_normals(t);
    planes.depth = lanes_det3(&planes.normal, to_plane, magnitudes(to_plane), &bound);
    planes.good = LANE_COMPARE(4.0f * bound, <, fabs(planes.depth));
    planes.relative_error = bound / fabs(planes.depth);
    return planes;
}

// Intervals in which 1 / t lies for certain, with enough on both sides for the error of nearness() as well, so that
// intervals apart order nearness() too; all numbers where floats cannot say. N and D are off by at most a quarter of
// themselves; with a and b their relative errors, N / D is off by a relative (a + b) / (1 - b) <= 4/3 (a + b). 1.4
// covers the roundings of that sum; 1e-6 those of the quotient (2.5 ulp) and of the interval's ends, and 2^-29. All
// numbers are normal: bounds are at least 2^-61, values at most 2^63.
typedef struct NearnessLanes {
    LaneFloat low, high;
} NearnessLanes;

static NearnessLanes nearness_of_planes(const PlaneLanes* planes, const RayLanes* rays) {
    LaneFloat bound;
    LaneFloat along = lanes_det3(&planes->normal, rays->direction, rays->size, &bound);
    LaneInt good = planes->good & LANE_COMPARE(4.0f * bound, <, fabs(along));
    LaneFloat value = along / planes->depth;
    LaneFloat error = fabs(value) * (1.4f * (bound / fabs(along) + planes->relative_error) + 1.0e-6f);
    NearnessLanes nearness;
    nearness.low = LANES_SELECT((LaneFloat)(-INFINITY), value - error, good);
    nearness.high = LANES_SELECT((LaneFloat)(INFINITY), value + error, good);
    return nearness;
}

static NearnessLanes nearness_lanes(Triangle t, float3 eye, const RayLanes* rays) {
    TriangleBlock same = same_triangle(t);
    PlaneLanes planes = planes_of(&same, eye);
    return nearness_of_planes(&planes, rays);
}

// ---- The nearest of a tile ------------------------------------------------------------------------------------------

// Rays side by side: where they pass through the picture, in pixels, and their entries in the table.
typedef struct RayBlock {
    LaneFloat x, y;
    LaneInt column, row;
} RayBlock;

static Ray ray_of_lane(__global const float* rays, const RayBlock* block, int lane) {
    return load_ray(rays, (uint)LANE_OF_INT(block->column, lane), (uint)LANE_OF_INT(block->row, lane));
}

// What a tile's rays may meet.
typedef struct TileLists {
    __global const uint2* ranges;
    __global const BinEntries* entries;
    __global const TriangleRecord* records;
    __global const TriangleBounds* bounds;
    __global const float* vertices;  // of the first triangle
    __global const float* rays;
    PictureRays picture;  // the same rays
} TileLists;

// The nearest so far: intervals of 1 / t, and the triangles' numbers.
typedef struct NearestLanes {
    LaneFloat low, high;
    LaneInt id;
} NearestLanes;

// Which of the lanes that a triangle may be the nearest for it is the nearest for.
typedef struct NearestFilter {
    LaneInt possible, inside, nearer;  // may be; meets the ray for certain; is nearer than the best so far for certain
    LaneFloat low, high;
} NearestFilter;

// Lanes that floats leave open, one by one.
static LaneInt decide_nearest(TileLists lists, float3 eye, const RayBlock* block, uint id, const Outline* outline,
                              Triangle t, const NearestFilter* found, const NearestLanes* best) {
    LaneInt wins = found->possible & found->inside & found->nearer;
    LaneInt open = found->possible & ~wins;
    uint other = GN_NO_ID;
    Triangle other_triangle;
    Plane plane, other_plane;
    for (int lane = 0; lane < GN_LANES; ++lane) {
        if (!LANE_OF_INT(open, lane)) continue;
        Ray ray = ray_of_lane(lists.rays, block, lane);
        if (!LANE_OF_INT(found->inside, lane) && !covers(outline, eye, ray)) continue;
        bool is_nearer = true;
        if (!LANE_OF_INT(found->nearer, lane) && (uint)LANE_OF_INT(best->id, lane) != GN_NO_ID) {
            if (other == GN_NO_ID) plane = plane_of(t, eye);
            if (other != (uint)LANE_OF_INT(best->id, lane)) {
                other = (uint)LANE_OF_INT(best->id, lane);
                other_triangle = load_triangle(lists.vertices, other);
                other_plane = plane_of(other_triangle, eye);
            }
            Wide mine = nearness(plane, t, ray), its = nearness(other_plane, other_triangle, ray);
            is_nearer = wide_less(its, mine) || (!wide_less(mine, its) && id < other);
        }
        LANE_OF_INT(wins, lane) = is_nearer ? -1 : 0;
    }
    return wins;
}

static void compare_with_best(NearestFilter* found, const NearestLanes* best) {
    found->nearer = LANE_COMPARE(found->low, >, best->high);
    found->possible &= ~LANE_COMPARE(found->high, <, best->low);
}

// The intervals of the best so far, which are those of records, from their triangles: for some lanes at least.
static void look_closer_at_best(TileLists lists, float3 eye, const RayLanes* rays, LaneInt lanes, NearestLanes* best) {
    lanes &= LANE_COMPARE(best->id, !=, (LaneInt)((int)GN_NO_ID));
    while (LANES_ANY(lanes)) {
        int id = LANE_OF_INT(best->id, first_lane(lanes));
        LaneInt same = LANE_COMPARE(best->id, ==, (LaneInt)(id));
        lanes &= ~same;
        NearnessLanes nearness = nearness_lanes(load_triangle(lists.vertices, (uint)id), eye, rays);
        best->low = LANES_SELECT(best->low, LANES_MAX(best->low, nearness.low), same);
        best->high = LANES_SELECT(best->high, LANES_MIN(best->high, nearness.high), same);
    }
}

// The same for what a record leaves open: the triangle itself says more, of all lanes at once.
static void look_closer(TileLists lists, float3 eye, const RayBlock* block, uint id, NearestFilter* found,
                        NearestLanes* best) {
    Triangle t = load_triangle(lists.vertices, id);
    RayLanes rays = rays_at(lists.picture, block->x, block->y);
    Outline outline;
    if (LANES_ANY(found->possible & ~found->inside)) {
        outline = outline_of(t, eye);
        OutlineLanes lanes = same_outline(&outline);
        Coverage coverage = coverage_of(&lanes, &rays);
        found->possible &= found->inside | coverage.possible;
        found->inside |= coverage.certain;
    }
    if (LANES_ANY(found->possible & ~found->nearer)) {
        NearnessLanes nearness = nearness_lanes(t, eye, &rays);
        found->low = LANES_MAX(found->low, nearness.low);
        found->high = LANES_MIN(found->high, nearness.high);
        compare_with_best(found, best);
        look_closer_at_best(lists, eye, &rays, found->possible & ~found->nearer, best);
        compare_with_best(found, best);
    }
    if (LANES_ANY(found->possible & ~(found->inside & found->nearer)))
        found->possible = decide_nearest(lists, eye, block, id, &outline, t, found, best);
}

// The part of the picture that rays pass through.
static QuantisedBlock box_of_rays(__constant const Projection* projection, const RayBlock* block, LaneInt lanes) {
    LaneInt x = LANES_TO_INT(clamp(block->x * texel_units(projection->width), 0.0f, 65535.0f));
    LaneInt y = LANES_TO_INT(clamp(block->y * texel_units(projection->height), 0.0f, 65535.0f));
    return block_of_lanes(x, y, x, y, (LaneInt)(0), lanes);
}

// Which of the lanes' rays meet this triangle, exactly?
static LaneInt lanes_met(TileLists lists, float3 eye, const RayBlock* block, uint id, LaneInt lanes) {
    Outline outline = outline_of(load_triangle(lists.vertices, id), eye);
    OutlineLanes same = same_outline(&outline);
    RayLanes rays = rays_at(lists.picture, block->x, block->y);
    Coverage coverage = coverage_of(&same, &rays);
    LaneInt open = lanes & coverage.possible & ~coverage.certain;
    for (int lane = 0; lane < GN_LANES; ++lane)
        if (LANE_OF_INT(open, lane) && covers(&outline, eye, ray_of_lane(lists.rays, block, lane)))
            LANE_OF_INT(coverage.certain, lane) = -1;
    return lanes & coverage.certain;
}

// Nothing found yet.
static NearestLanes nothing_near(void) {
    NearestLanes best = {(LaneFloat)(-INFINITY), (LaneFloat)(-INFINITY), (LaneInt)((int)GN_NO_ID)};
    return best;
}

// What a record says of a triangle for the lanes `searching`.
static NearestFilter filter_nearest(__global const TriangleRecord* r, const RayBlock* block, LaneInt searching,
                                    const NearestLanes* best) {
    LaneFloat e0 = lanes_linear(r->edge_x[0], r->edge_y[0], r->edge_0[0], block->x, block->y);
    LaneFloat e1 = lanes_linear(r->edge_x[1], r->edge_y[1], r->edge_0[1], block->x, block->y);
    LaneFloat e2 = lanes_linear(r->edge_x[2], r->edge_y[2], r->edge_0[2], block->x, block->y);
    LaneFloat least = LANES_MIN(e0, LANES_MIN(e1, e2));
    LaneFloat z = lanes_linear(r->plane_x, r->plane_y, r->plane_0, block->x, block->y);
    NearestFilter found;
    // Where a ray meets the triangle, 1 / t lies between the vertices' as well; where it does not, nothing depends
    // on it. Small triangles' planes say less than that.
    found.low = LANES_MAX(z - (LaneFloat)(r->margin_plane), (LaneFloat)(r->z_low));
    found.high = LANES_MIN(z + (LaneFloat)(r->margin_plane), (LaneFloat)(r->z_high));
    found.possible =
        searching & ~LANE_COMPARE(least, <, (LaneFloat)(-r->margin_edge)) & ~LANE_COMPARE(found.high, <, best->low);
    found.inside = LANE_COMPARE(least, >, (LaneFloat)(r->margin_edge));
    found.nearer = LANE_COMPARE(found.low, >, best->high);
    return found;
}

// One triangle of the list for the lanes `searching`; returns those that it is the nearest for so far.
static LaneInt look_at_record(TileLists lists, float3 eye, const RayBlock* block, uint slot, LaneInt searching,
                              NearestLanes* best) {
    NearestFilter found = filter_nearest(&lists.records[slot], block, searching, best);
    if (!LANES_ANY(found.possible)) return found.possible;
    uint id = lists.bounds[slot].id;
    if (LANES_ANY(found.possible & ~(found.inside & found.nearer))) look_closer(lists, eye, block, id, &found, best);
    best->low = LANES_SELECT(best->low, found.low, found.possible);
    best->high = LANES_SELECT(best->high, found.high, found.possible);
    best->id = LANES_SELECT(best->id, (LaneInt)((int)id), found.possible);
    return found.possible;
}

// Of the triangles listed for a tile, the nearest that each of the lanes `searching` meets, or GN_NO_ID.
static LaneInt nearest_of_tile(TileLists lists, __constant const Projection* projection, uint tile, RayBlock block,
                               LaneInt searching) {
    NearestLanes best = nothing_near();
    uint2 range = lists.ranges[tile];
    if (!LANES_ANY(searching)) return best.id;
    float3 eye = center_of(projection);
    QuantisedBlock box = box_of_rays(projection, &block, searching);
    float farthest = -INFINITY;  // of the best so far
#if GN_LANES > 1
    uint ahead = entries_to_look_at(lists.entries, lists.records, lists.bounds, range.x, range.y, box);
#endif
    for (uint i = range.x; i < range.y; ++i) {
#if GN_LANES == 1
        uint meeting = 1u;  // neighbours walk one list together: a look at the record that all share costs no more
#else
        uint meeting = ahead;
        ahead = entries_to_look_at(lists.entries, lists.records, lists.bounds, i + 1u, range.y, box);
#endif
        while (meeting != 0u) {
            uint slot = ENTRY_SLOT(&lists.entries[i], take_lowest_bit(&meeting));
            if (lists.records[slot].z_high < farthest) continue;
            if (!LANES_ANY(look_at_record(lists, eye, &block, slot, searching, &best))) continue;
            farthest = LANES_LEAST(LANES_SELECT((LaneFloat)(INFINITY), best.low, searching));
        }
    }
    return best.id;
}

#endif
