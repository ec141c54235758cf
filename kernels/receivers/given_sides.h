// SPDX-License-Identifier: MIT
// Contract of the given sides: a caller that knows on which side of its surface a point lies gives a normal per point,
// or declares that the counter-clockwise side of its receiver is the front. A point is then backfacing unless the light
// is strictly on that side; its visibility becomes 0, in shadow by definition of shading. This pass runs after a
// technique, of whatever kind, and writes nothing else.
#pragma once

#include "simd/points.h"

GN_STRUCT_BEGIN(GivenSidesParams)
    TrianglesLayout triangles;  // of the receivers; not read for normals
    PointsLayout points;
    PointsLayout normals;  // `first` and the strides; not read for receivers
    float light[4];
GN_STRUCT_END(GivenSidesParams, 128)
