// SPDX-License-Identifier: MIT
// How a CPU traces: points are not sorted, a work-item takes a block of GN_LANES neighbours, which mostly share a bin;
// where they do not, each of the bins is walked for its lanes.
#ifndef GN_TRACE_BLOCKS_H
#define GN_TRACE_BLOCKS_H

#include "trace_points.h"

#if GN_LANES > 1

// Each kernel's own loop over the blocks of a work-item. Adds to `total`. All else by value: in memory of its own,
// which no store to the points can change.
GN_APART void trace_blocks(Share share, LightFrame light_frame, TraceFrames frames, TraceLists lists, ExactPairs pairs,
                           TracePoints to, TraceCounts* total);

// The receiver that these points share, which blocks none of them; GN_NO_ID if they have several.
static uint one_receiver(const ExactPairs* pairs, const BlockPoints* points, LaneInt lanes) {
    if (!pairs->has_receivers) return GN_NO_ID;
    int first = LANE_OF_INT(points->receivers, first_lane(lanes));
    bool others = LANES_ANY(lanes & LANE_COMPARE(points->receivers, !=, (LaneInt)(first)));
    return others ? GN_NO_ID : (uint)first;
}

// A bin's list for some lanes of a block; returns the number of records looked at.
static uint walk(const ExactPairs* pairs, TraceLists lists, __constant const Projection* projection, uint2 range,
                 LaneInt lit, const BlockPoints* points, PointBlock places, BlockAnswer* answer) {
    QuantisedBlock block = quantised_block(projection, places, lit);
    uint looks = 0;
    uint next = entries_to_look_at(lists.entries, lists.records, lists.bounds, range.x, range.y, block);
    uint own = one_receiver(pairs, points, lit);
    for (uint i = range.x; i < range.y; ++i) {
        uint meeting = next;
        next = entries_to_look_at(lists.entries, lists.records, lists.bounds, i + 1u, range.y, block);
        while (meeting != 0u) {
            uint slot = ENTRY_SLOT(&lists.entries[i], take_lowest_bit(&meeting));
            uint id = lists.bounds[slot].id;
            if (id == own) continue;
            ++looks;
            FilterAnswer found = filter(&lists.records[slot], places, lit);
            if (!LANES_ANY(found.possible)) continue;
            lit &= ~settle(pairs, found, points, id, answer);
            if (!LANES_ANY(lit)) return looks;
        }
    }
    return looks;
}

// What the map says of these lanes of a frame; returns those that have lists to be walked.
static LaneInt ask_map(const TraceFrames* frames, int frame, PointBlock places, LaneFloat state, LaneInt lanes,
                       BlockAnswer* answer) {
    __constant const Projection* projection = &frames->projections[frame];
    __global const uint* map = frames->map + (size_t)frame * frames->texel_count;
    LaneInt below = lanes_below_map(projection, places, state, lanes, map);
    answer->shadowed |= below;
    answer->by_map |= below;
    lanes &= ~below;
    LaneInt doubtful = lanes & doubtful_lanes(state);
    if (LANES_ANY(doubtful))
        answer->below |= lanes_below_map(projection, places, (LaneFloat)(VISIBILITY_OPEN), doubtful, map);
    return lanes;
}

// The points `left` of a block against map and lists; returns the number of records looked at.
// `asks_map`: false if there is none, or it hides none of these points.
static uint trace_block(const ExactPairs* pairs, const TraceFrames* frames, TraceLists lists, bool asks_map,
                        LaneInt lane_frames, LaneInt left, LaneFloat state, const BlockPoints* points,
                        BlockAnswer* answer) {
    uint tests = 0;
    while (LANES_ANY(left)) {
        int frame = LANE_OF_INT(lane_frames, first_lane(left));
        LaneInt same_frame = left & LANE_COMPARE(lane_frames, ==, (LaneInt)(frame));
        left &= ~same_frame;
        __constant const Projection* projection = &frames->projections[frame];
        PointBlock places = project_points(projection, points->at);
        if (asks_map) same_frame = ask_map(frames, frame, places, state, same_frame, answer);
        answer->listed |= same_frame;
        LaneInt bins = bins_of(projection, places);
        while (LANES_ANY(same_frame)) {
            int bin = LANE_OF_INT(bins, first_lane(same_frame));
            LaneInt same_bin = same_frame & LANE_COMPARE(bins, ==, (LaneInt)(bin));
            same_frame &= ~same_bin;
            tests += walk(pairs, lists, projection, lists.ranges[(uint)frame * frames->bin_count + (uint)bin], same_bin,
                          points, places, answer);
        }
    }
    return tests;
}

// Not by work-groups: there are few work-items, and PoCL 3.1 keeps vectors misaligned across a barrier of work-groups
// of 3, 7 and so on.
static void add_counts_of_item(const TraceCounts* counts, __global FrameCounters* counters) {
    uint found[TRACE_COUNTS];
    read_counts(counts, found);
    if (counts->facing_exact != 0u) atomic_add(&counters->facing_exact, counts->facing_exact);
    add_counts(found, counters);
}

#endif
#endif
