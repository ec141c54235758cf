// SPDX-License-Identifier: MIT
// Clearance: how far above its receiver's plane everything lies that could shadow a sample of the camera. Neighbours in
// a mesh touch the receiver, so no filter keeps them apart from what lies on it; but most of them lie in its plane or
// below.
//
// With n the plane's normal towards the eye (and so the light: footprints are only asked if the receiver faces it), a
// a vertex and h(x) = n . (x - a): the camera lifts a sample by 4 unit n / |n|_max off a hit that is off by less than
// unit / 4, rounding moves it further up (camera.h), and |n| >= |n|_max. So h(P) > 3.5 unit |n|_max, unit being an ulp
// of a number m that no coordinate of hit and eye exceeds, more than u m / 1.01. On the way to the light h grows, or
// tends to h(S), the height of a lamp. So a triangle whose three vertices are below the lesser of both shadows no
// sample of the receiver. Heights are taken by det3's float level, and by its double level where that leaves them open.
// |n|_max is off by less than 5u of the sizes that make up n: one rounding for each difference, two for each minor.
#ifndef GN_CLEARANCE_H
#define GN_CLEARANCE_H

#include "exact/det3_lanes.h"
#include "footprint.h"

// The planes of a block's receivers, and what all samples on them are certain to have below them.
typedef struct ReceiverPlanes {
    TriangleBlock t;
    LaneCross normal;
    LaneFloat towards_eye;  // 1 or -1: the normal's side
    LaneFloat clearance;
    LaneInt usable;
} ReceiverPlanes;

static LaneFloat lanes_height(const ReceiverPlanes* planes, PointBlock place, LaneFloat* bound) {
    PointBlock d = difference(place, planes->t.a);
    return lanes_det3(&planes->normal, d, magnitudes(d), bound) * planes->towards_eye;
}

static ReceiverPlanes find_receiver_planes(__global const float* vertices, LaneInt ids, LaneInt lanes, float3 eye,
                                           float4 light, PointBlock centres, const FootprintBlock* around) {
    ReceiverPlanes planes;
    PointBlock from_eye = same_point(eye.x, eye.y, eye.z), reach = footprint_reach(around);
    planes.t = load_triangles_of(vertices, ids, lanes);
    planes.normal = triangle_normals(&planes.t);
    planes.towards_eye = (LaneFloat)(1.0f);
    LaneFloat bound, height_of_eye = lanes_height(&planes, from_eye, &bound);
    planes.usable = lanes & LANE_COMPARE(fabs(height_of_eye), >, bound);
    planes.towards_eye =
        LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(-1.0f), LANE_COMPARE(height_of_eye, <, (LaneFloat)(0.0f)));
    // The least that the largest coordinate of a hit, or the eye, can be.
    PointBlock size = magnitudes(centres);
    PointBlock least = {size.x - reach.x, size.y - reach.y, size.z - reach.z};
    LaneFloat m = LANES_MAX(least.x, least.y), size_of_eye = largest_of(from_eye);
    m = LANES_MAX(least.z, m);
    m = LANES_MAX(size_of_eye, m);
    LaneFloat longest = largest_of(planes.normal.value) - (5.0f * GN_U) * largest_of(planes.normal.size);
    planes.clearance = (3.4f * GN_U) * m * longest;
    if (light.w != 0.0f) {
        LaneFloat height_of_lamp = lanes_height(&planes, same_point(light.x, light.y, light.z), &bound) - bound;
        planes.clearance = LANES_MIN(height_of_lamp, planes.clearance);
    }
    return planes;
}

static Wide height_limit(Triangle receiver, float3 vertex, float towards_eye) {
    Wide bound;
    Wide height = det3_wide(det3_cross(det3_row(receiver.b, receiver.a), det3_row(receiver.c, receiver.a)),
                            det3_row(vertex, receiver.a), &bound);
    return wide_add(towards_eye < 0.0f ? wide_negated(height) : height, bound);
}

// Lanes whose samples their triangle of `t` cannot shadow, being too low.
static LaneInt lanes_clear_of(const ReceiverPlanes* planes, const TriangleBlock* t, LaneInt lanes) {
    const PointBlock vertices[3] = {t->a, t->b, t->c};
    LaneInt below = lanes & planes->usable, open = (LaneInt)(0);
    for (int i = 0; i < 3; ++i) {
        LaneFloat bound, height = lanes_height(planes, vertices[i], &bound);
        below &= ~LANE_COMPARE(height - bound, >, planes->clearance);
        open |= ~LANE_COMPARE(height + bound, <, planes->clearance);
    }
    open &= below;
    if (!LANES_ANY(open)) return below;
    for (int lane = 0; lane < GN_LANES; ++lane) {
        if (!LANE_OF_INT(open, lane)) continue;
        Triangle receiver = lane_triangle(&planes->t, lane);
        Wide clearance = wide_of_float(LANE_OF_FLOAT(planes->clearance, lane));
        for (int i = 0; i < 3 && LANE_OF_INT(below, lane); ++i)
            if (!wide_less(
                    height_limit(receiver, lane_point(vertices[i], lane), LANE_OF_FLOAT(planes->towards_eye, lane)),
                    clearance))
                LANE_OF_INT(below, lane) = 0;
    }
    return below;
}

#endif
