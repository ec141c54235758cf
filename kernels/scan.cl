// SPDX-License-Identifier: MIT
// Exclusive prefix sums of counts, for every list that is counted, scanned and filled. Each count can be rounded up to
// a multiple of `alignment` (a power of two) first, so that lists start aligned for vector loads.
//
// Three passes over pieces of SCAN_PIECE counts, one work-item each: sums of pieces, their scan by a single work-item,
// offsets within pieces. offsets[count] becomes the total.
#include "prelude.h"

#define SCAN_PIECE 256

static uint rounded_up(uint count, uint alignment) { return (count + alignment - 1) & ~(alignment - 1); }

__kernel void scan_sums(uint count, uint alignment, __global const uint* counts, __global uint* piece_sums) {
    uint pieces = (count + SCAN_PIECE - 1) / SCAN_PIECE;
    GN_FOR_EACH(piece, pieces) {
        uint sum = 0;
        uint last = min((uint)(piece + 1) * SCAN_PIECE, count);
        for (uint i = (uint)piece * SCAN_PIECE; i < last; ++i) sum = add_sat(sum, rounded_up(counts[i], alignment));
        piece_sums[piece] = sum;
    }
}

__kernel void scan_pieces(uint count, __global uint* piece_sums, __global uint* offsets) {
    uint pieces = (count + SCAN_PIECE - 1) / SCAN_PIECE;
    uint sum = 0;
    for (uint piece = 0; piece < pieces; ++piece) {
        uint size = piece_sums[piece];
        piece_sums[piece] = sum;
        sum = add_sat(sum, size);  // saturates: a total that does not fit is seen as an overflow by the host
    }
    offsets[count] = sum;
}

__kernel void scan_offsets(uint count, uint alignment, __global const uint* counts, __global const uint* piece_sums,
                           __global uint* offsets) {
    uint pieces = (count + SCAN_PIECE - 1) / SCAN_PIECE;
    GN_FOR_EACH(piece, pieces) {
        uint sum = piece_sums[piece];
        uint last = min((uint)(piece + 1) * SCAN_PIECE, count);
        for (uint i = (uint)piece * SCAN_PIECE; i < last; ++i) {
            offsets[i] = sum;
            sum = add_sat(sum, rounded_up(counts[i], alignment));
        }
    }
}
