// SPDX-License-Identifier: MIT
// The clearance of fragments' receivers, for clearance_test.cpp.
#include "samples/clearance.clh"

#define OTHERS 8u

// Fragment i has a footprint around centre i, on receivers[i]. clear[i]: bit k if the triangle others[OTHERS i + k]
// shadows no sample of it.
__kernel void find_clear(PointsLayout layout, float4 eye, float4 light, __global const float* vertices,
                         __global const float* centres, __global const float* footprints,
                         __global const uint* receivers, __global const uint* others, __global uint* clear) {
    GN_FOR_EACH(block, block_count(layout)) {
        LaneInt lanes = valid_lanes(layout, block), ids = load_lane_ids(receivers, layout, block), found = (LaneInt)(0);
        PointBlock at = load_block(centres, layout, block);
        FootprintBlock around = load_footprints(footprints, layout, block);
        ReceiverPlanes planes = find_receiver_planes(vertices, ids, lanes, eye.xyz, light, at, &around);
        for (uint k = 0; k < OTHERS; ++k) {
            LaneInt of_lanes = (LaneInt)(0);
            for (int lane = 0; lane < GN_LANES; ++lane)
                if (LANE_OF_INT(lanes, lane))
                    LANE_OF_INT(of_lanes, lane) = (int)others[(block * GN_LANES + (size_t)lane) * OTHERS + k];
            TriangleBlock t = load_triangles_of(vertices, of_lanes, lanes);
            found |= lanes_clear_of(&planes, &t, lanes) & (int)(1u << k);
        }
        store_lane_ids(found, clear, layout, block);
    }
}
