// SPDX-License-Identifier: MIT
// Sums over lights (light_sums.h).
#include "lights/light_sums.h"
#include "lists/whole_to_float.clh"
#include "simd/lanes.clh"

// Sets bit `slot` of the mask of each point that the technique found lit: for techniques that take one light at a time.
__kernel void light_bits(const LightSumsParams params, __global const float* visibility, uint slot,
                         __global uint* masks) {
    GN_FOR_EACH(i, params.point_count) {
        uint before = slot == 0u ? 0u : masks[i];
        masks[i] = visibility[i] >= 0.5f ? before | 1u << slot : before;
    }
}

// Adds the lights that horizons or sweeps found to reach the points to the masks, after the open lights were traced.
__kernel void light_join(const LightSumsParams params, __global uint* masks, __global const uint* lit) {
    GN_FOR_EACH(i, params.point_count * (size_t)params.bundle_count) {
        size_t at = i / params.point_count * params.mask_stride + i % params.point_count;
        masks[at] |= lit[at];
    }
}

// The weighted cosine of one light as a whole number: max(0, n . l), at most 1, times the weight. The three products
// and two sums are each rounded once, in this order; the product with the weight is rounded once; the result times
// 2^-exponent is rounded to the nearest whole number, ties to even.
static long cosine_term(float3 n, LightSlot slot, int exponent) {
    float x = fma(n.x, slot.direction[0], 0.0f), y = fma(n.y, slot.direction[1], 0.0f);
    float cosine = clamp(x + y + fma(n.z, slot.direction[2], 0.0f), 0.0f, 1.0f);
    return whole_of_float(fma(cosine, slot.weight, 0.0f), -exponent);
}

static long weighted_sum(uint mask, __global const long* tables) {
    return tables[mask & 255u] + tables[WEIGHT_TABLE + (mask >> 8 & 255u)] +
           tables[2u * WEIGHT_TABLE + (mask >> 16 & 255u)] + tables[3u * WEIGHT_TABLE + (mask >> 24)];
}

__kernel void light_sums(const LightSumsParams params, __global const uint* masks, __global const LightSlot* slots,
                         __global const long* weight_tables, __global const uint* order, __global const float* normals,
                         __global uint* bits, __global uint* counts, __global long* sums, __global uint* first,
                         __global uint* last) {
    GN_FOR_EACH(i, params.point_count) {
        size_t point = params.first_point + i;
        if (params.is_sorted != 0u) point = order[point];
        float3 n = (float3)(0.0f);
        if ((params.wants & WANTS_COSINES) != 0u) n = load_point(normals, params.normals, params.first_point + i);
        uint count = 0, earliest = GN_NO_ID, latest = 0;
        long sum = 0;
        for (uint b = 0; b < params.bundle_count; ++b) {
            uint mask = masks[b * (size_t)params.mask_stride + i];
            __global const LightSlot* mine = slots + (params.first_bundle + b) * MAX_BUNDLE_LIGHTS;
            count += popcount(mask);
            if ((params.wants & (WANTS_SUMS | WANTS_COSINES)) == WANTS_SUMS)
                sum += weighted_sum(mask,
                                    weight_tables + (size_t)(params.first_bundle + b) * WEIGHT_TABLES * WEIGHT_TABLE);
            if ((params.wants & (WANTS_BITS | WANTS_FIRST | WANTS_LAST | WANTS_COSINES)) == 0u) continue;
            while (mask != 0u) {
                LightSlot slot = mine[take_lowest_bit(&mask)];
                if ((params.wants & WANTS_BITS) != 0u)
                    bits[point * params.words + slot.light / 32u] |= 1u << (slot.light & 31u);
                if ((params.wants & WANTS_COSINES) != 0u) sum += cosine_term(n, slot, params.exponent);
                earliest = min(earliest, slot.light);
                latest = max(latest, slot.light + 1u);
            }
        }
        if ((params.wants & WANTS_COUNTS) != 0u) counts[point] += count;
        if ((params.wants & WANTS_SUMS) != 0u) sums[point] += sum;
        if ((params.wants & WANTS_FIRST) != 0u) first[point] = min(first[point], earliest);
        if ((params.wants & WANTS_LAST) != 0u && latest != 0u)
            last[point] = last[point] == GN_NO_ID ? latest - 1u : max(last[point], latest - 1u);
    }
}

// mean[i] = shares[counts[i]].
__kernel void light_means(uint point_count, __global const uint* counts, __global const float* shares,
                          __global float* mean) {
    GN_FOR_EACH(i, point_count) mean[i] = shares[counts[i]];
}

// Converts the whole sums to float64, in place.
__kernel void light_sums_finish(const LightSumsParams params, __global long* sums) {
    GN_FOR_EACH(i, params.point_count) sums[i] = double_bits_of_whole(sums[i], params.exponent);
}
