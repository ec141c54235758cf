// SPDX-License-Identifier: MIT
// Exact trace: the pairs that the float filter left open, decided by the exact predicate on the original coordinates.
//
// Several pairs may name one point, so visibility is written by an atomic exchange, and counted where it changes.
#include "exact/blocks_lanes.clh"
#include "occluders/triangle_setup.h"

#define EXACT_TRACE_PARAMETERS                                                                                  \
    float4 light, PointsLayout layout, ulong first_float, uint queue_capacity, __global const float *positions, \
        __global const float *vertices, __global const uint2 *queue, volatile __global uint *visibility_bits,   \
        __global FrameCounters *counters
GN_KERNEL_OF_ITEMS(exact_trace, (min(counters->uncertain, queue_capacity) + GN_LANES - 1u) / GN_LANES,
                   EXACT_TRACE_PARAMETERS,
                   (items, light, layout, first_float, queue_capacity, positions, vertices, queue, visibility_bits,
                    counters)) {
    uint by_level[3] = {0, 0, 0};
    uint decided = 0;
    uint count = min(counters->uncertain, queue_capacity);
    GN_FOR_EACH_OF(block, items) {
        uint first = (uint)block * GN_LANES;
        uint points[GN_LANES];
        __global const float* rows[GN_LANES];
        PointBlock p;
        LaneInt lanes = (LaneInt)(0);
        for (uint lane = 0; lane < GN_LANES; ++lane) {
            uint2 pair = queue[min(first + lane, count - 1u)];
            points[lane] = pair.x;
            rows[lane] = vertices + first_float + 9 * (size_t)pair.y;
            float3 at = load_point(positions, layout, pair.x);
            LANE_OF_FLOAT(p.x, lane) = at.x;
            LANE_OF_FLOAT(p.y, lane) = at.y;
            LANE_OF_FLOAT(p.z, lane) = at.z;
            // 0.0f: another triangle did it.
            LANE_OF_INT(lanes, lane) = first + lane < count && GN_RELAXED_LOAD(&visibility_bits[pair.x]) != 0u ? -1 : 0;
        }
        if (!LANES_ANY(lanes)) continue;
        TriangleBlock t = load_triangle_rows(rows);
        LaneInt open, blocked = blocks_by_float(&t, &p, light, lanes, &open);
        by_level[DET3_BY_FLOAT] += count_lanes(lanes & ~open);
        lanes = blocked | open;
        if (!LANES_ANY(lanes)) continue;
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(lanes, lane)) continue;
            if (LANE_OF_INT(open, lane)) {
                int level = DET3_BY_FLOAT;
                bool blocks_it = blocks(lane_triangle(&t, lane), lane_point(p, lane), light, &level);
                ++by_level[level];
                if (!blocks_it) continue;
            }
            if (atomic_xchg(&visibility_bits[points[lane]], 0u) != 0u) ++decided;
        }
    }
    if (by_level[0] != 0) atomic_add(&counters->exact_float, by_level[0]);
    if (by_level[1] != 0) atomic_add(&counters->exact_double, by_level[1]);
    if (by_level[2] != 0) atomic_add(&counters->exact_exact, by_level[2]);
    if (decided != 0) atomic_add(&counters->decided_by_exact, decided);
}
