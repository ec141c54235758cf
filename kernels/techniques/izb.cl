// SPDX-License-Identifier: MIT
// Irregular z-buffer: the points that the map leaves open, listed by bin of light space, contiguous (count, scan,
// scatter) and as a structure of arrays (Johnson et al. 2005, Aila and Laine 2004). What traversal=triangles walks.
//
// Listed points are lit from here on; trace_triangles puts into shadow those that something blocks.
#include "occluders/triangle_setup.h"
#include "trace/coarse_test.clh"

// Where there are no lists of triangles (an overflow: the host will grow them and run again, from the same visibility)
// none of points are made.
__kernel void izb_count(LightFrame light_frame, uint first_frame, PointsLayout layout,
                        __constant const Projection* projection, uint has_map, __global const float* positions,
                        __global const uint* map, __global float* visibility, __global uint* counts,
                        __global FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    uint decided = 0, listed = 0;
    GN_FOR_EACH(block, block_count(layout)) {
        LaneFloat state = load_lanes(visibility, layout, block);
        if (!LANES_ANY(open_lanes(state))) continue;
        PointBlock points = load_block(positions, layout, block);
        LaneInt lanes =
            open_lanes(state) & LANE_COMPARE(frames_of(light_frame, points), ==, (LaneInt)((int)first_frame));
        PointBlock places = project_points(projection, points);
        LaneInt below = (LaneInt)(0);
        if (has_map) below = lanes_below_map(projection, places, state, lanes, map);
        if (LANES_ANY(below)) store_lanes(LANES_SELECT(state, (LaneFloat)(0.0f), below), visibility, layout, block);
        decided += count_lanes(below);
        lanes &= ~below;
        listed += count_lanes(lanes);
        LaneInt bins = bins_of(projection, places);
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(lanes, lane)) atomic_inc(&counts[LANE_OF_INT(bins, lane)]);
    }
    if (decided != 0) atomic_add(&counters->decided_by_map, decided);
    if (listed != 0) atomic_add(&counters->listed, listed);
}

__kernel void izb_scatter(LightFrame light_frame, uint first_frame, PointsLayout layout,
                          __constant const Projection* projection, __global const float* positions,
                          __global float* visibility, __global const uint* offsets, __global uint* cursors,
                          __global float* sorted_x, __global float* sorted_y, __global float* sorted_z,
                          __global uint* order, __global const FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    GN_FOR_EACH(block, block_count(layout)) {
        LaneFloat state = load_lanes(visibility, layout, block);
        if (!LANES_ANY(open_lanes(state))) continue;
        PointBlock points = load_block(positions, layout, block);
        LaneInt lanes =
            open_lanes(state) & LANE_COMPARE(frames_of(light_frame, points), ==, (LaneInt)((int)first_frame));
        PointBlock places = project_points(projection, points);
        LaneInt bins = bins_of(projection, places);
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(lanes, lane)) continue;
            uint bin = (uint)LANE_OF_INT(bins, lane);
            uint slot = offsets[bin] + atomic_inc(&cursors[bin]);
            sorted_x[slot] = LANE_OF_FLOAT(places.x, lane);
            sorted_y[slot] = LANE_OF_FLOAT(places.y, lane);
            sorted_z[slot] = LANE_OF_FLOAT(places.z, lane);
            order[slot] = (uint)point_of_lane(layout, block, lane);
        }
        store_lanes(LANES_SELECT(state, (LaneFloat)(1.0f), lanes), visibility, layout, block);
    }
}
