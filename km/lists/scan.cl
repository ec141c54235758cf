// SPDX-License-Identifier: MIT
// Exclusive prefix sums of counts, for every list that is counted, scanned and filled. Each count can be rounded up to
// a multiple of `alignment` (a power of two) first, so that lists start aligned for vector loads.
//
// Three passes over chunks of SCAN_CHUNK counts, one work-item each: sums of chunks, their scan by one work-group,
// offsets within chunks. offsets[count] becomes the total.
#include "lists/scan.h"

static uint rounded_up(uint count, uint alignment) { return (count + alignment - 1) & ~(alignment - 1); }

__kernel void scan_sums(ScanParams params, __global const uint* counts, __global uint* chunk_sums) {
    uint count = params.count, chunks = (count + SCAN_CHUNK - 1) / SCAN_CHUNK;
    GN_FOR_EACH(chunk, chunks) {
        uint sum = 0;
        uint last = min((uint)(chunk + 1) * SCAN_CHUNK, count);
        for (uint i = (uint)chunk * SCAN_CHUNK; i < last; ++i)
            sum = add_sat(sum, rounded_up(counts[i], params.alignment));
        chunk_sums[chunk] = sum;
    }
}

// One work-group: each item sums a run of chunks, item 0 scans the runs, each item writes its run's offsets.
__kernel void scan_chunks(ScanParams params, __global uint* chunk_sums, __global uint* offsets,
                          __local uint* run_sums) {
    uint count = params.count, chunks = (count + SCAN_CHUNK - 1) / SCAN_CHUNK;
    uint items = (uint)get_local_size(0), item = (uint)get_local_id(0);
    uint run = (chunks + items - 1) / items;
    uint first = min(item * run, chunks), last = min(first + run, chunks);
    uint sum = 0;
    for (uint chunk = first; chunk < last; ++chunk) sum = add_sat(sum, chunk_sums[chunk]);
    run_sums[item] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) {
        uint before = 0;
        for (uint i = 0; i < items; ++i) {
            uint size = run_sums[i];
            run_sums[i] = before;
            before = add_sat(before, size);  // saturates: a total that does not fit is seen as an overflow by the host
        }
        offsets[count] = before;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    uint before = run_sums[item];
    for (uint chunk = first; chunk < last; ++chunk) {
        uint size = chunk_sums[chunk];
        chunk_sums[chunk] = before;
        before = add_sat(before, size);
    }
}

__kernel void scan_offsets(ScanParams params, __global const uint* counts, __global const uint* chunk_sums,
                           __global uint* offsets) {
    uint count = params.count, chunks = (count + SCAN_CHUNK - 1) / SCAN_CHUNK;
    GN_FOR_EACH(chunk, chunks) {
        uint sum = chunk_sums[chunk];
        uint last = min((uint)(chunk + 1) * SCAN_CHUNK, count);
        for (uint i = (uint)chunk * SCAN_CHUNK; i < last; ++i) {
            offsets[i] = sum;
            sum = add_sat(sum, rounded_up(counts[i], params.alignment));
        }
    }
}
