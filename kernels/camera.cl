// SPDX-License-Identifier: MIT
// Camera: visibility buffer by tiles, then shading points. Contract and proofs in camera.h.
//
// One work-item takes GN_LANES pixels of one row of a tile and walks the tile's triangle list, keeping the nearest in
// registers: no atomics, the same answer in any order. The records' margins tell which pixels are certain; the rest are
// decided per pixel, exactly. Double precision is the device's own or made of integers (exact/wide.h).
#include "bin_lists.h"
#include "camera.h"
#include "exact/det3.h"
#include "lanes.h"
#include "points.h"
#include "projection.h"
#include "triangle_setup.h"

typedef struct Ray {
    float3 column_high, column_low, row_high, row_low;
} Ray;

static Ray load_ray(__global const float* rays, uint width, uint x, uint y) {
    __global const float* column = rays + RAY_FLOATS * x;
    __global const float* row = rays + RAY_FLOATS * (width + y);
    Ray ray;
    ray.column_high = vload3(0, column);
    ray.column_low = vload3(1, column);
    ray.row_high = vload3(0, row);
    ray.row_low = vload3(1, row);
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

// det(u1 - u0, v1 - v0, r): its sign for certain. `cross` is that of both differences.
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
    outline.ab = det3_cross_float(t.a - eye, t.b - eye);
    outline.bc = det3_cross_float(t.b - eye, t.c - eye);
    outline.ca = det3_cross_float(t.c - eye, t.a - eye);
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

// 1 / t in float: true and an interval in which it lies for certain, with enough on both sides for the error of
// nearness() as well, so that intervals apart order nearness() too. N and D are off by at most a quarter of themselves;
// with a and b their relative errors, N / D is off by a relative (a + b) / (1 - b) <= 4/3 (a + b). 1.4 covers the
// roundings of that sum; 1e-6 those of the quotient (2.5 ulp) and of the interval's ends, and 2^-29. All numbers are
// normal: bounds are at least 2^-61, values at most 2^63.
static bool nearness_float(Triangle t, float3 eye, Ray ray, float* low, float* high) {
    Det3FloatCross n = det3_cross_float(t.b - t.a, t.c - t.a);
    float3 to_plane = t.a - eye, size;
    float3 r = ray_float(ray, &size);
    float bound_along, bound_depth;
    float along = det3_float(n, r, size, &bound_along);
    float depth = det3_float(n, to_plane, fabs(to_plane), &bound_depth);
    if (!(4.0f * bound_along < fabs(along) && 4.0f * bound_depth < fabs(depth))) return false;
    float value = along / depth;
    float error = fabs(value) * (1.4f * (bound_along / fabs(along) + bound_depth / fabs(depth)) + 1.0e-6f);
    *low = value - error;
    *high = value + error;
    return true;
}

static bool is_nearer(Triangle t, uint id, Triangle best, uint best_id, float3 eye, Ray ray) {
    float low, high, best_low, best_high;
    if (nearness_float(t, eye, ray, &low, &high) && nearness_float(best, eye, ray, &best_low, &best_high)) {
        if (low > best_high) return true;
        if (high < best_low) return false;
    }
    Wide mine = nearness(plane_of(t, eye), t, ray), other = nearness(plane_of(best, eye), best, ray);
    return wide_less(other, mine) || (!wide_less(mine, other) && id < best_id);
}

// `rays` are those of one sample per pixel, which lies `offset` pixels off the centre. With pixel_receivers, a sample
// whose ray meets the receiver of its pixel takes that one, seen or not. visible[first_point + pixel] is written.
__kernel void camera_visibility(__constant const Projection* projection, ulong first_float, float2 offset,
                                uint first_point, uint has_pixel_receivers, __global const float* vertices,
                                __global const float* rays, __global const TriangleRecord* records,
                                __global const TriangleBounds* bounds, __global const uint2* ranges,
                                __global const BinEntries* entries, __global const FrameCounters* counters,
                                __global const uint* pixel_receivers, __global uint* visible) {
    if (counters->references == GN_NO_LISTS) return;
    const uint tile_pixels = 1u << CAMERA_TILE_LOG2;
    const uint blocks_per_tile = tile_pixels * tile_pixels / GN_LANES;
    const uint blocks_per_row = tile_pixels / GN_LANES;
    float3 eye = center_of(projection);
    uint width = projection->width, height = projection->height;
    GN_FOR_EACH(block, projection->bins_x * projection->bins_y * blocks_per_tile) {
        uint tile = (uint)block / blocks_per_tile, within = (uint)block % blocks_per_tile;
        uint first_x = (tile % projection->bins_x) * tile_pixels + (within % blocks_per_row) * GN_LANES;
        uint pixel_y = (tile / projection->bins_x) * tile_pixels + within / blocks_per_row;
        if (pixel_y >= height || first_x >= width) continue;
        LaneInt column = (int)first_x + LANE_INDEX;
        LaneInt present = LANE_COMPARE(column, <, (LaneInt)((int)width));
        LaneFloat x = (LaneFloat)((float)first_x + 0.5f + offset.x);
        for (int lane = 0; lane < GN_LANES; ++lane) ((float*)&x)[lane] += (float)lane;
        LaneFloat y = (LaneFloat)((float)pixel_y + 0.5f + offset.y);
        LaneFloat best_low = (LaneFloat)(-INFINITY), best_high = (LaneFloat)(-INFINITY);
        LaneInt best_id = (LaneInt)((int)GN_NO_ID);
        LaneInt searching = present;
        if (has_pixel_receivers) {
            Outline outline;
            uint outlined = GN_NO_ID;
            for (int lane = 0; lane < GN_LANES; ++lane) {
                if (!((int*)&present)[lane]) continue;
                uint receiver = pixel_receivers[(size_t)pixel_y * width + first_x + (uint)lane];
                if (receiver == GN_NO_ID) continue;
                if (receiver != outlined) outline = outline_of(load_triangle(vertices + first_float, receiver), eye);
                outlined = receiver;
                if (!covers(&outline, eye, load_ray(rays, width, first_x + (uint)lane, pixel_y))) continue;
                ((int*)&best_id)[lane] = (int)receiver;
                ((int*)&searching)[lane] = 0;
            }
        }

        QuantisedBlock row;
        row.x0 = quantised_texel((float)first_x + 0.5f + offset.x, width);
        row.x1 = quantised_texel((float)(first_x + GN_LANES) - 0.5f + offset.x, width);
        row.y0 = row.y1 = quantised_texel((float)pixel_y + 0.5f + offset.y, height);
        row.z = 0;
        uint2 range = ranges[tile];
        if (!LANES_ANY(searching)) range.y = range.x;
        uint i = range.x, meeting = 0;
        while (true) {
#if GN_LANES == 1
            // Neighbours walk one list together: a look at the record that all of them share costs no more.
            if (i == range.y) break;
            meeting = 1u;
            ++i;
#else
            while (meeting == 0u && i < range.y) meeting = entries_that_meet(&entries[i++], row);
            if (meeting == 0u) break;
#endif
            uint slot = ENTRY_SLOT(&entries[i - 1u], take_lowest_bit(&meeting));
            __global const TriangleRecord* r = &records[slot];
            LaneFloat e0 = lanes_linear(r->edge_x[0], r->edge_y[0], r->edge_0[0], x, y);
            LaneFloat e1 = lanes_linear(r->edge_x[1], r->edge_y[1], r->edge_0[1], x, y);
            LaneFloat e2 = lanes_linear(r->edge_x[2], r->edge_y[2], r->edge_0[2], x, y);
            LaneFloat inside = LANES_MIN(e0, LANES_MIN(e1, e2));
            LaneFloat z = lanes_linear(r->plane_x, r->plane_y, r->plane_0, x, y);
            LaneFloat z_low = z - (LaneFloat)(r->margin_plane), z_high = z + (LaneFloat)(r->margin_plane);
            LaneInt possible =
                searching & ~LANE_COMPARE(inside, <, (LaneFloat)(-r->margin_edge)) & ~LANE_COMPARE(z_high, <, best_low);
            if (!LANES_ANY(possible)) continue;
            int id = (int)bounds[slot].id;
            LaneInt inside_for_certain = LANE_COMPARE(inside, >, (LaneFloat)(r->margin_edge));
            LaneInt nearer_for_certain = LANE_COMPARE(z_low, >, best_high);
            LaneInt certain = possible & inside_for_certain & nearer_for_certain;
            LaneInt open = possible & ~certain;
            if (LANES_ANY(open)) {
                Outline outline = outline_of(load_triangle(vertices + first_float, (uint)id), eye);
                for (int lane = 0; lane < GN_LANES; ++lane) {
                    if (!((int*)&open)[lane]) continue;
                    Ray ray = load_ray(rays, width, first_x + (uint)lane, pixel_y);
                    uint other = (uint)((int*)&best_id)[lane];
                    bool wins = ((int*)&inside_for_certain)[lane] || covers(&outline, eye, ray);
                    if (wins && other != GN_NO_ID && !((int*)&nearer_for_certain)[lane])
                        wins = is_nearer(outline.t, (uint)id, load_triangle(vertices + first_float, other), other, eye,
                                         ray);
                    ((int*)&certain)[lane] = wins ? -1 : 0;
                }
            }
            best_low = LANES_SELECT(best_low, z_low, certain);
            best_high = LANES_SELECT(best_high, z_high, certain);
            best_id = LANES_SELECT(best_id, (LaneInt)(id), certain);
        }
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (((int*)&present)[lane])
                visible[first_point + (size_t)pixel_y * width + first_x + (uint)lane] = (uint)((int*)&best_id)[lane];
    }
}

// ---- Shading points -------------------------------------------------------------------------------------------------

// The next float up, or down. On bits, since a device may flush denormals that it computes with.
static float next_towards(float x, bool up) {
    uint bits = as_uint(x);
    if ((bits << 1) == 0u) return as_float(up ? 0x00000001u : 0x80000001u);
    bool away_from_zero = (bits >> 31 == 0u) == up;
    return as_float(away_from_zero ? bits + 1u : bits - 1u);
}

// The nearest float to q on the side that `towards` points to; the nearest of all if it is 0. Never infinite.
static float rounded_towards(Wide q, Wide towards) {
    float x = float_of_wide(q);
    if (!GN_FINITE(x)) return wide_sign(q) > 0 ? FLT_MAX : -FLT_MAX;
    if (wide_sign(towards) > 0 && wide_less(wide_of_float(x), q)) x = next_towards(x, true);
    if (wide_sign(towards) < 0 && wide_less(q, wide_of_float(x))) x = next_towards(x, false);
    return GN_FINITE(x) ? x : copysign(FLT_MAX, x);
}

typedef struct Wide3 {
    Wide x, y, z;
} Wide3;

static Wide largest_coordinate(Wide3 v) {
    return wide_max(wide_max(wide_absolute(v.x), wide_absolute(v.y)), wide_absolute(v.z));
}

// A coordinate of the plane's normal with a small relative error.
static Wide normal_coordinate(Wide value, Wide size, Triangle t, float3 axis) {
    if (is_good(value, wide_mul(DET3_DOUBLE_BOUND, size))) return wide_add(value, WIDE_ZERO);  // no -0
    return exact_component(t, axis, (float3)(0.0f));
}

// The plane's normal, unnormalised, towards the eye.
static Wide3 normal_towards_eye(Det3Row normal, Triangle t, float3 eye) {
    Wide3 n;
    n.x = normal_coordinate(normal.x, normal.size_x, t, (float3)(1.0f, 0.0f, 0.0f));
    n.y = normal_coordinate(normal.y, normal.size_y, t, (float3)(0.0f, 1.0f, 0.0f));
    n.z = normal_coordinate(normal.z, normal.size_z, t, (float3)(0.0f, 0.0f, 1.0f));
    int level = DET3_BY_FLOAT;
    if (det3_sign(t.b, t.a, t.c, t.a, eye, t.a, &level) < 0) {
        n.x = wide_negated(n.x);
        n.y = wide_negated(n.y);
        n.z = wide_negated(n.z);
    }
    return n;
}

// LIFT_ULPS float32 ulps of a size below 2^128.
static Wide lift_of(Wide size) {
    return wide_mul(wide_of_float(LIFT_ULPS), wide_power_of_two(max(wide_exponent(size), -126) - 23));
}

// `hit` moved up along n by `lift` times its largest coordinate, and rounded up along it.
static float3 lifted(Wide3 hit, Wide3 n, Wide lift) {
    Wide scale = wide_div(lift, largest_coordinate(n));
    return (float3)(rounded_towards(wide_add(hit.x, wide_mul(scale, n.x)), n.x),
                    rounded_towards(wide_add(hit.y, wide_mul(scale, n.y)), n.y),
                    rounded_towards(wide_add(hit.z, wide_mul(scale, n.z)), n.z));
}

static Wide3 hit_of(float3 eye, Det3Row ray, Wide distance) {
    Wide3 hit;
    hit.x = wide_add(wide_of_float(eye.x), wide_mul(distance, ray.x));
    hit.y = wide_add(wide_of_float(eye.y), wide_mul(distance, ray.y));
    hit.z = wide_add(wide_of_float(eye.z), wide_mul(distance, ray.z));
    return hit;
}

// Positions as a structure of arrays: x of all points, then y, then z; pixel i is point first_point + i of point_count.
// Sky: NaN.
__kernel void camera_points(uint width, uint height, uint first_point, uint point_count, float4 eye_and_zero,
                            ulong first_float, __global const float* vertices, __global const float* rays,
                            __global const uint* visible, __global float* positions) {
    size_t count = (size_t)width * height;
    float3 eye = eye_and_zero.xyz;
    Wide eye_size = wide_of_float(fmax(fmax(fabs(eye.x), fabs(eye.y)), fabs(eye.z)));
    // Neighbours mostly see the same triangle: what they share is kept.
    uint id = GN_NO_ID;
    Triangle t;
    Plane plane;
    Wide3 n;
    GN_FOR_EACH(pixel, count) {
        float3 p = (float3)(NAN);
        size_t point = first_point + pixel;
        if (visible[point] != GN_NO_ID) {
            if (visible[point] != id) {
                id = visible[point];
                t = load_triangle(vertices + first_float, id);
                plane = plane_of(t, eye);
                n = normal_towards_eye(plane.normal, t, eye);
            }
            Ray ray = load_ray(rays, width, (uint)(pixel % width), (uint)(pixel / width));
            Wide3 hit = hit_of(eye, ray_row(ray), wide_div(WIDE_ONE, nearness(plane, t, ray)));
            p = lifted(hit, n, lift_of(wide_max(largest_coordinate(hit), eye_size)));
        }
        positions[point] = p.x;
        positions[point + point_count] = p.y;
        positions[point + 2 * (size_t)point_count] = p.z;
    }
}

static float3 unit_normal(Triangle t, float3 eye) {
    Wide3 n = normal_towards_eye(det3_cross(det3_row(t.b, t.a), det3_row(t.c, t.a)), t, eye);
    Wide largest = largest_coordinate(n);
    n.x = wide_div(n.x, largest);
    n.y = wide_div(n.y, largest);
    n.z = wide_div(n.z, largest);
    Wide length_of_n = wide_sqrt(wide_dot(n.x, n.y, n.z, n.x, n.y, n.z));
    return (float3)(float_of_wide(wide_div(n.x, length_of_n)), float_of_wide(wide_div(n.y, length_of_n)),
                    float_of_wide(wide_div(n.z, length_of_n)));
}

// Unit geometric normals facing the camera, packed xyz, for the host and for shading. Sky: 0.
__kernel void camera_normals(uint count, float4 eye_and_zero, ulong first_float, __global const float* vertices,
                             __global const uint* visible, __global float* normals) {
    uint id = GN_NO_ID;  // of the triangle that `normal` belongs to
    float3 normal = (float3)(0.0f);
    GN_FOR_EACH(pixel, count) {
        if (visible[pixel] != id) {
            id = visible[pixel];
            normal = (float3)(0.0f);
            if (id != GN_NO_ID) normal = unit_normal(load_triangle(vertices + first_float, id), eye_and_zero.xyz);
        }
        vstore3(normal, pixel, normals);
    }
}

// ---- Points of a caller ---------------------------------------------------------------------------------------------

// Each point moved off its receiver as a camera's are (camera.h), the point itself in the place of the hit. Points that
// are absent, or have no receiver with a plane, stay where they are. Packed xyz.
__kernel void lift_points(PointsLayout layout, float4 eye_and_zero, ulong first_float, uint triangle_count,
                          __global const float* vertices, __global const float* positions,
                          __global const uint* receivers, __global float* lifted_positions) {
    float3 eye = eye_and_zero.xyz;
    Wide eye_size = wide_of_float(fmax(fmax(fabs(eye.x), fabs(eye.y)), fabs(eye.z)));
    GN_FOR_EACH(i, layout.count) {
        float3 p = load_point(positions, layout, i);
        if (receivers[i] < triangle_count && is_present(p)) {
            Triangle t = load_triangle(vertices + first_float, receivers[i]);
            if (is_finite_triangle(t)) {
                Wide3 hit;
                hit.x = wide_of_float(p.x);
                hit.y = wide_of_float(p.y);
                hit.z = wide_of_float(p.z);
                Wide3 n = normal_towards_eye(det3_cross(det3_row(t.b, t.a), det3_row(t.c, t.a)), t, eye);
                if (!wide_is_zero(largest_coordinate(n)))
                    p = lifted(hit, n, lift_of(wide_max(largest_coordinate(hit), eye_size)));
            }
        }
        vstore3(p, i, lifted_positions);
    }
}
