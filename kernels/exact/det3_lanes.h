// SPDX-License-Identifier: MIT
// On which side of triangles points lie, for GN_LANES pairs at once: exact signs. Most are certain by det3's float
// level, taken for all lanes, or 0 since all products are; the others go through all levels one by one.
#ifndef GN_EXACT_DET3_LANES_H
#define GN_EXACT_DET3_LANES_H

#include "exact/det3.h"
#include "triangle_blocks.h"

// u x v as in det3_cross_float(); `usable`: the float level's range holds as far as u and v go.
typedef struct LaneCross {
    PointBlock value, size;
    LaneInt usable;
} LaneCross;

static LaneInt within_float_range(PointBlock size) {
    LaneFloat largest = LANES_MAX(size.x, size.y);
    largest = LANES_MAX(size.z, largest);
    return LANE_COMPARE(largest, <=, (LaneFloat)(0x1p20f));
}

static LaneCross lanes_cross(PointBlock u, PointBlock v) {
    PointBlock plus = {u.y * v.z, u.z * v.x, u.x * v.y}, minus = {u.z * v.y, u.x * v.z, u.y * v.x};
    PointBlock plus_size = magnitudes(plus), minus_size = magnitudes(minus);
    LaneCross cross;
    cross.value = difference(plus, minus);
    cross.size.x = plus_size.x + minus_size.x;
    cross.size.y = plus_size.y + minus_size.y;
    cross.size.z = plus_size.z + minus_size.z;
    cross.usable = within_float_range(magnitudes(u)) & within_float_range(magnitudes(v));
    return cross;
}
// One in all lanes.
static LaneCross same_cross(Det3FloatCross one) {
    bool usable = one.largest.x <= 0x1p20f && one.largest.y <= 0x1p20f && one.largest.z <= 0x1p20f;
    LaneCross cross = {same_point(one.value.x, one.value.y, one.value.z),
                       same_point(one.size.x, one.size.y, one.size.z), (LaneInt)(usable ? -1 : 0)};
    return cross;
}
static LaneCross triangle_normals(const TriangleBlock* t) {
    return lanes_cross(difference(t->b, t->a), difference(t->c, t->a));
}

// Which determinants det(u, v, w) are positive: right where *certain, by det3's float level. (In its range no NaN can
// arise, and outside of it nothing is certain.)
static LaneInt lanes_det3_positive(const LaneCross* cross, PointBlock w, LaneInt* certain) {
    PointBlock size = magnitudes(w);
    LaneFloat value = w.x * cross->value.x + w.y * cross->value.y + w.z * cross->value.z;
    LaneFloat permanent = size.x * cross->size.x + size.y * cross->size.y + size.z * cross->size.z;
    *certain = cross->usable & within_float_range(size) & LANE_COMPARE(permanent, >=, (LaneFloat)(0x1p-40f)) &
               LANE_COMPARE(fabs(value), >, permanent * DET3_FLOAT_BOUND);
    return LANE_COMPARE(value, >, (LaneFloat)(0.0f));
}

// det3_float().
static LaneFloat lanes_det3(const LaneCross* cross, PointBlock w, PointBlock size_w, LaneFloat* bound) {
    LaneFloat value = w.x * cross->value.x + w.y * cross->value.y + w.z * cross->value.z;
    LaneFloat permanent = size_w.x * cross->size.x + size_w.y * cross->size.y + size_w.z * cross->size.z;
    LaneInt in_range = cross->usable & within_float_range(size_w) & LANE_COMPARE(permanent, >=, (LaneFloat)(0x1p-40f));
    *bound = LANES_SELECT((LaneFloat)(INFINITY), DET3_FLOAT_BOUND * permanent, in_range);
    return value;
}

#if GN_LANES > 1
// Equal values for certain, also where a device takes denormals for 0.
static LaneInt lanes_equal(LaneFloat x, LaneFloat y) {
    LaneInt a = LANES_AS_INT(x), b = LANES_AS_INT(y);
    return LANE_COMPARE(a, ==, b) | LANE_COMPARE((a | b) & 0x7FFFFFFF, ==, (LaneInt)(0));
}

// Where a coordinate of each product is 0, the determinant is, as of axis-aligned geometry under an axis-aligned light.
static LaneInt lanes_without_products(const TriangleBlock* t, const PointBlock* end, const PointBlock* start) {
    LaneInt u_x = lanes_equal(t->b.x, t->a.x), u_y = lanes_equal(t->b.y, t->a.y), u_z = lanes_equal(t->b.z, t->a.z);
    LaneInt v_x = lanes_equal(t->c.x, t->a.x), v_y = lanes_equal(t->c.y, t->a.y), v_z = lanes_equal(t->c.z, t->a.z);
    return (lanes_equal(end->x, start->x) | ((u_y | v_z) & (u_z | v_y))) &
           (lanes_equal(end->y, start->y) | ((u_z | v_x) & (u_x | v_z))) &
           (lanes_equal(end->z, start->z) | ((u_x | v_y) & (u_y | v_x)));
}
#endif

// The sides of these lanes, one by one. Adds to *exact how many needed the exact level.
__attribute__((noinline)) static void settle_sides(const TriangleBlock* t, const PointBlock* end,
                                                   const PointBlock* start, LaneInt lanes, LaneInt* side, uint* exact) {
    for (int lane = 0; lane < GN_LANES; ++lane) {
        if (!LANE_OF_INT(lanes, lane)) continue;
        int level = DET3_BY_FLOAT;
        Triangle one = lane_triangle(t, lane);
        ((int*)side)[lane] =
            det3_sign(one.b, one.a, one.c, one.a, lane_point(*end, lane), lane_point(*start, lane), &level);
        *exact += level == DET3_BY_EXACT;
    }
}

// The sign of det(b - a, c - a, end - start): 1, -1 or 0, for certain, of these lanes. Their coordinates must be
// finite. `normals`: of t.
static LaneInt lanes_side(const TriangleBlock* t, const LaneCross* normals, const PointBlock* end,
                          const PointBlock* start, LaneInt lanes, uint* exact) {
    LaneInt certain, positive = lanes_det3_positive(normals, difference(*end, *start), &certain);
    LaneInt side = LANES_SELECT((LaneInt)(-1), (LaneInt)(1), positive);
    LaneInt open = lanes & ~certain;
    if (!LANES_ANY(open)) return side;
#if GN_LANES > 1
    LaneInt zero = open & lanes_without_products(t, end, start);
    side &= ~zero;
    open &= ~zero;
    if (!LANES_ANY(open)) return side;
#endif
    // Copies: what a function that is not inlined gets by pointer, a GPU keeps in memory from where it is made.
    TriangleBlock same = *t;
    PointBlock same_end = *end, same_start = *start;
    LaneInt settled = side;
    uint more = 0;
    settle_sides(&same, &same_end, &same_start, open, &settled, &more);
    *exact += more;
    return settled;
}

#endif
