// SPDX-License-Identifier: MIT
// The first look at open points: undecided pairs are handed over to the exact stage.
//
// After facing on a CPU, blocks that the map hides are settled by their bounds, without their points.
#define TRACE_KERNEL trace
#define TRACE_IN_PLACE 0
#define TRACE_MORE_PARAMETERS , uint has_blocks, __global const BlockBounds *block_bounds
// Null: there are none.
#define TRACE_MORE_OF_POINTS __global const BlockBounds* blocks;
#define TRACE_MORE_VALUES , has_blocks ? block_bounds : 0
#include "trace/trace_blocks.clh"
#include "trace/trace_open_points.clh"

#if GN_LANES > 1
GN_NOINLINE_ON_CPU void trace_blocks(ItemRange items, LightFrame light_frame, TraceFrames frames, TraceLists lists,
                                     ExactPairs pairs, TracePoints to, TraceCounts* total) {
    PointsLayout layout = to.layout;
    BlockGrid grid = block_grid(light_frame, frames.projections, frames.first);
    bool sees_map = frames.has_map && map_is_enabled(frames.projections);
    TraceCounts counts = *total;
    GN_FOR_EACH_OF(block, items) {
        uint map_says = MAP_MAY_HIDE;
        bool all_open = false;  // all lanes are, and in this frame: nothing has decided one before
        if (to.blocks != 0) {
            BlockBounds bounds = to.blocks[block];
            if (bounds.frame != frames.first && bounds.frame != BLOCK_IN_FRAMES) continue;
            if (sees_map) map_says = map_hides(&grid, frames.projections, &bounds, frames.map);
            all_open = bounds.frame == frames.first && bounds.flags == BLOCK_ALL_OPEN;
        }
        LaneFloat state = all_open ? (LaneFloat)(VISIBILITY_OPEN) : load_lanes(to.visibility, layout, block);
        LaneInt left = open_lanes(state);
        if (!LANES_ANY(left)) continue;
        if (map_says == MAP_HIDES_ALL) {
            counts.minus_by_map += left;
            store_lanes(LANES_SELECT(state, (LaneFloat)(0.0f), left), to.visibility, layout, block);
            continue;
        }
        BlockPoints points = load_points(to.positions, to.receivers, layout, block);
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
        left &= lanes_in_frames(&frames, lane_frames);
        BlockAnswer answer = no_answer();
        counts.tests += trace_block(&pairs, &frames, lists, sees_map && map_says != MAP_HIDES_NONE, lane_frames, left,
                                    state, &points, &answer);
        finish_block(&pairs, &points, left, state, &answer, to.visibility, &counts);
    }
    *total = counts;
}
#endif

#include "trace/trace_kernel.clh"
