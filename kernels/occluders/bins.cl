// SPDX-License-Identifier: MIT
// Bins: for each bin of a projection, the list of triangles that may matter to a point in it. Serves the light's frames
// and, with a bin per 16 x 16 pixels, the camera.
//
// A triangle enters a bin's list unless it certainly cannot matter there (bin_test.h). Each pair of triangle and bin is
// found once: bins_pairs remembers it with its place in the bin's list (on a CPU most were found by triangle_tiles
// before, while it had their records), bins_ranges gives each bin its part of the entries (in any order: what matters
// is that a list is contiguous), and bins_scatter writes it there. On a GPU bins_order then puts the highest triangles
// of each run of a list first.
#include "occluders/bins.h"

#include "occluders/pair_lists.clh"
#include "occluders/tile_bins.clh"

#ifdef GN_CPU
// Tiles from here to the one whose record is fetched: to wait for records is most of what large scenes cost.
#define TILES_AHEAD 12u

// Of each tile of the share; what it claimed of the list in the end and did not need, it marks.
GN_NOINLINE_ON_CPU void append_pairs(ItemRange items, PairList* list, uint tile_count,
                                     __global const TriangleRecord* records, __global const uint2* tiles) {
    GN_FOR_EACH_OF(i, items) {
        uint2 tile = tiles[i], ahead = tiles[min((uint)i + TILES_AHEAD, tile_count - 1u)];
        if (ahead.x != GN_NO_ID) GN_PREFETCH(&records[ahead.x]);
        if (tile.x == GN_NO_ID) continue;
        uint4 bins = bins_of_tile(tile.y);
        // A tile of one bin was looked at as a tile: no need for the record.
        if (bins.x == bins.z && bins.y == bins.w) {
            append_pair(list, tile.x, bin_number(list->projection, bins.x, bins.y));
            continue;
        }
        RecordBlock record;
        spread_record(&records[tile.x], &record);
        append_bins(list, tile.x, &record, bins);
    }
    close_pairs(list);
}
#endif

__kernel void bins_pairs(__constant const Projection* projection, uint tile_capacity, uint has_heights,
                         uint pair_capacity, __global const TriangleRecord* records, __global const uint2* tiles,
                         __global const uint* heights, __global uint* counts, __global Pair* pairs,
                         __global FrameCounters* counters, __local uint* ends, __local uint2* group_tiles,
                         __local uint2* group_pairs) {
    __local uint sum;
    uint tile_count = min(counters->tiles, tile_capacity);
#ifdef GN_CPU
    PairList list = {projection,  heights,       counts, pairs,           &counters->pairs,
                     has_heights, pair_capacity, 0u,     no_reservation()};
    append_pairs(item_range(tile_count), &list, tile_count, records, tiles);
    uint found = list.found;
#else
    uint found = 0;
    __local uint reserved[GROUP_APPEND_WORDS];
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    if (item == 0u) reserved[0] = 0u;
    TileGroup group = {group_tiles, ends};
    GN_ROUNDS(round, tile_count) {
        uint total = take_tile(group, tiles, tile_count, round, projection, has_heights, heights, records), end;
        for (uint first = 0; first < total; first = end) {
            end = min(total, first + items * PAIRS_AT_ONCE);
            for (uint i = first + item; i < end; i += items) {
                uint slot;
                uint4 bin = bin_to_walk(group, i, &slot);
                TriangleRecord record = records[slot];
                if (survives_cull(&record, projection, bin, has_heights, heights))
                    group_pairs[atomic_inc(&reserved[0])] = (uint2)(bin_number(projection, bin.x, bin.y), slot);
            }
            barrier(CLK_LOCAL_MEM_FENCE);
            uint count = reserved[0];
            uint at = reserve_for_group(count, reserved, &counters->pairs);
            if (item == 0u) reserved[0] = 0u;
            for (uint i = item; i < count; i += items) {
                Pair pair = listed_pair(group_pairs[i].x, group_pairs[i].y, counts);
                if (at + i < pair_capacity) pairs[at + i] = pair;
                ++found;
            }
            barrier(CLK_LOCAL_MEM_FENCE);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
#endif
    add_in_group(found, &sum, &counters->references);
}

// Bins that one work-item takes at a time.
#ifdef GN_CPU
#define RANGES_RUN 128u
#else
#define RANGES_RUN 1u
#endif

__kernel void bins_ranges(uint bin_count, uint entry_capacity, __global const uint* counts, __global uint2* ranges,
                          __global BinEntries* entries, __global FrameCounters* counters, __local uint* ends,
                          __local uint* group_first) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    for (uint base = (uint)get_group_id(0) * items * RANGES_RUN; base < bin_count;
         base += (uint)get_num_groups(0) * items * RANGES_RUN) {
        uint first_bin = base + item * RANGES_RUN, last_bin = min(first_bin + RANGES_RUN, bin_count), mine = 0;
        for (uint bin = first_bin; bin < last_bin; ++bin) mine += (counts[bin] + GN_LANES - 1u) / GN_LANES;
        scan_group(mine, ends);
        if (item == items - 1u) *group_first = ends[item] == 0u ? 0u : atomic_add(&counters->entries, ends[item]);
        barrier(CLK_LOCAL_MEM_FENCE);
        uint next = *group_first + ends[item] - mine;
        for (uint bin = first_bin; bin < last_bin; ++bin) {
            uint end = next + (counts[bin] + GN_LANES - 1u) / GN_LANES;
            ranges[bin] = (uint2)(next, end);
#if GN_LANES > 1
            // What is left over is in front (place_in_order).
            if (counts[bin] % GN_LANES != 0u && end <= entry_capacity) {
                entries[end - 1u].x0 = (LaneUshort)(65535);
                entries[end - 1u].x1 = (LaneUshort)(0);
            }
#endif
            next = end;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// What did not fit, here or in an earlier stage, is in no list: the host will grow them and run again.
static bool all_fits(uint slot_capacity, uint map_tile_capacity, uint tile_capacity, uint pair_capacity,
                     uint entry_capacity, __global const FrameCounters* counters) {
    return max(counters->slots, counters->map_slots) <= slot_capacity && counters->map_tiles <= map_tile_capacity &&
           counters->tiles <= tile_capacity && counters->pairs <= pair_capacity && counters->entries <= entry_capacity;
}

#if GN_LANES == 1
// Where in its run an entry was put, and how many are in the run: what bins_order has to know, for as long as the
// entries are not in order.
static uint packed_run(uint place, uint count) {
    uint in_run = place % LIST_RUN;
    return in_run | min(count - (place - in_run), LIST_RUN) << 8;
}
#endif

__kernel void bins_scatter(uint slot_capacity, uint map_tile_capacity, uint tile_capacity, uint pair_capacity,
                           uint entry_capacity, __global const Pair* pairs, __global const uint2* ranges,
                           __global const TriangleBounds* bounds, __global BinEntries* entries,
                           __global FrameCounters* counters) {
    if (!all_fits(slot_capacity, map_tile_capacity, tile_capacity, pair_capacity, entry_capacity, counters)) {
        if (get_global_id(0) == 0) counters->references = GN_NO_LISTS;
        return;
    }
    GN_FOR_EACH(i, counters->pairs) {
        Pair pair = pairs[i];
        if (pair.bin == GN_NO_ID) continue;
        uint2 range = ranges[pair.bin];
        __global BinEntries* at = &entries[range.x + pair.place / GN_LANES];
#if GN_LANES == 1
        uint4 of = ((__global const uint4*)bounds)[pair.slot];
        uint run = packed_run(pair.place, range.y - range.x);
        *(__global uint4*)at = (uint4)(of.xy, (of.z & 0xFFFFu) | run << 16, pair.slot);  // in one go
#else
        TriangleBounds of = bounds[pair.slot];
        uint lane = pair.place % GN_LANES;
        ENTRY_LANE(at, x0, lane) = of.x0;
        ENTRY_LANE(at, y0, lane) = of.y0;
        ENTRY_LANE(at, x1, lane) = of.x1;
        ENTRY_LANE(at, y1, lane) = of.y1;
        ENTRY_LANE(at, z, lane) = of.z;
        ((__global uint*)&at->slot)[lane] = pair.slot;
#endif
    }
}

#if GN_LANES == 1
// Each run of each list, highest first; of equals in the order that they came in. Place by place, so that all items
// have about as much to do. `heights`: of a work-group's places and of what else is in their runs, for a place for each
// item and a run on either side.
__kernel void bins_order(__global const uint4* listed, __global uint4* entries, __global const FrameCounters* counters,
                         __local uint* heights) {
    __local uint span[2];
    uint count = counters->references == GN_NO_LISTS ? 0u : counters->entries;
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    for (size_t base = get_group_id(0) * items; base < count; base += get_num_groups(0) * items) {
        uint place = (uint)base + item, last = (uint)min(base + items, (size_t)count) - 1u, first = 0, end = 0;
        // Place i has its height at i - low. Where low wraps around below 0, i - low does so back.
        uint low = (uint)base - LIST_RUN;
        uint4 mine;
        if (place <= last) {
            mine = listed[place];
            uint run = mine.z >> 16;
            first = place - (run & 0xFFu), end = first + (run >> 8);
            mine.z &= 0xFFFFu;
            heights[place - low] = mine.z;
        }
        if (item == 0u) span[0] = first;
        if (place == last) span[1] = end;
        barrier(CLK_LOCAL_MEM_FENCE);
        for (uint i = span[0] + item; i < (uint)base; i += items) heights[i - low] = listed[i].z & 0xFFFFu;
        for (uint i = last + 1u + item; i < span[1]; i += items) heights[i - low] = listed[i].z & 0xFFFFu;
        barrier(CLK_LOCAL_MEM_FENCE);
        uint at = first;
        for (uint i = first; i < end; ++i) {
            uint height = heights[i - low];
            at += height > mine.z || (height == mine.z && i < place) ? 1u : 0u;
        }
        if (place <= last) entries[at] = mine;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}
#endif
