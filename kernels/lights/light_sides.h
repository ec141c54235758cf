// SPDX-License-Identifier: MIT
// Contract of the sides of many lights: for each point and bundle, the mask of the lights that the point faces. Absent
// points, and points without a side, face all lights.
#pragma once

#include "lights/light_bundle.h"

// What tells the side of its surface on which a point lies.
#define SIDE_NONE 0u     // unknown: a receiver only excludes its triangle
#define SIDE_EYE 1u      // the side of its receiver's plane on which the eye is
#define SIDE_WINDING 2u  // the side of its receiver from which the vertices are counter-clockwise
#define SIDE_NORMALS 3u  // the side to which its normal points

GN_STRUCT_BEGIN(LightSidesParams)
    TrianglesLayout triangles;
    PointsLayout points;  // of a part of the sorted points
    uint bundle_count;
    uint mask_stride;
    uint side;
    uint padding;
GN_STRUCT_END(LightSidesParams, 80)
