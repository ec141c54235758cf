// SPDX-License-Identifier: MIT
// The trace under a prepared light, for prepared_trace.cl and prepared_trace_by_planes.cl: all points are looked at,
// and facing is decided on the way (prepared_facing.h), since reading points and writing visibility once is most of
// what such a run costs.
#ifndef GN_PREPARED_TRACE_H
#define GN_PREPARED_TRACE_H

#define TRACE_IN_PLACE 0
#define TRACE_MORE_PARAMETERS                                                                     \
    , uint triangle_count, __global const PreparedDomain *domains, __global const float4 *planes, \
        __global const uint *largest_coordinate, __global const uint *lit, __global const uint *slots
#define TRACE_MORE_OF_POINTS PreparedReceivers prepared;
#define TRACE_MORE_VALUES                                                                                      \
    , prepared_receivers(light_frame, layout, triangle_count, domains, planes, largest_coordinate, lit, slots, \
                         vertices + first_float)
#include "prepared_facing.h"
#include "trace_blocks.h"
#include "trace_rounds.h"

static LaneFloat state_of_points(const PreparedFacing* facing) {
    LaneFloat state = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), facing->away);
    state = LANES_SELECT(state, (LaneFloat)(VISIBILITY_OPEN), facing->open);
    return LANES_SELECT(state, (LaneFloat)(VISIBILITY_DOUBTFUL), facing->open & facing->doubtful);
}

static void count_facing(const PreparedFacing* facing, TraceCounts* counts) {
    counts->minus_absent += facing->absent;
    counts->minus_away += facing->away;
    counts->minus_strays += facing->strays;
}

#if GN_LANES > 1

GN_APART void trace_blocks(Share share, LightFrame light_frame, TraceFrames frames, TraceLists lists, ExactPairs pairs,
                           TracePoints to, TraceCounts* total) {
    PointsLayout layout = to.layout;
    TraceCounts counts = *total;
    GN_FOR_EACH_OF(block, share) {
        BlockPoints points = load_points(to.positions, to.receivers, layout, block);
        PreparedFacing facing =
            face_points(&to.prepared, light_frame, layout, block, &points.at, points.receivers, &counts.facing_exact);
        count_facing(&facing, &counts);
        LaneFloat state = state_of_points(&facing);
        if (!LANES_ANY(facing.open)) {
            store_lanes(state, to.visibility, layout, block);
            continue;
        }
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
        LaneInt left = facing.open & lanes_in_frames(&frames, lane_frames);
        BlockAnswer answer = no_answer();
        counts.tests +=
            trace_block(&pairs, &frames, lists, frames.has_map != 0u, lane_frames, left, state, &points, &answer);
        finish_block(&pairs, &points, left, state, &answer, to.visibility, &counts);
    }
    *total = counts;
}

#else

static uint own_slot(const TracePoints* to, size_t point) {
    if (!to->layout.has_receivers) return GN_NO_ID;
    return slot_of_receiver(&to->prepared, load_lane_ids(to->receivers, to->layout, point));
}

// Is a point's own receiver all that its list names? Then it need not be queued.
static bool names_own_alone(const TracePoints* to, TraceLists lists, uint2 range, size_t point) {
    return range.y - range.x == 1u && ENTRY_SLOT(&lists.entries[range.x], 0) == own_slot(to, point);
}

// What is asked for of the next point while one is looked at.
typedef struct AskedPoint {
    PointBlock at;
    LaneInt receiver;
} AskedPoint;

static AskedPoint ask_point(const TracePoints* of, size_t point) {
    AskedPoint asked = {load_block(of->positions, of->layout, point), (LaneInt)((int)GN_NO_ID)};
    if (of->layout.has_receivers) asked.receiver = load_lane_ids(of->receivers, of->layout, point);
    return asked;
}

static void look_at_points(Share share, LightFrame light_frame, TraceFrames frames, TraceLists lists, ExactPairs pairs,
                           TracePoints to, TraceCounts* total, const WalkQueue* queue) {
    PointsLayout layout = to.layout;
    TraceCounts counts = *total;
    AskedPoint asked_ahead = ask_point(&to, min(share.first, share.end - 1));
    GN_FOR_EACH_OF(point, share) {
        AskedPoint asked = asked_ahead;
        asked_ahead = ask_point(&to, min(point + share.step, share.end - 1));
        BlockPoints points = {asked.at, layout, point};
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
        PreparedFacing facing =
            face_points(&to.prepared, light_frame, layout, point, &points.at, asked.receiver, &counts.facing_exact);
        count_facing(&facing, &counts);
        LaneFloat state = state_of_points(&facing);
        if (!LANES_ANY(facing.open)) {
            store_lanes(state, to.visibility, layout, point);
            continue;
        }
        PointLookUp place = look_up(&frames, lists, lane_frames, points.at);
        LaneInt left = facing.open & lanes_in_frames(&frames, lane_frames);
        BlockAnswer answer = no_answer();
        if (ask_map(&place, left, state, &answer) && !names_own_alone(&to, lists, place.range, point)) {
            queue_point(queue, point, state, &answer);
            continue;
        }
        finish_block(&pairs, &points, left, state, &answer, to.visibility, &counts);
    }
    *total = counts;
}

#endif
#endif
