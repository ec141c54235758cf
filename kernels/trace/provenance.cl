// SPDX-License-Identifier: MIT
// Records the provenance of each point (contract: provenance.h). These kernels run between the stages of an exact run
// and compare visibility before and after a stage. Visibility alone does not separate the map from the filter, or the
// predicate's levels: for these the kernels call the stages' functions with the same values.
#include "exact/decide_pair.clh"
#include "simd/frame_counters.h"
#include "trace/map_query.clh"
#include "trace/provenance.h"
#include "trace/trace.h"

// After the facing stage.
__kernel void provenance_of_facing(PointsLayout layout, __global const float* positions,
                                   __global const float* visibility, __global uint* provenance) {
    GN_FOR_EACH(i, layout.count) {
        float state = visibility[i];
        uint found = state >= VISIBILITY_MAY_SELF_SHADOW ? PROVENANCE_MAY_SELF_SHADOW : PROVENANCE_OPEN;
        if (state == 0.0f) found = PROVENANCE_FACES_AWAY;
        if (state == 1.0f)
            found = is_present(load_point(positions, layout, i)) ? PROVENANCE_NOT_TRACED : PROVENANCE_ABSENT;
        provenance[i] = found;
    }
}

// After the trace of one frame, before the exact stage.
__kernel void provenance_of_trace(const TraceParams params, __constant const Projection* projection,
                                  __global const float* positions, __global const uint* map,
                                  __global const float* visibility, __global uint* provenance) {
    PointsLayout layout = params.layout;
    GN_FOR_EACH(block, block_count(layout)) {
        PointBlock points = load_block(positions, layout, block);
        LaneFloat now = load_lanes(visibility, layout, block);
        LaneInt before = load_lane_ids(provenance, layout, block);
        LaneInt frames = frames_of(params.light_frame, points);
        LaneInt lanes = valid_lanes(layout, block) &
                        LANE_COMPARE(before, <=, (LaneInt)((int)PROVENANCE_MAY_SELF_SHADOW)) & ~open_lanes(now) &
                        LANE_COMPARE(frames, ==, (LaneInt)((int)params.first_frame));
        if (!LANES_ANY(lanes)) continue;
        LaneInt below = (LaneInt)(0);
        if (params.has_map) {
            LaneFloat state = LANES_SELECT((LaneFloat)(VISIBILITY_OPEN), (LaneFloat)(VISIBILITY_MAY_SELF_SHADOW),
                                           LANE_COMPARE(before, ==, (LaneInt)((int)PROVENANCE_MAY_SELF_SHADOW)));
            below = lanes_below_map(projection, project_points(projection, points), state, lanes, map);
        }
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(lanes, lane))
                provenance[point_of_lane(layout, block, lane)] = LANE_OF_INT(below, lane) ? PROVENANCE_BY_MAP
                                                                 : LANE_OF_FLOAT(now, lane) == 0.0f
                                                                     ? PROVENANCE_SHADOWED_BY_FILTER
                                                                     : PROVENANCE_LIT_BY_FILTER;
    }
}

// After the exact stage. All pairs of a lit point count; for a point in shadow only the pairs that block it count.
__kernel void provenance_of_pairs(const TraceParams params, __global const float* positions,
                                  __global const float* vertices, __global const uint2* queue,
                                  __global const float* visibility, __global uint* provenance,
                                  __global const FrameCounters* counters) {
    uint count = min(counters->uncertain, params.queue_capacity);
    GN_FOR_EACH(i, count) {
        uint2 pair = queue[i];
        int level;
        bool blocked = decide_pair(triangles_of(vertices, params.triangles), pair.y,
                                   load_point(positions, params.layout, pair.x), light_of(params.light_frame), &level);
        if (blocked || visibility[pair.x] != 0.0f) atomic_max(&provenance[pair.x], PROVENANCE_BY_FLOAT + (uint)level);
    }
}

// Before the trace of a queue overflow, which decides the points of this frame that are still open.
__kernel void provenance_of_overflow(const TraceParams params, __global const float* positions,
                                     __global const float* visibility, __global uint* provenance) {
    PointsLayout layout = params.layout;
    GN_FOR_EACH(block, block_count(layout)) {
        LaneInt frames = frames_of(params.light_frame, load_block(positions, layout, block));
        LaneInt lanes = open_lanes(load_lanes(visibility, layout, block)) &
                        LANE_COMPARE(frames, ==, (LaneInt)((int)params.first_frame));
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(lanes, lane)) provenance[point_of_lane(layout, block, lane)] = PROVENANCE_QUEUE_OVERFLOW;
    }
}
