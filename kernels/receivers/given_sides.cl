// SPDX-License-Identifier: MIT
// Darkens the points whose given side is turned away from the light (given_sides.h), exactly.
#include "exact/normal_side.clh"
#include "receivers/facing.clh"
#include "receivers/given_sides.h"

// n . D > 0, for certain, where D is the light's direction, or light - P for a point light.
//
// Float filter: let S = sum |n_c D_c| over the three coordinates. D_c, each product and the two sums round once, so the
// computed dot product is within 5 * 2^-24 S of the exact one as long as no result is denormal. A device may flush a
// denormal operand or result to zero, which changes it by at most 2^-126: together at most 2^-122 (1 + sum |n_c| +
// sum |D_c|). The bound below is larger than the sum of both. If a value overflows, the comparison with an infinite or
// NaN bound is false and the integers decide.
static bool is_strictly_in_front(float3 n, float3 p, float4 light) {
    float3 d = light.w != 0.0f ? light.xyz - p : light.xyz;
    float3 products = n * d;
    float size = fabs(products.x) + fabs(products.y) + fabs(products.z);
    float sizes = 1.0f + fabs(n.x) + fabs(n.y) + fabs(n.z) + fabs(d.x) + fabs(d.y) + fabs(d.z);
    float dot_product = products.x + products.y + products.z;
    float bound = size * 0x1p-20f + sizes * 0x1p-110f;
    if (fabs(dot_product) > bound && bound < INFINITY) return dot_product > 0.0f;

    Accumulator sum;
    accumulator_clear(&sum);
    accumulator_add_dot(&sum, n, light.xyz, false);
    if (light.w != 0.0f) accumulator_add_dot(&sum, n, p, true);
    return accumulator_sign(&sum) > 0;
}

// A point whose normal has a NaN or infinite coordinate has no side and keeps its visibility.
__kernel void given_normals(const GivenSidesParams params, __global const float* positions,
                            __global const float* normals, __global float* visibility) {
    float4 light = (float4)(params.light[0], params.light[1], params.light[2], params.light[3]);
    GN_FOR_EACH(i, params.points.count) {
        float3 p = load_point(positions, params.points, i);
        float3 n = load_point(normals, params.normals, i);
        if (is_present(p) && is_present(n) && !is_strictly_in_front(n, p, light)) visibility[i] = 0.0f;
    }
}

// A point without a receiver, or on a receiver with a vertex that is not finite, keeps its visibility.
__kernel void given_winding(const GivenSidesParams params, __global const float* vertices,
                            __global const float* positions, __global const uint* receivers,
                            __global float* visibility) {
    float4 light = (float4)(params.light[0], params.light[1], params.light[2], params.light[3]);
    Triangles triangles = triangles_of(vertices, params.triangles);
    GN_FOR_EACH(i, params.points.count) {
        if (receivers[i] >= triangles.count || !is_present(load_point(positions, params.points, i))) continue;
        Triangle receiver = load_triangle(triangles.vertices, receivers[i]);
        int level = 0;
        if (is_finite_triangle(receiver) && side_of_light(receiver, light, &level) <= 0) visibility[i] = 0.0f;
    }
}
