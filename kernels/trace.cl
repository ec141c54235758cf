// SPDX-License-Identifier: MIT
// Frustum trace: every listed point against every triangle of its bin's list, by the float filter of the records.
//
// The filter only says what is certain. A pair it cannot decide (the point near an edge's ray or near the plane, by the
// proven margins) goes to the queue of the exact stage, unless the triangle is the point's own receiver. A work-item
// takes GN_LANES points of one bin (lists are padded to a multiple of that), so a CPU tests 16 at once.
// One writer per point: no atomics on visibility here.
#include "bin_lists.h"
#include "lanes.h"
#include "triangle_setup.h"

typedef struct TraceOutput {
    __global const uint* receivers;
    __global uint2* queue;
    __global FrameCounters* counters;
    uint queue_capacity;
    uint has_receivers;
} TraceOutput;

static bool is_receiver(const TraceOutput* out, uint point, uint id) {
    return out->has_receivers != 0u && out->receivers[point] == id;
}

static void hand_over(const TraceOutput* out, uint point, uint id) {
    uint slot = atomic_inc(&out->counters->uncertain);
    if (slot >= 0xC0000000u) atomic_dec(&out->counters->uncertain);  // never wraps: the host must see the overflow
    if (slot < out->queue_capacity) out->queue[slot] = (uint2)(point, id);
}

// Looks at the lanes that the filter did not dismiss; returns those that are now in shadow.
static LaneInt settle(const TraceOutput* out, LaneInt certain, LaneInt uncertain, LaneInt order, uint id) {
    LaneInt shadowed = certain;
    for (int lane = 0; lane < GN_LANES; ++lane) {
        uint point = (uint)((int*)&order)[lane];
        if (((int*)&certain)[lane]) {
            if (is_receiver(out, point, id)) ((int*)&shadowed)[lane] = 0;
        } else if (((int*)&uncertain)[lane]) {
            if (!is_receiver(out, point, id)) hand_over(out, point, id);
        }
    }
    return shadowed;
}

__kernel void trace(uint bin_count, uint queue_capacity, uint has_receivers, __global const uint* receivers,
                    __global const LaneFloat* sorted_x, __global const LaneFloat* sorted_y,
                    __global const LaneFloat* sorted_z, __global const LaneInt* sorted_order,
                    __global const uint* block_bin, __global const uint* point_offsets,
                    __global const uint* reference_offsets, __global const uint* references,
                    __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                    __global float* visibility, __global uint2* queue, __global FrameCounters* counters) {
    TraceOutput out;
    out.receivers = receivers;
    out.queue = queue;
    out.counters = counters;
    out.queue_capacity = queue_capacity;
    out.has_receivers = has_receivers;

    // An overflow upstream: the host will grow and run again, so there is nothing to do for now.
    if (counters->references == GN_NO_LISTS) return;

    uint block_count = point_offsets[bin_count] / GN_LANES;
    ulong tests = 0;
    uint decided = 0;
    GN_FOR_EACH(block, block_count) {
        uint bin = block_bin[block];
        LaneInt order = sorted_order[block];
        LaneInt alive = LANE_COMPARE(order, !=, (int)GN_NO_ID);
        LaneInt lit = alive;
        LaneFloat x = sorted_x[block], y = sorted_y[block], z = sorted_z[block];
        uint last = reference_offsets[bin + 1];
        for (uint i = reference_offsets[bin]; i < last; ++i) {
            uint slot = references[i];
            __global const TriangleRecord* r = &records[slot];
            ++tests;
            LaneFloat e0 = lanes_linear(r->edge_x[0], r->edge_y[0], r->edge_0[0], x, y);
            LaneFloat e1 = lanes_linear(r->edge_x[1], r->edge_y[1], r->edge_0[1], x, y);
            LaneFloat e2 = lanes_linear(r->edge_x[2], r->edge_y[2], r->edge_0[2], x, y);
            LaneFloat inside = LANES_MIN(e0, LANES_MIN(e1, e2));
            LaneFloat height = lanes_linear(r->plane_x, r->plane_y, r->plane_0, x, y) - z;
            float margin_edge = r->margin_edge, margin_plane = r->margin_plane;
            // height > 0: the plane is nearer to the light than the point.
            LaneInt possible = lit & ~LANE_COMPARE(inside, <, (LaneFloat)(-margin_edge)) &
                               ~LANE_COMPARE(height, <, (LaneFloat)(-margin_plane)) &
                               ~LANE_COMPARE(z, >, (LaneFloat)(r->z_high));
            if (!LANES_ANY(possible)) continue;
            LaneInt certain =
                possible & LANE_COMPARE(inside, >, (LaneFloat)(margin_edge)) &
                (LANE_COMPARE(height, >, (LaneFloat)(margin_plane)) | LANE_COMPARE(z, <, (LaneFloat)(r->z_low)));
            lit &= ~settle(&out, certain, possible & ~certain, order, bounds[slot].id);
            if (!LANES_ANY(lit)) break;
        }
        LaneInt shadowed = alive & ~lit;
        if (LANES_ANY(shadowed))
            for (int lane = 0; lane < GN_LANES; ++lane)
                if (((int*)&shadowed)[lane]) {
                    visibility[((int*)&order)[lane]] = 0.0f;
                    ++decided;
                }
    }
    if (decided != 0) atomic_add(&counters->decided_by_trace, decided);
    tests *= GN_LANES;
    uint low = (uint)tests;
    uint before = atomic_add(&counters->tests_low, low);
    uint high = (uint)(tests >> 32) + (before + low < before ? 1u : 0u);
    if (high != 0) atomic_add(&counters->tests_high, high);
}
