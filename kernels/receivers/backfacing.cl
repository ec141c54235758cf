// SPDX-License-Identifier: MIT
// Darkens the points whose given side is turned away from the light (backfacing.h), exactly.
#include "exact/normal_side.clh"
#include "receivers/backfacing.h"
#include "receivers/facing.clh"

// n . D > 0, for certain, where D is the light's direction, or light - P for a point light.
//
// Float filter: let S = sum |n_c D_c| over the three coordinates. D_c, each product and the two sums round once, so the
// computed dot product is within 5 * 2^-24 S of the exact one as long as no result is denormal. A device may flush a
// denormal operand or result to zero, which changes it by at most 2^-126: together at most 2^-122 (1 + sum |n_c| +
// sum |D_c|). The bound below is larger than the sum of both. If a value overflows, the comparison with an infinite or
// NaN bound is false and the integers decide.
static bool is_strictly_in_front(float3 n, float3 p, float4 light) {
    float3 d = light.w != 0.0f ? light.xyz - p : light.xyz;
    float3 products = n * d;
    float size = fabs(products.x) + fabs(products.y) + fabs(products.z);
    float sizes = 1.0f + fabs(n.x) + fabs(n.y) + fabs(n.z) + fabs(d.x) + fabs(d.y) + fabs(d.z);
    float dot_product = products.x + products.y + products.z;
    float bound = size * 0x1p-20f + sizes * 0x1p-110f;
    if (fabs(dot_product) > bound && bound < INFINITY) return dot_product > 0.0f;

    return dot_is_positive(n, light.xyz, light.w != 0.0f ? p : (float3)(0.0f));
}

// A point whose normal has a NaN or infinite coordinate has no side and keeps its visibility.
__kernel void darken_by_normals(const BackfacingParams params, __global const float* positions,
                                __global const float* normals, __global float* visibility) {
    float4 light = (float4)(params.light[0], params.light[1], params.light[2], params.light[3]);
    GN_FOR_EACH(i, params.points.count) {
        float3 p = load_point(positions, params.points, i);
        float3 n = load_point(normals, params.normals, i);
        if (is_present(p) && is_present(n) && !is_strictly_in_front(n, p, light)) visibility[i] = 0.0f;
    }
}

// A point without a receiver, or on a receiver with a vertex that is not finite, keeps its visibility.
__kernel void darken_by_winding(const BackfacingParams params, __global const float* vertices,
                                __global const float* positions, __global const uint* receivers,
                                __global float* visibility) {
    float4 light = (float4)(params.light[0], params.light[1], params.light[2], params.light[3]);
    Triangles triangles = triangles_of(vertices, params.triangles);
    GN_FOR_EACH(i, params.points.count) {
        if (receivers[i] >= triangles.count || !is_present(load_point(positions, params.points, i))) continue;
        Triangle receiver = load_triangle(triangles.vertices, receivers[i]);
        int level = 0;
        if (is_finite_triangle(receiver) && side_of_light(receiver, light, &level) <= 0) visibility[i] = 0.0f;
    }
}

// A vector: end - start, exactly.
typedef struct Arrow {
    float3 end, start;
} Arrow;

// The directions from a vertex over one of its triangles: k a + l b with k, l >= 0. Its front is where a, b run
// counter-clockwise.
typedef struct Sector {
    Arrow a, b;
} Sector;

static Sector load_sector(Triangles triangles, uint corner) {
    Triangle t = load_triangle(triangles.vertices, corner / 3);
    if (corner % 3 == 0) return (Sector){{t.b, t.a}, {t.c, t.a}};
    if (corner % 3 == 1) return (Sector){{t.c, t.b}, {t.a, t.b}};
    return (Sector){{t.a, t.c}, {t.b, t.c}};
}

// The sign of det(u, v, w): of w's side of the plane of u and v.
static int det_sign(Arrow u, Arrow v, Arrow w) {
    int level = 0;
    return det3_sign(u.end, u.start, v.end, v.start, w.end, w.start, &level);
}

// det(u, v, a) + det(u, v, b) from u x v, and what it must exceed to be certain. Each determinant's bound is larger
// than its error (det3.clh). The rounding of their sum changes no sign, and it changes the size by less than the
// factor 1.01, as do the roundings of the bounds' sum (tests/proofs/two_determinants.v).
static float det3_float_of_two(Det3FloatCross cross_uv, float3 a, float3 b, float* bound) {
    float bound_a, bound_b;
    float value = det3_float(cross_uv, a, fabs(a), &bound_a) + det3_float(cross_uv, b, fabs(b), &bound_b);
    *bound = 1.01f * (bound_a + bound_b);
    return value;
}
#ifdef GN_FP64
static Wide det3_wide_of_two(Det3Row cross_uv, Det3Row a, Det3Row b, Wide* bound) {
    Wide bound_a, bound_b;
    Wide value = wide_add(det3_wide(cross_uv, a, &bound_a), det3_wide(cross_uv, b, &bound_b));
    Wide bounds = wide_add(bound_a, bound_b);
    *bound = wide_add(bounds, wide_mul(bounds, wide_power_of_two(-6)));
    return value;
}
#endif

// The sign of det(u, v, r.a + r.b), for certain: the sum of two determinants.
static int det_pair_sign(Arrow u, Arrow v, Sector r) {
    float bound;
    float value = det3_float_of_two(det3_cross_float(u.end - u.start, v.end - v.start), r.a.end - r.a.start,
                                    r.b.end - r.b.start, &bound);
    if (fabs(value) > bound) return value > 0.0f ? 1 : -1;
#ifdef GN_FP64
    Wide bounds;
    Wide sum_of_wide = det3_wide_of_two(det3_cross(det3_row(u.end, u.start), det3_row(v.end, v.start)),
                                        det3_row(r.a.end, r.a.start), det3_row(r.b.end, r.b.start), &bounds);
    if (wide_less(bounds, wide_absolute(sum_of_wide)) || wide_is_zero(bounds)) return wide_sign(sum_of_wide);
#endif
    Accumulator sum;
    accumulator_clear(&sum);
    accumulator_add_det3(&sum, u.end, u.start, v.end, v.start, r.a.end, r.a.start);
    accumulator_add_det3(&sum, u.end, u.start, v.end, v.start, r.b.end, r.b.start);
    return accumulator_sign(&sum);
}

#define SECTOR_WITHOUT_AREA 0
#define SECTOR_MISSED 1
#define SECTOR_HIT 2

// Where d is with respect to a sector in whose plane it lies, decided in a projection along an axis.
static int place_in_plane(Sector s, Arrow d) {
    for (int c = 0; c < 3; ++c) {
        Arrow axis = {(float3)(c == 0, c == 1, c == 2), (float3)(0.0f)};
        int turn = det_sign(s.a, s.b, axis);
        if (turn == 0) continue;
        return turn * det_sign(s.a, d, axis) >= 0 && turn * det_sign(d, s.b, axis) >= 0 ? SECTOR_HIT : SECTOR_MISSED;
    }
    return SECTOR_WITHOUT_AREA;
}

// The corners of one fan, and the direction to the light from their vertex.
typedef struct Fan {
    Triangles triangles;
    __global const uint* corners;
    uint count;
    Arrow d;
} Fan;

// A fan of a height field (numerics.md, 14): the light must be strictly above each triangle over which d leaves. If
// there is none, *is_extended, and it must be strictly above the planes of all triangles. A triangle that is vertical
// or without area has no upper side: it is left out, and *is_extended.
static bool is_below_height_field(Fan fan, Arrow up, bool* is_extended) {
    bool leaves_over_one = false, is_below_one = false, has_vertical = false;
    for (uint i = 0; i < fan.count; ++i) {
        Sector s = load_sector(fan.triangles, fan.corners[i]);
        int turn = det_sign(s.a, s.b, up);
        int side = turn * det_sign(s.a, s.b, fan.d);
        if (turn == 0) {
            if (det_sign(s.a, s.b, fan.d) == 0 && place_in_plane(s, fan.d) == SECTOR_HIT) return true;
            has_vertical = true;
            continue;
        }
        bool leaves_over = turn * det_sign(s.a, fan.d, up) >= 0 && turn * det_sign(fan.d, s.b, up) >= 0;
        if (leaves_over && side <= 0) return true;
        leaves_over_one |= leaves_over;
        is_below_one |= side <= 0;
    }
    *is_extended = !leaves_over_one || has_vertical;
    return !leaves_over_one && is_below_one;
}

// The straight path from d to the middle of sector r, moved by an infinitely small amount, passes through s.
static bool is_crossed(Sector s, Arrow d, Sector r) {
    bool a_left = det_pair_sign(s.a, d, r) >= 0, b_left = det_pair_sign(s.b, d, r) >= 0;
    if (a_left == b_left) return false;
    int side = det_sign(s.a, s.b, d), side_of_end = det_pair_sign(s.a, s.b, r);
    return a_left ? side < 0 && side_of_end > 0 : side > 0 && side_of_end < 0;
}

// d is strictly in front of a closed fan, seen from each of its triangles whose plane does not contain d: the path to
// the middle of that triangle arrives at its front after an even number of crossings, or at its back after an odd one.
static bool is_in_front_of_closed(Fan fan) {
    for (uint k = 0; k < fan.count; ++k) {
        Sector end = load_sector(fan.triangles, fan.corners[k]);
        int side = det_sign(end.a, end.b, fan.d);
        if (side == 0) continue;
        bool is_in_front = side > 0;
        for (uint i = 0; i < fan.count; ++i)
            if (i != k && is_crossed(load_sector(fan.triangles, fan.corners[i]), fan.d, end))
                is_in_front = !is_in_front;
        if (!is_in_front) return false;
    }
    return true;
}

// A fan of any mesh whose fronts are counter-clockwise (numerics.md, 14).
static bool is_behind_fan(Fan fan, bool is_closed, bool* is_extended) {
    bool has_before = false, has_behind = false, has_beside = false;
    for (uint i = 0; i < fan.count; ++i) {
        Sector s = load_sector(fan.triangles, fan.corners[i]);
        int side = det_sign(s.a, s.b, fan.d);
        int place = side == 0 ? place_in_plane(s, fan.d) : SECTOR_MISSED;
        if (place == SECTOR_HIT) return true;
        is_closed = is_closed && place != SECTOR_WITHOUT_AREA;
        has_before |= side > 0;
        has_behind |= side < 0;
        has_beside |= side == 0 && place == SECTOR_MISSED;
    }
    *is_extended = !is_closed;
    if (!has_behind && !has_beside) return false;
    return !has_before || !is_closed || !is_in_front_of_closed(fan);
}

// A point without a triangle around it keeps its visibility. *extended: the number of points that an extension decided.
__kernel void darken_by_fans(const BackfacingFansParams params, __global const float* vertices,
                             __global const uint* fans, __global const uint* corners, __global float* visibility,
                             __global uint* extended) {
    Arrow up = {(float3)(params.up[0], params.up[1], params.up[2]), (float3)(0.0f)};
    float3 light = (float3)(params.light[0], params.light[1], params.light[2]);
    Fan fan;
    fan.triangles = triangles_of(vertices, params.triangles);
    uint extended_here = 0;
    GN_FOR_EACH(i, params.count) {
        fan.corners = corners + fans[2 * i];
        fan.count = fans[2 * i + 1] & ~FAN_IS_CLOSED;
        if (fan.count == 0) continue;
        float3 from = params.light[3] != 0.0f ? load_sector(fan.triangles, fan.corners[0]).a.start : (float3)(0.0f);
        fan.d = (Arrow){light, from};
        bool is_extended = false;
        bool is_away = params.has_up ? is_below_height_field(fan, up, &is_extended)
                                     : is_behind_fan(fan, (fans[2 * i + 1] & FAN_IS_CLOSED) != 0u, &is_extended);
        if (is_away) visibility[i] = 0.0f;
        extended_here += is_extended;
    }
    if (extended_here != 0u) atomic_add(extended, extended_here);
}
