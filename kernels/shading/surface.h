// SPDX-License-Identifier: MIT
// Contract of the surfaces of a picture: what a pixel shows before light falls on it, its albedo and its shading
// normal. Pictures only: nothing here decides visibility.
//
// What triangles have lies in arrays by slot: a material, and the corners' texture coordinates, linear colours and
// normals (16 bits each of the octahedral map's x and y, pack_normal(); 0: the corner has none). A slot is a triangle's
// id; where the arrays of all triangles do not fit, the host gathers those of the shown triangles and numbers them.
//
// A pixel's barycentric coordinates are those of its sample's ray (its centre's, of one sample), weights w_i . d with
// w_a = (B - E) x (C - B) and so on, which are linear in the ray's direction d: so their derivatives per pixel, the
// area of the pixel in the texture, are exact for the pinhole camera (Igehy 1999, "Tracing Ray Differentials").
//
// Texels: 8-bit sRGB, and a weight. Each texture has all its levels, one behind the other, each of half the sides
// (rounded down, at least 1). Texels are decoded before they are filtered.
#pragma once

#include "simd/points.h"

// What happens to a texture coordinate outside of 0..1, as in TextureWrap.
#define SURFACE_REPEAT 0u
#define SURFACE_MIRROR 1u
#define SURFACE_CLAMP 2u

// How texels smaller than pixels are filtered, as in TextureMinification.
#define SURFACE_MEAN 0u
#define SURFACE_MINIFY_LINEAR 1u
#define SURFACE_MINIFY_NEAREST 2u

// The most probes of a pixel, each trilinear, along its longer axis.
#define SURFACE_MAX_PROBES 16

GN_STRUCT_BEGIN(SurfaceParams)
    TrianglesLayout triangles;
    PointsLayout layout;  // of the pixels
    float eye[3];
    float corner[3];  // from the eye to the centre of pixel (0, 0)
    float across[3];  // from a pixel to the next in its row
    float down[3];    // and in its column
    uint width, height;
    uint has_colors;    // 0: corners' colours are not read
    uint has_normals;   // 0: shading normals are not written
    float pixel_share;  // the side of the square, in pixels, that textures are filtered over
    uint padding;
GN_STRUCT_END(SurfaceParams, 136)

GN_STRUCT_BEGIN(SurfaceMaterial)
    float base_color[3];
    uint is_nearest;     // 1: magnified texels are squares
    ulong first_texel;   // of the texture
    uint width, height;  // of its first level; 0: there is no texture
    uint wrap_u, wrap_v;
    uint minification;  // as in TextureMinification
    uint padding;
GN_STRUCT_END(SurfaceMaterial, 48)
