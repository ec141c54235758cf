// SPDX-License-Identifier: MIT
// Bins: for each bin of a projection, the list of triangles that may matter to a point in it. Serves the light's frames
// and, with a bin per 16 x 16 pixels, the camera.
//
// A triangle enters a bin's list unless it certainly cannot matter there (bin_test.h). Each pair of triangle and bin is
// found once: bins_pairs remembers it with its place in the bin's list, the counts are scanned, and bins_scatter writes
// it there. No fixed capacity, contiguous lists.
#include "bin_test.h"

// The heights below which a triangle need not be listed, per bin, and three levels of minima above them: one work-item
// per 8 x 8 bins.
__kernel void bins_heights(uint width, uint height, uint from_farthest, uint first, __global const uint* farthest,
                           __global uint* heights) {
    uint tiles_x = (width + TILE_LAST) >> TILE_LOG2, tiles_y = (height + TILE_LAST) >> TILE_LOG2;
    GN_FOR_EACH(tile, tiles_x * tiles_y) {
        uint x = (uint)tile % tiles_x, y = (uint)tile / tiles_x;
        uint level_first = first, level_width = width, level_height = height;
        uint size = 1u << TILE_LOG2;
        for (uint level = 0; level <= TILE_LOG2; ++level) {
            __global uint* cells = heights + level_first;
            uint below_width = level == 0u ? 0u : (width + (1u << (level - 1u)) - 1u) >> (level - 1u);
            uint below_height = level == 0u ? 0u : (height + (1u << (level - 1u)) - 1u) >> (level - 1u);
            __global const uint* below = cells - below_width * below_height;
            uint last_x = min((x + 1u) * size, level_width), last_y = min((y + 1u) * size, level_height);
            for (uint cell_y = y * size; cell_y < last_y; ++cell_y)
                for (uint cell_x = x * size; cell_x < last_x; ++cell_x) {
                    uint at = cell_y * level_width + cell_x;
                    if (level == 0u) {
                        if (from_farthest) cells[at] = farthest[at];
                        continue;
                    }
                    uint x0 = 2u * cell_x, x1 = min(x0 + 1u, below_width - 1u);
                    uint y0 = 2u * cell_y, y1 = min(y0 + 1u, below_height - 1u);
                    cells[at] = min(min(below[y0 * below_width + x0], below[y0 * below_width + x1]),
                                    min(below[y1 * below_width + x0], below[y1 * below_width + x1]));
                }
            if (level_width == 1u && level_height == 1u) break;
            level_first += level_width * level_height;
            level_width = (level_width + 1u) / 2u;
            level_height = (level_height + 1u) / 2u;
            size /= 2u;
        }
    }
}

// A (triangle, bin) pair, and its place in the bin's list.
typedef struct Pair {
    uint bin, slot, place;
} Pair;

__kernel void bins_pairs(__constant const Projection* projection, uint tile_capacity, uint has_heights,
                         uint pair_capacity, __global const TriangleRecord* records, __global const uint2* tiles,
                         __global const uint* heights, __global uint* counts, __global Pair* pairs,
                         __global FrameCounters* counters) {
    uint tile_count = min(counters->tiles, tile_capacity);
    Claim places = no_claim();
    GN_FOR_EACH(i, tile_count * TILE_LANES) {
        uint2 tile = tiles[i / TILE_LANES];
        if (tile.x == GN_NO_ID) continue;
        TriangleRecord record = records[tile.x];
        uint4 bins = bins_of_tile(tile.y);
        uint bin_count = bins_of_rectangle(bins);
        for (uint b = (uint)i % TILE_LANES; b < bin_count; b += TILE_LANES) {
            uint4 bin = bin_of_rectangle(bins, b);
            if (!may_matter(&record, projection, bin, has_heights, heights)) continue;
            Pair pair;
            pair.bin = bin.y * projection->bins_x + bin.x;
            pair.slot = tile.x;
            pair.place = atomic_inc(&counts[pair.bin]);
            uint at = claim(&places, &counters->pairs);
            if (at < pair_capacity) pairs[at] = pair;
        }
    }
    for (; places.next < min(places.end, pair_capacity); ++places.next) pairs[places.next].bin = GN_NO_ID;
}

__kernel void bins_scatter(uint bin_count, uint slot_capacity, uint map_tile_capacity, uint tile_capacity,
                           uint pair_capacity, __global const Pair* pairs, __global const uint* offsets,
                           __global uint* references, __global FrameCounters* counters) {
    // What found no room on the way is in no list: the host will grow its list and run again (the same conditions as
    // fitted() of the stages, so that nothing is read that is not counted).
    bool fits = max(counters->slots, counters->map_slots) <= slot_capacity &&
                counters->map_tiles <= map_tile_capacity && counters->tiles <= tile_capacity &&
                counters->pairs <= pair_capacity;
    if (get_global_id(0) == 0) counters->references = fits ? offsets[bin_count] : GN_NO_LISTS;
    if (!fits) return;
    GN_FOR_EACH(i, counters->pairs) {
        Pair pair = pairs[i];
        if (pair.bin != GN_NO_ID) references[offsets[pair.bin] + pair.place] = pair.slot;
    }
}
