// SPDX-License-Identifier: MIT
// The second look, at points whose undecided pairs found no room in the queue: they are decided in place.
#define TRACE_KERNEL trace_queue_overflow
#define TRACE_IN_PLACE 1
#define TRACE_MORE_PARAMETERS
#define TRACE_MORE_OF_POINTS
#define TRACE_MORE_VALUES
#include "trace/trace_blocks.clh"
#include "trace/trace_open_points.clh"

#if GN_LANES > 1
GN_NOINLINE_ON_CPU void trace_blocks(ItemRange items, LightFrame light_frame, TraceFrames frames, TraceLists lists,
                                     ExactPairs pairs, TracePoints to, TraceCounts* total) {
    TraceCounts counts = *total;
    GN_FOR_EACH_OF(block, items) {
        LaneFloat state = load_lanes(to.visibility, to.layout, block);
        LaneInt left = open_lanes(state);
        if (!LANES_ANY(left)) continue;
        BlockPoints points = load_points(to.positions, to.receivers, to.layout, block);
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
        left &= lanes_in_frames(&frames, lane_frames);
        BlockAnswer answer = no_answer();
        counts.tests +=
            trace_block(&pairs, &frames, lists, frames.has_map != 0u, lane_frames, left, state, &points, &answer);
        finish_block(&pairs, &points, left, state, &answer, to.visibility, &counts);
    }
    *total = counts;
}
#endif

#include "trace/trace_kernel.clh"
