// SPDX-License-Identifier: MIT
// Technique conservative-map: decides one frame's open points by the conservative map alone. A point below the map's
// height of its texel is certainly in shadow; every other point counts as lit. So each dark point is dark by the exact
// technique too, and their share is the part of the shadow that single triangles over whole texels prove.
#include "occluders/triangle_setup.h"
#include "rivals/framed_technique.h"
#include "trace/map_query.clh"

__kernel void conservative_map_lookup(FramedParams params, __constant const Projection* projection,
                                      __global const float* positions, __global const uint* map,
                                      __global float* visibility, __global FrameCounters* counters) {
    uint decided = 0;
    GN_FOR_EACH(block, block_count(params.layout)) {
        FrameBlock at;
        if (!load_frame_block(params, projection, positions, visibility, block, &at)) continue;
        LaneInt below = lanes_below_map(projection, at.in_grid, at.state, at.lanes, map);
        decided += count_lanes(below);
        store_frame_block(params, &at, below, visibility, block);
    }
    if (decided != 0) atomic_add(&counters->decided_by_map, decided);
}
