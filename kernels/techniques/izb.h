// SPDX-License-Identifier: MIT
// Contract of the technique izb: lists of points by bin of light space.
#pragma once

#include "receivers/light_frame.h"
#include "simd/points.h"

GN_STRUCT_BEGIN(IzbParams)
    TrianglesLayout triangles;
    LightFrame light_frame;  // the light's first frame
    PointsLayout layout;
    uint frame;           // the frame of the listed points
    uint has_map;         // 0: the map's buffer is not read
    uint slot_count;      // of the lists, a multiple of 16
    uint queue_capacity;  // pairs
GN_STRUCT_END(IzbParams, 144)

// The lists as a structure of arrays: slot_count words each of the point's index, GN_NO_ID in an empty slot, and of its
// X, Y, Z in the grid.
#define IZB_WORDS 4u
