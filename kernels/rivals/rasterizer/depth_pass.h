// SPDX-License-Identifier: MIT
// Contract of the depth pass: finds the triangle that is nearest to the light at each texel's centre.
//
// A texel's key is the depth (map_view.h) of the nearest caster that covers its centre, biased and clamped to [0, 1],
// as the bits of the float: bits and numbers have the same order, so an atomic minimum finds the key in any order of
// work. An empty texel has EMPTY_KEY, depth 1: no receiver is farther.
//
// Coverage: a triangle covers a centre P if its three edge functions there have the same sign or are 0. With vertices
// h = (u w, v w, w) and a the vertex of an edge (a, b) with the larger |w|,
//   e(P) = a_w ((b_x - a_u b_w) (P_v - a_v) - (b_y - a_v b_w) (P_u - a_u)),
// the triple product (a, b, P): no clipping, whatever the signs of w (Olano and Greer 1997). Differences are taken
// before products, so that small triangles keep their shape. The values of a and b alone decide their order, so two
// triangles that share an edge compute the same number with opposite signs, and at least one covers a centre between
// them: no cracks. Both faces cast; triangles edge-on to the light cast nothing.
//
// A masked triangle (exact/cut_outs.h) covers a centre only where its texture is opaque there, or too near to the
// threshold for floats to tell: the alpha test of every renderer of shadow maps.
//
// Depth at P: (sum of e_i d_i) / (sum of e_i), a convex combination: never outside the triangle's own range.
#pragma once

#include "occluders/clusters.h"
#include "rivals/rasterizer/map_view.h"

#define EMPTY_KEY 0x3F800000u  // the bits of 1.0f

// The output of a pass.
#define PASS_NEAREST 0u  // the key of the nearest caster
#define PASS_SECOND 1u   // the nearest key after the first one (dual depth layers)
#define PASS_SLOPE 2u    // of the nearest caster: squared depth per texel, dx^2 + dy^2, as float bits; 0 if clamped

// A CPU's work-item owns a window, a square of texels, and draws all that lies in it: no two items write one texel.
// Clusters of CLUSTER_TRIANGLES neighbours (occluders/clusters.h) whose casters miss a window cost it one comparison.
// On a GPU a large caster hides the tiles that it covers (Hi-Z), and work-groups take its chunks, 2^CHUNK_LOG2 texels a
// side; a work-group's items share out the texels of small casters; texels take atomic minima. Both give a texel the
// same key, since a key is the minimum over all casters.
#define WINDOW_LOG2 7u
#define CHUNK_LOG2 6u
#define TILE_LOG2 4u  // tiles of large casters have texels of one length each
// If a caster's bounding rectangle has more texels than this, it is large.
#define SMALL_TEXELS 256u
// On a GPU a caster with more than this number of texels is cut into chunks.
#define CHUNKED_TEXELS 1024u
// In a GPU's virtual map an item draws a part of a caster with at most this number of texels at once.
#define TINY_TEXELS 64u
// Of a GPU's local memory, for each small caster that waits there.
#define WAITING_CASTER_WORDS 29u

GN_STRUCT_BEGIN(DepthPass)
    TrianglesLayout triangles;
    uint cluster_count;
    uint has_boxes;   // 0: the clusters' boxes are not known
    uint view_count;  // of virtual maps: of the finest levels' grids
    uint view_step;   // between these views in their buffer
    uint pass;
    uint chunk_capacity;  // of a GPU's list
    float slope_bias;     // times max(|dz/dx|, |dz/dy|), depth per texel
    float slope_limit;    // the slope-scaled part is at most this
GN_STRUCT_END(DepthPass, 48)

// A part of a large caster.
GN_STRUCT_BEGIN(Chunk)
    uint id, view;
    uint chunk;  // of the caster's, row by row
GN_STRUCT_END(Chunk, 12)

#ifndef __cplusplus

static bool has_slopes(const DepthPass* pass) { return pass->slope_bias != 0.0f || pass->pass == PASS_SLOPE; }

#endif
