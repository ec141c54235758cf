// SPDX-License-Identifier: MIT
// Exclusive prefix sums of counts, for every list that is counted, scanned and filled. Sums stay at 2^32 - 1
// where they would be larger, so that the host sees a total that does not fit.
//
// Three passes over chunks of SCAN_CHUNK counts, which work-groups take: sums of chunks, their scan by one work-group,
// offsets within chunks. offsets[count] becomes the total. Each item of a group takes a run of neighbours. Local memory
// of all three: a word for each item.
#include "lists/scan.h"

#include "lists/group_scan.clh"

// The run of an item among `count` counts from `first` on, as (first, end).
static uint2 run_of_item(uint first, uint count) {
    uint items = (uint)get_local_size(0), run = (count + items - 1u) / items;
    uint begin = min((uint)get_local_id(0) * run, count);
    return (uint2)(first + begin, first + min(begin + run, count));
}

static uint sum_of_run(__global const uint* counts, uint2 run) {
    uint sum = 0u;
    for (uint i = run.x; i < run.y; ++i) sum = add_sat(sum, counts[i]);
    return sum;
}

static uint chunk_count_of(uint count) { return (count + SCAN_CHUNK - 1u) / SCAN_CHUNK; }
static uint counts_in_chunk(uint count, uint chunk) { return min(count - chunk * SCAN_CHUNK, SCAN_CHUNK); }

__kernel void scan_sums(uint count, __global const uint* counts, __global uint* chunk_sums, __local uint* sums) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    GN_FOR_EACH_BY_GROUP(uint, chunk, chunk_count_of(count)) {
        scan_group(sum_of_run(counts, run_of_item(chunk * SCAN_CHUNK, counts_in_chunk(count, chunk))), sums);
        if (item == items - 1u) chunk_sums[chunk] = sums[item];
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// One work-group.
__kernel void scan_chunks(uint count, __global uint* chunk_sums, __global uint* offsets, __local uint* sums) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    uint2 run = run_of_item(0u, chunk_count_of(count));
    scan_group(sum_of_run(chunk_sums, run), sums);
    uint before = sum_before(sums, item);
    if (item == items - 1u) offsets[count] = sums[item];
    for (uint i = run.x; i < run.y; ++i) {
        uint sum = chunk_sums[i];
        chunk_sums[i] = before;
        before = add_sat(before, sum);
    }
}

__kernel void scan_offsets(uint count, __global const uint* counts, __global const uint* chunk_sums,
                           __global uint* offsets, __local uint* sums) {
    GN_FOR_EACH_BY_GROUP(uint, chunk, chunk_count_of(count)) {
        uint2 run = run_of_item(chunk * SCAN_CHUNK, counts_in_chunk(count, chunk));
        scan_group(sum_of_run(counts, run), sums);
        uint before = add_sat(chunk_sums[chunk], sum_before(sums, (uint)get_local_id(0)));
        for (uint i = run.x; i < run.y; ++i) {
            offsets[i] = before;
            before = add_sat(before, counts[i]);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}
