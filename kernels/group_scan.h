// SPDX-License-Identifier: MIT
// Sums over the items of a work-group, of any size, and work shared out by them.
#ifndef GN_GROUP_SCAN_H
#define GN_GROUP_SCAN_H

#include "prelude.h"

// Sets sums[item] to the sum of the values of items 0 to `item`, for all to read. Every item of the group must come
// here; what they wrote to global memory before is visible to all of them afterwards.
static void scan_group(uint value, __local uint* sums) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    sums[item] = value;
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
    for (uint step = 1; step < items; step *= 2) {
        uint before = item >= step ? sums[item - step] : 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        sums[item] += before;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// Adds what the items of a work-group have counted, all of which must come here: on a GPU by one atomic for them all,
// since on one address those of thousands of items take tens of microseconds.
static void add_in_group(uint value, __local uint* sum, __global uint* counter) {
#ifdef GN_CPU
    if (value != 0u) atomic_add(counter, value);
#else
    bool is_first = get_local_id(0) == 0;
    if (is_first) *sum = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (value != 0u) atomic_add(sum, value);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (is_first && *sum != 0u) atomic_add(counter, *sum);
#endif
}

// Where each item brought some pieces of work, and sums[item] are those of items 0 to `item`: whose the i-th piece is,
// the first item whose sum lies beyond i.
static uint item_of_piece(__local const uint* sums, uint i) {
    uint low = 0, high = (uint)get_local_size(0) - 1u;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (sums[middle] > i)
            high = middle;
        else
            low = middle + 1u;
    }
    return low;
}

// for (round) each item takes thing_of_round(round, count), if that is below `count`: as many rounds for all items.
// Fewer things than items are dealt out one by one, since neighbours are alike: groups then have about the same to do.
#define GN_ROUNDS(round, count) for (uint round = 0; round * (uint)get_global_size(0) < (count); ++round)
static uint thing_of_round(uint round, uint count) {
    if (count < get_global_size(0)) return (uint)get_local_id(0) * (uint)get_num_groups(0) + (uint)get_group_id(0);
    return round * (uint)get_global_size(0) + (uint)get_global_id(0);
}

#endif
