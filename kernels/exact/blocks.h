// SPDX-License-Identifier: MIT
// The decision itself: does this triangle block the open ray from P towards the light? The visibility contract
// (docs/numerics.md, 1), word for word:
//   the triangle is a closed set, both faces cast, edge-on or zero area never blocks, a point on its plane is not
//   blocked by it; directional: t > 0; positional: strictly between P and S.
// With D = L - w P (L, w the homogeneous light), n = (b - a) x (c - a):
//   facing side   directional: s = sign(n . D), must equal the sign of n . (a - P) and not be 0
//                 positional:  s = sign(n . (a - P)), must be the opposite of the sign of n . (a - S) and not be 0
//                 (then n . D = n . (a - P) - n . (a - S) has the sign s as well)
//   inside        s det(a - P, b - P, D) >= 0 for the three edges
#ifndef GN_EXACT_BLOCKS_H
#define GN_EXACT_BLOCKS_H

#include "exact/det3.h"
#include "points.h"

static bool blocks(Triangle t, float3 p, float4 light, int* level) {
    float3 start = light.w != 0.0f ? p : (float3)(0.0f);  // D = light - start
    int side = det3_sign(t.b, t.a, t.c, t.a, t.a, p, level);
    if (side == 0) return false;
    int side_light = light.w != 0.0f ? -det3_sign(t.b, t.a, t.c, t.a, t.a, light.xyz, level)
                                     : det3_sign(t.b, t.a, t.c, t.a, light.xyz, start, level);
    if (side_light != side) return false;
    return det3_sign(t.a, p, t.b, p, light.xyz, start, level) * side >= 0 &&
           det3_sign(t.b, p, t.c, p, light.xyz, start, level) * side >= 0 &&
           det3_sign(t.c, p, t.a, p, light.xyz, start, level) * side >= 0;
}

#endif
