// SPDX-License-Identifier: MIT
// Contract of cut-outs: where the texture of a masked triangle lies on the device, and its units.
//
// A masked triangle blocks, or is seen, at the point X where a ray meets it only if its alpha there is at least the
// threshold: texel(X) >= threshold, exactly, in units of 1 / 255 (docs/numerics.md, 15). (u, v) of X is the exact
// interpolation of the corners' coordinates. Texel (i, j) is the square from (i, j) to (i + 1, j + 1) in the plane of
// (u width, v height). A nearest texture's squares are closed: X has the greatest alpha of all texels with X in
// them. A linear texture's alpha is the bilinear mean of the four texels with centres around X.
//
// The buffer of the triangles' vertices has these words behind the last vertex:
//   two words for each CUT_OUT_GROUP triangles: the triangles' classes, two bits each, and the number of masked
//     triangles before the group. An ordered copy of the vertices (clusters) has only these words.
//   CutOutHeader, the masked triangles in the order of their ids, DeviceMaterials, texels (a byte each)
// Programs with GN_CUT_OUTS read them; the host chooses these programs for triangles with cut-outs.
#pragma once

#include "prelude.h"

#define CUT_OUT_GROUP 16u
#define CUT_OUT_CLASS_WORDS(count) (2u * ((count) / CUT_OUT_GROUP + ((count) % CUT_OUT_GROUP != 0u)))

// Classes of triangles, and of hits.
#define CUT_OUT_OPAQUE 0u  // blocks wherever it is hit
#define CUT_OUT_MASKED 1u  // the texture decides; of a hit: undecided
#define CUT_OUT_CLEAR 2u   // never blocks, and is never seen

// Positions are in words from the first word behind the vertices.
GN_STRUCT_BEGIN(CutOutHeader)
    uint first_triangle;  // a masked triangle: its material, u and v of its three corners, then their alphas if there
                          // are any
    uint triangle_words;
    uint first_material;
    uint padding;
GN_STRUCT_END(CutOutHeader, 16)
#define CUT_OUT_TRIANGLE_WORDS 7u
#define CUT_OUT_TRIANGLE_WORDS_WITH_ALPHAS 10u

// Wraps: the texel that a coordinate outside of the texture stands for.
#define CUT_OUT_REPEAT 0u
#define CUT_OUT_MIRROR 1u
#define CUT_OUT_CLAMP 2u

GN_STRUCT_BEGIN(DeviceMaterial)
    uint first_texel;  // in words
    uint width, height;
    uint wraps;        // of u, and of v << 2
    uint is_linear;    // 0: the nearest texel
    uint threshold;    // in units of 2^-16 / 255
    uint has_alphas;   // 1: times the interpolated alpha of the corners, from 0 to 1
    uint first_class;  // in words: of each texel with its eight neighbours the class, two bits; a word for each tile of
                       // CUT_OUT_TILE x CUT_OUT_TILE texels, row by row, since neighbouring hits are; 0: none
GN_STRUCT_END(DeviceMaterial, 32)

#define CUT_OUT_TILE 4u
#define CUT_OUT_TILES(side) (((side) + CUT_OUT_TILE - 1u) / CUT_OUT_TILE)

// A texture's sides are at most 2^15 texels, and no corner is farther than this many texels from (0, 0) in u or v.
#define CUT_OUT_LARGEST_SIDE 32768u
#define CUT_OUT_FARTHEST_TEXEL 0x40000000
