// SPDX-License-Identifier: MIT
// Triangle setup: bounds every triangle in the grid, drops those that cannot matter, and makes records for the rest.
//
// triangle_bounds looks at the whole scene and drops, each counted: a NaN or infinite vertex; behind the light or
// outside the grid; farther from the light than every point it could cover (a pyramid of farthest heights). What is
// left goes into a list of 16 bytes each. triangle_tiles takes that list, or the part of it that may cover whole texels
// (the conservative map is drawn first, and then hides many of the others): it makes the record, drops what is exactly
// edge-on to the rays (never blocks, by contract), and cuts the triangle's bins into tiles. So no later stage walks a
// triangle: they walk tiles, which are all of about the same size. Both take GN_LANES triangles at a time.
//
// Error bounds. Let a, b, c be the projected vertices, p = (X, Y, 1) a point of the grid, and r_a = a - a_w p the first
// two coordinates of a relative to p. Then (Mizoguchi's and everybody's) edge function is
//     e_ab = det(a, b, p) = cross(r_a, r_b).
// a is off by at most E_a = error + R error_w in r_a, where R bounds |X|, |Y|; project_hulls() gives
// one bound of the error to all three vertices. With |r_a| <= rho_a over the triangle's bins,
//     |cross error| <= 2 (rho_a E_b + rho_b E_a + E_a E_b).
// The coefficients a x (b - a) round once for the difference and twice for products and sum, the evaluation twice:
// at most 6u Q, Q = R (|a_y d_w| + |a_w d_y|) + R (|a_w d_x| + |a_x d_w|) + |a_x d_y| + |a_y d_x|, d = b - a.
// The point itself is off by point_error in X and Y: (|edge_x| + |edge_y|) point_error. (R and rho are for the real
// point: they reach point_error beyond the bins, which a light far from a small scene makes many texels.)
//
// Height of the plane, z(X, Y). Parallel: n = (b - a) x (c - a) in (X, Y, Z), z = a_z - (n_x (X - a_x) + n_y (Y - a_y))
// / n_z. An error delta_n of n, E of X, Y and E_z of Z moves z by at most
//     (delta_nx rho + delta_ny rho + delta_nz rho_z + (|n_x| + |n_y|) E) / |n_z| + E_z,
// rho and rho_z bounding X - a_x and z - a_z over the bins; n_z itself is off by delta_nz, so we divide by |n_z| -
// delta_nz. The quotients n_x / n_z may be off by 2.5 ulp (5u; they multiply X - a_x), the constant by 4u, the
// evaluation by 4u of the largest sum of magnitudes L: at most 18u L in all; we use 20u L.
//
// Perspective: z = N . p / det, det = det(a, b, c), N = (b - a) x (c - a) in (x, y, w). N . p = cross(r_b - r_a,
// r_c - r_a) is bounded as an edge. det = N . a; with N', a' the real ones,
//     |N' . a' - N . a| <= |N . (a' - a)| + |(N' - N) . a'|,
// and the last is a'_w times the error of N . p at the place of a' in the grid, or, where a is far outside the grid or
// not in front of the light, the errors of N's components times those of a'.
//
// Every bound is computed in float with all terms positive, and inflated by BOUND_INFLATION (1 %), which covers the
// roundings of its own computation (fewer than 100, each under 2^-23) many times over.
//
// Underflow: relative errors are not all where a product falls below 2^-126. The edges' margin has 1e-30 on top, above
// what any of their sums can lose. In perspective all coordinates shrink with the distance from the light, so N and the
// determinant underflow for triangles within about 1e-11 of it; UNDERFLOW is more than what the products of a plane can
// lose together, flushed denormals included, and swamps the bound there. (Parallel: error_z has 2^-20 |d| in it.)
#include "exact/det3_lanes.clh"
#include "lists/group_scan.clh"
#include "occluders/bin_test.clh"
#include "occluders/cluster_boxes.clh"
#include "occluders/pair_lists.clh"
#include "occluders/record_blocks.clh"

#define UNDERFLOW 1.0e-36f

typedef struct Edge {
    LaneFloat x, y, c;                 // coefficients
    LaneFloat size_x, size_y, size_c;  // sums of the magnitudes of the products that make them
} Edge;

// a x (b - a), as d = b - a.
static Edge make_edge(const Projected* a, LaneFloat d_x, LaneFloat d_y, LaneFloat d_w) {
    Edge edge;
    edge.x = fma(a->y, d_w, -(a->w * d_y));
    edge.y = fma(a->w, d_x, -(a->x * d_w));
    edge.c = fma(a->x, d_y, -(a->y * d_x));
    edge.size_x = fabs(a->y * d_w) + fabs(a->w * d_y);
    edge.size_y = fabs(a->w * d_x) + fabs(a->x * d_w);
    edge.size_c = fabs(a->x * d_y) + fabs(a->y * d_x);
    return edge;
}

// Largest coordinate difference between vertex (x, y, w) and any point of the rectangle, times w.
static LaneFloat largest_offset(LaneFloat x, LaneFloat y, LaneFloat w, Rectangles rectangle) {
    LaneFloat left = fabs(x - w * rectangle.x0), right = fabs(x - w * rectangle.x1);
    LaneFloat top = fabs(y - w * rectangle.y0), bottom = fabs(y - w * rectangle.y1);
    LaneFloat horizontal = LANES_MAX(left, right), vertical = LANES_MAX(top, bottom);
    return LANES_MAX(horizontal, vertical);
}

// The orientation of the triangles as the light sees them, for certain: 1, -1, or 0 for exactly edge-on.
static LaneInt orientations_from_light(const TriangleBlock* t, __constant const Projection* projection, LaneInt lanes,
                                       uint* exact) {
    PointBlock light = same_point(projection->light[0], projection->light[1], projection->light[2]);
    LaneCross normals = triangle_normals(t);
    if (projection->light[3] != 0.0f) return lanes_side(t, &normals, &t->a, &light, lanes, exact);
    PointBlock zero = same_point(0.0f, 0.0f, 0.0f);
    return lanes_side(t, &normals, &light, &zero, lanes, exact);
}

static void set_plane(RecordBlock* record, LaneInt lanes, LaneFloat x, LaneFloat y, LaneFloat constant_term,
                      LaneFloat margin) {
    record->plane_x = LANES_SELECT((LaneFloat)(0.0f), x, lanes);
    record->plane_y = LANES_SELECT((LaneFloat)(0.0f), y, lanes);
    record->plane_0 = LANES_SELECT((LaneFloat)(0.0f), constant_term, lanes);
    record->margin_plane = LANES_SELECT((LaneFloat)(INFINITY), margin, lanes);
}

// Sets plane and its margin; leaves them undecided where a triangle is too near to edge-on for floats.
static void set_plane_parallel(RecordBlock* record, const Projected* v, Rectangles rectangle, LaneFloat orientation,
                               float point_error, float height_error) {
    LaneFloat error_1 = v[0].error + v[1].error, error_2 = v[0].error + v[2].error;
    LaneFloat error_1z = v[0].error_z + v[1].error_z, error_2z = v[0].error_z + v[2].error_z;
    LaneFloat x1 = v[1].x - v[0].x, y1 = v[1].y - v[0].y, z1 = v[1].z - v[0].z;
    LaneFloat x2 = v[2].x - v[0].x, y2 = v[2].y - v[0].y, z2 = v[2].z - v[0].z;
    LaneFloat n_x = fma(y1, z2, -(z1 * y2));
    LaneFloat n_y = fma(z1, x2, -(x1 * z2));
    LaneFloat n_z = fma(x1, y2, -(y1 * x2));
    LaneFloat ax1 = fabs(x1), ay1 = fabs(y1), az1 = fabs(z1), ax2 = fabs(x2), ay2 = fabs(y2), az2 = fabs(z2);
    LaneFloat delta_x = ay1 * error_2z + az2 * error_1 + az1 * error_2 + ay2 * error_1z + error_1 * error_2z +
                        error_1z * error_2 + (ay1 * az2 + az1 * ay2) * (4.0f * GN_U);
    LaneFloat delta_y = az1 * error_2 + ax2 * error_1z + ax1 * error_2z + az2 * error_1 + error_1 * error_2z +
                        error_1z * error_2 + (az1 * ax2 + ax1 * az2) * (4.0f * GN_U);
    LaneFloat delta_z = ax1 * error_2 + ay2 * error_1 + ay1 * error_2 + ax2 * error_1 + error_1 * error_2 * 2.0f +
                        (ax1 * ay2 + ay1 * ax2) * (4.0f * GN_U);
    LaneFloat size_n_z = fabs(n_z), safe_n_z = size_n_z - delta_z * BOUND_INFLATION;
    LaneInt lanes = LANE_COMPARE(safe_n_z, >, size_n_z * 0.25f) & LANE_COMPARE(n_z * orientation, >, (LaneFloat)(0.0f));

    LaneFloat slope_x = -n_x / n_z, slope_y = -n_y / n_z;
    LaneFloat height = v[0].z - (slope_x * v[0].x + slope_y * v[0].y);
    LaneFloat rho = largest_offset(v[0].x, v[0].y, v[0].w, rectangle) + v[0].error + point_error;
    LaneFloat size_n = fabs(n_x) + fabs(n_y);
    LaneFloat rho_z = size_n * rho / safe_n_z;
    LaneFloat error = v[0].error + point_error;
    LaneFloat margin =
        (delta_x * rho + delta_y * rho + delta_z * rho_z + size_n * error) / safe_n_z + v[0].error_z + height_error;
    LaneFloat size_x = fabs(v[0].x), size_y = fabs(v[0].y);
    LaneFloat largest = fabs(slope_x) * LANES_MAX(size_x, rectangle.x1) +
                        fabs(slope_y) * LANES_MAX(size_y, rectangle.y1) + fabs(v[0].z);
    margin = (margin + largest * (20.0f * GN_U)) * BOUND_INFLATION;
    lanes &= LANE_COMPARE(margin, <, (LaneFloat)(INFINITY));
    set_plane(record, lanes, slope_x, slope_y, height, margin);
}

// N . a of a triangle whose vertex a may lie anywhere: by the errors of N's components and those of a.
static LaneFloat determinant_error_anywhere(const Projected* v, LaneFloat side_1_size, LaneFloat side_2_size,
                                            LaneFloat size_x, LaneFloat size_y, LaneFloat size_w) {
    LaneFloat e_0 = v[0].error, e_0w = v[0].error_w;
    LaneFloat side_error_1 = v[0].error + v[1].error + v[0].error_w + v[1].error_w;
    LaneFloat side_error_2 = v[0].error + v[2].error + v[0].error_w + v[2].error_w;
    LaneFloat delta_n = side_1_size * side_error_2 + side_2_size * side_error_1 + side_error_1 * side_error_2;
    LaneFloat far_x = fabs(v[0].x) + e_0, far_y = fabs(v[0].y) + e_0, far_w = fabs(v[0].w) + e_0w;
    return delta_n * (far_x + far_y + far_w) + (size_x * far_x + size_y * far_y + size_w * far_w) * (4.0f * GN_U);
}

static void set_plane_perspective(RecordBlock* record, const Projected* v, Rectangles rectangle, LaneFloat orientation,
                                  LaneInt straddles, float point_error, float height_error) {
    LaneFloat x1 = v[1].x - v[0].x, y1 = v[1].y - v[0].y, w1 = v[1].w - v[0].w;
    LaneFloat x2 = v[2].x - v[0].x, y2 = v[2].y - v[0].y, w2 = v[2].w - v[0].w;
    LaneFloat n_x = fma(y1, w2, -(w1 * y2));
    LaneFloat n_y = fma(w1, x2, -(x1 * w2));
    LaneFloat n_w = fma(x1, y2, -(y1 * x2));
    LaneFloat size_x = fabs(y1 * w2) + fabs(w1 * y2);
    LaneFloat size_y = fabs(w1 * x2) + fabs(x1 * w2);
    LaneFloat size_w = fabs(x1 * y2) + fabs(y1 * x2);
    LaneFloat determinant = fma(n_x, v[0].x, fma(n_y, v[0].y, n_w * v[0].w));
    LaneInt lanes = LANE_COMPARE(determinant * orientation, >, (LaneFloat)(0.0f));

    // N . p, as the cross product of the sides relative to p.
    LaneFloat reach = LANES_MAX(rectangle.x1, rectangle.y1) + point_error;
    LaneFloat e_a = v[0].error + reach * v[0].error_w;
    LaneFloat e_1 = e_a + v[1].error + reach * v[1].error_w, e_2 = e_a + v[2].error + reach * v[2].error_w;
    LaneFloat rho_1 = largest_offset(x1, y1, w1, rectangle) + fabs(w1) * point_error;
    LaneFloat rho_2 = largest_offset(x2, y2, w2, rectangle) + fabs(w2) * point_error;
    LaneFloat delta_np =
        (rho_1 * e_2 + rho_2 * e_1 + e_1 * e_2) * 2.0f + (reach * size_x + reach * size_y + size_w) * (8.0f * GN_U);
    // N . a: at a's own place in the grid it is a_w N . p, inside the rectangle unless the triangle straddles.
    LaneFloat e_0 = v[0].error, e_0w = v[0].error_w;
    LaneFloat delta_determinant = fabs(n_x) * e_0 + fabs(n_y) * e_0 + fabs(n_w) * e_0w +
                                  (fabs(n_x * v[0].x) + fabs(n_y * v[0].y) + fabs(n_w * v[0].w)) * (4.0f * GN_U) +
                                  (fabs(v[0].x) + fabs(v[0].y) + fabs(v[0].w) + 1.0f) * UNDERFLOW;
    LaneInt a_in_grid = ~straddles & LANE_COMPARE(fabs(v[0].x) / fabs(v[0].w), <=, reach) &
                        LANE_COMPARE(fabs(v[0].y) / fabs(v[0].w), <=, reach);
    LaneFloat more = determinant_error_anywhere(v, fabs(x1) + fabs(y1) + fabs(w1), fabs(x2) + fabs(y2) + fabs(w2),
                                                size_x, size_y, size_w);
    if (LANES_ANY(a_in_grid)) {
        // The bound above over the rectangle need not hold at a itself when the rectangle was cut to the grid.
        LaneFloat a_x = v[0].x / v[0].w, a_y = v[0].y / v[0].w;
        Rectangles whole = {LANES_MIN(a_x, rectangle.x0), LANES_MIN(a_y, rectangle.y0), LANES_MAX(a_x, rectangle.x1),
                            LANES_MAX(a_y, rectangle.y1)};
        LaneFloat place_error = e_a / (v[0].w - e_0w);  // of a in the grid
        LaneFloat rho_1a = largest_offset(x1, y1, w1, whole) + fabs(w1) * place_error;
        LaneFloat rho_2a = largest_offset(x2, y2, w2, whole) + fabs(w2) * place_error;
        LaneFloat e_1a = e_1 + place_error * (v[0].error_w + v[1].error_w);
        LaneFloat e_2a = e_2 + place_error * (v[0].error_w + v[2].error_w);
        LaneFloat far_reach = reach + place_error;
        LaneFloat in_grid = (v[0].w + e_0w) * ((rho_1a * e_2a + rho_2a * e_1a + e_1a * e_2a) * 2.0f +
                                               (far_reach * size_x + far_reach * size_y + size_w) * (8.0f * GN_U));
        more = LANES_SELECT(more, in_grid, a_in_grid);
    }
    delta_determinant += more;
    LaneFloat size_determinant = fabs(determinant);
    LaneFloat safe_determinant = size_determinant - delta_determinant * BOUND_INFLATION;
    lanes &= LANE_COMPARE(safe_determinant, >, size_determinant * 0.25f);

    LaneFloat plane_x = n_x / determinant, plane_y = n_y / determinant, plane_0 = n_w / determinant;
    LaneFloat largest = fabs(plane_x) * reach + fabs(plane_y) * reach + fabs(plane_0);
    LaneFloat margin = (delta_np + largest * delta_determinant) / safe_determinant;
    margin = (margin + (fabs(n_x) + fabs(n_y)) / safe_determinant * point_error + largest * (16.0f * GN_U) +
              largest * (2.0f * height_error)) *
             BOUND_INFLATION;
    // A point with Z above 2 largest is nearer than the plane by more than its own relative error only if the margin
    // is not larger than the heights themselves.
    lanes &= LANE_COMPARE(margin, <, largest * 0.5f);
    set_plane(record, lanes, plane_x, plane_y, plane_0, margin);
}

// Is there a texel's centre between these?
static LaneInt hold_a_centre(LaneFloat low, LaneFloat high, uint texels) {
    LaneFloat last = LANES_MIN(high - 0.5f, (LaneFloat)((float)texels)), first = low - 0.5f;
    LaneInt inside = LANE_COMPARE(last, >=, (LaneFloat)(0.0f));
    LaneFloat centre = LANES_TO_FLOAT(LANES_TO_INT(LANES_MAX(last, (LaneFloat)(0.0f))));
    return inside & LANE_COMPARE(centre, >=, first);
}

// Can the triangles cover a whole texel? A matter of speed alone: an answer that is off by rounding costs a look or a
// texel, never a wrong shadow.
//
// A texel with its centre at p is covered if each barycentric coordinate is at p at least what it loses towards the
// texel's worst corner: for the corner opposite the edge (x, y), s = (|x| + |y|) / 2 / (2 area). The three s sum up to
// S = (breadth + depth) / (2 area). If S > 1 there is no such p; else these p make up a triangle, the original times
// 1 - S, with its first corner at a + s_b ab + s_c ac + (1 - S) 0; and some texel's centre must be within its bounds.
// Its area is how many texels the original covers on average over all places of the grid: `expected`.
static LaneInt can_cover_texel(const Projected* v, Rectangles rectangle, __constant const Projection* projection,
                               LaneInt lanes, LaneFloat* expected) {
    lanes &= LANE_COMPARE(rectangle.x1 - rectangle.x0, >=, (LaneFloat)(1.0f)) &
             LANE_COMPARE(rectangle.y1 - rectangle.y0, >=, (LaneFloat)(1.0f));
    if (!LANES_ANY(lanes)) return lanes;
    LaneFloat a_x = v[0].x / v[0].w, a_y = v[0].y / v[0].w;
    LaneFloat ab_x = v[1].x / v[1].w - a_x, ab_y = v[1].y / v[1].w - a_y;
    LaneFloat ac_x = v[2].x / v[2].w - a_x, ac_y = v[2].y / v[2].w - a_y;
    LaneFloat twice_area = fabs(ab_x * ac_y - ab_y * ac_x), zero = (LaneFloat)(0.0f);
    LaneFloat low_x = LANES_MIN(LANES_MIN(ab_x, ac_x), zero), high_x = LANES_MAX(LANES_MAX(ab_x, ac_x), zero);
    LaneFloat low_y = LANES_MIN(LANES_MIN(ab_y, ac_y), zero), high_y = LANES_MAX(LANES_MAX(ab_y, ac_y), zero);
    LaneFloat around = high_x - low_x + high_y - low_y;
    lanes &= LANE_COMPARE(twice_area, >=, around);
    if (!LANES_ANY(lanes)) return lanes;
    LaneFloat s_b = (fabs(ac_x) + fabs(ac_y)) * 0.5f / twice_area, s_c = (fabs(ab_x) + fabs(ab_y)) * 0.5f / twice_area;
    LaneFloat rest = (LaneFloat)(1.0f) - around / twice_area;
    LaneFloat first_x = a_x + s_b * ab_x + s_c * ac_x, first_y = a_y + s_b * ab_y + s_c * ac_y;
    LaneFloat area = twice_area * 0.5f * rest * rest;
    *expected = LANES_SELECT(*expected, LANES_MIN(area, *expected), lanes);
    return lanes & hold_a_centre(first_x + rest * low_x, first_x + rest * high_x, projection->width) &
           hold_a_centre(first_y + rest * low_y, first_y + rest * high_y, projection->height);
}

// The projected vertices, and what they say at once. A wild triangle is in every bin, and every test of it exact.
typedef struct ProjectedTriangles {
    Projected v[3];
    HullSides sides;
} ProjectedTriangles;

static ProjectedTriangles project_triangles(const TriangleBlock* t, __constant const Projection* projection) {
    ProjectedTriangles p;
    const PointBlock corners[3] = {t->a, t->b, t->c};
    project_hulls(projection, corners, 3, p.v);
    p.sides = sides_of_hulls(p.v, 3, projection);
    return p;
}

// ---- Bounds ---------------------------------------------------------------------------------------------------------

// TriangleBounds of GN_LANES triangles.
typedef struct BoundsBlock {
    LaneInt x0, y0, x1, y1, z, flags;
    LaneFloat expected;  // texels that those for the map will cover, roughly
} BoundsBlock;

// Bounds that say nothing: every bin, or (indistinct) the one that all points share.
static BoundsBlock open_bounds(__constant const Projection* projection) {
    BoundsBlock bounds;
    bounds.x0 = bounds.y0 = bounds.flags = (LaneInt)(0);
    bounds.x1 = (LaneInt)(projection->indistinct ? (int)(texel_units(projection->width) - 1.0f) : 65535);
    bounds.y1 = (LaneInt)(projection->indistinct ? (int)(texel_units(projection->height) - 1.0f) : 65535);
    bounds.z = (LaneInt)(65535);
    bounds.expected = (LaneFloat)(0.0f);
    return bounds;
}

// quantised_texel() and quantised_height() of lanes.
static LaneInt quantised(LaneFloat units) {
    const LaneFloat least = (LaneFloat)(0.0f), most = (LaneFloat)(65535.0f);
    units = LANES_MAX(units, least);
    return LANES_TO_INT(LANES_MIN(units, most));
}

// Which of these finite triangles may matter, and their bounds. `pyramid` is ignored unless `has_pyramid`.
static LaneInt bound_triangles(const TriangleBlock* t, LaneInt lanes, __constant const Projection* projection,
                               __global const uint* pyramid, bool has_pyramid, BoundsBlock* bounds) {
    *bounds = open_bounds(projection);
    if (projection->indistinct) return lanes;
    ProjectedTriangles p = project_triangles(t, projection);
    Rectangles rectangle;
    LaneInt out_of_range = lanes & p.sides.out_of_range, inside = lanes & ~p.sides.out_of_range & ~p.sides.behind;
    inside &= covered_rectangles(p.v, 3, projection, &rectangle);
    if (!LANES_ANY(inside)) return out_of_range;
    LaneFloat z_low, z_high;
    height_intervals(p.v, 3, p.sides.straddles, projection, &z_low, &z_high);
    if (has_pyramid) inside &= ~lanes_hidden(rectangle, z_high, inside, projection, pyramid);
    if (!LANES_ANY(inside)) return out_of_range;
    float x_units = texel_units(projection->width), y_units = texel_units(projection->height);
    bounds->x0 = LANES_SELECT(bounds->x0, quantised(rectangle.x0 * x_units), inside);
    bounds->y0 = LANES_SELECT(bounds->y0, quantised(rectangle.y0 * y_units), inside);
    bounds->x1 = LANES_SELECT(bounds->x1, quantised(rectangle.x1 * x_units), inside);
    bounds->y1 = LANES_SELECT(bounds->y1, quantised(rectangle.y1 * y_units), inside);
    LaneInt z = projection->z_scale == 0.0f ? quantised_nearness(z_high)
                                            : quantised((z_high - projection->z_origin) * projection->z_scale);
    bounds->z = LANES_SELECT(bounds->z, z, inside);
    LaneInt for_map = inside & p.sides.straddles;
    bounds->expected = (rectangle.x1 - rectangle.x0) * (rectangle.y1 - rectangle.y0);  // no more than the grid has
    for_map |= can_cover_texel(p.v, rectangle, projection, inside & ~p.sides.straddles, &bounds->expected);
    bounds->flags = LANES_SELECT(bounds->flags, (LaneInt)(BOUNDS_FOR_MAP), for_map);
    return inside | out_of_range;
}

// What a work-item counts.
typedef struct BoundsCounts {
    uint survivors, candidates, finite, looked_at;
    LaneFloat expected;
} BoundsCounts;

static BoundsCounts no_bounds_counts(void) {
    BoundsCounts counts = {0u, 0u, 0u, 0u, (LaneFloat)(0.0f)};
    return counts;
}

// What of GN_LANES triangles may matter; *first is the first of them.
static LaneInt bound_block(uint block, __constant const Projection* projection, uint triangle_count, uint has_pyramid,
                           __global const float* vertices, __global const uint* pyramid, uint* first,
                           BoundsBlock* found, BoundsCounts* counts) {
    *first = block * GN_LANES;
    if (*first >= triangle_count) return (LaneInt)(0);  // past the end of the last cluster
    uint count = min(triangle_count - *first, (uint)GN_LANES);
    TriangleBlock t = load_triangles(vertices, *first, triangle_count);
    LaneInt finite = LANE_COMPARE((LaneInt)((int)count), >, LANE_INDEX) & finite_triangles(&t);
    counts->looked_at += count;
    counts->finite += count_lanes(finite);
    LaneInt survivors = bound_triangles(&t, finite, projection, pyramid, has_pyramid != 0u, found);
    counts->survivors += count_lanes(survivors);
    return survivors;
}

// TriangleBounds, in the order of its members.
static uint4 lane_bounds(const BoundsBlock* found, uint lane, uint id) {
    return (uint4)((uint)LANE_OF_INT(found->x0, lane) | (uint)LANE_OF_INT(found->y0, lane) << 16,
                   (uint)LANE_OF_INT(found->x1, lane) | (uint)LANE_OF_INT(found->y1, lane) << 16,
                   (uint)LANE_OF_INT(found->z, lane) | (uint)LANE_OF_INT(found->flags, lane) << 16, id);
}

#ifdef GN_CPU
// What a work-item's triangles are asked, where those go that may matter, and what it counts.
typedef struct BoundsWork {
    __constant const Projection* projection;
    __global const float* vertices;  // of the first triangle
    __global const uint* pyramid;
    __global TriangleBounds* bounds;
    __global uint* map_candidates;
    __global FrameCounters* counters;
    uint triangle_count, capacity, has_pyramid;
    Reservation slots, candidates;
    BoundsCounts counts;
} BoundsWork;

static void append_block(BoundsWork* work, uint block) {
    uint first;
    BoundsBlock found;
    LaneInt survivors = bound_block(block, work->projection, work->triangle_count, work->has_pyramid, work->vertices,
                                    work->pyramid, &first, &found, &work->counts);
    if (!LANES_ANY(survivors)) return;
    work->counts.expected +=
        LANES_SELECT((LaneFloat)(0.0f), found.expected, survivors & LANE_COMPARE(found.flags, !=, (LaneInt)(0)));
    for (int lane = 0; lane < GN_LANES; ++lane) {
        if (!LANE_OF_INT(survivors, lane)) continue;
        bool for_map = LANE_OF_INT(found.flags, lane) != 0;
        work->counts.candidates += for_map;
        uint slot = reservation(&work->slots, &work->counters->slots);
        if (slot >= work->capacity) continue;
        *(__global uint4*)&work->bounds[slot] = lane_bounds(&found, lane, first + (uint)lane);
        if (!for_map) continue;
        uint place = reservation(&work->candidates, &work->counters->map_slots);
        if (place < work->capacity) work->map_candidates[place] = slot;
    }
}

// A CPU takes GN_LANES clusters at a time: of those that are listed, or (else) those of all whose boxes, made on the
// way, say that they may matter. A box around triangles takes a small part of the time that bounding them one by one
// does; where less than one in FEW_DROPPED clusters is dropped by it, the next groups go without.
#define BLOCKS_OF_CLUSTER (CLUSTER_TRIANGLES / GN_LANES)
#define FEW_DROPPED 4u
#define GROUPS_WITHOUT_BOXES 3u

typedef struct ClusterChoice {
    uint clusters[GN_LANES];
    uint count;
} ClusterChoice;

static void choose_all(uint first, uint count, ClusterChoice* choice) {
    for (uint k = 0; k < count; ++k) choice->clusters[k] = first + k;
    choice->count = count;
}

static void choose_listed(__global const uint* clusters, uint first, uint count, ClusterChoice* choice) {
    for (uint k = 0; k < count; ++k) choice->clusters[k] = clusters[first + k];
    choice->count = count;
}

GN_NOINLINE_ON_CPU void choose_by_boxes(BoundsWork* work, uint first, uint count, ClusterChoice* choice) {
    ClusterBoxes boxes;
    make_boxes(work->vertices, work->triangle_count, first, &boxes);
    LaneInt too_far, present = LANE_COMPARE(boxes.low[0], <=, boxes.high[0]);
    LaneInt matter = visible_boxes(&boxes, present, work->projection, work->pyramid, work->has_pyramid != 0u, &too_far);
    choice->count = 0;
    for (uint lane = 0; lane < count; ++lane) {
        uint cluster = first + lane;
        if (LANE_OF_INT(matter, lane)) {
            choice->clusters[choice->count++] = cluster;
        } else {
            uint triangles = min(work->triangle_count - cluster * CLUSTER_TRIANGLES, CLUSTER_TRIANGLES);
            work->counts.looked_at += triangles;
            work->counts.finite += triangles - (uint)LANE_OF_INT(boxes.not_finite, lane);
        }
    }
}

// Every `step`th group of clusters: where most are dropped others are in view, and work-items that took neighbours
// would take unlike times.
GN_NOINLINE_ON_CPU void bound_clusters(ItemRange items, uint cluster_count, uint has_clusters,
                                       __global const uint* clusters, BoundsWork* work) {
    uint without_boxes = 0;
    for (size_t i = items.first; i < items.end; i += items.step) {
        uint first = (uint)i * GN_LANES, count = min(cluster_count - first, (uint)GN_LANES);
        ClusterChoice choice;
        if (has_clusters) {
            choose_listed(clusters, first, count, &choice);
        } else if (without_boxes != 0u) {
            choose_all(first, count, &choice);
            --without_boxes;
        } else {
            choose_by_boxes(work, first, count, &choice);
            if ((count - choice.count) * FEW_DROPPED < count) without_boxes = GROUPS_WITHOUT_BOXES;
        }
        for (uint k = 0; k < choice.count * BLOCKS_OF_CLUSTER; ++k)
            append_block(work, choice.clusters[k / BLOCKS_OF_CLUSTER] * BLOCKS_OF_CLUSTER + k % BLOCKS_OF_CLUSTER);
    }
}
#endif

// A GPU's work-group keeps what it finds in `found`, BOUNDS_AT_ONCE for each of its items, and claims places for all of
// it by one atomic: one for each warp takes longer than the pass.
__kernel void triangle_bounds(__constant const Projection* projection, uint triangle_count, ulong first_float,
                              uint capacity, uint has_clusters, uint has_pyramid, __global const float* vertices,
                              __global const uint* clusters, __global const uint* pyramid,
                              __global TriangleBounds* bounds, __global uint* map_candidates,
                              __global FrameCounters* counters, __local uint4* found) {
    __local uint sum;
    vertices += first_float;
#ifdef GN_CPU
    uint cluster_count = triangle_count / CLUSTER_TRIANGLES + (triangle_count % CLUSTER_TRIANGLES != 0u);
    if (has_clusters) cluster_count = counters->clusters_listed;
    if (projection->active_points == 0u) cluster_count = 0u;
    BoundsWork work;
    work.projection = projection;
    work.vertices = vertices;
    work.pyramid = pyramid;
    work.bounds = bounds;
    work.map_candidates = map_candidates;
    work.counters = counters;
    work.triangle_count = triangle_count;
    work.capacity = capacity;
    work.has_pyramid = has_pyramid;
    work.slots = work.candidates = no_reservation();
    work.counts = no_bounds_counts();
    ItemRange items = {get_global_id(0), (cluster_count + GN_LANES - 1u) / GN_LANES, get_global_size(0)};
    bound_clusters(items, cluster_count, has_clusters, clusters, &work);
    for (; work.slots.next < min(work.slots.end, capacity); ++work.slots.next) drop_bounds(&bounds[work.slots.next]);
    for (; work.candidates.next < min(work.candidates.end, capacity); ++work.candidates.next)
        map_candidates[work.candidates.next] = GN_NO_ID;
    BoundsCounts counts = work.counts;
    // Cut off at what is enough, here and where the others have counted as much, so that no sum overflows.
    uint enough = texels_worth_a_map(projection->width, projection->height);
    uint texels = (uint)LANES_SUM(LANES_TO_INT(LANES_MIN(counts.expected, (LaneFloat)((float)enough))));
    volatile __global uint* counted = &counters->map_expected;
    if (texels != 0 && GN_RELAXED_LOAD(counted) < enough) atomic_add(counted, min(texels, enough));
#else
    uint blocks = has_clusters ? counters->clusters_listed * CLUSTER_TRIANGLES : triangle_count;
    if (projection->active_points == 0u) blocks = 0u;
    BoundsCounts counts = no_bounds_counts();
    __local uint reserved[GROUP_APPEND_WORDS];
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), many = items * BOUNDS_AT_ONCE;
    if (item == 0u) reserved[0] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint base = (uint)get_group_id(0) * many; base < blocks; base += (uint)get_num_groups(0) * many) {
        for (uint i = base + item; i < min(base + many, blocks); i += items) {
            uint id;
            BoundsBlock of;
            uint block = has_clusters ? clusters[i / CLUSTER_TRIANGLES] * CLUSTER_TRIANGLES + i % CLUSTER_TRIANGLES : i;
            if (bound_block(block, projection, triangle_count, has_pyramid, vertices, pyramid, &id, &of, &counts))
                found[atomic_inc(&reserved[0])] = lane_bounds(&of, 0u, id);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        uint count = reserved[0], first = reserve_for_group(count, reserved, &counters->slots);
        if (item == 0u) reserved[0] = 0u;
        for (uint i = item; i < count; i += items) {
            bool for_map = (found[i].z >> 16 & BOUNDS_FOR_MAP) != 0u;
            counts.candidates += for_map;
            if (first + i >= capacity) continue;
            *(__global uint4*)&bounds[first + i] = found[i];
            if (!for_map) continue;
            uint place = reserve_slots(1u, &counters->map_slots);
            if (place < capacity) map_candidates[place] = first + i;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
#endif
    uint not_finite = counts.looked_at - counts.finite, outside = counts.finite - counts.survivors;
    add_in_group(counts.survivors, &sum, &counters->survivors);
    add_in_group(counts.candidates, &sum, &counters->map_candidates);
    add_in_group(not_finite, &sum, &counters->not_finite);
    add_in_group(outside, &sum, &counters->outside);
}

// ---- Records --------------------------------------------------------------------------------------------------------

// Bins as texels (square_of_bins).
static Rectangles squares_of_bins(const BinRectangles* bins, __constant const Projection* projection) {
    float size = (float)(1u << projection->bin_log2);
    Rectangles square = {LANES_TO_FLOAT(bins->x0) * size, LANES_TO_FLOAT(bins->y0) * size,
                         LANES_TO_FLOAT(bins->x1 + 1) * size, LANES_TO_FLOAT(bins->y1 + 1) * size};
    return square;
}

// The float filters of triangles that survived, for all points of their bins. Returns those not exactly edge-on.
static LaneInt make_records(const TriangleBlock* t, LaneInt lanes, __constant const Projection* projection,
                            const BinRectangles* bins, RecordBlock* record, uint* exact) {
    if (projection->indistinct) {
        set_undecided(record, (LaneInt)(-1));
        return lanes;
    }
    ProjectedTriangles p = project_triangles(t, projection);
    const Projected* v = p.v;
    LaneInt in_range = lanes & ~p.sides.out_of_range;
    LaneFloat orientation =
        LANES_TO_FLOAT(orientations_from_light(t, projection, in_range, exact)) * projection->handedness;
    in_range &= LANE_COMPARE(orientation, !=, (LaneFloat)(0.0f));

    Rectangles domain = squares_of_bins(bins, projection);
    LaneFloat reach = LANES_MAX(domain.x1, domain.y1) + projection->point_error;
    LaneFloat rho[3], error[3];
    for (int i = 0; i < 3; ++i) {
        error[i] = v[i].error + reach * v[i].error_w;
        rho[i] = largest_offset(v[i].x, v[i].y, v[i].w, domain) + error[i] + fabs(v[i].w) * projection->point_error;
    }
    LaneFloat margin = (LaneFloat)(0.0f);
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3;
        Edge edge = make_edge(&v[i], v[j].x - v[i].x, v[j].y - v[i].y, v[j].w - v[i].w);
        record->edge_x[i] = orientation * edge.x;
        record->edge_y[i] = orientation * edge.y;
        record->edge_0[i] = orientation * edge.c;
        LaneFloat bound = (rho[i] * error[j] + rho[j] * error[i] + error[i] * error[j]) * 2.0f +
                          (reach * (edge.size_x + edge.size_y) + edge.size_c) * (6.0f * GN_U) +
                          (fabs(edge.x) + fabs(edge.y)) * projection->point_error;
        bound *= BOUND_INFLATION;
        margin = LANES_MAX(bound, margin);
    }
    record->margin_edge = margin + 1.0e-30f;
    height_intervals(v, 3, p.sides.straddles, projection, &record->z_low, &record->z_high);
    if (IS_PERSPECTIVE(*projection))
        set_plane_perspective(record, v, domain, orientation, p.sides.straddles, projection->point_error,
                              projection->height_error);
    else
        set_plane_parallel(record, v, domain, orientation, projection->point_error, projection->height_error);
    if (LANES_ANY(p.sides.out_of_range)) set_undecided(record, p.sides.out_of_range);
    return in_range | (lanes & p.sides.out_of_range);
}

// ---- Tiles ----------------------------------------------------------------------------------------------------------

typedef struct TileWork {
    __constant const Projection* projection;
    __global const float* vertices;  // of the first triangle
    __global const uint* numbers;    // of the triangles in the clusters' order, if `has_numbers`
    __global const uint* heights;
    __global TriangleBounds* bounds;
    __global TriangleRecord* records;
    __global const uint* map_candidates;
    __global uint2* tiles;
    __global uint* tiles_wanted;
    uint tile_capacity, has_numbers, has_heights, for_map;
    uint hidden, edge_on, exact;
    Reservation places;
#ifdef GN_CPU
    uint lists_pairs;
    PairList pairs;  // if `lists_pairs`: of small triangles, which then have no tiles
#endif
} TileWork;

// Triangles of the list that are worth a record, and their bins: GN_LANES of them, or fewer.
typedef struct Chosen {
    uint count;
    uint slots[GN_LANES], ids[GN_LANES];  // as triangle_bounds left them
    BinRectangles bins;
} Chosen;

// What of GN_LANES triangles from the i-th on is worth a record, and their bins. What is dropped from the lists keeps
// empty bounds.
typedef struct Choice {
    LaneInt slots, chosen;
    BinRectangles bins;
} Choice;

static Choice choose(TileWork* work, uint i, uint count) {
    Choice choice;
    choice.chosen = LANE_COMPARE((LaneInt)((int)min(count - i, (uint)GN_LANES)), >, LANE_INDEX);
    choice.slots = LANES_SELECT((LaneInt)(0), LANE_INDEX, choice.chosen) + (LaneInt)((int)i);
    __global const float* rows[GN_LANES];
    if (work->for_map) {
        for (int lane = 0; lane < GN_LANES; ++lane)
            rows[lane] = (__global const float*)&work->map_candidates[(uint)LANE_OF_INT(choice.slots, lane)];
        choice.slots = LANES_AS_INT(LANES_OF_ROWS(rows, 0));
        choice.chosen &= LANE_COMPARE(choice.slots, !=, (LaneInt)((int)GN_NO_ID));
        choice.slots = LANES_SELECT((LaneInt)(0), choice.slots, choice.chosen);
    }
    for (int lane = 0; lane < GN_LANES; ++lane)
        rows[lane] = (__global const float*)&work->bounds[(uint)LANE_OF_INT(choice.slots, lane)];
    LaneInt low = LANES_AS_INT(LANES_OF_ROWS(rows, 0)), high = LANES_AS_INT(LANES_OF_ROWS(rows, 1));
    LaneInt x0 = low & 0xFFFF, y0 = low >> 16 & 0xFFFF, x1 = high & 0xFFFF, y1 = high >> 16 & 0xFFFF;
    choice.chosen &= LANE_COMPARE(x0, <=, x1);
    if (!LANES_ANY(choice.chosen)) return choice;
    __constant const Projection* projection = work->projection;
    uint bin_log2 = projection->bin_log2;
    choice.bins.x0 = bins_of_quantised(max(x0, 1) - 1, projection->width, bin_log2);
    choice.bins.y0 = bins_of_quantised(max(y0, 1) - 1, projection->height, bin_log2);
    choice.bins.x1 = bins_of_quantised(x1, projection->width, bin_log2);
    choice.bins.y1 = bins_of_quantised(y1, projection->height, bin_log2);
    if (!work->has_heights) return choice;
    LaneFloat lowest = lanes_lowest_height_under(work->heights, projection, choice.bins);
    LaneInt z = LANES_AS_INT(LANES_OF_ROWS(rows, 2)) & 0xFFFF;
    LaneInt hidden = LANE_COMPARE(z, <, quantised((lowest - projection->z_origin) * projection->z_scale)) |
                     LANE_COMPARE(lowest, ==, (LaneFloat)(INFINITY));
    hidden &= choice.chosen;
    if (!LANES_ANY(hidden)) return choice;
    work->hidden += count_lanes(hidden);
    choice.chosen &= ~hidden;
    if (work->for_map) return choice;
    for (int lane = 0; lane < GN_LANES; ++lane)
        if (LANE_OF_INT(hidden, lane)) drop_bounds(&work->bounds[(uint)LANE_OF_INT(choice.slots, lane)]);
    return choice;
}

static uint4 lane_bins(const BinRectangles* bins, uint lane) {
    return (uint4)((uint)LANE_OF_INT(bins->x0, lane), (uint)LANE_OF_INT(bins->y0, lane),
                   (uint)LANE_OF_INT(bins->x1, lane), (uint)LANE_OF_INT(bins->y1, lane));
}
static void set_lane_bins(BinRectangles* bins, uint lane, uint4 of) {
    LANE_OF_INT(bins->x0, lane) = (int)of.x, LANE_OF_INT(bins->y0, lane) = (int)of.y;
    LANE_OF_INT(bins->x1, lane) = (int)of.z, LANE_OF_INT(bins->y1, lane) = (int)of.w;
}

static void add_chosen(const TileWork* work, const Choice* choice, int lane, Chosen* chosen) {
    uint slot = (uint)LANE_OF_INT(choice->slots, lane);
    chosen->slots[chosen->count] = slot;
    chosen->ids[chosen->count] = work->bounds[slot].id;
    __global const float* vertices = work->vertices + 9 * (size_t)chosen->ids[chosen->count];
    GN_PREFETCH(vertices);
    GN_PREFETCH(vertices + 8);
    set_lane_bins(&chosen->bins, chosen->count, lane_bins(&choice->bins, lane));
    ++chosen->count;
}

// Makes the records of the chosen; returns which are kept, the others being exactly edge-on. There must be at least
// one.
static LaneInt prepare(TileWork* work, Chosen* chosen, RecordBlock* records) {
    __global const float* rows[GN_LANES];
    for (uint lane = 0; lane < GN_LANES; ++lane) {
        uint one = min(lane, chosen->count - 1u);
        rows[lane] = work->vertices + 9 * (size_t)chosen->ids[one];
        if (lane != one) set_lane_bins(&chosen->bins, lane, lane_bins(&chosen->bins, one));
    }
    TriangleBlock t = load_triangle_rows(rows);
    LaneInt lanes = LANE_COMPARE((LaneInt)((int)chosen->count), >, LANE_INDEX);
    LaneInt kept = make_records(&t, lanes, work->projection, &chosen->bins, records, &work->exact);
    LaneInt dropped = lanes & ~kept;
    if (!LANES_ANY(dropped)) return kept;
    work->edge_on += count_lanes(dropped);
    for (uint lane = 0; lane < chosen->count; ++lane)
        if (LANE_OF_INT(dropped, lane)) drop_bounds(&work->bounds[chosen->slots[lane]]);
    return kept;
}

// Stores the records that are kept; returns those whose tiles are wanted.
static LaneInt store_chosen(const TileWork* work, const Chosen* chosen, const RecordBlock* records, LaneInt kept) {
    store_records(records, kept, chosen->slots, work->records);
    if (work->for_map) return kept & LANE_COMPARE(records->margin_plane, <, (LaneFloat)(INFINITY));
    if (!work->has_numbers) return kept;
    for (uint lane = 0; lane < chosen->count; ++lane)
        if (LANE_OF_INT(kept, lane)) work->bounds[chosen->slots[lane]].id = work->numbers[chosen->ids[lane]];
    return kept;
}

#ifdef GN_CPU
static void append_tile(TileWork* work, uint slot, uint tile) {
    uint place = reservation(&work->places, work->tiles_wanted);
    if (place < work->tile_capacity) work->tiles[place] = (uint2)(slot, tile);
}

static void append_tile_if_matters(TileWork* work, uint slot, uint4 bins, uint i) {
    uint tile = tile_of_bins(bins, i);
    TriangleRecord record = work->records[slot];
    if (survives_cull(&record, work->projection, bins_of_tile(tile), work->has_heights, work->heights))
        append_tile(work, slot, tile);
}

// Most triangles are in four bins at most: 2 x 2 of them are looked at in GN_LANES triangles at once, while their
// records are at hand, and no tile is made. Returns which of those kept were that small.
static LaneInt append_small(TileWork* work, const Chosen* chosen, const RecordBlock* records, LaneInt kept) {
    const BinRectangles* bins = &chosen->bins;
    LaneInt slots = LANES_AS_INT(LANES_STRIDED((const float*)chosen->slots, 1));
    LaneInt small = kept & LANE_COMPARE((bins->x1 - bins->x0) | (bins->y1 - bins->y0), <=, (LaneInt)(1));
    for (int corner = 0; corner < 4; ++corner) {
        LaneInt right = bins->x0 + (corner & 1), down = bins->y0 + (corner >> 1);
        LaneInt x = min(right, bins->x1), y = min(down, bins->y1);
        LaneInt matters = small & LANE_COMPARE(x, ==, right) & LANE_COMPARE(y, ==, down);
        if (!LANES_ANY(matters)) continue;
        matters &= lanes_survive_cull(records, work->projection, x, y, work->has_heights, work->heights);
        append_lanes(&work->pairs, slots, x, y, matters);
    }
    return small;
}

// A triangle of so few tiles that its work-item lists all its pairs.
#define TILES_LISTED_AT_ONCE 4u

static void append_tiles_at_once(TileWork* work, const Chosen* chosen, const RecordBlock* records, uint lane) {
    RecordBlock record;
    spread_lane(records, lane, &record);
    uint4 bins = lane_bins(&chosen->bins, lane);
    uint tile_count = tile_count_of(bins);
    for (uint tile = 0; tile < tile_count; ++tile)
        append_bins(&work->pairs, chosen->slots[lane], &record, bins_of_tile(tile_of_bins(bins, tile)));
}

// Pairs of those kept that are not too large for it. Returns which these are.
static LaneInt append_at_once(TileWork* work, const Chosen* chosen, const RecordBlock* records, LaneInt kept) {
    LaneInt listed = append_small(work, chosen, records, kept), others = kept & ~listed;
    if (!LANES_ANY(others)) return listed;
    for (uint lane = 0; lane < chosen->count; ++lane) {
        if (!LANE_OF_INT(others, lane)) continue;
        if (tile_count_of(lane_bins(&chosen->bins, lane)) > TILES_LISTED_AT_ONCE) continue;
        append_tiles_at_once(work, chosen, records, lane);
        LANE_OF_INT(listed, lane) = -1;
    }
    return listed;
}

// Of all that are chosen; then none is.
GN_NOINLINE_ON_CPU void append_tiles_of(TileWork* work, Chosen* chosen) {
    RecordBlock records;
    LaneInt kept = prepare(work, chosen, &records), listed = (LaneInt)(0);
    // Before the records are stored: an atomic of a CPU waits for all stores before it.
    if (work->lists_pairs) listed = append_at_once(work, chosen, &records, kept);
    LaneInt wanted = store_chosen(work, chosen, &records, kept) & ~listed;
    if (!LANES_ANY(wanted)) chosen->count = 0;
    for (uint lane = 0; lane < chosen->count; ++lane) {
        if (!LANE_OF_INT(wanted, lane)) continue;
        uint slot = chosen->slots[lane];
        uint4 bins = lane_bins(&chosen->bins, lane);
        uint tile_count = tile_count_of(bins);
        if (tile_count == 1u)
            append_tile(work, slot, tile_of_bins(bins, 0));
        else
            for (uint tile = 0; tile < tile_count; ++tile) append_tile_if_matters(work, slot, bins, tile);
    }
    chosen->count = 0;
}

GN_NOINLINE_ON_CPU void append_tiles(ItemRange items, TileWork* work, uint count) {
    Chosen chosen;
    chosen.count = 0;
    GN_FOR_EACH_OF(block, items) {
        Choice choice = choose(work, (uint)block * GN_LANES, count);
        if (!LANES_ANY(choice.chosen)) continue;
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(choice.chosen, lane)) continue;
            add_chosen(work, &choice, lane, &chosen);
            if (chosen.count == GN_LANES) append_tiles_of(work, &chosen);
        }
    }
    if (chosen.count != 0u) append_tiles_of(work, &chosen);
    for (; work->places.next < min(work->places.end, work->tile_capacity); ++work->places.next)
        work->tiles[work->places.next] = (uint2)(GN_NO_ID, 0);
    close_pairs(&work->pairs);
}
#endif

// A CPU's work-item takes its triangles as they come, and asks of each tile whether it matters; with `lists_pairs`
// small triangles become pairs at once. A GPU's work-group shares out the tiles of its triangles evenly, since one may
// have thousands; who takes them from the list (tile_bins.h) asks.
__kernel void triangle_tiles(__constant const Projection* projection, ulong first_float, uint capacity,
                             uint tile_capacity, uint has_numbers, uint has_heights, uint for_map, uint lists_pairs,
                             uint pair_capacity, __global const float* vertices, __global const uint* numbers,
                             __global const uint* heights, __global TriangleBounds* bounds,
                             __global TriangleRecord* records, __global const uint* map_candidates,
                             __global uint2* tiles, __global uint* bin_counts, __global Pair* pairs,
                             __global FrameCounters* counters, __local uint* ends, __local uint4* ranges,
                             __local uint* slots) {
    __local uint sum;
    TileWork work;
    work.projection = projection;
    work.vertices = vertices + first_float;
    work.numbers = numbers;
    work.heights = heights;
    work.bounds = bounds;
    work.records = records;
    work.map_candidates = map_candidates;
    work.tiles = tiles;
    work.tiles_wanted = for_map ? &counters->map_tiles : &counters->tiles;
    work.tile_capacity = tile_capacity;
    work.has_numbers = has_numbers;
    work.has_heights = has_heights;
    work.for_map = for_map;
    work.hidden = work.edge_on = work.exact = 0;
    work.places = no_reservation();
    uint count = min(for_map ? counters->map_slots : counters->slots, capacity);
    if (for_map && projection->map_disabled) count = 0;
#ifdef GN_CPU
    PairList list = {projection,  heights,       bin_counts, pairs,           &counters->pairs,
                     has_heights, pair_capacity, 0u,         no_reservation()};
    work.lists_pairs = lists_pairs;
    work.pairs = list;
    append_tiles(item_range((count + GN_LANES - 1u) / GN_LANES), &work, count);
    add_in_group(work.pairs.found, &sum, &counters->references);
#else
    __local uint reserved[GROUP_APPEND_WORDS];
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    GN_ROUNDS(round, count) {
        uint i = index_in_round(round, count), tile_count = 0;
        Chosen chosen;
        chosen.count = 0;
        if (i < count) {
            Choice choice = choose(&work, i, count);
            if (choice.chosen) add_chosen(&work, &choice, 0, &chosen);
        }
        RecordBlock records;
        LaneInt kept = chosen.count == 0u ? 0 : prepare(&work, &chosen, &records);
        if (kept && store_chosen(&work, &chosen, &records, kept)) {
            slots[item] = chosen.slots[0];
            ranges[item] = lane_bins(&chosen.bins, 0);
            tile_count = tile_count_of(ranges[item]);
        }
        scan_group(tile_count, ends);
        uint total = ends[items - 1u], end;
        for (uint first = 0; first < total; first = end) {
            end = min(total, first + items * LARGEST_GROUP_APPEND);
            uint place = reserve_for_group(end - first, reserved, work.tiles_wanted);
            for (uint piece = first + item; piece < end; piece += items) {
                uint at = place + (piece - first), owner = item_of_piece(ends, piece);
                if (at >= tile_capacity) break;
                uint tile = tile_of_bins(ranges[owner], owner == 0u ? piece : piece - ends[owner - 1u]);
                tiles[at] = (uint2)(slots[owner], tile);
            }
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
#endif
    add_in_group(work.edge_on, &sum, &counters->edge_on);
    add_in_group(work.exact, &sum, &counters->setup_exact);
    add_in_group(work.hidden, &sum, for_map ? &counters->map_hidden : &counters->hidden);
}
