// SPDX-License-Identifier: MIT
// Bins: for each bin of a projection, the list of the triangles that may block a point in it. Serves the light's frames
// and, with a bin for each 16 x 16 pixels, the camera.
//
// A triangle enters a bin's list if it survives the cull there (bin_overlap.clh). Each pair of triangle and bin is
// found once: bins_pairs stores it with its index in the bin's list (on a CPU triangle_tiles does so, while it has the
// records). bins_ranges gives each bin its range of the entries (in any order, but contiguous).
// bins_scatter writes the entry there. On a GPU bins_order then puts the highest triangles of each run of a list first.
#include "occluders/tile_bins.clh"

#if GN_LANES == 1
__kernel void bins_pairs(BinsParams params, __constant const Projection* projection,
                         __global const TriangleRecord* records, __global const uint2* tiles,
                         __global const uint* pyramid, __global uint* counts, __global Pair* pairs,
                         __global FrameCounters* counters, __local uint* ends, __local uint2* group_tiles,
                         __local uint2* group_pairs) {
    __local uint sum;
    uint tile_count = min(counters->tiles, params.tile_capacity);
    uint found = 0;
    __local uint reserved[GROUP_APPEND_WORDS];
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    if (item == 0u) reserved[0] = 0u;
    TileGroup group = {group_tiles, ends};
    GN_ROUNDS(round, tile_count) {
        uint total = take_tile(group, tiles, tile_count, round, projection, params.has_pyramid, pyramid, records), end;
        for (uint first = 0; first < total; first = end) {
            end = min(total, first + items * PAIRS_AT_ONCE);
            for (uint i = first + item; i < end; i += items) {
                uint slot;
                bool alone;
                uint4 bin = bin_to_walk(group, i, &slot, &alone);
                // Without a depth to fail, a triangle meets the only bin of its rectangle, and needs no record.
                bool survives = alone && !params.has_pyramid;
                if (!survives) {
                    TriangleRecord record = records[slot];
                    survives = survives_cull(&record, projection, bin, params.has_pyramid, pyramid);
                }
                if (survives)
                    group_pairs[atomic_inc(&reserved[0])] = (uint2)(bin_index(projection, bin.x, bin.y), slot);
            }
            barrier(CLK_LOCAL_MEM_FENCE);
            uint count = reserved[0];
            uint at = reserve_for_group(count, reserved, &counters->pairs);
            if (item == 0u) reserved[0] = 0u;
            for (uint i = item; i < count; i += items) {
                uint bin = group_pairs[i].x;
                Pair pair = {bin, group_pairs[i].y, atomic_inc(&counts[bin])};
                if (at + i < params.pair_capacity) pairs[at + i] = pair;
                ++found;
            }
            barrier(CLK_LOCAL_MEM_FENCE);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    add_in_group(found, &sum, &counters->references);
}
#endif

// Bins that one work-item takes at a time.
#ifndef GN_CPU
#define RANGES_RUN 1u
#else
#define RANGES_RUN 128u

// Makes each count of some bins the number of the bin's pairs in the rows before; returns the bins' entries together,
// and leaves the sums of their counts in `ranges`.
GN_NOINLINE_ON_CPU uint sum_rows(BinsParams params, uint first_bin, uint last_bin, __global uint* counts,
                                 __global uint2* ranges) {
    uint sums[RANGES_RUN], all = 0;
    for (uint i = 0; i < RANGES_RUN; ++i) sums[i] = 0u;
    for (uint row = 0; row < params.count_rows; ++row) {
        __global uint* of_row = counts + (size_t)row * params.bin_count;
        for (uint bin = first_bin; bin < last_bin; ++bin) {
            uint count = of_row[bin];
            of_row[bin] = sums[bin - first_bin];
            sums[bin - first_bin] += count;
        }
    }
    for (uint bin = first_bin; bin < last_bin; ++bin) {
        ranges[bin].x = sums[bin - first_bin];
        all += (sums[bin - first_bin] + GN_LANES - 1u) / GN_LANES;
    }
    return all;
}

// Adds each bin's first place to its rows' counts: a pair's place is its row's count plus its index.
GN_NOINLINE_ON_CPU void add_first_places(BinsParams params, uint first_bin, uint last_bin, __global uint* counts,
                                         __global const uint2* ranges) {
    for (uint row = 0; row < params.count_rows; ++row) {
        __global uint* of_row = counts + (size_t)row * params.bin_count;
        for (uint bin = first_bin; bin < last_bin; ++bin) of_row[bin] += ranges[bin].x * GN_LANES;
    }
}
#endif

__kernel void bins_ranges(BinsParams params, __global uint* counts, __global uint2* ranges,
                          __global BinEntries* entries, __global FrameCounters* counters, __local uint* ends,
                          __local uint* group_first) {
    uint bin_count = params.bin_count;
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    for (uint base = (uint)get_group_id(0) * items * RANGES_RUN; base < bin_count;
         base += (uint)get_num_groups(0) * items * RANGES_RUN) {
        uint first_bin = base + item * RANGES_RUN, last_bin = min(first_bin + RANGES_RUN, bin_count), mine = 0;
#ifdef GN_CPU
        mine = sum_rows(params, first_bin, last_bin, counts, ranges);
#define COUNT_OF_BIN ranges[bin].x
#else
        for (uint bin = first_bin; bin < last_bin; ++bin) mine += counts[bin];
#define COUNT_OF_BIN counts[bin]
#endif
        scan_group(mine, ends);
        if (item == items - 1u) *group_first = ends[item] == 0u ? 0u : atomic_add(&counters->entries, ends[item]);
        barrier(CLK_LOCAL_MEM_FENCE);
        uint next = *group_first + ends[item] - mine;
        for (uint bin = first_bin; bin < last_bin; ++bin) {
            uint count = COUNT_OF_BIN, end = next + (count + GN_LANES - 1u) / GN_LANES;
            ranges[bin] = (uint2)(next, end);
#if GN_LANES > 1
            // The last BinEntries is not full: all its lanes start unused, and bins_scatter fills the front ones.
            if (count % GN_LANES != 0u && end <= params.entry_capacity) {
                entries[end - 1u].x0 = (LaneUshort)(65535);
                entries[end - 1u].x1 = (LaneUshort)(0);
            }
#endif
            next = end;
        }
#ifdef GN_CPU
        add_first_places(params, first_bin, last_bin, counts, ranges);
#endif
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// False if a list was too short, here or in an earlier stage: the host grows the lists and runs the frame again.
static bool all_fits(BinsParams capacities, __global const FrameCounters* counters) {
    return max(counters->slots, counters->map_slots) <= capacities.bounds_capacity &&
           counters->map_tiles <= capacities.map_tile_capacity && counters->tiles <= capacities.tile_capacity &&
           counters->pairs <= capacities.pair_capacity && counters->entries <= capacities.entry_capacity;
}

#if GN_LANES == 1
// The index of an entry in its run, and the length of the run: kept for bins_order until the entries are in order.
static uint packed_run(uint index, uint count) {
    uint in_run = index % LIST_RUN;
    return in_run | min(count - (index - in_run), LIST_RUN) << 8;
}
#endif

__kernel void bins_scatter(BinsParams params, __global const Pair* pairs, __global const uint* counts,
                           __global const uint2* ranges, __global const TriangleBounds* bounds,
                           __global BinEntries* entries, __global FrameCounters* counters GN_SHARES) {
    bool fits = all_fits(params, counters);
    if (!fits && get_global_id(0) == 0) counters->references = GN_NO_LISTS;
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(fits ? counters->pairs : 0u)) {
        Pair pair = pairs[i];
        if (pair.bin == GN_NO_ID) continue;
#if GN_LANES == 1
        uint2 range = ranges[pair.bin];
        __global BinEntries* at = &entries[range.x + pair.index];
        uint4 of = ((__global const uint4*)bounds)[pair.slot];
        uint run = packed_run(pair.index, range.y - range.x);
        *(__global uint4*)at = (uint4)(of.xy, (of.z & 0xFFFFu) | run << 16, pair.slot);  // one store
#else
        TriangleBounds of = bounds[pair.slot];
        uint place = counts[pair.bin] + pair.index, lane = place % GN_LANES;
        __global BinEntries* at = &entries[place / GN_LANES];
        ENTRY_LANE(at, x0, lane) = of.x0;
        ENTRY_LANE(at, y0, lane) = of.y0;
        ENTRY_LANE(at, x1, lane) = of.x1;
        ENTRY_LANE(at, y1, lane) = of.y1;
        ENTRY_LANE(at, z, lane) = of.z;
        ((__global uint*)&at->slot)[lane] = pair.slot;
#endif
    }
    GN_END_SHARES;
}

#if GN_LANES == 1
// Sorts each run of each list, highest first; equal heights keep their order. An item takes one entry at a time, so
// that all items have about equal work. `heights`: one for each item of the work-group, and a run on either side.
__kernel void bins_order(__global const uint4* listed, __global uint4* entries, __global const FrameCounters* counters,
                         __local uint* heights) {
    __local uint span[2];
    uint count = counters->references == GN_NO_LISTS ? 0u : counters->entries;
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    for (size_t base = get_group_id(0) * items; base < count; base += get_num_groups(0) * items) {
        uint own = (uint)base + item, last = (uint)min(base + items, (size_t)count) - 1u, first = 0, end = 0;
        // The height of entry i is at i - low. Where low wraps around below 0, i - low wraps back.
        uint low = (uint)base - LIST_RUN;
        uint4 mine;
        if (own <= last) {
            mine = listed[own];
            uint run = mine.z >> 16;
            first = own - (run & 0xFFu), end = first + (run >> 8);
            mine.z &= 0xFFFFu;
            heights[own - low] = mine.z;
        }
        if (item == 0u) span[0] = first;
        if (own == last) span[1] = end;
        barrier(CLK_LOCAL_MEM_FENCE);
        for (uint i = span[0] + item; i < (uint)base; i += items) heights[i - low] = listed[i].z & 0xFFFFu;
        for (uint i = last + 1u + item; i < span[1]; i += items) heights[i - low] = listed[i].z & 0xFFFFu;
        barrier(CLK_LOCAL_MEM_FENCE);
        uint at = first;
        for (uint i = first; i < end; ++i) {
            uint height = heights[i - low];
            at += height > mine.z || (height == mine.z && i < own) ? 1u : 0u;
        }
        if (own <= last) entries[at] = mine;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}
#endif
