// SPDX-License-Identifier: MIT
// Contract of the stored quantities that may be filtered: a texel holds `planes` numbers, functions of its depth z, and
// a filtered texel their means over a neighbourhood. Plane p of texel t is planes[p * set.texels + t].
//
//   store           planes                                            source
//   variance        z, z^2 + (dx^2 + dy^2) / 4                        Donnelly and Lauritzen 2006
//   layered         per layer l the same of clamp((z - p_l) / (q_l - p_l), 0, 1)   Lauritzen and McCool 2008
//   convolution     sin(c_k z), cos(c_k z), c_k = pi (2 k - 1), k = 1..terms       Annen et al. 2007
//   exponential     exp(c z)                                          Annen et al. 2008
//   evsm2           w, w^2 with w = exp(c x), x = 2 z - 1             Lauritzen and McCool 2008
//   evsm4           the same, and n, n^2 with n = -exp(-c_negative x)
//   ewgf            as evsm2                                          Gumbau, Sbert, Szirmay-Kalos et al. 2013
//   moments         x, x^2, x^3, x^4 (Hamburger 4MSM), x = 2 z - 1    Peters and Klein 2015
//                   with half_bits: those of z, transformed for 16 bits per number
// Numbers are floats in memory, but with half_bits 16-bit fixed point of [0, 1]: 64 bits per texel, also where a
// prefilter reads and writes them.
// z is in [0, 1]. dx, dy are the caster's depth per texel: the moment bias, for a texel seen as a Gaussian of half a
// texel's deviation. It is limited (Lauritzen, GPU Gems 3, chapter 8, asks for a limit) to z - z^2, the largest
// variance of any quantity in [0, 1] with the mean z: so it is 0 where z, or a layer's share of it, is clamped.
#pragma once

#include "rivals/shadow_map/texel_footprint.h"

#define STORE_DEPTH 0u
#define STORE_VARIANCE 1u
#define STORE_LAYERED 2u
#define STORE_CONVOLUTION 3u
#define STORE_EXPONENTIAL 4u
#define STORE_EVSM2 5u
#define STORE_EVSM4 6u
#define STORE_EWGF 7u
#define STORE_MOMENTS 8u

// A layer extends back into the previous layer by this share of its length: otherwise points just behind a border would
// find no variance there (Lauritzen and McCool 2008, section 4).
#define LAYER_OVERLAP 0.5f

GN_STRUCT_BEGIN(StorePlan)
    uint store;
    uint planes;
    uint layers;              // layered: 1 to 16
    uint terms;               // convolution: 1 to 16
    float exponent;           // c
    float negative_exponent;  // c_negative
    float receiver_bias;      // subtracted from the receiver's depth: depth; adaptive: share of the scene's diagonal
    float bleeding;           // visibility below this becomes 0, the rest is stretched to [0, 1]
    float moment_bias;        // moments: share of a constant vector mixed in; others: least deviation, depth
    uint half_bits;      // moments alone: 16 bits per number (64-bit texels) after the optimised transform; else 32
    uint edges_only;     // variance: only where the four texels around the point disagree (Sterna 2011)
    uint summed;         // planes are summed areas (prefilter.cl)
    float width;         // of the lookup's box in summed areas, texels
    float summed_scale;  // fixed point: 1 is this much
    uint mips;           // levels of the mip chain beside level 0 (below); 0: none
    float threshold;     // exponential: subtracted from visibility before it is limited to [0, 1]
GN_STRUCT_END(StorePlan, 64)

// One axis of the Gaussian prefilter.
GN_STRUCT_BEGIN(GaussianPass)
    uint taps;  // texels, odd
    uint axis;  // 0 along x, 1 along y
GN_STRUCT_END(GaussianPass, 8)

#ifndef __cplusplus

// Depths that layer l maps to [0, 1].
static float2 layer_range(const StorePlan* plan, uint l) {
    float length = 1.0f / (float)plan->layers;
    return (float2)((float)l * length - (l > 0 ? LAYER_OVERLAP * length : 0.0f), (float)(l + 1) * length);
}

// Number i of planes as stored in memory. If half_bits is a constant after inlining, the branch falls away.
static float load_number(uint half_bits, __global const void* numbers, size_t i) {
    if (half_bits) return (float)((__global const ushort*)numbers)[i] * (1.0f / 65535.0f);
    return ((__global const float*)numbers)[i];
}
static void store_number(uint half_bits, __global void* numbers, size_t i, float number) {
    if (half_bits)
        ((__global ushort*)numbers)[i] = (ushort)rint(clamp(number, 0.0f, 1.0f) * 65535.0f);
    else
        ((__global float*)numbers)[i] = number;
}

// True if the planes' numbers lie in [-1, 1].
static bool is_signed(const StorePlan* plan) {
    return plan->store == STORE_CONVOLUTION || (plan->store == STORE_MOMENTS && !plan->half_bits);
}

static float frequency(uint k) { return M_PI_F * (float)(2 * k + 1); }  // k from 0

// ---- Mip chains (Williams 1983, "Pyramidal Parametrics")
// -------------------------------------------------------------
// Levels of a view's stored numbers, each of half the texels per side of the one before, down to a side of one texel.
// Level l has (width >> l) x (height >> l) texels. A texel is the mean of the texels of the level before that it
// covers: 2 x 2 of them, or 3 along an odd side, the outer two by their share. Level 0 is the map itself. The others
// lie side by side in a second buffer, in the same view's rectangle as level 0 in the map: level 1 from column 0 on,
// then level 2 and so on; width / 2 + width / 4 + ... is less than width.

// A level, as lookups and filters read it.
typedef struct MipLevel {
    size_t first;  // of its texel (0, 0), in a plane of its buffer
    uint row_stride, width, height;
} MipLevel;

// Width 0: the view has no such level.
static MipLevel mip_level(__global const MapView* view, uint level) {
    MipLevel found = {view->first_texel, view->row_stride, view->width >> level, view->height >> level};
    if (found.height == 0) found.width = 0;
    for (uint l = 1; l < level; ++l) found.first += view->width >> l;
    return found;
}

#endif
