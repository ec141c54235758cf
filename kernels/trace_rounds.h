// SPDX-License-Identifier: MIT
// How a GPU traces. A work-group takes its points in rounds: first all of a round are looked at by the map, neighbours
// by neighbours, and those that it leaves open are queued; then the items walk the lists of the queued points, and who
// is done takes the next. So a warp's items all walk, though most of its points are settled at once, and none waits for
// the longest list of its neighbours (counted: a point looks at 1.2 entries, the longest list of a warp's points at 4).
#ifndef GN_TRACE_ROUNDS_H
#define GN_TRACE_ROUNDS_H

#include "trace_points.h"

#if GN_LANES == 1

// The points of a round whose lists are to be walked, from the round's first point on, and what is known of them.
typedef struct WalkQueue {
    __local uint* entries;
    __local uint *count, *taken;
    size_t first_point;
} WalkQueue;
#define QUEUED_DOUBTFUL 0x80000000u
#define QUEUED_BELOW 0x40000000u  // the map

// Each kernel's own look at an item's points of a round: what the map settles is settled, and points whose lists are to
// be walked are queued. Adds to `total`.
static void look_at_points(Share share, LightFrame light_frame, TraceFrames frames, TraceLists lists, ExactPairs pairs,
                           TracePoints to, TraceCounts* total, const WalkQueue* queue);

// As far as the kernel knows it: the slot of the record of a point's own receiver, which cannot block it; else
// GN_NO_ID. Most lit points meet no other entry, so that to pass it over saves them a look at a record.
static uint own_slot(const TracePoints* to, size_t point);

// What is known of a point's place in its frame. Asked for as early as can be, also where it is not needed in the end:
// so that a GPU waits once for all that it reads of the point.
typedef struct PointLookUp {
    PointBlock place;
    uint2 range;  // of its bin's list
    int cover;    // of its texel, in order; none is below INT_MIN
} PointLookUp;

static PointLookUp look_up(const TraceFrames* frames, TraceLists lists, int frame, PointBlock point) {
    PointLookUp found;
    uint nearest_frame = (uint)clamp(frame, 0, (int)frames->count - 1);
    __constant const Projection* projection = &frames->projections[nearest_frame];
    found.place = project_points(projection, point);
    found.range = lists.ranges[nearest_frame * frames->bin_count + (uint)bins_of(projection, found.place)];
    found.cover = INT_MIN;
    if (frames->has_map && map_is_seen(projection))
        found.cover = covers_of(projection, found.place, frames->map + (size_t)nearest_frame * frames->texel_count);
    return found;
}

// What the map says of a point that is `left`; true if it has a list to be walked.
static bool ask_map(const PointLookUp* found, LaneInt left, LaneFloat state, BlockAnswer* answer) {
    LaneInt below = left & LANE_COMPARE(lanes_in_order(found->place.z), <, found->cover);
    answer->shadowed = answer->by_map = below & ~doubtful_lanes(state);
    answer->below = below & doubtful_lanes(state);
    answer->listed = left & ~answer->by_map;
    return answer->listed && found->range.x != found->range.y;
}

// Every item of the group must come here.
static void start_round(const WalkQueue* queue) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) *queue->count = *queue->taken = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
}

static void queue_point(const WalkQueue* queue, size_t point, LaneFloat state, const BlockAnswer* answer) {
    uint flags = (doubtful_lanes(state) ? QUEUED_DOUBTFUL : 0u) | (answer->below ? QUEUED_BELOW : 0u);
    queue->entries[atomic_inc(queue->count)] = (uint)(point - queue->first_point) | flags;
}

// A queued point, and how far its list has been walked.
typedef struct Walk {
    BlockPoints points;
    LaneFloat state;
    PointBlock place;
    QuantisedBlock quantised;
    uint2 range;
    uint own;                   // slot
    uint next, first, meeting;  // entries from `next` on, and of those from `first` on these
    BlockAnswer answer;
} Walk;

static Walk start_walk(const TraceFrames* frames, TraceLists lists, uint frame, BlockPoints points, uint own,
                       uint flags) {
    Walk walk;
    walk.points = points;
    walk.state = flags & QUEUED_DOUBTFUL ? VISIBILITY_DOUBTFUL : VISIBILITY_OPEN;
    __constant const Projection* projection = &frames->projections[frame];
    walk.place = project_points(projection, points.at);
    walk.quantised = quantised_block(projection, walk.place, -1);
    walk.range = lists.ranges[frame * frames->bin_count + (uint)bins_of(projection, walk.place)];
    walk.own = own;
    walk.next = walk.first = walk.range.x;
    walk.meeting = 0u;
    walk.answer = no_answer();
    walk.answer.listed = -1;
    walk.answer.below = flags & QUEUED_BELOW ? -1 : 0;
    return walk;
}

// Some entries, and one record if any of them meets the point: all items of a warp look at one together. True if that
// was the last.
static bool walk_on(const ExactPairs* pairs, TraceLists lists, Walk* walk, ulong* tests) {
    if (walk->meeting == 0u && walk->next < walk->range.y) {
        walk->first = walk->next;
        walk->meeting = next_that_meet(lists.entries, walk->range, &walk->next, walk->quantised, walk->own);
    }
    if (walk->meeting != 0u) {
        uint slot = ENTRY_SLOT(&lists.entries[walk->first + take_lowest_bit(&walk->meeting)], 0);
        ++*tests;
        FilterAnswer found = filter(&lists.records[slot], walk->place, -1);
        if (found.possible && settle(pairs, found, &walk->points, lists.bounds[slot].id, &walk->answer)) return true;
    }
    return walk->meeting == 0u && walk->next >= walk->range.y;
}

// Each item takes queued points, one after the other, as long as there are any. Every item of the group must come here,
// after all have queued theirs.
static void walk_queue(const WalkQueue* queue, LightFrame light_frame, const TraceFrames* frames, TraceLists lists,
                       const ExactPairs* pairs, const TracePoints* to, TraceCounts* counts) {
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);  // of the visibility, too: another item has read the point's
    uint queued = *queue->count;
    bool walks = false;
    Walk walk;
    while (true) {
        if (!walks) {
            uint at = atomic_inc(queue->taken);
            if (at >= queued) break;
            uint entry = queue->entries[at];
            BlockPoints points = load_points(to->positions, to->receivers, to->layout,
                                             queue->first_point + (entry & ~(QUEUED_DOUBTFUL | QUEUED_BELOW)));
            uint frame = (uint)(frames_of(light_frame, points.at) - (int)frames->first);
            walk = start_walk(frames, lists, frame, points, own_slot(to, points.block), entry);
            walks = true;
        }
        if (!walk_on(pairs, lists, &walk, &counts->tests)) continue;
        finish_block(pairs, &walk.points, -1, walk.state, &walk.answer, to->visibility, counts);
        walks = false;
    }
}

// What a work-group takes of `count` points, a round after the other. Every item of the group must come here. Adds to
// `total`.
static void trace_rounds(WalkQueue queue, uint points_at_once, uint count, LightFrame light_frame, TraceFrames frames,
                         TraceLists lists, ExactPairs pairs, TracePoints to, TraceCounts* total) {
    for (size_t first = get_group_id(0) * (size_t)points_at_once; first < count;
         first += get_num_groups(0) * (size_t)points_at_once) {
        queue.first_point = first;
        start_round(&queue);
        Share share = {first + get_local_id(0), min(first + points_at_once, (size_t)count), get_local_size(0)};
        look_at_points(share, light_frame, frames, lists, pairs, to, total, &queue);
        walk_queue(&queue, light_frame, &frames, lists, &pairs, &to, total);
    }
}

// One atomic per work-group and counter: hundreds of thousands on one address would take longer than the trace.
static void clear_counts(__local uint* of_group) {
    for (uint i = (uint)get_local_id(0); i < TRACE_COUNTS; i += (uint)get_local_size(0)) of_group[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
}

// Every item of the group must come here.
static void add_counts_of_group(const TraceCounts* counts, __local uint* of_group, __global FrameCounters* counters) {
    uint found[TRACE_COUNTS];
    read_counts(counts, found);
    if (counts->facing_exact != 0u) atomic_add(&counters->facing_exact, counts->facing_exact);
    for (uint i = 0; i < TRACE_COUNTS; ++i)
        if (found[i] != 0u) atomic_add(&of_group[i], found[i]);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) != 0) return;
    for (uint i = 0; i < TRACE_COUNTS; ++i) found[i] = of_group[i];
    add_counts(found, counters);
}

#endif
#endif
