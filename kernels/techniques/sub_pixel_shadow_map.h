// SPDX-License-Identifier: MIT
// Contract of technique sub-pixel: a shadow map that stores which triangle, not how deep (Lecocq, Marvie, Sourimant and
// Gautron 2014, "Sub-Pixel Shadow Mapping").
//
// Per texel of a light's frame the map keeps the triangle that comes nearest to the light among those that touch the
// texel anywhere (conservative rasterization), GN_NO_ID where there is none. The exact predicate (exact/blocks.clh)
// tests a point against the triangle of its texel; with neighbours also against those of the 8 texels around.
// So a shadow's edge is the triangle's edge, however large the texels are, and nothing needs a bias.
//
// Promise: a point is in shadow only if a triangle other than its receiver blocks it, so none is wrongly in shadow.
// Limit: one triangle a texel. Where several overlap in one, or are smaller than it, points are wrongly lit.
#pragma once

#include "receivers/light_frame.h"
#include "simd/points.h"

GN_STRUCT_BEGIN(SubPixelParams)
    ulong first_float;  // where the triangles begin in their buffer
    uint frame;         // of a point light
    uint reach;         // texels around the point's whose triangles are tested: 0 or 1
    uint tile_capacity;
    uint stores_ids;  // the second run of sub_pixel_draw
    LightFrame light_frame;
    PointsLayout layout;
GN_STRUCT_END(SubPixelParams, 136)

// Of a frame, zeroed at its start.
GN_STRUCT_BEGIN(SubPixelCounters)
    uint texels;     // with a triangle
    uint in_shadow;  // points
GN_STRUCT_END(SubPixelCounters, 8)
