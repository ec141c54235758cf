// SPDX-License-Identifier: MIT
// Technique conservative-map: decides one frame's open points by the conservative map alone. A point below the map's
// height of its texel is certainly in shadow; every other point counts as lit. So each dark point is dark by the exact
// technique too, and their share is the part of the shadow that single triangles over whole texels prove.
#include "occluders/triangle_setup.h"
#include "trace/coarse_test.clh"

__kernel void conservative_map_lookup(LightFrame light_frame, uint frame, PointsLayout layout,
                                      __constant const Projection* projection, __global const float* positions,
                                      __global const uint* map, __global float* visibility,
                                      __global FrameCounters* counters) {
    uint decided = 0;
    GN_FOR_EACH(block, block_count(layout)) {
        LaneFloat state = load_lanes(visibility, layout, block);
        if (!LANES_ANY(open_lanes(state))) continue;
        PointBlock points = load_block(positions, layout, block);
        LaneInt lanes = open_lanes(state) & LANE_COMPARE(frames_of(light_frame, points), ==, (LaneInt)((int)frame));
        LaneInt below = lanes_below_map(projection, project_points(projection, points), state, lanes, map);
        decided += count_lanes(below);
        LaneFloat result = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), below);
        store_lanes(LANES_SELECT(state, result, lanes), visibility, layout, block);
    }
    if (decided != 0) atomic_add(&counters->decided_by_map, decided);
}
