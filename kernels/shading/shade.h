// SPDX-License-Identifier: MIT
// Contract of the shading: a light's part, and the table from linear light in [0, 1] to 8-bit sRGB.
#pragma once

#include "simd/points.h"

#define SRGB_TABLE_SIZE 4096

GN_STRUCT_BEGIN(ShadeParams)
    PointsLayout layout;
    float light[4];    // homogeneous, as in LightFrame
    uint is_first;     // 1: nothing is read from `lambert`
    uint has_spreads;  // 1: the normals are shading normals
    uint padding[2];
GN_STRUCT_END(ShadeParams, 80)

GN_STRUCT_BEGIN(PictureParams)
    PointsLayout layout;  // of the pixels' points
    uint has_albedos;     // 0: the triangles' materials have the base colours
    uint has_sky_shares;  // 0: ambient light everywhere
    float exposure;       // the factor of all light
    uint is_first;        // shade_add: 1: nothing is read from the sums
GN_STRUCT_END(PictureParams, 64)

#ifndef __cplusplus

#include "simd/point_blocks.clh"

// The layouts of other values of the same pixels.
static PointsLayout strided_layout(PointsLayout of, uint point_stride, uint coordinate_stride) {
    of.first = 0u;
    of.point_stride = point_stride;
    of.coordinate_stride = coordinate_stride;
    return of;
}
// Three floats for each pixel, one after the other; or x of all pixels, then y, then z.
static PointsLayout packed_layout(PointsLayout of) { return strided_layout(of, 3u, 1u); }
static PointsLayout planes_layout(PointsLayout of) { return strided_layout(of, 1u, of.count); }
GN_INLINE_ON_CPU LaneFloat block_dot(PointBlock a, PointBlock b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

#endif
