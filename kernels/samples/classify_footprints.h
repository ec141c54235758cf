// SPDX-License-Identifier: MIT
// Contract of the stage that classifies footprints (receivers/footprint.h) as in shadow, lit or mixed.
#pragma once

#include "receivers/light_frame.h"
#include "simd/points.h"

// The kernel takes the footprints that lie in the frames [first_frame, first_frame + frame_count).
GN_STRUCT_BEGIN(ClassifyParams)
    TrianglesLayout triangles;
    LightFrame light_frame;
    PointsLayout layout;  // of the footprints' centres
    uint first_frame, frame_count;
    uint has_map;  // 0: the map's buffer is ignored
    uint domains;  // for a prepared light the offset of its domains behind the ranges (PreparedTables); else 0
GN_STRUCT_END(ClassifyParams, 144)
