// SPDX-License-Identifier: MIT
// Contract of the techniques that decide points frame by frame of the light: their common parameters, and a block's
// open points of one frame.
#pragma once

#include "receivers/light_frame.h"
#include "simd/points.h"

GN_STRUCT_BEGIN(FramedParams)
    TrianglesLayout triangles;
    LightFrame light_frame;  // the light's first frame
    PointsLayout layout;
    uint frame;  // the frame whose points a launch decides
    uint padding;
GN_STRUCT_END(FramedParams, 136)

#ifndef __cplusplus

typedef struct FrameBlock {
    LaneFloat state;             // visibility
    LaneInt lanes;               // open points of the frame
    PointBlock points, in_grid;  // in world space, and their grid positions
} FrameBlock;

// False if no point of the block is open.
static bool load_frame_block(FramedParams params, __constant const Projection* projection,
                             __global const float* positions, __global const float* visibility, size_t block,
                             FrameBlock* at) {
    at->state = load_lanes(visibility, params.layout, block);
    at->lanes = open_lanes(at->state);
    if (!LANES_ANY(at->lanes)) return false;
    at->points = load_block(positions, params.layout, block);
    at->lanes &= LANE_COMPARE(frames_of(params.light_frame, at->points), ==, (LaneInt)((int)params.frame));
    at->in_grid = project_points(projection, at->points);
    return true;
}

// Decides the block's points of the frame: the `blocked` ones are in shadow, the others lit.
static void store_frame_block(FramedParams params, const FrameBlock* at, LaneInt blocked, __global float* visibility,
                              size_t block) {
    LaneFloat result = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), blocked);
    store_lanes(LANES_SELECT(at->state, result, at->lanes), visibility, params.layout, block);
}

#endif
