// SPDX-License-Identifier: MIT
// A pass of the sort (sort.h) by one digit. sort_count counts each digit in each chunk of SORT_CHUNK keys. Prefix sums
// over the counts, by digit and within a digit by chunk, give the slots: on a GPU by the stage scan, on a CPU by the
// last item of sort_count, since three launches take longer. sort_scatter writes every key to its slot. The order of
// equal keys depends only on the chunks, whatever the size of work-groups.
#include "lists/sort.h"

#include "lists/group_scan.clh"

static uint digit_of(uint key, uint shift) { return (key >> shift) & (SORT_DIGITS - 1u); }
static uint chunk_count_of(uint count) { return (count + SORT_CHUNK - 1u) / SORT_CHUNK; }

#ifdef GN_CPU
// Makes counts the slots of their keys, in place.
static void make_slots(uint chunks, __global uint* counts) {
    uint before = 0u;
    for (uint i = 0; i < chunks * SORT_DIGITS; ++i) {
        uint mine = counts[i];
        counts[i] = before;
        before += mine;
    }
}

// `of_digits` and `memory` are a GPU's.
__kernel void sort_count(SortParams params, __global const uint* keys, __global uint* counts,
                         __local uint* of_digits GN_SHARES) {
    uint count = params.count, chunks = chunk_count_of(count);
    GN_FOR_EACH_OF(chunk, GN_SHARED_RANGE(chunks)) {
        uint mine[SORT_DIGITS];
        for (uint digit = 0; digit < SORT_DIGITS; ++digit) mine[digit] = 0u;
        uint last = min((uint)(chunk + 1) * SORT_CHUNK, count);
        for (uint i = (uint)chunk * SORT_CHUNK; i < last; ++i) ++mine[digit_of(keys[i], params.shift)];
        for (uint digit = 0; digit < SORT_DIGITS; ++digit) counts[digit * chunks + (uint)chunk] = mine[digit];
    }
    if (GN_END_SHARES) make_slots(chunks, counts);
}

__kernel void sort_scatter(SortParams params, __global const uint* keys, __global const uint* values,
                           __global const uint* slots, __global uint* sorted_keys, __global uint* sorted_values,
                           __local uint* memory GN_SHARES) {
    uint count = params.count, chunks = chunk_count_of(count);
    GN_FOR_EACH_OF(chunk, GN_SHARED_RANGE(chunks)) {
        uint next[SORT_DIGITS];
        for (uint digit = 0; digit < SORT_DIGITS; ++digit) next[digit] = slots[digit * chunks + (uint)chunk];
        uint last = min((uint)(chunk + 1) * SORT_CHUNK, count);
        for (uint i = (uint)chunk * SORT_CHUNK; i < last; ++i) {
            uint key = keys[i], slot = next[digit_of(key, params.shift)]++;
            sorted_keys[slot] = key;
            sorted_values[slot] = values[i];
        }
    }
    GN_END_SHARES;
}
#else
// of_digits: SORT_DIGITS words.
__kernel void sort_count(SortParams params, __global const uint* keys, __global uint* counts, __local uint* of_digits) {
    uint count = params.count, chunks = chunk_count_of(count);
    GN_FOR_EACH_BY_GROUP(uint, chunk, chunks) {
        uint first = chunk * SORT_CHUNK, in_chunk = min(SORT_CHUNK, count - first);
        GN_FOR_EACH_IN_GROUP(digit, SORT_DIGITS) of_digits[digit] = 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        GN_FOR_EACH_IN_GROUP(i, in_chunk) atomic_inc(&of_digits[digit_of(keys[first + i], params.shift)]);
        barrier(CLK_LOCAL_MEM_FENCE);
        GN_FOR_EACH_IN_GROUP(digit, SORT_DIGITS) counts[digit * chunks + chunk] = of_digits[digit];
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// A key of a chunk: its digit << 16 | its index in the chunk.
#define INDEX_OF_ENTRY 0xFFFFu
#define DIGIT_OF_ENTRY 16u

// Counts the entries of each item's run by half of their digits, then makes the counts the entries' slots: an item's
// counts stand `items` words apart, so that the sums over all words are by half digit, and within one by item.
static void find_slots(__local const uint* entries, uint2 run, uint shift, __local uint* slots, __local uint* sums) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), sum = 0u;
    for (uint k = 0; k < SORT_HALVES; ++k) slots[k * items + item] = 0u;
    for (uint i = run.x; i < run.y; ++i) ++slots[((entries[i] >> shift) & (SORT_HALVES - 1u)) * items + item];
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint k = 0; k < SORT_HALVES; ++k) sum += slots[item * SORT_HALVES + k];
    scan_group(sum, sums);
    uint before = sum_before(sums, item);
    for (uint k = 0; k < SORT_HALVES; ++k) {
        uint mine = slots[item * SORT_HALVES + k];
        slots[item * SORT_HALVES + k] = before;
        before += mine;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}

// Sorts the entries by half of their digits.
static void sort_by_half(__local const uint* entries, uint count, uint shift, __local uint* sorted, __local uint* slots,
                         __local uint* sums) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), length = (count + items - 1u) / items;
    uint2 run = (uint2)(min(item * length, count), min((item + 1u) * length, count));
    find_slots(entries, run, shift, slots, sums);
    for (uint i = run.x; i < run.y; ++i) {
        uint entry = entries[i];
        sorted[slots[((entry >> shift) & (SORT_HALVES - 1u)) * items + item]++] = entry;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}

// memory: SORT_CHUNK words twice, SORT_DIGITS words, and SORT_HALVES + 1 for each item.
__kernel void sort_scatter(SortParams params, __global const uint* keys, __global const uint* values,
                           __global const uint* slots, __global uint* sorted_keys, __global uint* sorted_values,
                           __local uint* memory) {
    uint count = params.count, chunks = chunk_count_of(count);
    __local uint* entries = memory;
    __local uint* half_sorted = entries + SORT_CHUNK;
    __local uint* first_of_digit = half_sorted + SORT_CHUNK;
    __local uint* sums = first_of_digit + SORT_DIGITS;
    __local uint* slots_of_halves = sums + get_local_size(0);
    GN_FOR_EACH_BY_GROUP(uint, chunk, chunks) {
        uint first = chunk * SORT_CHUNK, in_chunk = min(SORT_CHUNK, count - first);
        GN_FOR_EACH_IN_GROUP(i, in_chunk) entries[i] = digit_of(keys[first + i], params.shift) << DIGIT_OF_ENTRY | i;
        barrier(CLK_LOCAL_MEM_FENCE);
        sort_by_half(entries, in_chunk, DIGIT_OF_ENTRY, half_sorted, slots_of_halves, sums);
        sort_by_half(half_sorted, in_chunk, DIGIT_OF_ENTRY + SORT_HALF_BITS, entries, slots_of_halves, sums);
        GN_FOR_EACH_IN_GROUP(i, in_chunk) {
            uint digit = entries[i] >> DIGIT_OF_ENTRY;
            bool is_first = i == 0u || entries[i - 1u] >> DIGIT_OF_ENTRY != digit;
            if (is_first) first_of_digit[digit] = i;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        GN_FOR_EACH_IN_GROUP(i, in_chunk) {
            uint digit = entries[i] >> DIGIT_OF_ENTRY, from = first + (entries[i] & INDEX_OF_ENTRY);
            uint slot = slots[digit * chunks + chunk] + (i - first_of_digit[digit]);
            sorted_keys[slot] = keys[from];
            sorted_values[slot] = values[from];
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}
#endif
