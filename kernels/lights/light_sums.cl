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

// The inputs and outputs of light_sums.
typedef struct SumsWork {
    LightSumsParams params;
    __global const uint* masks;
    __global const LightSlot* slots;
    __global const long* weight_tables;
    __global const uint* order;
    __global const float* normals;
    __global uint* bits;
    __global uint* counts;
    __global long* sums;
    __global uint* first;
    __global uint* last;
} SumsWork;

// What the lights of some masks add to a point: `latest` is one more than the index of the last light, or 0.
typedef struct PointSums {
    uint count, earliest, latest;
    long sum;
} PointSums;

static size_t number_of_point(const SumsWork* work, size_t i) {
    size_t point = work->params.first_point + i;
    return work->params.is_sorted != 0u ? work->order[point] : point;
}

static __global const LightSlot* slots_of_bundle(const SumsWork* work, uint b) {
    return work->slots + (work->params.first_bundle + b) * MAX_BUNDLE_LIGHTS;
}
static __global const long* tables_of_bundle(const SumsWork* work, uint b) {
    return work->weight_tables + (size_t)(work->params.first_bundle + b) * WEIGHT_TABLES * WEIGHT_TABLE;
}

static bool wants(const SumsWork* work, uint outputs) { return (work->params.wants & outputs) != 0u; }
static bool sums_by_tables(const SumsWork* work) {
    return (work->params.wants & (WANTS_SUMS | WANTS_COSINES)) == WANTS_SUMS;
}

static void add_sums(const SumsWork* work, size_t point, PointSums found) {
    if (wants(work, WANTS_COUNTS)) work->counts[point] += found.count;
    if (wants(work, WANTS_SUMS)) work->sums[point] += found.sum;
    if (wants(work, WANTS_FIRST)) work->first[point] = min(work->first[point], found.earliest);
    if (wants(work, WANTS_LAST) && found.latest != 0u) {
        uint before = work->last[point];
        work->last[point] = before == GN_NO_ID ? found.latest - 1u : max(before, found.latest - 1u);
    }
}

static void sum_point(const SumsWork* work, size_t i) {
    size_t point = number_of_point(work, i);
    float3 n = (float3)(0.0f);
    if (wants(work, WANTS_COSINES)) n = load_point(work->normals, work->params.normals, work->params.first_point + i);
    PointSums found = {0u, GN_NO_ID, 0u, 0};
    for (uint b = 0; b < work->params.bundle_count; ++b) {
        uint mask = work->masks[b * (size_t)work->params.mask_stride + i];
        __global const LightSlot* mine = slots_of_bundle(work, b);
        found.count += popcount(mask);
        if (sums_by_tables(work)) found.sum += weighted_sum(mask, tables_of_bundle(work, b));
        if (!wants(work, WANTS_BITS | WANTS_FIRST | WANTS_LAST | WANTS_COSINES)) continue;
        while (mask != 0u) {
            LightSlot slot = mine[take_lowest_bit(&mask)];
            if (wants(work, WANTS_BITS))
                work->bits[point * work->params.words + slot.light / 32u] |= 1u << (slot.light & 31u);
            if (wants(work, WANTS_COSINES)) found.sum += cosine_term(n, slot, work->params.exponent);
            found.earliest = min(found.earliest, slot.light);
            found.latest = max(found.latest, slot.light + 1u);
        }
    }
    add_sums(work, point, found);
}

#if GN_LANES > 1
// The most words of packed bits that a point may have for its block to be summed at once.
#define MAX_BLOCK_WORDS 160u

// Adds the weights of each lane's lights. Bytes that are 0 in all masks add nothing.
GN_INLINE_ON_CPU void add_weights(LaneInt masks, __global const long* tables, long* sums) {
    uint any = LANES_ANY_BIT(masks);
    for (uint first = 0; first < 32u && any >> first != 0u; first += 8u, tables += WEIGHT_TABLE)
        for (uint lane = 0; lane < GN_LANES; ++lane)
            sums[lane] += tables[(uint)LANE_OF_INT(masks, lane) >> first & 255u];
}

// Asks for the sums of the points of a block: in the sorted order they are strewn over the memory.
GN_INLINE_ON_CPU void prefetch_sums(const SumsWork* work, size_t first) {
    for (uint lane = 0; lane < GN_LANES; ++lane) {
        size_t point = number_of_point(work, first + lane);
        if (wants(work, WANTS_COUNTS)) GN_PREFETCH(&work->counts[point]);
        if (wants(work, WANTS_SUMS)) GN_PREFETCH(&work->sums[point]);
    }
}

// sum_point() for GN_LANES neighbours, without cosines: a light is looked at once for all of them.
GN_NOINLINE_ON_CPU void sum_block(const SumsWork* work, size_t first) {
    prefetch_sums(work, first);
    const LaneInt none = (LaneInt)(0);
    LaneInt words[MAX_BLOCK_WORDS], counts = none, earliest = (LaneInt)(INT_MAX), latest = none;
    long sums[GN_LANES] = {0};
    for (uint w = 0; w < work->params.words; ++w) words[w] = none;
    for (uint b = 0; b < work->params.bundle_count; ++b) {
        LaneInt masks = as_int16(vload16(0, work->masks + b * (size_t)work->params.mask_stride + first));
        if (wants(work, WANTS_COUNTS)) counts += popcount(masks);
        if (sums_by_tables(work)) add_weights(masks, tables_of_bundle(work, b), sums);
        if (!wants(work, WANTS_BITS | WANTS_FIRST | WANTS_LAST)) continue;
        __global const LightSlot* mine = slots_of_bundle(work, b);
        for (uint any = LANES_ANY_BIT(masks); any != 0u;) {
            uint slot = take_lowest_bit(&any);
            int light = (int)mine[slot].light;
            LaneInt lit = LANE_COMPARE(masks & (int)(1u << slot), !=, none);
            words[light / 32] |= lit & (int)(1u << (light & 31));
            earliest = LANES_SELECT(earliest, min(earliest, light), lit);
            latest = LANES_SELECT(latest, max(latest, light + 1), lit);
        }
    }
    for (uint lane = 0; lane < GN_LANES; ++lane) {
        size_t point = number_of_point(work, first + lane);
        uint last = (uint)LANE_OF_INT(latest, lane);
        uint lowest = last == 0u ? GN_NO_ID : (uint)LANE_OF_INT(earliest, lane);
        add_sums(work, point, (PointSums){(uint)LANE_OF_INT(counts, lane), lowest, last, sums[lane]});
        if (!wants(work, WANTS_BITS)) continue;
        for (uint w = 0; w < work->params.words; ++w)
            work->bits[point * work->params.words + w] |= (uint)LANE_OF_INT(words[w], lane);
    }
}
#endif

__kernel void light_sums(const LightSumsParams params, __global const uint* masks, __global const LightSlot* slots,
                         __global const long* weight_tables, __global const uint* order, __global const float* normals,
                         __global uint* bits, __global uint* counts, __global long* sums, __global uint* first,
                         __global uint* last) {
    const SumsWork work = {params, masks, slots, weight_tables, order, normals, bits, counts, sums, first, last};
#if GN_LANES > 1
    const uint lanes = !wants(&work, WANTS_COSINES) && params.words <= MAX_BLOCK_WORDS ? GN_LANES : 1u;
    GN_FOR_EACH(block, (params.point_count + GN_LANES - 1u) / GN_LANES) {
        size_t begin = block * GN_LANES, end = min(begin + GN_LANES, (size_t)params.point_count);
        if (lanes > 1u && end - begin == GN_LANES)
            sum_block(&work, begin);
        else
            for (size_t i = begin; i < end; ++i) sum_point(&work, i);
    }
#else
    GN_FOR_EACH(i, params.point_count) sum_point(&work, i);
#endif
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
