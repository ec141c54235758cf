// SPDX-License-Identifier: MIT
// How a GPU walks a list of tiles: a work-group takes some, and shares out the bins of those that matter evenly among
// its items, since a tile may have one bin or 64. (A CPU's work-item takes tile by tile, and asked before it listed
// them.)
#ifndef GN_TILE_BINS_H
#define GN_TILE_BINS_H

#include "bin_test.h"
#include "group_scan.h"

#ifndef GN_CPU

// A tile of fewer bins is not asked about as a whole: its bins are, when they are walked.
#define BINS_WORTH_A_TEST 5u

// The tiles of a group, one for each item, and the sums of their bins.
typedef struct TileGroup {
    __local uint2* tiles;
    __local uint* ends;
} TileGroup;

// Takes the item's tile of this round, if there is one; returns how many bins the group has to walk. All items must
// come here.
static uint take_tile(TileGroup group, __global const uint2* tiles, uint count, uint round,
                      __constant const Projection* projection, uint has_heights, __global const uint* heights,
                      __global const TriangleRecord* records) {
    uint item = (uint)get_local_id(0), i = thing_of_round(round, count), bin_count = 0;
    if (i < count) {
        uint2 tile = tiles[i];
        uint4 bins = bins_of_tile(tile.y);
        bin_count = bins_of_rectangle(bins);
        if (bin_count >= BINS_WORTH_A_TEST) {
            TriangleRecord record = records[tile.x];
            if (!may_matter(&record, projection, bins, has_heights, heights)) bin_count = 0;
        }
        group.tiles[item] = tile;
    }
    scan_group(bin_count, group.ends);
    return group.ends[get_local_size(0) - 1u];
}

// The i-th bin of those that the group walks, and the record that is asked about it.
static uint4 bin_to_walk(TileGroup group, uint i, uint* slot) {
    uint owner = item_of_piece(group.ends, i);
    uint2 tile = group.tiles[owner];
    *slot = tile.x;
    return bin_of_rectangle(bins_of_tile(tile.y), owner == 0u ? i : i - group.ends[owner - 1u]);
}

#endif
#endif
