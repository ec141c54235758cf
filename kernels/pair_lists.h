// SPDX-License-Identifier: MIT
// Pairs of a triangle and a bin that it may matter to, as they are found: what triangle_setup and bins do alike.
#ifndef GN_PAIR_LISTS_H
#define GN_PAIR_LISTS_H

#include "bin_test.h"
#include "bins.h"

static Pair listed_pair(uint bin, uint slot, __global uint* counts) {
    Pair pair;
    pair.bin = bin;
    pair.slot = slot;
    pair.place = atomic_inc(&counts[bin]);
    return pair;
}

static uint bin_number(__constant const Projection* projection, uint x, uint y) { return y * projection->bins_x + x; }

#ifdef GN_CPU
// Where a CPU's work-item lists its pairs.
typedef struct PairList {
    __constant const Projection* projection;
    __global const uint* heights;
    __global uint* counts;
    __global Pair* pairs;
    __global uint* wanted;
    uint has_heights, capacity, found;
    Claim places;
} PairList;

static void append_pair(PairList* list, uint slot, uint bin) {
    ++list->found;
    Pair pair = listed_pair(bin, slot, list->counts);
    uint at = claim(&list->places, list->wanted);
    if (at < list->capacity) list->pairs[at] = pair;
}

static void append_lanes(PairList* list, LaneInt slots, LaneInt x, LaneInt y, LaneInt lanes) {
    LaneInt bins = y * (int)list->projection->bins_x + x;
    uint bits = lane_bits(lanes);
    while (bits != 0u) {
        uint lane = take_lowest_bit(&bits);
        append_pair(list, (uint)LANE_OF_INT(slots, lane), (uint)LANE_OF_INT(bins, lane));
    }
}

// Of a rectangle of at most 8 x 8 bins those that the triangle may matter to; its record is in all lanes.
static void append_bins(PairList* list, uint slot, const RecordBlock* record, uint4 bins) {
    int width = (int)(bins.z - bins.x + 1u), reciprocal = 65536 / width + 1;  // exact for all 64
    int last = (int)bins_of_rectangle(bins) - 1;
    for (int first = 0; first <= last; first += GN_LANES) {
        LaneInt wanted = LANE_INDEX + first, i = min(wanted, (LaneInt)(last));
        LaneInt row = (i * reciprocal) >> 16;
        LaneInt x = i - row * width + (int)bins.x, y = row + (int)bins.y;
        LaneInt matters = lanes_may_matter(record, list->projection, x, y, list->has_heights, list->heights);
        append_lanes(list, (LaneInt)((int)slot), x, y, matters & LANE_COMPARE(i, ==, wanted));
    }
}

// Marks the places that were claimed and not used.
static void close_pairs(PairList* list) {
    for (; list->places.next < min(list->places.end, list->capacity); ++list->places.next)
        list->pairs[list->places.next].bin = GN_NO_ID;
}
#endif

#endif
