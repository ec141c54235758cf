// SPDX-License-Identifier: MIT
// How a GPU looks at points that facing has left open: for trace.cl and trace_again.cl.
#ifndef GN_TRACE_OPEN_POINTS_H
#define GN_TRACE_OPEN_POINTS_H

#include "trace_rounds.h"

#if GN_LANES == 1

// Lists made for one run have no slots by triangle: no entry is passed over.
static uint own_slot(const TracePoints* to, size_t point) { return GN_NO_ID; }

// The next point's state is asked for while one is looked at: most are not open.
static void look_at_points(Share share, LightFrame light_frame, TraceFrames frames, TraceLists lists, ExactPairs pairs,
                           TracePoints to, TraceCounts* total, const WalkQueue* queue) {
    PointsLayout layout = to.layout;
    TraceCounts counts = *total;
    LaneFloat state_ahead = share.first < share.end ? to.visibility[share.first] : 0.0f;
    GN_FOR_EACH_OF(point, share) {
        LaneFloat state = state_ahead;
        size_t ahead = point + share.step;
        state_ahead = ahead < share.end ? to.visibility[ahead] : 0.0f;
        LaneInt left = open_lanes(state);
        if (!LANES_ANY(left)) continue;
        BlockPoints points = load_points(to.positions, to.receivers, layout, point);
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
        PointLookUp place = look_up(&frames, lists, lane_frames, points.at);
        left &= lanes_in_frames(&frames, lane_frames);
        BlockAnswer answer = no_answer();
        if (ask_map(&place, left, state, &answer)) {
            queue_point(queue, point, state, &answer);
            continue;
        }
        finish_block(&pairs, &points, left, state, &answer, to.visibility, &counts);
    }
    *total = counts;
}

#endif
#endif
