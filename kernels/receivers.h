// SPDX-License-Identifier: MIT
// What the triangles that points lie on, their receivers, say of GN_LANES points at once: exactly. Which points face
// away from the light, and which are doubtful, says facing.cl.
#ifndef GN_RECEIVERS_H
#define GN_RECEIVERS_H

#include "exact/det3_lanes.h"

// Which of these ids, which are unsigned, are less than a count: turn the top bit to compare them.
static LaneInt lanes_below(LaneInt ids, uint count) {
    LaneInt top = (LaneInt)((int)0x80000000);
    return LANE_COMPARE(ids ^ top, <, (LaneInt)((int)count) ^ top);
}

// What is said of points that have a receiver with a plane.
typedef struct ReceiverAnswer {
    LaneInt faces_away, doubtful;
} ReceiverAnswer;

// Points on triangles, of these lanes. `points` is null where no point is doubtful.
static ReceiverAnswer answer_of_triangles(const TriangleBlock* t, LaneInt asked, const PointBlock* points,
                                          PointsLayout layout, float4 light, uint* exact) {
    ReceiverAnswer answer = {(LaneInt)(0), (LaneInt)(0)};
    asked &= finite_triangles(t);
    if (!LANES_ANY(asked)) return answer;
    LaneCross normals = triangle_normals(t);
    PointBlock towards = same_point(light.x, light.y, light.z), from = same_point(0.0f, 0.0f, 0.0f);
    if (light.w != 0.0f) from = t->a;  // (a pointer to one or the other would keep both in memory on a GPU)
    LaneInt side = lanes_side(t, &normals, &towards, &from, asked, exact);
    LaneInt facing = asked & LANE_COMPARE(side, !=, (LaneInt)(0));
    if (layout.has_eye) {
        float3 at = eye_of(layout);
        PointBlock eye = same_point(at.x, at.y, at.z);
        facing &= LANE_COMPARE(lanes_side(t, &normals, &eye, &t->a, facing, exact), ==, side);
        answer.faces_away = asked & ~facing;
    }
    if (points && LANES_ANY(facing)) {
        uint doubts_by_exact = 0;  // not counted: they are no matter of facing
        LaneInt point_side = lanes_side(t, &normals, &t->a, points, facing, &doubts_by_exact);
        answer.doubtful = facing & LANE_COMPARE(point_side, ==, side);
    }
    return answer;
}

#if GN_LANES == 1
// Which of the lanes `asked`, lifted off these triangles, face away, as far as floats tell; *unsure: where they do not.
static LaneInt away_by_floats(const TriangleBlock* t, LaneInt asked, PointsLayout layout, float4 light,
                              LaneInt* unsure) {
    asked &= finite_triangles(t);
    LaneCross normals = triangle_normals(t);
    float3 at = eye_of(layout);
    PointBlock towards = same_point(light.x, light.y, light.z), eye = same_point(at.x, at.y, at.z);
    if (light.w != 0.0f) towards = difference(towards, t->a);
    LaneInt certain_of_light, certain_of_eye;
    LaneInt light_above = lanes_det3_positive(&normals, towards, &certain_of_light);
    LaneInt eye_above = lanes_det3_positive(&normals, difference(eye, t->a), &certain_of_eye);
    *unsure = asked & ~(certain_of_light & certain_of_eye);
    return asked & ~*unsure & (light_above ^ eye_above);
}
#endif

// `ids` of the lanes `asked` name triangles. Doubts are only cast on points that may have any.
static ReceiverAnswer ask_receivers(LaneInt ids, LaneInt asked, const PointBlock* points, PointsLayout layout,
                                    float4 light, bool doubts, __global const float* vertices, uint* exact) {
    TriangleBlock t = load_triangles_of(vertices, ids, asked);
    return answer_of_triangles(&t, asked, doubts ? points : 0, layout, light, exact);
}

#endif
