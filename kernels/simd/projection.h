// SPDX-License-Identifier: MIT
// The map from world space to light space (or the camera's pixels), and the bounds of its float errors.
//
// A Projection maps a world position p, with d = p - center, to a grid of texels:
//
//     h = (row_x . d + row_x.w,  row_y . d + row_y.w)     W = row_z . d  (perspective)  or 1  (parallel)
//     (X, Y) = h / W    in texels, [0, width) x [0, height)
//     Z = 1 / W  (perspective)  or  row_z . d  (parallel)
//
// Z is height towards the light: of two points on one ray the one with the larger Z is nearer to the light. The map is
// linear before the division, so lines stay lines, triangles stay triangles, and nothing is ever clipped.
//
// Directional light D = -d: a shear instead of a rotation. With k the coordinate in which |D| is largest,
//     X = sx ((p - c)_i - (D_i / D_k) (p - c)_k) + offset,   Y likewise,   Z = sign(D_k) (p - c)_k.
// In real arithmetic X and Y are exactly constant along the light's rays, and Z is exact but for the rounding of p - c,
// which is monotone: comparisons of Z are never wrong, only sometimes undecided.
// Point light: one projection per face of a cube around it, center = S (exactly), W = +-(p - S)_k.
// Camera: center = eye, rows = the inverse of the pixel-to-ray matrix.
//
// Error bounds (u = 2^-24). Each d_i is rounded once (u |d_i|); a row entry differs from the real map's by at most
// 4u of itself (quotient and product on the host or device; in perspective any float map is exact by definition);
// three fma round at most 3u of the sum of magnitudes. With g = |row| . |d| + |row.w| this is below 8.1u g; we use
// PROJECTION_ERROR = 10u, which also covers second-order terms and the rounding of g itself. A camera's rows come from
// products and sums in double, whose error is relative to the row's largest entry, not to each: 2^-20 |row|_1 |d|_1 is
// added to g for it (10u 2^-20 = 5.7e-13, thousands of double roundings).
// Underflow: a product or sum below 2^-126 errs by up to 2^-150, whatever its size; where denormals are flushed, each
// d_i by up to 4 2^-126, times the row. PROJECTION_UNDERFLOW is above that for rows up to 2^32
// (tests/proofs/projection.v): a vertex that near to a point light or an eye does not count as certainly in front of
// it. Under a direction a small scene's rows are larger, but the offset is at least a fifth of a texel (frame_fit.v).
#pragma once

#include "prelude.h"

#define PROJECTION_ERROR (10.0f * GN_U)
#define PROJECTION_UNDERFLOW 0x1p-90f

// Bins: squares of texels, the unit of triangle lists and point lists. bin = (X >> bin_log2) + (Y >> bin_log2) * bins_x
GN_STRUCT_BEGIN(Projection)
    float row_x[4];
    float row_y[4];
    float row_z[4];
    float center[4];  // world; [3] unused
    uint width;       // texels
    uint height;      // texels
    uint bin_log2;    // texels per bin side, as a power of two
    uint bins_x;      // bins per row
    uint bins_y;
    uint perspective;    // 1: W = row_z . d; 0: W = 1
    uint indistinct;     // 1: extents beyond what floats resolve: all points share bin 0 and every test is exact
    float point_error;   // texels: how far a point's computed X or Y may be from the real one (camera pixels: 0)
    float height_error;  // how far a point's computed Z may be off: absolute (parallel) or relative to Z (perspective)
    float handedness;    // sign of the map's determinant: +1 keeps the orientation of triangles, -1 turns it
    float light[4];      // homogeneous light (or eye): w = 0 minus the direction of travel, w = 1 a position
    uint active_points;  // points this projection was fitted to
    float z_origin;      // heights are brought to 16 bits as (Z - z_origin) z_scale, see bin_lists.h
    float z_scale;       // > 0; of a camera 0: by their exponents
    uint map_disabled;   // 1: the conservative map would decide too little to be worth it, see conservative_map.cl
    float block_error;   // texels: how far a block's computed X or Y may be from its points' (block_bounds.h)
    uint padding;
GN_STRUCT_END(Projection, 144)

// A camera's rays for the float level, as a function of the position in the picture (pixels): corner + x step_x + y
// step_y. The vectors are rounded to float; the exact rays are those of the table (camera.h), within 2^-47 of the real
// function.
GN_STRUCT_BEGIN(PictureRays)
    float corner[4];  // [3] unused, here and below
    float step_x[4];
    float step_y[4];
GN_STRUCT_END(PictureRays, 48)

#ifndef __cplusplus

// For a Projection or a LightFrame. A GPU has separate programs for directional lights (GN_DIRECTIONAL_ONLY): the
// registers that perspective takes would leave fewer work-items at once.
#ifdef GN_DIRECTIONAL_ONLY
#define IS_PERSPECTIVE(of) 0u
#else
#define IS_PERSPECTIVE(of) ((of).perspective)
#endif

static float3 center_of(__constant const Projection* projection) {
    return (float3)(projection->center[0], projection->center[1], projection->center[2]);
}

// The index of a texel. Points are fitted inside the grid with a margin above their error; the clamp only guards.
static uint texel_index(float coordinate, uint count) { return (uint)clamp((int)coordinate, 0, (int)count - 1); }

#endif
