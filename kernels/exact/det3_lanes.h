// SPDX-License-Identifier: MIT
// On which side of triangles points lie, for GN_LANES pairs at once: exact signs. Most are certain by det3's float
// level, taken for all lanes; the others go through all levels one by one.
#ifndef GN_EXACT_DET3_LANES_H
#define GN_EXACT_DET3_LANES_H

#include "exact/det3.h"
#include "triangle_blocks.h"

// (b - a) x (c - a) as in det3_cross_float(); `usable`: the float level's range holds as far as these rows go.
typedef struct TriangleNormals {
    PointBlock value, size;
    LaneInt usable;
} TriangleNormals;

static LaneInt within_float_range(PointBlock size) {
    LaneFloat largest = LANES_MAX(size.x, size.y);
    largest = LANES_MAX(size.z, largest);
    return LANE_COMPARE(largest, <=, (LaneFloat)(0x1p20f));
}

static TriangleNormals triangle_normals(const TriangleBlock* t) {
    PointBlock u = difference(t->b, t->a), v = difference(t->c, t->a);
    PointBlock plus = {u.y * v.z, u.z * v.x, u.x * v.y}, minus = {u.z * v.y, u.x * v.z, u.y * v.x};
    PointBlock plus_size = magnitudes(plus), minus_size = magnitudes(minus);
    TriangleNormals normals;
    normals.value = difference(plus, minus);
    normals.size.x = plus_size.x + minus_size.x;
    normals.size.y = plus_size.y + minus_size.y;
    normals.size.z = plus_size.z + minus_size.z;
    normals.usable = within_float_range(magnitudes(u)) & within_float_range(magnitudes(v));
    return normals;
}

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
// finite. (In the range no NaN can arise, and outside of it nothing is certain.)
static LaneInt lanes_side(const TriangleBlock* t, const TriangleNormals* normals, const PointBlock* end,
                          const PointBlock* start, LaneInt lanes, uint* exact) {
    PointBlock w = difference(*end, *start), size = magnitudes(w);
    LaneFloat value = w.x * normals->value.x + w.y * normals->value.y + w.z * normals->value.z;
    LaneFloat permanent = size.x * normals->size.x + size.y * normals->size.y + size.z * normals->size.z;
    LaneInt certain = normals->usable & within_float_range(size) & LANE_COMPARE(permanent, >=, (LaneFloat)(0x1p-40f)) &
                      LANE_COMPARE(fabs(value), >, permanent * DET3_FLOAT_BOUND);
    LaneInt side = LANES_SELECT((LaneInt)(-1), (LaneInt)(1), LANE_COMPARE(value, >, (LaneFloat)(0.0f)));
    LaneInt open = lanes & ~certain;
    if (LANES_ANY(open)) settle_sides(t, end, start, open, &side, exact);
    return side;
}

#endif
