// SPDX-License-Identifier: MIT
// Views while they are fitted (PlannedView of projection.h): where points lie in them, and which points they hold.
#ifndef GN_SHADOW_PLANNED_VIEW_H
#define GN_SHADOW_PLANNED_VIEW_H

#include "homography.h"

// planned[0] and [1] are not views: the scene's box in world space, and camera depths. The views follow.
#define FIRST_VIEW 2

static float4 planned_row(__global const float* row) { return (float4)(row[0], row[1], row[2], row[3]); }

static void set_row(float* row, float4 value) {
    row[0] = value.x;
    row[1] = value.y;
    row[2] = value.z;
    row[3] = value.w;
}

// (u, v, depth, w) of a point, and whether the view is to hold it.
static bool place_in_view(const ViewPlan* plan, __global const PlannedView* view, float3 p, float4* place) {
    float camera_depth = dot3(p - to_float3(plan->eye), to_float3(plan->forward));
    if (camera_depth < view->hold_near || camera_depth > view->hold_far) return false;
    float4 q = (float4)(p - (float3)(view->origin[0], view->origin[1], view->origin[2]), 1.0f);
    float w = dot4(planned_row(view->row_w), q);
    float u = dot4(planned_row(view->row_u), q) / w, v = dot4(planned_row(view->row_v), q) / w;
    float depth = dot4(planned_row(view->row_depth), q);
    *place = (float4)(u, v, depth, w);
    if (view->is_front_only && !(depth > 0.0f)) return false;
    if (view->face != NO_FACE) return is_on_face(p - to_float3(plan->light), view->face, SIDE_RIM);
    return u >= view->limit_low[0] && u <= view->limit_high[0] && v >= view->limit_low[1] && v <= view->limit_high[1];
}

#endif
