// SPDX-License-Identifier: MIT
// A pass of the sort (sort.h) by one digit. sort_count counts each digit in each chunk of SORT_CHUNK keys. Prefix sums
// over the counts (scan.cl), by digit and within a digit by chunk, give the slots. sort_scatter writes every key to its
// slot. Each chunk belongs to one work-item, whatever the size of work-groups, so the order of equal keys depends only
// on the chunks.
#include "lists/sort.h"

static uint digit_of(uint key, uint shift) { return (key >> shift) & (SORT_DIGITS - 1u); }

__kernel void sort_count(SortParams params, __global const uint* keys, __global uint* counts) {
    uint count = params.count, chunks = (count + SORT_CHUNK - 1u) / SORT_CHUNK;
    GN_FOR_EACH(chunk, chunks) {
        uint mine[SORT_DIGITS];
        for (uint digit = 0; digit < SORT_DIGITS; ++digit) mine[digit] = 0u;
        uint last = min((uint)(chunk + 1) * SORT_CHUNK, count);
        for (uint i = (uint)chunk * SORT_CHUNK; i < last; ++i) ++mine[digit_of(keys[i], params.shift)];
        for (uint digit = 0; digit < SORT_DIGITS; ++digit) counts[digit * chunks + (uint)chunk] = mine[digit];
    }
}

__kernel void sort_scatter(SortParams params, __global const uint* keys, __global const uint* values,
                           __global const uint* slots, __global uint* sorted_keys, __global uint* sorted_values) {
    uint count = params.count, chunks = (count + SORT_CHUNK - 1u) / SORT_CHUNK;
    GN_FOR_EACH(chunk, chunks) {
        uint next[SORT_DIGITS];
        for (uint digit = 0; digit < SORT_DIGITS; ++digit) next[digit] = slots[digit * chunks + (uint)chunk];
        uint last = min((uint)(chunk + 1) * SORT_CHUNK, count);
        for (uint i = (uint)chunk * SORT_CHUNK; i < last; ++i) {
            uint key = keys[i], slot = next[digit_of(key, params.shift)]++;
            sorted_keys[slot] = key;
            sorted_values[slot] = values[i];
        }
    }
}
