// SPDX-License-Identifier: MIT
// Contract of explain: the exact signs that decide one point, and every triangle that blocks its shadow ray.
#pragma once

#include "simd/points.h"

GN_STRUCT_BEGIN(ExplainParams)
    TrianglesLayout triangles;
    float light[4];
    PointsLayout points;
    uint index;     // the point to explain
    uint capacity;  // slots for ExplainedTriangle
GN_STRUCT_END(ExplainParams, 88)

// What a triangle does to the shadow ray.
#define EXPLAINED_MISSED 0u
#define EXPLAINED_BLOCKS 1u
#define EXPLAINED_CLEAR 2u  // the ray meets a masked triangle where its texture is clear

// A triangle a, b, c and the shadow ray from P along D (exact/blocks.clh).
GN_STRUCT_BEGIN(ExplainedTriangle)
    uint triangle;
    uint meets;      // EXPLAINED_...
    int point_side;  // sign of det(b - a, c - a, P - a)
    int light_side;  // sign of det(b - a, c - a, S - a), of det(b - a, c - a, D) for a directional light
    int edges[3];    // signs of det(a - P, b - P, D), det(b - P, c - P, D) and det(c - P, a - P, D)
    int level;       // DET3_BY_...: the hardest level that the exact predicate reached
    float vertices[9];
GN_STRUCT_END(ExplainedTriangle, 68)

GN_STRUCT_BEGIN(ExplainedPoint)
    float position[3];
    uint receiver;  // GN_NO_ID if the receiver is no triangle of the scene
    uint is_backfacing;
    int eye_side;  // of the receiver's plane, as light_side; 0 without an eye
    int facing_level;
    uint count;  // triangles that belong in the list, even if it is too short for them
    ExplainedTriangle on_receiver;
GN_STRUCT_END(ExplainedPoint, 100)
