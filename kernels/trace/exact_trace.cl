// SPDX-License-Identifier: MIT
// Exact trace: the exact predicate decides the queued pairs on the original coordinates.
//
// Several pairs may name one point, so visibility is written by an atomic exchange, and counted where it changes.
#include "exact/blocks_lanes.clh"
#include "simd/frame_counters.h"
#include "trace/trace.h"

GN_NOINLINE_ON_CPU void decide_pairs(ItemRange items, const TraceParams params, __global const float* positions,
                                     __global const float* vertices, __global const uint2* queue,
                                     volatile __global uint* visibility_bits, __global FrameCounters* counters) {
    uint by_level[3] = {0, 0, 0};
    uint decided = 0;
    uint count = min(counters->uncertain, params.queue_capacity);
    float4 light = light_of(params.light_frame);
    GN_FOR_EACH_OF(block, items) {
        uint first = (uint)block * GN_LANES;
        uint points[GN_LANES];
        __global const float* rows[GN_LANES];
        PointBlock p;
        LaneInt lanes = (LaneInt)(0);
        for (uint lane = 0; lane < GN_LANES; ++lane) {
            uint2 pair = queue[min(first + lane, count - 1u)];
            points[lane] = pair.x;
            rows[lane] = vertices + params.first_float + 9 * (size_t)pair.y;
            float3 at = load_point(positions, params.layout, pair.x);
            LANE_OF_FLOAT(p.x, lane) = at.x;
            LANE_OF_FLOAT(p.y, lane) = at.y;
            LANE_OF_FLOAT(p.z, lane) = at.z;
            // 0.0f: already shadowed by another triangle.
            LANE_OF_INT(lanes, lane) = first + lane < count && GN_RELAXED_LOAD(&visibility_bits[pair.x]) != 0u ? -1 : 0;
        }
        if (!LANES_ANY(lanes)) continue;
        TriangleBlock t = load_triangle_rows(rows);
        LaneInt undecided, blocked = blocks_by_float(&t, &p, light, lanes, &undecided);
        by_level[DET3_BY_FLOAT] += count_lanes(lanes & ~undecided);
        lanes = blocked | undecided;
        if (!LANES_ANY(lanes)) continue;
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(lanes, lane)) continue;
            if (LANE_OF_INT(undecided, lane)) {
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

__kernel void exact_trace(const TraceParams params, __global const float* positions, __global const float* vertices,
                          __global const uint2* queue, volatile __global uint* visibility_bits,
                          __global FrameCounters* counters) {
    uint count = min(counters->uncertain, params.queue_capacity);
    decide_pairs(item_range(count / GN_LANES + (count % GN_LANES != 0u)), params, positions, vertices, queue,
                 visibility_bits, counters);
}
