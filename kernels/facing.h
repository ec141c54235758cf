// SPDX-License-Identifier: MIT
// Which side of a triangle the light is on, and whether a receiver faces away from it: exact, for every technique.
//
// A point faces away if the light is not strictly on the eye's side of its receiver's plane: with e and l the signs of
// det(b - a, c - a, eye - a) and det(b - a, c - a, D) (D = minus the direction of travel, or S - a), unless e l > 0.
#ifndef GN_FACING_H
#define GN_FACING_H

#include "exact/det3.h"
#include "points.h"

// 1: the light sees a, b, c counterclockwise; -1: clockwise; 0: exactly edge-on, or no area.
static int side_of_light(Triangle t, float4 light, int* level) {
    return light.w != 0.0f ? det3_sign(t.b, t.a, t.c, t.a, light.xyz, t.a, level)
                           : det3_sign(t.b, t.a, t.c, t.a, light.xyz, (float3)(0.0f), level);
}

// `side`: of the light, for this triangle.
static bool faces_away_with_side(Triangle receiver, int side, float3 eye, int* level) {
    return side == 0 || side * det3_sign(receiver.b, receiver.a, receiver.c, receiver.a, eye, receiver.a, level) <= 0;
}

static bool faces_away(Triangle receiver, float4 light, float3 eye, int* level) {
    return is_finite_triangle(receiver) &&
           faces_away_with_side(receiver, side_of_light(receiver, light, level), eye, level);
}

#endif
