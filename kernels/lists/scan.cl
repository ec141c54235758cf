// SPDX-License-Identifier: MIT
// Exclusive prefix sums of counts, for every list that is counted, scanned and filled. Each count can be rounded up to
// a multiple of `alignment` (a power of two) first, so that lists start aligned for vector loads.
//
// Three passes over pieces of SCAN_CHUNK counts, one work-item each: sums of pieces, their scan by one work-group,
// offsets within pieces. offsets[count] becomes the total.
#include "lists/scan.h"

static uint rounded_up(uint count, uint alignment) { return (count + alignment - 1) & ~(alignment - 1); }

__kernel void scan_sums(uint count, uint alignment, __global const uint* counts, __global uint* piece_sums) {
    uint pieces = (count + SCAN_CHUNK - 1) / SCAN_CHUNK;
    GN_FOR_EACH(piece, pieces) {
        uint sum = 0;
        uint last = min((uint)(piece + 1) * SCAN_CHUNK, count);
        for (uint i = (uint)piece * SCAN_CHUNK; i < last; ++i) sum = add_sat(sum, rounded_up(counts[i], alignment));
        piece_sums[piece] = sum;
    }
}

// One work-group: each item sums a run of pieces, item 0 scans the runs, each item writes its run's offsets.
__kernel void scan_pieces(uint count, __global uint* piece_sums, __global uint* offsets, __local uint* run_sums) {
    uint pieces = (count + SCAN_CHUNK - 1) / SCAN_CHUNK;
    uint items = (uint)get_local_size(0), item = (uint)get_local_id(0);
    uint run = (pieces + items - 1) / items;
    uint first = min(item * run, pieces), last = min(first + run, pieces);
    uint sum = 0;
    for (uint piece = first; piece < last; ++piece) sum = add_sat(sum, piece_sums[piece]);
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
    for (uint piece = first; piece < last; ++piece) {
        uint size = piece_sums[piece];
        piece_sums[piece] = before;
        before = add_sat(before, size);
    }
}

__kernel void scan_offsets(uint count, uint alignment, __global const uint* counts, __global const uint* piece_sums,
                           __global uint* offsets) {
    uint pieces = (count + SCAN_CHUNK - 1) / SCAN_CHUNK;
    GN_FOR_EACH(piece, pieces) {
        uint sum = piece_sums[piece];
        uint last = min((uint)(piece + 1) * SCAN_CHUNK, count);
        for (uint i = (uint)piece * SCAN_CHUNK; i < last; ++i) {
            offsets[i] = sum;
            sum = add_sat(sum, rounded_up(counts[i], alignment));
        }
    }
}
