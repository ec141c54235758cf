// SPDX-License-Identifier: MIT
// Contract of the facing stage: one pass over all points. Backfacing points (facing.clh) become 0, in shadow by
// definition of shading. Absent points (NaN) and points at a point light become 1. All others become open, and the
// stage computes the bounds of the light's frames from the open points.
//
// All points on a receiver have the same facing. Where no point may shadow itself, each triangle is therefore
// classified once, and its points read the result from a cache (facing_cache.clh). On a GPU with many more points than
// triangles facing_triangles classifies all triangles in order, so that a point loads one byte instead of nine
// scattered floats. On a CPU the first block that needs a triangle classifies GN_LANES triangles in a row, which are
// neighbours in most meshes; a block with scattered receivers classifies its own receivers and caches no result.
//
// On a GPU the exact predicate's registers would slow down every point. With fewer points facing_filter therefore
// decides by floats and lists the undecided points, and facing_exact_fallback decides the listed points.
//
// A footprint (footprint.h) has the facing of its receiver; all its samples, which the camera stage makes, have the
// same facing. A footprint that no frame contains as a whole is mixed at once; the bounds contain all others as a
// whole. The samples of a mixed footprint are known to face the light: has_receivers is 0 for them.
#pragma once

#include "receivers/light_frame.h"
#include "simd/points.h"

GN_STRUCT_BEGIN(FacingParams)
    TrianglesLayout triangles;
    LightFrame light_frame;
    PointsLayout layout;
    uint has_receivers;   // 0: no point has a receiver, or all points are known to face the light
    uint has_footprints;  // 1: the points are the centres of footprints
    uint has_blocks;      // 1: the stage writes `blocks`
    uint opens_points;    // 0: points that are not backfacing are lit, and the stage computes no bounds
GN_STRUCT_END(FacingParams, 144)

// On a GPU: word 0 of `undecided` counts the points that the float filter left undecided; the first UNDECIDED_CAPACITY
// of their indices follow.
#define UNDECIDED_CAPACITY 65536u
