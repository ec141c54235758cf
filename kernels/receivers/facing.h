// SPDX-License-Identifier: MIT
// Contract of the facing stage: one pass over all points. Backfacing points (facing.clh) become 0, in shadow by
// definition of shading; absent points (NaN) and points at a point light become 1; all others become open, and the
// stage takes the bounds of the light's frames from them.
//
// All points on a receiver have the same facing. Where no point may shadow itself, each triangle is therefore
// classified once, and its points look the result up (facing_cache.clh). On a GPU with many more points than triangles
// facing_triangles classifies all triangles in order, so that a point loads a byte in place of nine floats from
// anywhere. On a CPU the first block that needs a triangle classifies GN_LANES triangles in a row, which are neighbours
// in most meshes; a block whose points lie on triangles from anywhere classifies its own receivers and keeps nothing.
//
// On a GPU the exact predicate's registers would slow down every point. With fewer points facing_filter therefore
// decides by floats and lists the undecided points, and facing_exact_fallback decides those.
//
// A footprint (footprint.h) has the facing of its receiver, as all its samples have, which the camera stage has made. A
// footprint that no frame contains as a whole is mixed at once; the bounds contain all others as a whole. The samples
// of a mixed footprint are known to face the light: has_receivers is 0 for them.
#pragma once

#include "receivers/light_frame.h"
#include "simd/points.h"

GN_STRUCT_BEGIN(FacingParams)
    ulong first_float;  // of the first triangle in `vertices`
    LightFrame light_frame;
    PointsLayout layout;
    uint triangle_count;
    uint has_receivers;   // 0: no point has one, or all points are known to face the light
    uint has_footprints;  // 1: the points are the centres of footprints
    uint has_blocks;      // 1: `blocks` is to be written
    uint opens_points;    // 0: points that are not backfacing are lit, and no bounds are taken
    uint padding;
GN_STRUCT_END(FacingParams, 144)

// On a GPU: word 0 of `undecided` counts the points that the float filter left undecided; the first UNDECIDED_CAPACITY
// of their indices follow.
#define UNDECIDED_CAPACITY 65536u
