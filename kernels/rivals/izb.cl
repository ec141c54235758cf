// SPDX-License-Identifier: MIT
// Irregular z-buffer. The kernels list the points that the map leaves open by bin of light space, contiguous (count,
// scan, scatter) and as a structure of arrays (Johnson et al. 2005, Aila and Laine 2004). Then triangles traverse these
// lists (Wyman et al. 2016; Mizokuchi and Tokuyoshi), with the filter of the trace.
//
// Listed points are lit after izb_scatter; izb_trace puts a point into shadow if a triangle blocks it.
#include "rivals/izb.h"

#include "occluders/bin_lists.h"
#include "trace/filter.clh"
#include "trace/map_query.clh"

// If a list of triangles overflowed, the host grows it and runs again from the same visibility: in that case the
// kernels make no lists of points.
__kernel void izb_count(const IzbParams params, __constant const Projection* projection,
                        __global const float* positions, __global const uint* map, __global float* visibility,
                        __global uint* counts, __global FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    PointsLayout layout = params.framed.layout;
    uint decided = 0, listed = 0;
    GN_FOR_EACH(block, block_count(layout)) {
        FrameBlock at;
        if (!load_frame_block(params.framed, projection, positions, visibility, block, &at)) continue;
        LaneInt below = (LaneInt)(0);
        if (params.has_map) below = lanes_below_map(projection, at.in_grid, at.state, at.lanes, map);
        if (LANES_ANY(below)) store_lanes(LANES_SELECT(at.state, (LaneFloat)(0.0f), below), visibility, layout, block);
        decided += count_lanes(below);
        LaneInt lanes = at.lanes & ~below, bins = bins_of(projection, at.in_grid);
        listed += count_lanes(lanes);
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(lanes, lane)) atomic_inc(&counts[LANE_OF_INT(bins, lane)]);
    }
    if (decided != 0) atomic_add(&counters->decided_by_map, decided);
    if (listed != 0) atomic_add(&counters->listed, listed);
}

__kernel void izb_scatter(const IzbParams params, __constant const Projection* projection,
                          __global const float* positions, __global const uint* offsets, __global float* visibility,
                          __global uint* cursors, __global float* lists, __global const FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    PointsLayout layout = params.framed.layout;
    size_t slots = params.slot_count;
    GN_FOR_EACH(block, block_count(layout)) {
        FrameBlock at;
        if (!load_frame_block(params.framed, projection, positions, visibility, block, &at)) continue;
        LaneInt bins = bins_of(projection, at.in_grid);
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(at.lanes, lane)) continue;
            uint bin = (uint)LANE_OF_INT(bins, lane);
            uint slot = offsets[bin] + atomic_inc(&cursors[bin]);
            lists[slot] = as_float((uint)point_of_lane(layout, block, lane));
            lists[slots + slot] = LANE_OF_FLOAT(at.in_grid.x, lane);
            lists[2 * slots + slot] = LANE_OF_FLOAT(at.in_grid.y, lane);
            lists[3 * slots + slot] = LANE_OF_FLOAT(at.in_grid.z, lane);
        }
        store_frame_block(params.framed, &at, (LaneInt)(0), visibility, block);
    }
}

// A work-item takes one (triangle, bin) pair. Several items may put one point into shadow, so an item writes visibility
// by an atomic exchange and counts changes. If the queue is full, the item decides the pair in place.
__kernel void izb_trace(const IzbParams params, __global const float* positions, __global const uint* receivers,
                        __global const float* vertices, __global const float* lists, __global const uint* offsets,
                        __global const Pair* triangle_pairs, __global const TriangleRecord* records,
                        __global const TriangleBounds* bounds, __global uint* visibility_bits, __global uint2* queue,
                        __global FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    FramedParams framed = params.framed;
    Triangles triangles = triangles_of(vertices, framed.triangles);
    ExactPairs pairs = {receivers, framed.layout.has_receivers, triangles, light_of(framed.light_frame),
                        queue,     params.queue_capacity,       counters};
    size_t slots = params.slot_count;
    __global const uint* order = (__global const uint*)lists;
    __global const LaneFloat *x = (__global const LaneFloat*)(lists + slots), *y = x + slots / GN_LANES;
    __global const LaneFloat* z = y + slots / GN_LANES;
    uint by_trace = 0, by_exact = 0;
    ulong tests = 0;
    GN_FOR_EACH(i, counters->pairs) {
        uint bin = triangle_pairs[i].bin, slot = triangle_pairs[i].slot;
        if (bin == GN_NO_ID) continue;
        bin %= framed.light_frame.bins_x * framed.light_frame.bins_y;  // Pair: on a CPU it is the bin of a row
        uint id = bounds[slot].id;
        uint last = offsets[bin + 1] / GN_LANES;
        for (uint block = offsets[bin] / GN_LANES; block < last; ++block) {
            PointBlock in_grid = {x[block], y[block], z[block]};
            FilterResult found = filter(&records[slot], in_grid, (LaneInt)(-1));
            ++tests;
            if (!LANES_ANY(found.possible)) continue;
#ifdef GN_CUT_OUTS
            if (is_masked(&bounds[slot])) found.certain = (LaneInt)(0);
#endif
            for (uint lane = 0; lane < GN_LANES; ++lane) {
                uint point = order[block * GN_LANES + lane];
                if (!LANE_OF_INT(found.possible, lane) || point == GN_NO_ID || is_receiver(&pairs, point, id) ||
                    atomic_or(&visibility_bits[point], 0u) == 0u)  // 0.0f: already shadowed by another triangle
                    continue;
                if (LANE_OF_INT(found.certain, lane))
                    by_trace += atomic_xchg(&visibility_bits[point], 0u) != 0u;
                else if (!queue_pair(&pairs, point, id) &&
                         blocks_exactly(&pairs, load_point(positions, framed.layout, point), id))
                    by_exact += atomic_xchg(&visibility_bits[point], 0u) != 0u;
            }
        }
    }
    if (by_trace != 0) atomic_add(&counters->decided_by_trace, by_trace);
    if (by_exact != 0) atomic_add(&counters->decided_by_exact, by_exact);
    count_tests(tests * GN_LANES, counters);
}
