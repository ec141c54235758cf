// SPDX-License-Identifier: MIT
// Exact trace: the pairs that the float filter left open, decided by the exact predicate on the original coordinates.
//
// Several pairs may name one point, so visibility is written by an atomic exchange, and counted where it changes.
#include "exact/blocks.h"
#include "triangle_setup.h"

__kernel void exact_trace(float4 light, PointsLayout layout, ulong first_float, uint queue_capacity,
                          __global const float* positions, __global const float* vertices, __global const uint2* queue,
                          __global uint* visibility_bits, __global FrameCounters* counters) {
    uint by_level[3] = {0, 0, 0};
    uint decided = 0;
    uint count = min(counters->uncertain, queue_capacity);
    GN_FOR_EACH(i, count) {
        uint2 pair = queue[i];
        if (atomic_or(&visibility_bits[pair.x], 0u) == 0u) continue;  // 0.0f: another triangle did it
        int level = DET3_BY_FLOAT;
        bool blocked =
            blocks(load_triangle(vertices + first_float, pair.y), load_point(positions, layout, pair.x), light, &level);
        ++by_level[level];
        if (blocked && atomic_xchg(&visibility_bits[pair.x], 0u) != 0u) ++decided;
    }
    if (by_level[0] != 0) atomic_add(&counters->exact_float, by_level[0]);
    if (by_level[1] != 0) atomic_add(&counters->exact_double, by_level[1]);
    if (by_level[2] != 0) atomic_add(&counters->exact_exact, by_level[2]);
    if (decided != 0) atomic_add(&counters->decided_by_exact, decided);
}
