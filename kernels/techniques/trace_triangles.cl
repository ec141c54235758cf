// SPDX-License-Identifier: MIT
// The other traversal (Wyman et al. 2016; Mizoguchi and Tokuyoshi): every triangle of a bin's list against every point
// that the irregular z-buffer lists there, by the same filter. Kept to compare with: trace.cl is the default.
//
// A work-item takes one (triangle, bin) pair. Several may put one point into shadow, so visibility is written by an
// atomic exchange, and counted where it changes. Pairs that find the queue full are decided in place.
#include "occluders/bin_lists.h"
#include "trace/trace.clh"

__kernel void trace_triangles(LightFrame light_frame, PointsLayout layout, uint queue_capacity, ulong first_float,
                              __global const float* positions, __global const uint* receivers,
                              __global const float* vertices, __global const LaneFloat* sorted_x,
                              __global const LaneFloat* sorted_y, __global const LaneFloat* sorted_z,
                              __global const uint* order, __global const uint* point_offsets,
                              __global const Pair* triangle_pairs, __global const TriangleRecord* records,
                              __global const TriangleBounds* bounds, __global uint* visibility_bits,
                              __global uint2* queue, __global FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    ExactPairs pairs =
        exact_pairs(light_frame, layout, receivers, vertices + first_float, queue, queue_capacity, counters);
    uint by_trace = 0, by_exact = 0;
    ulong tests = 0;
    GN_FOR_EACH(i, counters->pairs) {
        uint bin = triangle_pairs[i].bin, slot = triangle_pairs[i].slot;
        if (bin == GN_NO_ID) continue;
        uint id = bounds[slot].id;
        uint last = point_offsets[bin + 1] / GN_LANES;
        for (uint block = point_offsets[bin] / GN_LANES; block < last; ++block) {
            PointBlock places = {sorted_x[block], sorted_y[block], sorted_z[block]};
            FilterAnswer found = filter(&records[slot], places, (LaneInt)(-1));
            ++tests;
            if (!LANES_ANY(found.possible)) continue;
            for (uint lane = 0; lane < GN_LANES; ++lane) {
                uint point = order[block * GN_LANES + lane];
                if (!LANE_OF_INT(found.possible, lane) || point == GN_NO_ID || is_receiver(&pairs, point, id) ||
                    atomic_or(&visibility_bits[point], 0u) == 0u)  // 0.0f: another triangle did it
                    continue;
                if (LANE_OF_INT(found.certain, lane))
                    by_trace += atomic_xchg(&visibility_bits[point], 0u) != 0u;
                else if (!hand_over(&pairs, point, id) &&
                         blocks_exactly(&pairs, load_point(positions, layout, point), id))
                    by_exact += atomic_xchg(&visibility_bits[point], 0u) != 0u;
            }
        }
    }
    if (by_trace != 0) atomic_add(&counters->decided_by_trace, by_trace);
    if (by_exact != 0) atomic_add(&counters->decided_by_exact, by_exact);
    count_tests(tests * GN_LANES, counters);
}
