// SPDX-License-Identifier: MIT
// The filter of points against a triangle's record, and what becomes of pairs that it cannot decide. Shared by the two
// traversals: points over lists of triangles (trace.cl), triangles over lists of points (trace_triangles.cl).
#ifndef GN_TRACE_H
#define GN_TRACE_H

#include "exact/blocks.h"
#include "light_frame.h"
#include "triangle_setup.h"

// Where pairs are decided for good, and where they wait for that. In place of a run-time size the queue is bounded.
typedef struct ExactPairs {
    __global const uint* receivers;
    __global const float* vertices;  // from the first triangle on
    __global uint2* queue;           // (point, triangle)
    uint queue_capacity;
    uint has_receivers;
    float4 light;
    __global FrameCounters* counters;
} ExactPairs;

static ExactPairs exact_pairs(LightFrame light_frame, PointsLayout layout, __global const uint* receivers,
                              __global const float* vertices, __global uint2* queue, uint queue_capacity,
                              __global FrameCounters* counters) {
    ExactPairs pairs;
    pairs.receivers = receivers;
    pairs.vertices = vertices;
    pairs.queue = queue;
    pairs.queue_capacity = queue_capacity;
    pairs.has_receivers = layout.has_receivers;
    pairs.light = light_of(light_frame);
    pairs.counters = counters;
    return pairs;
}

static bool is_receiver(const ExactPairs* pairs, uint point, uint id) {
    return pairs->has_receivers != 0u && pairs->receivers[point] == id;
}

// False if the queue is full.
static bool hand_over(const ExactPairs* pairs, uint point, uint id) {
    uint place = atomic_inc(&pairs->counters->uncertain);
    if (place >= 0xC0000000u) atomic_dec(&pairs->counters->uncertain);  // never wraps: the host must see the overflow
    if (place >= pairs->queue_capacity) return false;
    pairs->queue[place] = (uint2)(point, id);
    return true;
}

static bool blocks_exactly(const ExactPairs* pairs, float3 p, uint id) {
    int level = DET3_BY_FLOAT;
    bool blocked = blocks(load_triangle(pairs->vertices, id), p, pairs->light, &level);
    atomic_inc(level == DET3_BY_FLOAT    ? &pairs->counters->exact_float
               : level == DET3_BY_DOUBLE ? &pairs->counters->exact_double
                                         : &pairs->counters->exact_exact);
    return blocked;
}

// The filter for the lanes `lit` of points at these places: which of them the triangle blocks for certain, which it
// may. The sign of a rounded sum is that of the sum (0 at worst, where denormals are flushed: undecided), so that one
// comparison does for several.
typedef struct FilterAnswer {
    LaneInt certain, possible;
} FilterAnswer;

static FilterAnswer filter(__global const TriangleRecord* r, PointBlock places, LaneInt lit) {
    LaneFloat x = places.x, y = places.y, z = places.z;
    LaneFloat e0 = lanes_linear(r->edge_x[0], r->edge_y[0], r->edge_0[0], x, y);
    LaneFloat e1 = lanes_linear(r->edge_x[1], r->edge_y[1], r->edge_0[1], x, y);
    LaneFloat e2 = lanes_linear(r->edge_x[2], r->edge_y[2], r->edge_0[2], x, y);
    LaneFloat inside = LANES_MIN(e0, LANES_MIN(e1, e2));
    // height > 0: the plane is nearer to the light than the point.
    LaneFloat height = lanes_linear(r->plane_x, r->plane_y, r->plane_0, x, y) - z;
    // >= 0: not outside for certain, not nearer to the light than the plane or all of the triangle.
    LaneFloat inside_at_most = inside + r->margin_edge, height_at_most = height + r->margin_plane;
    LaneFloat below_top = r->z_high - z;
    LaneFloat at_most = LANES_MIN(inside_at_most, height_at_most);
    at_most = LANES_MIN(below_top, at_most);
    // > 0: inside for certain, and behind the plane or all of the triangle.
    LaneFloat inside_at_least = inside - r->margin_edge, height_at_least = height - r->margin_plane;
    LaneFloat below_bottom = r->z_low - z;
    LaneFloat behind = LANES_MAX(height_at_least, below_bottom);
    LaneFloat at_least = LANES_MIN(inside_at_least, behind);
    FilterAnswer answer;
    answer.possible = lit & LANE_COMPARE(at_most, >=, (LaneFloat)(0.0f));
    answer.certain = answer.possible & LANE_COMPARE(at_least, >, (LaneFloat)(0.0f));
    return answer;
}

static void count_tests(ulong tests, __global FrameCounters* counters) {
    if (tests == 0) return;
    uint low = (uint)tests;
    uint before = atomic_add(&counters->tests_low, low);
    uint high = (uint)(tests >> 32) + (before + low < before ? 1u : 0u);
    if (high != 0) atomic_add(&counters->tests_high, high);
}

#endif
