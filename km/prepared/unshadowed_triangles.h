// SPDX-License-Identifier: MIT
// Contract of unshadowed triangles: under a prepared light no triangle shadows them. A point on one needs neither map
// nor list.
//
// Each triangle R has a bit, which is set only if no other triangle can block any point in R's interior
// (unshadowed_triangles.cl). Let P be a point with receiver R, lifted (on R's plane or on its light's side, exactly),
// and strictly within R in the light's view: P = Q + t D, t >= 0, Q in R's interior, D towards the light. P's ray is
// part of Q's, so a triangle that blocked P would block Q: P is lit, wherever on its ray it is. A triangle with Q on
// its plane has no other point on the ray, so the contract's exception for such Q changes no result.
//
// The three edges' determinants of blocks() decide whether P is within R, by det3's float level alone, which is certain
// except for points a millionth of R's size from an edge. Such points are traced.
#pragma once

#include "simd/points.h"

// Bits in a word, and the number of work-items that share a triangle's bins.
#define UNSHADOWED_WORD_BITS 32u
#define UNSHADOWED_TEAM 32u

#ifndef __cplusplus

#include "exact/det3.clh"

static uint unshadowed_bit(uint id) { return 1u << (id % UNSHADOWED_WORD_BITS); }

static bool is_unshadowed(__global const uint* unshadowed, uint id) {
    return (unshadowed[id / UNSHADOWED_WORD_BITS] & unshadowed_bit(id)) != 0u;
}

// For a directional light.
static bool is_certainly_within(Triangle t, float3 p, float3 towards_light) {
    const float3 zero = (float3)(0.0f);
    int ab, bc, ca;
    bool certain = det3_sign_float(t.a, p, t.b, p, towards_light, zero, &ab) &
                   det3_sign_float(t.b, p, t.c, p, towards_light, zero, &bc) &
                   det3_sign_float(t.c, p, t.a, p, towards_light, zero, &ca);
    return certain && ab == bc && bc == ca;
}

#endif
