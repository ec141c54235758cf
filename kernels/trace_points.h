// SPDX-License-Identifier: MIT
// Frustum trace: every open point against the map, then against the triangles of its bin's list, by the float filter of
// the records. This is what all its kernels share: what becomes of a point, and what is counted. How a CPU walks lists
// is in trace_blocks.h, how a GPU does in trace_rounds.h, and which points are looked at in each kernel's own file.
//
// The filter only says what is certain. A pair it cannot decide (the point near an edge's ray or near the plane, by the
// proven margins) goes to the queue of the exact stage, unless the triangle is the point's own receiver. Where the
// queue is full the point stays open, and a second look decides such pairs in place (TRACE_IN_PLACE): so the memory of
// open pairs is bounded. One writer per point: no atomics on visibility here.
//
// Of a prepared light's lists, triangles below the map are missing that only a doubtful point below the map could need.
// Such a point is a stray, unless a listed triangle blocks it.
#ifndef GN_TRACE_POINTS_H
#define GN_TRACE_POINTS_H

#include "bin_lists.h"
#include "coarse_test.h"
#include "trace.h"

typedef struct TraceLists {
    __global const uint2* ranges;
    __global const BinEntries* entries;
    __global const TriangleRecord* records;
    __global const TriangleBounds* bounds;  // of the records, for their ids
} TraceLists;

// The frames that points are looked at in, and the maps.
typedef struct TraceFrames {
    __constant const Projection* projections;
    __global const uint* map;
    uint first, count;
    uint has_map;
    uint bin_count, texel_count;
} TraceFrames;

// Which lanes lie in one of them, by the number of each lane's frame from `first` on.
static LaneInt lanes_in_frames(const TraceFrames* frames, LaneInt lane_frames) {
    return LANE_COMPARE(lane_frames, >=, (LaneInt)(0)) & LANE_COMPARE(lane_frames, <, (LaneInt)((int)frames->count));
}

// What a work-item reads and writes of the points. TRACE_MORE_OF_POINTS: members that its kernel's file adds.
typedef struct TracePoints {
    PointsLayout layout;
    __global const float* positions;
    __global const uint* receivers;
    __global float* visibility;
    TRACE_MORE_OF_POINTS
} TracePoints;

// The square and the least height that some lanes of a block span.
static QuantisedBlock quantised_block(__constant const Projection* projection, PointBlock places, LaneInt lanes) {
    const float most = 65535.0f;
    LaneInt x = LANES_TO_INT(clamp(places.x * texel_units(projection->width), 0.0f, most));
    LaneInt y = LANES_TO_INT(clamp(places.y * texel_units(projection->height), 0.0f, most));
    LaneInt z = LANES_TO_INT(clamp((places.z - projection->z_origin) * projection->z_scale, 0.0f, most));
    return block_of_lanes(x, y, x, y, z, lanes);
}

// What becomes of a block: points in shadow, and points that must be looked at again.
typedef struct BlockAnswer {
    LaneInt shadowed, postponed;
    LaneInt by_map, by_exact;  // of the shadowed ones
    LaneInt listed;            // the map did not decide them
    LaneInt below;             // of these, those below the map
    LaneInt waiting;           // a triangle that the filter left open, GN_NO_ID: none
} BlockAnswer;

static BlockAnswer no_answer(void) {
    BlockAnswer answer;
    answer.shadowed = answer.postponed = answer.by_map = answer.by_exact = answer.listed = answer.below = (LaneInt)(0);
    answer.waiting = (LaneInt)((int)GN_NO_ID);
    return answer;
}

// The points of the block that is looked at.
typedef struct BlockPoints {
    PointBlock at;
    PointsLayout layout;
    size_t block;
#if GN_LANES > 1
    LaneInt receivers;
#endif
} BlockPoints;

static BlockPoints load_points(__global const float* positions, __global const uint* receivers, PointsLayout layout,
                               size_t block) {
    BlockPoints points;
    points.at = load_block(positions, layout, block);
    points.layout = layout;
    points.block = block;
#if GN_LANES > 1
    if (layout.has_receivers) points.receivers = load_lane_ids(receivers, layout, block);
#endif
    return points;
}

// On a GPU only where they are asked for: most points never ask.
static LaneInt receivers_of(const ExactPairs* pairs, const BlockPoints* points) {
#if GN_LANES > 1
    return points->receivers;
#else
    return load_lane_ids(pairs->receivers, points->layout, points->block);
#endif
}

// What the filter left open, of points that the triangle may block. Returns those that need no more triangles.
static LaneInt settle_open(const ExactPairs* pairs, LaneInt open, const BlockPoints* points, uint id,
                           BlockAnswer* answer) {
    LaneInt settled = (LaneInt)(0);
    for (uint bits = lane_bits(open); bits != 0u;) {
        int lane = take_lane(&bits);
        if (TRACE_IN_PLACE) {
            if (!blocks_exactly(pairs, lane_point(points->at, lane), id)) continue;
            LANE_OF_INT(answer->shadowed, lane) = LANE_OF_INT(answer->by_exact, lane) = LANE_OF_INT(settled, lane) = -1;
        } else if (LANE_OF_INT(answer->waiting, lane) == (int)GN_NO_ID) {
            LANE_OF_INT(answer->waiting, lane) = (int)id;
        } else if (!hand_over(pairs, (uint)point_of_lane(points->layout, points->block, lane), id)) {
            LANE_OF_INT(answer->postponed, lane) = LANE_OF_INT(settled, lane) = -1;
        }
    }
    return settled;
}

// Looks at the lanes that the filter did not dismiss; returns those that need no more triangles.
static LaneInt settle(const ExactPairs* pairs, FilterAnswer found, const BlockPoints* points, uint id,
                      BlockAnswer* answer) {
    LaneInt others = (LaneInt)(-1);
    if (pairs->has_receivers) others = LANE_COMPARE(receivers_of(pairs, points), !=, (LaneInt)((int)id));
    LaneInt settled = found.certain & others, open = found.possible & others & ~settled;
    answer->shadowed |= settled;
    if (LANES_ANY(open)) settled |= settle_open(pairs, open, points, id, answer);
    return settled;
}

// Most points with an open pair have but one. It waits until the block's lists are walked: then most such points turn
// out to be in shadow anyway, and the walk's loop does not have to fork.
static void hand_over_waiting(const ExactPairs* pairs, const BlockPoints* points, BlockAnswer* answer) {
    LaneInt lanes =
        ~answer->shadowed & ~answer->postponed & LANE_COMPARE(answer->waiting, !=, (LaneInt)((int)GN_NO_ID));
    for (uint bits = lane_bits(lanes); bits != 0u;) {
        int lane = take_lane(&bits);
        if (!hand_over(pairs, (uint)point_of_lane(points->layout, points->block, lane),
                       (uint)LANE_OF_INT(answer->waiting, lane)))
            LANE_OF_INT(answer->postponed, lane) = -1;
    }
}

// What a work-item counts.
typedef struct TraceCounts {
    LaneInt minus_by_map, minus_by_trace, minus_by_exact, minus_listed, minus_strays;
    LaneInt minus_absent, minus_away;  // where facing is decided on the way
    uint facing_exact;
    ulong tests;
} TraceCounts;

static TraceCounts no_counts(void) {
    TraceCounts counts;
    counts.minus_by_map = counts.minus_by_trace = counts.minus_by_exact = (LaneInt)(0);
    counts.minus_listed = counts.minus_strays = (LaneInt)(0);
    counts.minus_absent = counts.minus_away = (LaneInt)(0);
    counts.facing_exact = 0;
    counts.tests = 0;
    return counts;
}

// All is known of the points `left` of a block.
static void finish_block(const ExactPairs* pairs, const BlockPoints* points, LaneInt left, LaneFloat state,
                         BlockAnswer* answer, __global float* visibility, TraceCounts* counts) {
    counts->minus_by_map += answer->by_map;
    counts->minus_listed += answer->listed;
    counts->minus_by_trace += answer->shadowed & ~answer->by_map & ~answer->by_exact;
    hand_over_waiting(pairs, points, answer);
    counts->minus_by_exact += answer->by_exact;
    counts->minus_strays += answer->below & ~answer->shadowed;
    LaneFloat result = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), answer->shadowed);
    result = LANES_SELECT(result, state, answer->postponed & ~answer->shadowed);
    store_lanes(LANES_SELECT(state, result, left), visibility, points->layout, points->block);
}

// The same as words, for sums. The tests in two words: their low 16 bits and the rest, so that neither sum overflows.
enum {
    COUNT_MAP,
    COUNT_TRACE,
    COUNT_EXACT,
    COUNT_LISTED,
    COUNT_STRAYS,
    COUNT_TESTS_LOW,
    COUNT_TESTS_HIGH,
    COUNT_ABSENT,
    COUNT_AWAY,
    TRACE_COUNTS
};

static void add_counts(const uint* found, __global FrameCounters* counters) {
    __global uint* totals[] = {&counters->decided_by_map, &counters->decided_by_trace, &counters->decided_by_exact,
                               &counters->listed,         &counters->strays,           &counters->absent,
                               &counters->facing_away};
    const uint counts[] = {COUNT_MAP, COUNT_TRACE, COUNT_EXACT, COUNT_LISTED, COUNT_STRAYS, COUNT_ABSENT, COUNT_AWAY};
    for (uint i = 0; i < sizeof(counts) / sizeof(counts[0]); ++i)
        if (found[counts[i]] != 0u) atomic_add(totals[i], found[counts[i]]);
    count_tests((found[COUNT_TESTS_LOW] + ((ulong)found[COUNT_TESTS_HIGH] << 16)) * GN_LANES, counters);
}

// Sets found[], of TRACE_COUNTS.
static void read_counts(const TraceCounts* counts, uint* found) {
    found[COUNT_MAP] = count_lanes(counts->minus_by_map);
    found[COUNT_TRACE] = count_lanes(counts->minus_by_trace);
    found[COUNT_EXACT] = count_lanes(counts->minus_by_exact);
    found[COUNT_LISTED] = TRACE_IN_PLACE ? 0u : count_lanes(counts->minus_listed);
    found[COUNT_STRAYS] = count_lanes(counts->minus_strays);
    found[COUNT_TESTS_LOW] = (uint)counts->tests & 0xFFFFu;
    found[COUNT_TESTS_HIGH] = (uint)(counts->tests >> 16);
    found[COUNT_ABSENT] = count_lanes(counts->minus_absent);
    found[COUNT_AWAY] = count_lanes(counts->minus_away);
}

#endif
