// SPDX-License-Identifier: MIT
// Contract of the light frame: the projection fitted to the points that still need an answer.
#ifndef GN_LIGHT_FRAME_H
#define GN_LIGHT_FRAME_H

#include "projection.h"

// What the host knows of a frame before the points are looked at.
GN_STRUCT_BEGIN(LightFrame)
    float light[4];          // homogeneous: w = 0 minus the direction of travel, w = 1 the position
    uint axis_x, axis_y;     // world coordinates that span the grid; axis_x, axis_y, axis_z are a cyclic order
    uint axis_z;             // world coordinate along which heights are measured
    float sign_z;            // +1 or -1: towards the light (parallel); the face's side of the light (perspective)
    float shear_x, shear_y;  // D_x / D_z, D_y / D_z of the light direction, each at most 1 in magnitude (parallel)
    uint perspective;        // 1: only points in this face's pyramid belong to the frame
    uint width, height;      // texels
    uint bin_log2, bins_x, bins_y;
GN_STRUCT_END(LightFrame, 64)

// Bounds of the points of a frame; light_frame_bounds writes one per work-group, light_frame_fit reads them.
GN_STRUCT_BEGIN(PointBounds)
    float grid_low[2], grid_high[2];    // sheared coordinates or, in perspective, ratios; before scaling
    float world_low[3], world_high[3];  // in perspective [2] of both: W
    uint count;
    uint padding[1];
GN_STRUCT_END(PointBounds, 48)

#ifndef __cplusplus

#include "points.h"

// Does the point belong to the frame? Parallel: always. Perspective: if the frame's axis is the one of the largest
// difference to the light (first of equals), on the frame's side. A point at the light itself belongs to none: nothing
// lies strictly between.
static bool is_in_frame(LightFrame frame, float3 p_world) {
    if (!frame.perspective) return true;
    float3 d = p_world - (float3)(frame.light[0], frame.light[1], frame.light[2]);
    float3 size = fabs(d);
    uint axis = size.x >= size.y ? (size.x >= size.z ? 0u : 2u) : (size.y >= size.z ? 1u : 2u);
    float along = axis == 0u ? d.x : axis == 1u ? d.y : d.z;
    // Where denormals are flushed a difference can vanish between unlike positions. Such a point goes to the first
    // frame, whose heights it makes indistinct.
    if (along == 0.0f && any(as_int3(p_world) != as_int3((float3)(frame.light[0], frame.light[1], frame.light[2]))))
        return frame.axis_z == 0u && frame.sign_z > 0.0f;
    return axis == frame.axis_z && along * frame.sign_z > 0.0f;
}

// Does point i still need an answer from this frame? Loads it if so.
static bool is_open_in_frame(LightFrame frame, PointsLayout layout, __global const float* positions,
                             __global const float* visibility, size_t i, float3* p_world) {
    if (visibility[i] != 1.0f) return false;
    *p_world = load_point(positions, layout, i);
    return is_present(*p_world) && is_in_frame(frame, *p_world);
}

#endif
#endif
