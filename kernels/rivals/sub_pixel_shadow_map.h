// SPDX-License-Identifier: MIT
// Contract of technique sub-pixel: a shadow map that stores which triangle, not how deep (Lecocq, Marvie, Sourimant and
// Gautron 2014, "Sub-Pixel Shadow Mapping").
//
// Per texel of a light's frame the map stores the triangle that comes nearest to the light among the triangles that
// touch the texel anywhere (conservative rasterization), or GN_NO_ID. The exact predicate (exact/blocks.clh) tests a
// point against the triangle of its texel; with neighbours also against the triangles of the 8 texels around. So a
// shadow's edge is the triangle's edge, however large the texels are, and the test needs no bias.
//
// A masked triangle that is clear where the light sees the texel's middle is not stored there, as maps test alpha.
//
// Promise: a point is in shadow only if a triangle other than its receiver blocks it, so no point is wrongly in shadow.
// Limit: one triangle a texel. If several triangles overlap in a texel or are smaller than it, points are wrongly lit.
#pragma once

#include "rivals/framed_technique.h"

GN_STRUCT_BEGIN(SubPixelParams)
    FramedParams framed;
    uint reach;  // rings of texels around the point's texel with triangles to test: 0 or 1
    uint tile_capacity;
    uint stores_ids;  // the second run of sub_pixel_draw
    uint padding;
GN_STRUCT_END(SubPixelParams, 152)
