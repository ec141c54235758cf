// SPDX-License-Identifier: MIT
// Triangle setup: bounds every triangle in the grid, drops those that cannot matter, and makes records for the rest.
//
// triangle_bounds looks at the whole scene and drops, each counted: a NaN or infinite vertex; behind the light or
// outside the grid; farther from the light than every point it could cover (a pyramid of farthest heights). What is
// left goes into a list of 16 bytes each. triangle_tiles takes that list, or the part of it that may cover whole texels
// (the conservative map is drawn first, and then hides many of the others): it makes the record, drops what is exactly
// edge-on to the rays (never blocks, by contract), and cuts the triangle's bins into tiles. So no later stage walks a
// triangle: they walk tiles, which are all of about the same size.
//
// Error bounds. Let a, b, c be the projected vertices, p = (X, Y, 1) a point of the grid, and r_a = a - a_w p the first
// two coordinates of a relative to p. Then (Mizoguchi's and everybody's) edge function is
//     e_ab = det(a, b, p) = cross(r_a, r_b).
// a is off by at most E_a = error + R error_w in r_a, where R bounds |X|, |Y|. With |r_a| <= rho_a over the triangle's
// bins,    |cross error| <= 2 (rho_a E_b + rho_b E_a + E_a E_b).
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
#include "bin_test.h"
#include "exact/det3.h"
#include "group_scan.h"
#include "points.h"

#define BOUND_INFLATION 1.01f
#define UNDERFLOW 1.0e-36f
// Beyond this (texels) a projected vertex no longer says anything useful: every test of the triangle is exact.
#define WILD_TEXELS 1.0e12f

typedef struct Edge {
    float x, y, c;                 // coefficients
    float size_x, size_y, size_c;  // sums of the magnitudes of the products that make them
} Edge;

// a x (b - a), as d = b - a.
static Edge make_edge(Projected a, float d_x, float d_y, float d_w) {
    Edge edge;
    edge.x = fma(a.y, d_w, -(a.w * d_y));
    edge.y = fma(a.w, d_x, -(a.x * d_w));
    edge.c = fma(a.x, d_y, -(a.y * d_x));
    edge.size_x = fabs(a.y * d_w) + fabs(a.w * d_y);
    edge.size_y = fabs(a.w * d_x) + fabs(a.x * d_w);
    edge.size_c = fabs(a.x * d_y) + fabs(a.y * d_x);
    return edge;
}

// Largest coordinate difference between vertex a and any point of the rectangle (x0, y0, x1, y1), times a.w.
static float largest_offset(Projected a, float4 rectangle) {
    float x = fmax(fabs(a.x - a.w * rectangle.x), fabs(a.x - a.w * rectangle.z));
    float y = fmax(fabs(a.y - a.w * rectangle.y), fabs(a.y - a.w * rectangle.w));
    return fmax(x, y);
}

// The orientation of the triangle as the light sees it, for certain: 0 means exactly edge-on.
static int orientation_from_light(Triangle t, __constant const Projection* projection, int* level) {
    float3 light = (float3)(projection->light[0], projection->light[1], projection->light[2]);
    if (projection->light[3] != 0.0f) return det3_sign(t.a, light, t.b, light, t.c, light, level);
    return det3_sign(t.b, t.a, t.c, t.a, light, (float3)(0.0f), level);
}

// A record under which every test is uncertain.
static TriangleRecord undecided_record(void) {
    TriangleRecord record;
    for (int i = 0; i < 3; ++i) record.edge_x[i] = record.edge_y[i] = record.edge_0[i] = 0.0f;
    record.plane_x = record.plane_y = record.plane_0 = 0.0f;
    record.margin_edge = record.margin_plane = INFINITY;
    record.z_low = -INFINITY;
    record.z_high = INFINITY;
    return record;
}

// The interval of one grid coordinate that a triangle's part in front of the light (W > 0) can cover.
//
// X <= x there if h_x - x h_w <= 0 for all three vertices, since the left side is linear over the triangle. In front,
// a vertex asks for x >= X, behind for x <= X, near W = 0 for h_x <= 0 whatever x of the grid. So the bound is the
// largest X in front, if those behind and near agree with it, else there is none; the lower bound likewise.
typedef struct Interval {
    float low, high;                // of the vertices in front
    float behind_low, behind_high;  // of those behind
    bool has_low, has_high;         // no vertex near W = 0 speaks against the bound
} Interval;

static Interval empty_interval(void) {
    Interval interval;
    interval.low = interval.behind_low = INFINITY;
    interval.high = interval.behind_high = -INFINITY;
    interval.has_low = interval.has_high = true;
    return interval;
}

// h is the vertex's coordinate before the division, w and its error as in Projected, reach the largest coordinate.
static void include_vertex(Interval* interval, float h, float error, float w, float error_w, float reach) {
    if (fabs(w) > 2.0f * error_w) {
        // The quotient is off by at most (error + |x| error_w) / (|w| - error_w), the division by at most 3 ulp.
        float x = h / w, size = fabs(x);
        float slack = BOUND_INFLATION * ((error + size * error_w) / (fabs(w) - error_w) + 8.0f * GN_U * size);
        // An infinite quotient says nothing, and its NaN difference to the slack would be passed over.
        if (!(slack < INFINITY)) interval->has_low = interval->has_high = false;
        if (w > 0.0f) {
            interval->low = fmin(interval->low, x - slack);
            interval->high = fmax(interval->high, x + slack);
        } else {
            interval->behind_low = fmin(interval->behind_low, x - slack);
            interval->behind_high = fmax(interval->behind_high, x + slack);
        }
    } else {
        float slack = BOUND_INFLATION * (error + reach * (fabs(w) + error_w));
        interval->has_high = interval->has_high && h + slack <= 0.0f;
        interval->has_low = interval->has_low && h - slack >= 0.0f;
    }
}

// The bounds within [-1, last + 1] (a bound outside the grid is as good as any farther one, and serves where no vertex
// is in front), a point's error added.
static float2 bounds_of(Interval interval, float point_error, float last) {
    float low = fmin(interval.low, last + 1.0f), high = fmax(interval.high, -1.0f);
    bool has_low = interval.has_low && low >= interval.behind_high;
    bool has_high = interval.has_high && high <= interval.behind_low;
    return (float2)(has_low ? low - point_error : 0.0f, has_high ? high + point_error : last);
}

// Texel rectangle (x0, y0, x1, y1) that holds everything the triangle can cover of the grid. False if that is nothing.
static bool covered_rectangle(const Projected* v, __constant const Projection* projection, float4* rectangle) {
    float width = (float)projection->width, height = (float)projection->height;
    Interval x = empty_interval(), y = empty_interval();
    for (int i = 0; i < 3; ++i) {
        include_vertex(&x, v[i].x, v[i].error, v[i].w, v[i].error_w, width + 1.0f);
        include_vertex(&y, v[i].y, v[i].error, v[i].w, v[i].error_w, height + 1.0f);
    }
    float2 x_bounds = bounds_of(x, projection->point_error, width);
    float2 y_bounds = bounds_of(y, projection->point_error, height);
    if (!(x_bounds.y >= 0.0f && y_bounds.y >= 0.0f && x_bounds.x < width && y_bounds.x < height)) return false;
    *rectangle =
        (float4)(fmax(x_bounds.x, 0.0f), fmax(y_bounds.x, 0.0f), fmin(x_bounds.y, width), fmin(y_bounds.y, height));
    return true;
}

// Sets plane and its margin; leaves them undecided where the triangle is too near to edge-on for floats.
static void set_plane_parallel(TriangleRecord* record, const Projected* v, float4 rectangle, float orientation,
                               float point_error, float height_error) {
    float error_1 = v[0].error + v[1].error, error_2 = v[0].error + v[2].error;
    float error_1z = v[0].error_z + v[1].error_z, error_2z = v[0].error_z + v[2].error_z;
    float x1 = v[1].x - v[0].x, y1 = v[1].y - v[0].y, z1 = v[1].z - v[0].z;
    float x2 = v[2].x - v[0].x, y2 = v[2].y - v[0].y, z2 = v[2].z - v[0].z;
    float n_x = fma(y1, z2, -(z1 * y2));
    float n_y = fma(z1, x2, -(x1 * z2));
    float n_z = fma(x1, y2, -(y1 * x2));
    float ax1 = fabs(x1), ay1 = fabs(y1), az1 = fabs(z1), ax2 = fabs(x2), ay2 = fabs(y2), az2 = fabs(z2);
    float delta_x = ay1 * error_2z + az2 * error_1 + az1 * error_2 + ay2 * error_1z + error_1 * error_2z +
                    error_1z * error_2 + 4.0f * GN_U * (ay1 * az2 + az1 * ay2);
    float delta_y = az1 * error_2 + ax2 * error_1z + ax1 * error_2z + az2 * error_1 + error_1 * error_2z +
                    error_1z * error_2 + 4.0f * GN_U * (az1 * ax2 + ax1 * az2);
    float delta_z = ax1 * error_2 + ay2 * error_1 + ay1 * error_2 + ax2 * error_1 + 2.0f * error_1 * error_2 +
                    4.0f * GN_U * (ax1 * ay2 + ay1 * ax2);
    float safe_n_z = fabs(n_z) - BOUND_INFLATION * delta_z;
    if (!(safe_n_z > 0.25f * fabs(n_z)) || n_z * orientation <= 0.0f) return;

    float slope_x = -n_x / n_z, slope_y = -n_y / n_z;
    float height = v[0].z - (slope_x * v[0].x + slope_y * v[0].y);
    float rho = largest_offset(v[0], rectangle) + v[0].error + point_error;
    float rho_z = (fabs(n_x) + fabs(n_y)) * rho / safe_n_z;
    float error = v[0].error + point_error;
    float margin = (delta_x * rho + delta_y * rho + delta_z * rho_z + (fabs(n_x) + fabs(n_y)) * error) / safe_n_z +
                   v[0].error_z + height_error;
    float largest = fabs(slope_x) * fmax(fabs(v[0].x), rectangle.z) + fabs(slope_y) * fmax(fabs(v[0].y), rectangle.w) +
                    fabs(v[0].z);
    margin = BOUND_INFLATION * (margin + 20.0f * GN_U * largest);
    if (!(margin < INFINITY)) return;
    record->plane_x = slope_x;
    record->plane_y = slope_y;
    record->plane_0 = height;
    record->margin_plane = margin;
}

static void set_plane_perspective(TriangleRecord* record, const Projected* v, float4 rectangle, float orientation,
                                  bool straddles, float point_error, float height_error) {
    float x1 = v[1].x - v[0].x, y1 = v[1].y - v[0].y, w1 = v[1].w - v[0].w;
    float x2 = v[2].x - v[0].x, y2 = v[2].y - v[0].y, w2 = v[2].w - v[0].w;
    float n_x = fma(y1, w2, -(w1 * y2));
    float n_y = fma(w1, x2, -(x1 * w2));
    float n_w = fma(x1, y2, -(y1 * x2));
    float size_x = fabs(y1 * w2) + fabs(w1 * y2);
    float size_y = fabs(w1 * x2) + fabs(x1 * w2);
    float size_w = fabs(x1 * y2) + fabs(y1 * x2);
    float determinant = fma(n_x, v[0].x, fma(n_y, v[0].y, n_w * v[0].w));
    if (determinant * orientation <= 0.0f) return;

    // N . p, as the cross product of the sides relative to p.
    float reach = fmax(rectangle.z, rectangle.w) + point_error;
    float e_a = v[0].error + reach * v[0].error_w;
    float e_1 = e_a + v[1].error + reach * v[1].error_w, e_2 = e_a + v[2].error + reach * v[2].error_w;
    Projected side_1 = v[0], side_2 = v[0];
    side_1.x = x1, side_1.y = y1, side_1.w = w1;
    side_2.x = x2, side_2.y = y2, side_2.w = w2;
    float rho_1 = largest_offset(side_1, rectangle) + fabs(w1) * point_error;
    float rho_2 = largest_offset(side_2, rectangle) + fabs(w2) * point_error;
    float delta_np =
        2.0f * (rho_1 * e_2 + rho_2 * e_1 + e_1 * e_2) + 8.0f * GN_U * (reach * size_x + reach * size_y + size_w);
    // N . a: at a's own place in the grid it is a_w N . p, inside the rectangle unless the triangle straddles.
    float e_0 = v[0].error, e_0w = v[0].error_w;
    float delta_determinant = fabs(n_x) * e_0 + fabs(n_y) * e_0 + fabs(n_w) * e_0w +
                              4.0f * GN_U * (fabs(n_x * v[0].x) + fabs(n_y * v[0].y) + fabs(n_w * v[0].w)) +
                              UNDERFLOW * (1.0f + fabs(v[0].x) + fabs(v[0].y) + fabs(v[0].w));
    float a_x = fabs(v[0].x) / fabs(v[0].w), a_y = fabs(v[0].y) / fabs(v[0].w);
    bool a_in_grid = !straddles && a_x <= reach && a_y <= reach;
    if (a_in_grid) {
        // The bound above over the rectangle need not hold at a itself when the rectangle was cut to the grid.
        float4 whole = (float4)(fmin(rectangle.xy, (float2)(v[0].x, v[0].y) / v[0].w),
                                fmax(rectangle.zw, (float2)(v[0].x, v[0].y) / v[0].w));
        float place_error = e_a / (v[0].w - e_0w);  // of a in the grid
        float rho_1a = largest_offset(side_1, whole) + fabs(w1) * place_error;
        float rho_2a = largest_offset(side_2, whole) + fabs(w2) * place_error;
        float e_1a = e_1 + place_error * (v[0].error_w + v[1].error_w);
        float e_2a = e_2 + place_error * (v[0].error_w + v[2].error_w);
        float far_reach = reach + place_error;
        delta_determinant += (v[0].w + e_0w) * (2.0f * (rho_1a * e_2a + rho_2a * e_1a + e_1a * e_2a) +
                                                8.0f * GN_U * (far_reach * size_x + far_reach * size_y + size_w));
    } else {
        float side_error_1 = v[0].error + v[1].error + v[0].error_w + v[1].error_w;
        float side_error_2 = v[0].error + v[2].error + v[0].error_w + v[2].error_w;
        float side_1_size = fabs(x1) + fabs(y1) + fabs(w1), side_2_size = fabs(x2) + fabs(y2) + fabs(w2);
        float delta_n = side_1_size * side_error_2 + side_2_size * side_error_1 + side_error_1 * side_error_2;
        float far_x = fabs(v[0].x) + e_0, far_y = fabs(v[0].y) + e_0, far_w = fabs(v[0].w) + e_0w;
        delta_determinant +=
            delta_n * (far_x + far_y + far_w) + 4.0f * GN_U * (size_x * far_x + size_y * far_y + size_w * far_w);
    }
    float safe_determinant = fabs(determinant) - BOUND_INFLATION * delta_determinant;
    if (!(safe_determinant > 0.25f * fabs(determinant))) return;

    float plane_x = n_x / determinant, plane_y = n_y / determinant, plane_0 = n_w / determinant;
    float largest = fabs(plane_x) * reach + fabs(plane_y) * reach + fabs(plane_0);
    float margin = (delta_np + largest * delta_determinant) / safe_determinant;
    margin = BOUND_INFLATION * (margin + (fabs(n_x) + fabs(n_y)) / safe_determinant * point_error +
                                16.0f * GN_U * largest + 2.0f * height_error * largest);
    // A point with Z above 2 largest is nearer than the plane by more than its own relative error only if the margin
    // is not larger than the heights themselves.
    if (!(margin < 0.5f * largest)) return;
    record->plane_x = plane_x;
    record->plane_y = plane_y;
    record->plane_0 = plane_0;
    record->margin_plane = margin;
}

// Can the triangle cover a whole texel? Only if the texel's incircle, of radius 1/2, fits: 2 area / perimeter >= 1/2. A
// matter of speed alone: an answer that is off by rounding costs a look or a texel, never a wrong shadow.
static bool can_cover_texel(const Projected* v) {
    float2 a = (float2)(v[0].x, v[0].y) / v[0].w, b = (float2)(v[1].x, v[1].y) / v[1].w;
    float2 c = (float2)(v[2].x, v[2].y) / v[2].w;
    float2 ab = b - a, ac = c - a, bc = c - b;
    float twice_area = fabs(ab.x * ac.y - ab.y * ac.x);
    float perimeter = sqrt(dot(ab, ab)) + sqrt(dot(ac, ac)) + sqrt(dot(bc, bc));
    return twice_area >= 0.5f * perimeter;
}

#define NOT_FINITE 1
#define EDGE_ON 2
#define OUTSIDE 3
#define SURVIVES 0

// The projected vertices, and what they say at once.
typedef struct ProjectedTriangle {
    Projected v[3];
    bool wild;       // too far for floats: in every bin, and every test is exact
    bool behind;     // the light: wholly
    bool straddles;  // not wholly in front of the light for certain
} ProjectedTriangle;

static ProjectedTriangle project_triangle(Triangle t, __constant const Projection* projection) {
    ProjectedTriangle p;
    p.v[0] = project(projection, t.a);
    p.v[1] = project(projection, t.b);
    p.v[2] = project(projection, t.c);
    float wildest = 0.0f;
    p.behind = true;
    p.straddles = false;
    for (int i = 0; i < 3; ++i) {
        wildest = fmax(wildest, fmax(fmax(fabs(p.v[i].x), fabs(p.v[i].y)), fmax(fabs(p.v[i].w), p.v[i].error)));
        p.behind = p.behind && p.v[i].w < -p.v[i].error_w;
        p.straddles = p.straddles || !(p.v[i].w > 2.0f * p.v[i].error_w);
    }
    p.wild = !(wildest < WILD_TEXELS) || !GN_FINITE(p.v[0].x + p.v[1].x + p.v[2].x) ||
             !GN_FINITE(p.v[0].y + p.v[1].y + p.v[2].y) || !GN_FINITE(p.v[0].w + p.v[1].w + p.v[2].w);
    return p;
}

// The vertices' least and greatest height, moved out by their errors and the points'.
static float2 height_interval(const ProjectedTriangle* p, __constant const Projection* projection) {
    if (p->straddles) return (float2)(-INFINITY, INFINITY);
    float z_low = INFINITY, z_high = -INFINITY;
    for (int i = 0; i < 3; ++i) {
        // In perspective Z = 1 / W with W off by error_w and the division by 2.5 ulp, 5u.
        const Projected* v = &p->v[i];
        float slack = projection->perspective
                          ? BOUND_INFLATION * v->z * (v->error_w / (v->w - v->error_w) + 6.0f * GN_U)
                          : v->error_z;
        z_low = fmin(z_low, v->z - slack);
        z_high = fmax(z_high, v->z + slack);
    }
    // The points' own error: absolute (parallel), or relative to Z (perspective).
    float height_error = projection->height_error;
    z_low -= BOUND_INFLATION * (projection->perspective ? height_error * fabs(z_low) : height_error);
    z_high += BOUND_INFLATION * (projection->perspective ? height_error * fabs(z_high) : height_error);
    return (float2)(z_low, z_high);
}

// Bounds that say nothing: every bin, or (indistinct) the one that all points share.
static TriangleBounds open_bounds(__constant const Projection* projection) {
    TriangleBounds bounds;
    bounds.x0 = bounds.y0 = 0;
    bounds.x1 = projection->indistinct ? (ushort)(texel_units(projection->width) - 1.0f) : 65535;
    bounds.y1 = projection->indistinct ? (ushort)(texel_units(projection->height) - 1.0f) : 65535;
    bounds.z = 65535;
    bounds.frame = 0;
    bounds.id = GN_NO_ID;
    return bounds;
}

// `pyramid` is ignored unless `has_pyramid`.
static int bound_triangle(Triangle t, __constant const Projection* projection, __global const uint* pyramid,
                          bool has_pyramid, TriangleBounds* bounds) {
    *bounds = open_bounds(projection);
    if (!is_finite_triangle(t)) return NOT_FINITE;
    if (projection->indistinct) return SURVIVES;
    ProjectedTriangle p = project_triangle(t, projection);
    if (p.wild) return SURVIVES;
    if (p.behind) return OUTSIDE;
    float4 rectangle;
    if (!covered_rectangle(p.v, projection, &rectangle)) return OUTSIDE;
    bounds->x0 = quantised_texel(rectangle.x, projection->width);
    bounds->y0 = quantised_texel(rectangle.y, projection->height);
    bounds->x1 = quantised_texel(rectangle.z, projection->width);
    bounds->y1 = quantised_texel(rectangle.w, projection->height);
    float z_high = height_interval(&p, projection).y;
    if (has_pyramid && z_high < lowest_height_under(pyramid, projection, bins_of_bounds(*bounds, projection)))
        return OUTSIDE;
    bounds->z = quantised_height(z_high, projection->z_origin, projection->z_scale);
    if (p.straddles || can_cover_texel(p.v)) bounds->frame |= BOUNDS_FOR_MAP;
    return SURVIVES;
}

// The float filter of a triangle that survived, for all points of its bins. False if it is exactly edge-on.
static bool make_record(Triangle t, __constant const Projection* projection, uint4 bins, TriangleRecord* record,
                        int* level) {
    *record = undecided_record();
    if (projection->indistinct) return true;
    ProjectedTriangle p = project_triangle(t, projection);
    if (p.wild) return true;
    const Projected* v = p.v;
    float orientation = (float)orientation_from_light(t, projection, level) * projection->handedness;
    if (orientation == 0.0f) return false;

    float4 domain = square_of_bins(bins, projection);
    float reach = fmax(domain.z, domain.w) + projection->point_error;
    float rho[3], error[3];
    for (int i = 0; i < 3; ++i) {
        error[i] = v[i].error + reach * v[i].error_w;
        rho[i] = largest_offset(v[i], domain) + error[i] + fabs(v[i].w) * projection->point_error;
    }
    float margin = 0.0f;
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3;
        Edge edge = make_edge(v[i], v[j].x - v[i].x, v[j].y - v[i].y, v[j].w - v[i].w);
        record->edge_x[i] = orientation * edge.x;
        record->edge_y[i] = orientation * edge.y;
        record->edge_0[i] = orientation * edge.c;
        float bound = 2.0f * (rho[i] * error[j] + rho[j] * error[i] + error[i] * error[j]) +
                      6.0f * GN_U * (reach * (edge.size_x + edge.size_y) + edge.size_c) +
                      (fabs(edge.x) + fabs(edge.y)) * projection->point_error;
        margin = fmax(margin, BOUND_INFLATION * bound);
    }
    record->margin_edge = margin + 1.0e-30f;
    float2 heights = height_interval(&p, projection);
    record->z_low = heights.x;
    record->z_high = heights.y;
    if (projection->perspective)
        set_plane_perspective(record, v, domain, orientation, p.straddles, projection->point_error,
                              projection->height_error);
    else
        set_plane_parallel(record, v, domain, orientation, projection->point_error, projection->height_error);
    return true;
}

// One work-item per triangle, over the whole scene.
__kernel void triangle_bounds(__constant const Projection* projection, uint triangle_count, ulong first_float,
                              uint capacity, uint has_pyramid, __global const float* vertices,
                              __global const uint* pyramid, __global TriangleBounds* bounds,
                              __global uint* map_candidates, __global FrameCounters* counters) {
    uint tally[4] = {0, 0, 0, 0}, candidate_count = 0;
    if (projection->active_points == 0u) return;
    Claim slots = no_claim(), candidates = no_claim();
    GN_FOR_EACH(id, triangle_count) {
        TriangleBounds mine;
        int verdict =
            bound_triangle(load_triangle(vertices + first_float, id), projection, pyramid, has_pyramid != 0u, &mine);
        ++tally[verdict];
        if (verdict != SURVIVES) continue;
        candidate_count += (mine.frame & BOUNDS_FOR_MAP) != 0u;
        mine.id = (uint)id;
        uint slot = claim(&slots, &counters->slots);
        if (slot >= capacity) continue;
        bounds[slot] = mine;
        if (!(mine.frame & BOUNDS_FOR_MAP)) continue;
        uint place = claim(&candidates, &counters->map_slots);
        if (place < capacity) map_candidates[place] = slot;
    }
    for (; slots.next < min(slots.end, capacity); ++slots.next) drop_bounds(&bounds[slots.next]);
    for (; candidates.next < min(candidates.end, capacity); ++candidates.next)
        map_candidates[candidates.next] = GN_NO_ID;
    if (tally[SURVIVES] != 0) atomic_add(&counters->survivors, tally[SURVIVES]);
    if (candidate_count != 0) atomic_add(&counters->map_candidates, candidate_count);
    if (tally[NOT_FINITE] != 0) atomic_add(&counters->not_finite, tally[NOT_FINITE]);
    if (tally[OUTSIDE] != 0) atomic_add(&counters->outside, tally[OUTSIDE]);
}

// ---- Records and tiles ----------------------------------------------------------------------------------------------

typedef struct TileWork {
    __constant const Projection* projection;
    __global const float* vertices;  // of the first triangle
    __global const uint* heights;
    __global TriangleBounds* bounds;
    __global TriangleRecord* records;
    __global const uint* map_candidates;
    __global uint2* tiles;
    __global uint* tiles_wanted;
    uint capacity, tile_capacity, has_heights, for_map;
    uint hidden, edge_on, exact;
    Claim places;
} TileWork;

// Makes the record of the i-th triangle. False if it is dropped. What is dropped from the lists keeps empty bounds.
static bool prepare(TileWork* work, uint i, uint* slot, uint4* bins) {
    *slot = work->for_map ? work->map_candidates[i] : i;
    if (*slot == GN_NO_ID) return false;
    TriangleBounds bounds = work->bounds[*slot];
    if (is_dropped(bounds)) return false;
    *bins = bins_of_bounds(bounds, work->projection);
    if (work->has_heights) {
        float lowest = lowest_height_under(work->heights, work->projection, *bins);
        if (bounds.z < quantised_height(lowest, work->projection->z_origin, work->projection->z_scale) ||
            lowest == INFINITY) {
            if (!work->for_map) drop_bounds(&work->bounds[*slot]);
            ++work->hidden;
            return false;
        }
    }
    TriangleRecord record;
    int level = DET3_BY_FLOAT;
    bool survives = make_record(load_triangle(work->vertices, bounds.id), work->projection, *bins, &record, &level);
    work->exact += level == DET3_BY_EXACT;
    if (!survives) {
        drop_bounds(&work->bounds[*slot]);
        ++work->edge_on;
        return false;
    }
    work->records[*slot] = record;
    return !work->for_map || record.margin_plane < INFINITY;
}

static void append_tile(TileWork* work, uint slot, uint tile) {
    uint place = claim(&work->places, work->tiles_wanted);
    if (place < work->tile_capacity) work->tiles[place] = (uint2)(slot, tile);
}

static void append_tile_if_matters(TileWork* work, uint slot, uint4 bins, uint i) {
    uint tile = tile_of_bins(bins, i);
    TriangleRecord record = work->records[slot];
    if (may_matter(&record, work->projection, bins_of_tile(tile), work->has_heights, work->heights))
        append_tile(work, slot, tile);
}

// A GPU's work-group shares out the tiles of its triangles evenly: a triangle may have one or thousands. A CPU's
// work-item takes them as they come.
__kernel void triangle_tiles(__constant const Projection* projection, ulong first_float, uint capacity,
                             uint tile_capacity, uint has_heights, uint for_map, __global const float* vertices,
                             __global const uint* heights, __global TriangleBounds* bounds,
                             __global TriangleRecord* records, __global const uint* map_candidates,
                             __global uint2* tiles, __global FrameCounters* counters, __local uint* ends,
                             __local uint4* ranges, __local uint* slots) {
    TileWork work;
    work.projection = projection;
    work.vertices = vertices + first_float;
    work.heights = heights;
    work.bounds = bounds;
    work.records = records;
    work.map_candidates = map_candidates;
    work.tiles = tiles;
    work.tiles_wanted = for_map ? &counters->map_tiles : &counters->tiles;
    work.capacity = capacity;
    work.tile_capacity = tile_capacity;
    work.has_heights = has_heights;
    work.for_map = for_map;
    work.hidden = work.edge_on = work.exact = 0;
    work.places = no_claim();
    uint count = min(for_map ? counters->map_slots : counters->slots, capacity);
#ifdef GN_CPU
    GN_FOR_EACH(i, count) {
        uint slot;
        uint4 bins;
        if (!prepare(&work, (uint)i, &slot, &bins)) continue;
        uint tile_count = tile_count_of(bins);
        if (tile_count == 1u)
            append_tile(&work, slot, tile_of_bins(bins, 0));
        else
            for (uint tile = 0; tile < tile_count; ++tile) append_tile_if_matters(&work, slot, bins, tile);
    }
    for (; work.places.next < min(work.places.end, tile_capacity); ++work.places.next)
        tiles[work.places.next] = (uint2)(GN_NO_ID, 0);
#else
    // Where there are few triangles every group has some of them, so that all lanes help with the tiles.
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), groups = (uint)get_num_groups(0);
    uint share = min(items, (count + groups - 1u) / groups);
    for (uint base = (uint)get_group_id(0) * share; base < count; base += groups * share) {
        uint slot = GN_NO_ID;
        uint4 bins = (uint4)(0);
        uint tile_count = 0;
        if (item < share && base + item < count && prepare(&work, base + item, &slot, &bins))
            tile_count = tile_count_of(bins);
        if (tile_count == 1u) {
            append_tile(&work, slot, tile_of_bins(bins, 0));
            tile_count = 0;
        }
        slots[item] = slot;
        ranges[item] = bins;
        scan_group(tile_count, ends);  // and this group's records are visible to all of it
        uint total = ends[items - 1];
        for (uint i = item; i < total; i += items) {
            uint low = 0, high = items - 1;  // the first whose end lies beyond i
            while (low < high) {
                uint middle = (low + high) / 2;
                if (ends[middle] > i)
                    high = middle;
                else
                    low = middle + 1;
            }
            append_tile_if_matters(&work, slots[low], ranges[low], low == 0u ? i : i - ends[low - 1]);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
#endif
    if (work.edge_on != 0) atomic_add(&counters->edge_on, work.edge_on);
    if (work.exact != 0) atomic_add(&counters->setup_exact, work.exact);
    if (work.hidden != 0) atomic_add(for_map ? &counters->map_hidden : &counters->hidden, work.hidden);
}
