// SPDX-License-Identifier: MIT
// Watches an exact run between its stages: what each of them changed in `visibility` says whom it decided (contract:
// decisions.h). What visibility does not tell, the map from the filter and the predicate's level, is asked again of the
// very functions that the stages ask, with the very values: they give the same answers.
#include "exact/blocks.clh"
#include "simd/frame_counters.h"
#include "trace/coarse_test.clh"
#include "trace/provenance.h"

// After the facing stage.
__kernel void decisions_of_facing(PointsLayout layout, __global const float* positions,
                                  __global const float* visibility, __global uint* provenance) {
    GN_FOR_EACH(i, layout.count) {
        float state = visibility[i];
        uint decision = state >= VISIBILITY_MAY_SELF_SHADOW ? PROVENANCE_DOUBTFUL : PROVENANCE_OPEN;
        if (state == 0.0f) decision = PROVENANCE_FACES_AWAY;
        if (state == 1.0f)
            decision = is_present(load_point(positions, layout, i)) ? PROVENANCE_NOT_ASKED : PROVENANCE_ABSENT;
        provenance[i] = decision;
    }
}

// After the trace of one frame, before the exact stage.
__kernel void decisions_of_trace(LightFrame light_frame, uint frame, PointsLayout layout,
                                 __constant const Projection* projection, uint has_map, __global const float* positions,
                                 __global const uint* map, __global const float* visibility,
                                 __global uint* provenance) {
    GN_FOR_EACH(block, block_count(layout)) {
        PointBlock points = load_block(positions, layout, block);
        LaneFloat now = load_lanes(visibility, layout, block);
        LaneInt before = load_lane_ids(provenance, layout, block);
        LaneInt lanes = valid_lanes(layout, block) & LANE_COMPARE(before, <=, (LaneInt)((int)PROVENANCE_DOUBTFUL)) &
                        ~open_lanes(now) & LANE_COMPARE(frames_of(light_frame, points), ==, (LaneInt)((int)frame));
        if (!LANES_ANY(lanes)) continue;
        LaneInt below = (LaneInt)(0);
        if (has_map) {
            LaneFloat state = LANES_SELECT((LaneFloat)(VISIBILITY_OPEN), (LaneFloat)(VISIBILITY_MAY_SELF_SHADOW),
                                           LANE_COMPARE(before, ==, (LaneInt)((int)PROVENANCE_DOUBTFUL)));
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

// After the exact stage: a lit point was asked about all its pairs; one in shadow counts those that put it there.
__kernel void decisions_of_pairs(float4 light, PointsLayout layout, ulong first_float, uint queue_capacity,
                                 __global const float* positions, __global const float* vertices,
                                 __global const uint2* queue, __global const float* visibility,
                                 __global uint* provenance, __global const FrameCounters* counters) {
    uint count = min(counters->uncertain, queue_capacity);
    GN_FOR_EACH(i, count) {
        uint2 pair = queue[i];
        int level = DET3_BY_FLOAT;
        bool blocked =
            blocks(load_triangle(vertices + first_float, pair.y), load_point(positions, layout, pair.x), light, &level);
        if (blocked || visibility[pair.x] != 0.0f) atomic_max(&provenance[pair.x], PROVENANCE_BY_FLOAT + (uint)level);
    }
}

// Before a second look: it is for the points of this frame that are still open.
__kernel void decisions_of_second_look(LightFrame light_frame, uint frame, PointsLayout layout,
                                       __global const float* positions, __global const float* visibility,
                                       __global uint* provenance) {
    GN_FOR_EACH(block, block_count(layout)) {
        LaneInt lanes = open_lanes(load_lanes(visibility, layout, block));
        lanes &= LANE_COMPARE(frames_of(light_frame, load_block(positions, layout, block)), ==, (LaneInt)((int)frame));
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(lanes, lane)) provenance[point_of_lane(layout, block, lane)] = PROVENANCE_SECOND_LOOK;
    }
}
