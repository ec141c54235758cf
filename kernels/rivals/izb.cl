// SPDX-License-Identifier: MIT
// Irregular z-buffer. The kernels list the points that the map leaves open by texel of light space, contiguous (count,
// scan, scatter) and as a structure of arrays (Johnson et al. 2005, Aila and Laine 2004). Then triangles traverse these
// lists (Wyman et al. 2016; Mizokuchi and Tokuyoshi), with the filter of the trace. A point that a triangle puts into
// shadow is removed from its list (Wyman et al. 2016): its slot becomes empty, and later triangles do not test it.
//
// Listed points are lit after izb_scatter; izb_trace puts a point into shadow if a triangle blocks it.
#include "rivals/izb.h"

#include "occluders/bin_overlap.clh"
#include "trace/filter.clh"
#include "trace/map_query.clh"

// The list of a texel. The texels of a bin are neighbours, row by row.
static LaneInt lists_of(__constant const Projection* projection, PointBlock in_grid) {
    int bin_log2 = (int)projection->bin_log2;
    LaneInt in_bin = (LaneInt)((1 << bin_log2) - 1);
    LaneInt x = texel_indices(in_grid.x, projection->width) & in_bin;
    LaneInt y = texel_indices(in_grid.y, projection->height) & in_bin;
    return (bins_of(projection, in_grid) << (2 * bin_log2)) + (y << bin_log2) + x;
}

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
        LaneInt lanes = at.lanes & ~below, lists = lists_of(projection, at.in_grid);
        listed += count_lanes(lanes);
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(lanes, lane)) atomic_inc(&counts[LANE_OF_INT(lists, lane)]);
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
        LaneInt of = lists_of(projection, at.in_grid);
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(at.lanes, lane)) continue;
            uint list = (uint)LANE_OF_INT(of, lane);
            uint slot = offsets[list] + atomic_inc(&cursors[list]);
            lists[slot] = as_float((uint)point_of_lane(layout, block, lane));
            lists[slots + slot] = LANE_OF_FLOAT(at.in_grid.x, lane);
            lists[2 * slots + slot] = LANE_OF_FLOAT(at.in_grid.y, lane);
            lists[3 * slots + slot] = LANE_OF_FLOAT(at.in_grid.z, lane);
        }
        store_frame_block(params.framed, &at, (LaneInt)(0), visibility, block);
    }
}

// Slots of the lists, from `slot` on.
#if GN_LANES == 1
#define LOAD_SLOTS(values, slot) ((values)[slot])
#define IDS_OF(values) ((int)(values))
#define SLOTS_BEFORE(slot, end) (-1)
#else
#define LOAD_SLOTS(values, slot) vload16(0, (values) + (slot))
#define IDS_OF(values) as_int16(values)
#define SLOTS_BEFORE(slot, end) ((int)(slot) + LANE_INDEX < (LaneInt)((int)(end)))
#endif

typedef struct IzbLists {
    __global uint* order;
    __global const float *x, *y, *z;
} IzbLists;

typedef struct IzbTotals {
    uint by_trace, by_exact;
    ulong tests;
} IzbTotals;

// Tests a triangle against the points of the slots [slot, end). Several items may put one point into shadow, so an item
// writes visibility by an atomic exchange and counts changes. An item that reads the slot of a removed point too early
// tests the point once more. If the queue is full, the item decides the pair in place.
static void trace_slots(const ExactPairs* pairs, PointsLayout layout, __global const float* positions, IzbLists lists,
                        uint slot, uint end, __global const TriangleRecord* record,
                        __global const TriangleBounds* bounds, __global uint* visibility_bits, IzbTotals* totals) {
    uint id = bounds->id;
    for (; slot < end; slot += GN_LANES) {
        LaneInt points = IDS_OF(LOAD_SLOTS(lists.order, slot));
        LaneInt present = LANE_COMPARE(points, !=, (LaneInt)((int)GN_NO_ID)) & SLOTS_BEFORE(slot, end);
        if (!LANES_ANY(present)) continue;
        PointBlock in_grid = {LOAD_SLOTS(lists.x, slot), LOAD_SLOTS(lists.y, slot), LOAD_SLOTS(lists.z, slot)};
        FilterResult found = filter(record, in_grid, present);
        ++totals->tests;
        if (!LANES_ANY(found.possible)) continue;
#ifdef GN_CUT_OUTS
        if (is_masked(bounds)) found.certain = (LaneInt)(0);
#endif
        for (uint lane = 0; lane < GN_LANES; ++lane) {
            uint point = (uint)LANE_OF_INT(points, lane);
            if (!LANE_OF_INT(found.possible, lane) || is_receiver(pairs, point, id) ||
                atomic_or(&visibility_bits[point], 0u) == 0u)  // 0.0f: already shadowed by another triangle
                continue;
            bool is_certain = LANE_OF_INT(found.certain, lane) != 0;
            if (!is_certain &&
                (queue_pair(pairs, point, id) || !blocks_exactly(pairs, load_point(positions, layout, point), id)))
                continue;
            lists.order[slot + lane] = GN_NO_ID;
            uint changed = atomic_xchg(&visibility_bits[point], 0u) != 0u;
            if (is_certain)
                totals->by_trace += changed;
            else
                totals->by_exact += changed;
        }
    }
}

// A work-item takes one (triangle, bin) pair, and of each row of the bin's texels those in the triangle's bounds, whose
// slots are neighbours.
__kernel void izb_trace(const IzbParams params, __global const float* positions, __global const uint* receivers,
                        __global const float* vertices, __global uint* order, __global const uint* offsets,
                        __global const Pair* triangle_pairs, __global const TriangleRecord* records,
                        __global const TriangleBounds* bounds, __global uint* visibility_bits, __global uint2* queue,
                        __global FrameCounters* counters GN_SHARES) {
    FramedParams framed = params.framed;
    LightFrame frame = framed.light_frame;
    ExactPairs pairs = {receivers,
                        framed.layout.has_receivers,
                        triangles_of(vertices, framed.triangles),
                        light_of(frame),
                        queue,
                        params.queue_capacity,
                        counters};
    size_t slots = params.slot_count;
    __global const float* in_grid = (__global const float*)order + slots;
    IzbLists lists = {order, in_grid, in_grid + slots, in_grid + 2 * slots};
    IzbTotals totals = {0u, 0u, 0u};
    uint side = 1u << frame.bin_log2;
    bool has_lists = counters->references != GN_NO_LISTS;
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(has_lists ? counters->pairs : 0u)) {
        uint bin = triangle_pairs[i].bin, slot = triangle_pairs[i].slot;
        if (bin == GN_NO_ID) continue;
        bin %= frame.bins_x * frame.bins_y;  // Pair: on a CPU it is the bin of a row
        uint4 texels = squares_of_bounds(bounds[slot], frame.width, frame.height, 0u);
        uint left = bin % frame.bins_x * side, top = bin / frame.bins_x * side;
        uint x0 = max(texels.x, left) - left, x1 = min(texels.z, left + side - 1u) - left;
        uint y0 = max(texels.y, top) - top, y1 = min(texels.w, top + side - 1u) - top;
        for (uint y = y0; y <= y1; ++y) {
            __global const uint* row = offsets + (bin << (2u * frame.bin_log2)) + (y << frame.bin_log2);
            trace_slots(&pairs, framed.layout, positions, lists, row[x0], row[x1 + 1u], &records[slot], &bounds[slot],
                        visibility_bits, &totals);
        }
    }
    if (totals.by_trace != 0) atomic_add(&counters->decided_by_trace, totals.by_trace);
    if (totals.by_exact != 0) atomic_add(&counters->decided_by_exact, totals.by_exact);
    count_tests(totals.tests * GN_LANES, counters);
    GN_END_SHARES;
}
