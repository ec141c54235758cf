// SPDX-License-Identifier: MIT
// blocks() for GN_LANES pairs at once, as far as det3's float level goes.
#ifndef GN_EXACT_BLOCKS_LANES_H
#define GN_EXACT_BLOCKS_LANES_H

#include "exact/blocks.h"
#include "exact/det3_lanes.h"

// The lanes that block, for certain. *open: those for which blocks() must be asked, because it would need more than the
// float level: the signs are asked in its order, and a lane that is dismissed by one is not asked for the next.
static LaneInt blocks_by_float(const TriangleBlock* t, const PointBlock* p, float4 light, LaneInt lanes,
                               LaneInt* open) {
    bool is_position = light.w != 0.0f;
    PointBlock to_light = same_point(light.x, light.y, light.z), towards = to_light;
    if (is_position) {
        towards = difference(to_light, *p);
        to_light = difference(to_light, t->a);  // n . (S - a) = -n . (a - S), also when rounded
    }
    PointBlock corners[3] = {difference(t->a, *p), difference(t->b, *p), difference(t->c, *p)};
    LaneCross normals = triangle_normals(t);
    LaneInt certain, side = lanes_det3_positive(&normals, corners[0], &certain);
    *open = lanes & ~certain;
    lanes &= certain;
    LaneInt light_side = lanes_det3_positive(&normals, to_light, &certain);
    *open |= lanes & ~certain;
    lanes &= certain & ~(side ^ light_side);
    for (int i = 0; i < 3; ++i) {
        LaneCross edge = lanes_cross(corners[i], corners[(i + 1) % 3]);
        LaneInt inside = lanes_det3_positive(&edge, towards, &certain);
        *open |= lanes & ~certain;
        lanes &= certain & ~(side ^ inside);
    }
    return lanes;
}

#endif
