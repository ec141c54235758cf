// SPDX-License-Identifier: MIT
// Contract of backfacing: a caller that knows on which side of its surface a point lies gives a normal per point,
// or declares that the counter-clockwise side of its receiver is the front, or that the point is a vertex of a mesh. A
// point is then backfacing unless the light is strictly on that side; its visibility becomes 0, in shadow by definition
// of shading. This pass runs after a technique, of whatever kind, and writes nothing else.
//
// The fan of a point that is a vertex: the triangles that have it as a corner, as corner ids (3 * triangle + corner).
#pragma once

#include "simd/points.h"

GN_STRUCT_BEGIN(BackfacingParams)
    TrianglesLayout triangles;  // of the receivers; not read for normals
    PointsLayout points;
    PointsLayout normals;  // `first` and the strides; not read for receivers
    float light[4];
GN_STRUCT_END(BackfacingParams, 128)

// Word 2 i of the fans is the first corner of point i, word 2 i + 1 their number, with this bit if the fan is closed:
// each edge at the point runs towards it in one triangle and away from it in one other.
#define FAN_IS_CLOSED 0x80000000u

GN_STRUCT_BEGIN(BackfacingFansParams)
    TrianglesLayout triangles;
    uint count;  // of points
    uint
        has_up;  // 1: the mesh is a height field over the planes that `up` is perpendicular to; its winding is not read
    float up[2 + 1];
    uint padding;
    float light[4];
GN_STRUCT_END(BackfacingFansParams, 56)
