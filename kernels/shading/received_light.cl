// SPDX-License-Identifier: MIT
// What of an area light's or the sky's light reaches each pixel. Contract: received_light.h.
#include "exact/wide.clh"
#include "shading/received_light.h"

typedef struct ReceivedVector {
    Wide x, y, z;
} ReceivedVector;

static Wide received_dot(ReceivedVector a, ReceivedVector b) { return wide_dot(a.x, a.y, a.z, b.x, b.y, b.z); }

// The sums of one point: of V f c, of f c, of f (gnomon/shading.hpp).
typedef struct ReceivedSums {
    Wide reaching, facing, towards;
} ReceivedSums;

static void add_received(ReceivedVector area, ReceivedVector at, ReceivedVector normal, float4 sample, bool reaches,
                         ReceivedSums* sums) {
    ReceivedVector l = {wide_sub(wide_of_float(sample.x), at.x), wide_sub(wide_of_float(sample.y), at.y),
                        wide_sub(wide_of_float(sample.z), at.z)};
    Wide square = received_dot(l, l), none = WIDE_ZERO;
    if (wide_is_zero(square)) return;
    Wide distance = wide_sqrt(square);
    // area . l = |area| r cosine, so f times the area is this over r^3.
    Wide f = wide_div(wide_max(none, wide_negated(received_dot(area, l))), wide_mul(square, distance));
    Wide fc = wide_div(wide_mul(f, wide_max(none, received_dot(normal, l))), distance);
    sums->towards = wide_add(sums->towards, f);
    sums->facing = wide_add(sums->facing, fc);
    if (reaches) sums->reaching = wide_add(sums->reaching, fc);
}

// `lights`: the area light's samples; `bits`: those that reach each point, a row of words for each.
__kernel void received_from_area(ReceivedParams params, __global const float* positions, __global const uint* receivers,
                                 __global const float* normals, __global const float4* lights,
                                 __global const uint* bits, __global float* shares, __global float* irradiances,
                                 __global float* brightnesses) {
    ReceivedVector area = {wide_of_bits(params.area[0]), wide_of_bits(params.area[1]), wide_of_bits(params.area[2])};
    GN_FOR_EACH(pixel, params.layout.count) {
        bool is_sky = receivers[pixel] == GN_NO_ID;
        Wide none = WIDE_ZERO;
        ReceivedSums sums = {none, none, none};
        float3 p = load_point(positions, params.layout, pixel), n = vload3(pixel, normals);
        ReceivedVector at = {wide_of_float(p.x), wide_of_float(p.y), wide_of_float(p.z)};
        ReceivedVector normal = {wide_of_float(n.x), wide_of_float(n.y), wide_of_float(n.z)};
        for (uint i = 0; i < params.samples && !is_sky; ++i)
            add_received(area, at, normal, lights[i], (bits[pixel * params.words + i / 32u] >> i % 32u & 1u) != 0u,
                         &sums);
        bool faces = !wide_is_zero(sums.facing);
        Wide share = faces ? wide_div(sums.reaching, sums.facing) : none, samples = wide_of_uint(params.samples);
        shares[pixel] = is_sky ? 1.0f : float_of_wide(share);
        irradiances[pixel] = faces ? float_of_wide(wide_div(sums.reaching, samples)) : 0.0f;
        brightnesses[pixel] = faces ? float_of_wide(wide_div(wide_mul(share, sums.towards), samples)) : 0.0f;
    }
}

// float32 of the sums of a table of lights.
__kernel void received_from_sky(uint count, __global const ulong* sums, __global float* shares) {
    GN_FOR_EACH(i, count) shares[i] = float_of_wide(wide_of_bits(sums[i]));
}
