// SPDX-License-Identifier: MIT
// The trace of points that facing has left open. Undecided pairs are queued for the exact stage.
//
// TRACE_QUEUE_OVERFLOW makes the variant for points with undecided pairs that found no room in the queue: it decides
// such pairs in place.
#ifdef TRACE_QUEUE_OVERFLOW
#define TRACE_KERNEL trace_queue_overflow
#define TRACE_IN_PLACE 1
#else
#define TRACE_KERNEL trace
#define TRACE_IN_PLACE 0
#endif
#define TRACE_TABLE __global const BlockBounds*
#if GN_LANES == 1
#define TRACE_MORE_OF_POINTS
#define TRACE_MORE_VALUES
#else
#define TRACE_MORE_OF_POINTS __global const BlockBounds* blocks;  // from facing; null: no block bounds
#define TRACE_MORE_VALUES , params.has_block_bounds ? table : 0
#endif
#include "trace/walk_cpu.clh"
#include "trace/walk_gpu.clh"

#if GN_LANES > 1

// The map decides the blocks that it hides wholly by their bounds alone, without their points.
GN_NOINLINE_ON_CPU void trace_blocks(ItemRange items, LightFrame light_frame, TraceFrames frames, TraceLists lists,
                                     ExactPairs pairs, TracePoints to, TraceCounts* total) {
    PointsLayout layout = to.layout;
    BlockGrid grid = block_grid(light_frame, frames.projections, frames.first);
    // A queue overflow may have several frames, which apply_map() checks one by one.
    bool sees_map = frames.has_map && (TRACE_IN_PLACE || map_is_enabled(frames.projections));
    TraceCounts counts = *total;
    GN_FOR_EACH_OF(block, items) {
        uint coverage = MAP_MAY_HIDE;
        bool all_open = false;  // all lanes are open and in this frame: no stage has decided one before
        if (to.blocks != 0) {
            BlockBounds bounds = to.blocks[block];
            if (bounds.frame != frames.first && bounds.frame != BLOCK_IN_FRAMES) continue;
            if (sees_map) coverage = map_hides(&grid, frames.projections, &bounds, frames.map);
            all_open = bounds.frame == frames.first && bounds.flags == BLOCK_ALL_OPEN;
        }
        LaneFloat state = all_open ? (LaneFloat)(VISIBILITY_OPEN) : load_lanes(to.visibility, layout, block);
        LaneInt left = open_lanes(state);
        if (!LANES_ANY(left)) continue;
        if (coverage == MAP_HIDES_ALL) {
            counts.minus_by_map += left;
            store_lanes(LANES_SELECT(state, (LaneFloat)(0.0f), left), to.visibility, layout, block);
            continue;
        }
        BlockPoints points = load_points(to.positions, to.receivers, layout, block);
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
        left &= lanes_in_frames(&frames, lane_frames);
        BlockResult result = empty_result();
        counts.tests += trace_block(&pairs, &frames, lists, sees_map && coverage != MAP_HIDES_NONE, lane_frames, left,
                                    state, &points, &result);
        finish_block(&pairs, &points, left, state, &result, to.visibility, &counts);
    }
    *total = counts;
}

#else

// The lists that a run makes have no table from triangles to slots.
static uint receiver_slot(const TracePoints* to, size_t point) { return GN_NO_ID; }

// The next point's state is loaded while the current point is tested: most points are not open.
static void queue_walks(ItemRange items, LightFrame light_frame, TraceFrames frames, TraceLists lists, ExactPairs pairs,
                        TracePoints to, TraceCounts* total, const WalkQueue* queue) {
    PointsLayout layout = to.layout;
    TraceCounts counts = *total;
    LaneFloat state_ahead = items.first < items.end ? to.visibility[items.first] : 0.0f;
    GN_FOR_EACH_OF(point, items) {
        LaneFloat state = state_ahead;
        size_t ahead = point + items.step;
        state_ahead = ahead < items.end ? to.visibility[ahead] : 0.0f;
        LaneInt left = open_lanes(state);
        if (!LANES_ANY(left)) continue;
        BlockPoints points = load_points(to.positions, to.receivers, layout, point);
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
        PointLookUp found = look_up(&frames, lists, lane_frames, points.at);
        left &= lanes_in_frames(&frames, lane_frames);
        BlockResult result = empty_result();
        if (apply_map(&found, left, state, &result)) {
            queue_point(queue, point, state, &result);
            continue;
        }
        finish_block(&pairs, &points, left, state, &result, to.visibility, &counts);
    }
    *total = counts;
}

#endif

#include "trace/trace_kernel.clh"
