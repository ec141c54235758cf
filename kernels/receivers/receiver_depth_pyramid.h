// SPDX-License-Identifier: MIT
// Contract of the receiver depth pyramid (Hi-Z): per bin the depth that the farthest open point reaches, and a pyramid
// over it. A triangle that lies wholly farther than every point that it could cover blocks no point (Wyman et al. 2016,
// "Frustum-Traced Irregular Z-Buffers", section on early-z; the pyramid is ours). A frame culls its triangles by it
// twice, as in two-pass occlusion culling:
//
//     open points --> pyramid --> cull --> triangles for the conservative map --> draw the map
//                        |                                                             |
//                        +---> depth that points left open may reach: depth_after_map <+
//                                                 |
//                                                 +--> cull --> triangles for the occluder lists --> trace
//
// Depths are heights (z towards the light), kept as order-preserving keys, so that integer minima serve: the farthest
// point has the least key, and an empty bin has 0xFFFFFFFF, above all. A cell may hold less than its points' least
// height, never more. Several frames: bins are in order of frames; levels are in order, and within a level frames.
#pragma once

#include "receivers/light_frame.h"
#include "simd/points.h"

GN_STRUCT_BEGIN(ReceiverDepthParams)
    LightFrame light_frame;
    PointsLayout layout;
    uint first_frame, frame_count;
    uint has_footprints;  // 1: the points are the centres of footprints
    uint has_blocks;      // 1: the facing stage has written the points' BlockBounds; frame_count is 1 then
GN_STRUCT_END(ReceiverDepthParams, 128)

// The level that a reduction starts from.
GN_STRUCT_BEGIN(PyramidLevel)
    uint frame_count, width, height;
    uint first;  // index of the level's first cell
GN_STRUCT_END(PyramidLevel, 16)

// The number of levels that one launch makes.
#define PYRAMID_LEVELS 5
