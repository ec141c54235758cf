// SPDX-License-Identifier: MIT
// A pass of the sort (sort.h) by one digit: how often each piece of SORT_CHUNK keys has each digit, a scan over them,
// digit by digit and in each piece by piece (scan.cl), and every key to its place. Each piece belongs to one work-item,
// whatever the size of work-groups, so the order of equal keys hangs on nothing else.
#include "lists/sort.h"

static uint digit_of(uint key, uint shift) { return (key >> shift) & (SORT_DIGITS - 1u); }

__kernel void sort_count(uint count, uint shift, __global const uint* keys, __global uint* counts) {
    uint pieces = (count + SORT_CHUNK - 1u) / SORT_CHUNK;
    GN_FOR_EACH(piece, pieces) {
        uint mine[SORT_DIGITS];
        for (uint digit = 0; digit < SORT_DIGITS; ++digit) mine[digit] = 0u;
        uint last = min((uint)(piece + 1) * SORT_CHUNK, count);
        for (uint i = (uint)piece * SORT_CHUNK; i < last; ++i) ++mine[digit_of(keys[i], shift)];
        for (uint digit = 0; digit < SORT_DIGITS; ++digit) counts[digit * pieces + (uint)piece] = mine[digit];
    }
}

__kernel void sort_scatter(uint count, uint shift, __global const uint* keys, __global const uint* values,
                           __global const uint* places, __global uint* sorted_keys, __global uint* sorted_values) {
    uint pieces = (count + SORT_CHUNK - 1u) / SORT_CHUNK;
    GN_FOR_EACH(piece, pieces) {
        uint next[SORT_DIGITS];
        for (uint digit = 0; digit < SORT_DIGITS; ++digit) next[digit] = places[digit * pieces + (uint)piece];
        uint last = min((uint)(piece + 1) * SORT_CHUNK, count);
        for (uint i = (uint)piece * SORT_CHUNK; i < last; ++i) {
            uint key = keys[i], place = next[digit_of(key, shift)]++;
            sorted_keys[place] = key;
            sorted_values[place] = values[i];
        }
    }
}
