// SPDX-License-Identifier: MIT
// Exact trace: the exact predicate decides the queued pairs on the original coordinates.
//
// Several pairs may name one point, so visibility is written by an atomic exchange, and counted where it changes.
#include "exact/decide_pair.clh"
#include "simd/frame_counters.h"
#include "trace/trace.h"

GN_NOINLINE_ON_CPU void decide_queue(ItemRange items, const TraceParams params, __global const float* positions,
                                     __global const float* vertices, __global const uint2* queue,
                                     volatile __global uint* visibility_bits, __global FrameCounters* counters) {
    Triangles triangles = triangles_of(vertices, params.triangles);
    uint by_level[3] = {0, 0, 0};
    uint decided = 0;
    uint count = min(counters->uncertain, params.queue_capacity);
    float4 light = light_of(params.light_frame);
    GN_FOR_EACH_OF(block, items) {
        uint first = (uint)block * GN_LANES;
        uint points[GN_LANES], ids[GN_LANES];
        PointBlock p;
        LaneInt lanes = (LaneInt)(0);
        for (uint lane = 0; lane < GN_LANES; ++lane) {
            uint2 pair = queue[min(first + lane, count - 1u)];
            points[lane] = pair.x;
            ids[lane] = pair.y;
            float3 at = load_point(positions, params.layout, pair.x);
            set_lane(&p, lane, at);
            // 0.0f: already shadowed by another triangle.
            LANE_OF_INT(lanes, lane) = first + lane < count && GN_RELAXED_LOAD(&visibility_bits[pair.x]) != 0u ? -1 : 0;
        }
        if (!LANES_ANY(lanes)) continue;
        for (uint bits = lane_bits(decide_pairs(triangles, ids, &p, light, lanes, by_level)); bits != 0u;)
            if (atomic_xchg(&visibility_bits[points[take_lane(&bits)]], 0u) != 0u) ++decided;
    }
    if (by_level[0] != 0) atomic_add(&counters->exact_float, by_level[0]);
    if (by_level[1] != 0) atomic_add(&counters->exact_double, by_level[1]);
    if (by_level[2] != 0) atomic_add(&counters->exact_exact, by_level[2]);
    if (decided != 0) atomic_add(&counters->decided_by_exact, decided);
}

__kernel void exact_trace(const TraceParams params, __global const float* positions, __global const float* vertices,
                          __global const uint2* queue, volatile __global uint* visibility_bits,
                          __global FrameCounters* counters GN_SHARES) {
    uint count = min(counters->uncertain, params.queue_capacity);
    decide_queue(GN_SHARED_RANGE(count / GN_LANES + (count % GN_LANES != 0u)), params, positions, vertices, queue,
                 visibility_bits, counters);
    GN_END_SHARES;
}
