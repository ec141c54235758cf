// SPDX-License-Identifier: MIT
// Contract of the sides of many lights: for each point and bundle, the mask of the lights that the point faces. Absent
// points, and points without a side, face all lights.
#pragma once

#include "lights/light_bundle.h"

// Which side of its surface a point lies on.
#define SIDE_NONE 0u     // unknown: a receiver only excludes its triangle
#define SIDE_EYE 1u      // of its receiver's plane, the side of the eye
#define SIDE_WINDING 2u  // of its receiver, the side from which the vertices are counter-clockwise
#define SIDE_NORMALS 3u  // the side of its normal

GN_STRUCT_BEGIN(LightSidesParams)
    TrianglesLayout triangles;
    PointsLayout points;  // of a part of the sorted points
    uint bundle_count;
    uint mask_stride;
    uint side;
    uint padding;
GN_STRUCT_END(LightSidesParams, 80)
