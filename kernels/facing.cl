// SPDX-License-Identifier: MIT
// Facing: starts every point as lit, and puts into shadow those that the light cannot reach by definition of shading.
//
// A point faces away if the light is not strictly on the eye's side of its receiver's plane: with e and l the signs of
// det(b - a, c - a, eye - a) and det(b - a, c - a, D) (D = minus the direction of travel, or S - a), unless e l > 0.
// Decided exactly. Asked only where the points carry an eye; absent points (NaN) stay lit and cost nothing further.
#include "exact/det3.h"
#include "points.h"
#include "triangle_setup.h"

static int side_of_light(Triangle t, float4 light, int* level) {
    return light.w != 0.0f ? det3_sign(t.b, t.a, t.c, t.a, light.xyz, t.a, level)
                           : det3_sign(t.b, t.a, t.c, t.a, light.xyz, (float3)(0.0f), level);
}

static bool faces_away(Triangle receiver, float4 light, float3 eye, int* level) {
    if (!is_finite_triangle(receiver)) return false;
    int side = side_of_light(receiver, light, level);
    return side == 0 || side * det3_sign(receiver.b, receiver.a, receiver.c, receiver.a, eye, receiver.a, level) <= 0;
}

__kernel void facing(PointsLayout layout, float4 light, ulong first_float, uint triangle_count,
                     __global const float* positions, __global const uint* receivers, __global const float* vertices,
                     __global float* visibility, __global FrameCounters* counters) {
    uint absent = 0, away = 0, exact = 0;
    float3 eye = (float3)(layout.eye[0], layout.eye[1], layout.eye[2]);
    // Neighbours often share a receiver, and its answer.
    uint known_receiver = GN_NO_ID;
    bool known_away = false;
    GN_FOR_EACH(i, layout.count) {
        visibility[i] = 1.0f;
        if (!is_present(load_point(positions, layout, i))) {
            ++absent;
            continue;
        }
        if (!layout.has_eye || !layout.has_receivers || receivers[i] >= triangle_count) continue;
        if (receivers[i] != known_receiver) {
            known_receiver = receivers[i];
            int level = DET3_BY_FLOAT;
            known_away = faces_away(load_triangle(vertices + first_float, known_receiver), light, eye, &level);
            exact += level == DET3_BY_EXACT;
        }
        if (!known_away) continue;
        visibility[i] = 0.0f;
        ++away;
    }
    if (absent != 0) atomic_add(&counters->absent, absent);
    if (away != 0) atomic_add(&counters->facing_away, away);
    if (exact != 0) atomic_add(&counters->facing_exact, exact);
}
