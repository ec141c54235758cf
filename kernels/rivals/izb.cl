// SPDX-License-Identifier: MIT
// Irregular z-buffer. The kernels list the points that the map leaves open by texel of light space, contiguous (count,
// scan, scatter) and as a structure of arrays (Johnson et al. 2005, Aila and Laine 2004). Then triangles traverse these
// lists (Wyman et al. 2016; Mizokuchi and Tokuyoshi), with the filter of the trace. A point that a triangle puts into
// shadow is removed from its list (Wyman et al. 2016): its slot becomes empty, and later triangles do not test it.
//
// Listed points are lit after izb_scatter; izb_trace puts a point into shadow if a triangle blocks it.
#include "rivals/izb.h"

#include "lists/group_scan.clh"
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
                        __global uint* counts, __global uint* ranks, __global FrameCounters* counters) {
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
            if (LANE_OF_INT(lanes, lane))
                ranks[point_of_lane(layout, block, lane)] = atomic_inc(&counts[LANE_OF_INT(lists, lane)]);
    }
    if (decided != 0) atomic_add(&counters->decided_by_map, decided);
    if (listed != 0) atomic_add(&counters->listed, listed);
}

__kernel void izb_scatter(const IzbParams params, __constant const Projection* projection,
                          __global const float* positions, __global const uint* offsets, __global const uint* ranks,
                          __global float* visibility, __global float* lists, __global const FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    PointsLayout layout = params.framed.layout;
    size_t slots = params.slot_count;
    GN_FOR_EACH(block, block_count(layout)) {
        FrameBlock at;
        if (!load_frame_block(params.framed, projection, positions, visibility, block, &at)) continue;
        LaneInt of = lists_of(projection, at.in_grid);
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(at.lanes, lane)) continue;
            size_t point = point_of_lane(layout, block, lane);
            uint slot = offsets[LANE_OF_INT(of, lane)] + ranks[point];
            lists[slot] = as_float((uint)point);
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
#define LOAD_POINTS(order, slot) ((int)GN_RELAXED_LOAD(&(order)[slot]))
#define SLOTS_BEFORE(slot, end) (-1)
#else
#define LOAD_SLOTS(values, slot) vload16(0, (values) + (slot))
#define LOAD_POINTS(order, slot) as_int16(vload16(0, (order) + (slot)))
#define SLOTS_BEFORE(slot, end) ((int)(slot) + LANE_INDEX < (LaneInt)((int)(end)))
#endif

// What the items of izb_trace read and write.
typedef struct IzbTrace {
    ExactPairs pairs;
    LightFrame frame;
    PointsLayout layout;
    __global const float* positions;
    __global uint* order;  // of the points in the lists
    __global const float *x, *y, *z;
    __global const uint* offsets;
    __global const Pair* triangle_pairs;
    __global const TriangleRecord* records;
    __global const TriangleBounds* bounds;
    __global uint* visibility_bits;
    uint by_trace, by_exact;  // the item's counts
    ulong tests;
} IzbTrace;

// Tests the triangle of a record against the points of the slots [slot, end). Several items may put one point into
// shadow, so an item writes visibility by an atomic exchange and counts changes. An item that reads the slot of a
// removed point too early tests the point once more. If the queue is full, the item decides the pair in place.
static void trace_slots(IzbTrace* trace, uint record, uint slot, uint end) {
    const ExactPairs* pairs = &trace->pairs;
    uint id = trace->bounds[record].id;
    for (; slot < end; slot += GN_LANES) {
        LaneInt points = LOAD_POINTS(trace->order, slot);
        LaneInt present = LANE_COMPARE(points, !=, (LaneInt)((int)GN_NO_ID)) & SLOTS_BEFORE(slot, end);
        if (!LANES_ANY(present)) continue;
        PointBlock in_grid = {LOAD_SLOTS(trace->x, slot), LOAD_SLOTS(trace->y, slot), LOAD_SLOTS(trace->z, slot)};
        FilterResult found = filter(&trace->records[record], in_grid, present);
        ++trace->tests;
        if (!LANES_ANY(found.possible)) continue;
#ifdef GN_CUT_OUTS
        if (is_masked(&trace->bounds[record])) found.certain = (LaneInt)(0);
#endif
        for (uint lane = 0; lane < GN_LANES; ++lane) {
            uint point = (uint)LANE_OF_INT(points, lane);
            if (!LANE_OF_INT(found.possible, lane) || is_receiver(pairs, point, id) ||
                GN_RELAXED_LOAD(&trace->visibility_bits[point]) == 0u)  // 0.0f: in the shadow of another triangle
                continue;
            bool is_certain = LANE_OF_INT(found.certain, lane) != 0;
            if (!is_certain && (queue_pair(pairs, point, id) ||
                                !blocks_exactly(pairs, load_point(trace->positions, trace->layout, point), id)))
                continue;
            atomic_xchg(&trace->order[slot + lane], GN_NO_ID);
            uint changed = atomic_xchg(&trace->visibility_bits[point], 0u) != 0u;
            trace->by_trace += is_certain ? changed : 0u;
            trace->by_exact += is_certain ? 0u : changed;
        }
    }
}

// The texels of a pair's bin that lie in its triangle's bounds: some in each of several rows. The slots of a row's
// texels are neighbours.
typedef struct PairTexels {
    uint record;  // the triangle's
    uint first;   // the first row's first texel in the order of the lists
    uint across, rows, row_step;
} PairTexels;

static PairTexels texels_of_pair(const IzbTrace* trace, Pair pair) {
    LightFrame frame = trace->frame;
    PairTexels texels = {pair.slot, 0u, 0u, 0u, 1u << frame.bin_log2};
    if (pair.bin == GN_NO_ID) return texels;
    uint bin = pair.bin % (frame.bins_x * frame.bins_y);  // Pair: on a CPU it is the bin of a row
    uint4 covered = squares_of_bounds(trace->bounds[pair.slot], frame.width, frame.height, 0u);
    uint side = texels.row_step, left = bin % frame.bins_x * side, top = bin / frame.bins_x * side;
    uint x = max(covered.x, left) - left, y = max(covered.y, top) - top;
    texels.first = (bin << (2u * frame.bin_log2)) + (y << frame.bin_log2) + x;
    texels.across = min(covered.z, left + side - 1u) - left - x + 1u;
    texels.rows = min(covered.w, top + side - 1u) - top - y + 1u;
    return texels;
}

// The slots of a row's texels, as (first, end).
static uint2 slots_of_row(const IzbTrace* trace, const PairTexels* texels, uint row) {
    __global const uint* first = trace->offsets + texels->first + row * texels->row_step;
    return (uint2)(first[0], first[texels->across]);
}

// The (triangle, bin) pairs that wait in a work-group's local memory, one for each item, and the end of each one's
// slots.
typedef struct WaitingPairs {
    __local PairTexels* texels;
    __local uint* ends;
} WaitingPairs;

#ifdef GN_CPU
// An item takes one pair after the other.
static void trace_pairs(IzbTrace* trace, ItemRange items, WaitingPairs waiting) {
    GN_FOR_EACH_OF(i, items) {
        PairTexels texels = texels_of_pair(trace, trace->triangle_pairs[i]);
        for (uint row = 0; row < texels.rows; ++row) {
            uint2 slots = slots_of_row(trace, &texels, row);
            trace_slots(trace, texels.record, slots.x, slots.y);
        }
    }
}
#else
// A work-group takes one pair for each item, and its items share out the slots of all of them evenly: neighbours read
// neighbouring slots, and no item waits for the longest list.
static void trace_pairs(IzbTrace* trace, ItemRange items, WaitingPairs waiting) {
    uint item = (uint)get_local_id(0), group = (uint)get_local_size(0);
    GN_ROUNDS(round, items.end) {
        uint i = strewn_index(round), count = 0u;
        if (i < items.end) {
            PairTexels texels = texels_of_pair(trace, trace->triangle_pairs[i]);
            for (uint row = 0; row < texels.rows; ++row) {
                uint2 slots = slots_of_row(trace, &texels, row);
                count += slots.y - slots.x;
            }
            waiting.texels[item] = texels;
        }
        scan_group(count, waiting.ends);
        for (uint k = item; k < waiting.ends[group - 1u]; k += group) {
            uint owner = item_of_piece(waiting.ends, k), left = piece_of_item(waiting.ends, owner, k), row = 0u;
            PairTexels texels = waiting.texels[owner];
            uint2 slots = slots_of_row(trace, &texels, row);
            for (; left >= slots.y - slots.x; slots = slots_of_row(trace, &texels, ++row)) left -= slots.y - slots.x;
            trace_slots(trace, texels.record, slots.x + left, slots.x + left + 1u);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}
#endif

__kernel void izb_trace(const IzbParams params, __global const float* positions, __global const uint* receivers,
                        __global const float* vertices, __global uint* order, __global const uint* offsets,
                        __global const Pair* triangle_pairs, __global const TriangleRecord* records,
                        __global const TriangleBounds* bounds, __global uint* visibility_bits, __global uint2* queue,
                        __global FrameCounters* counters GN_SHARES) {
    __local PairTexels texels[IZB_GROUP];
    __local uint ends[IZB_GROUP];
    __local uint sum;
    FramedParams framed = params.framed;
    __global const float* in_grid = (__global const float*)order;
    size_t slots = params.slot_count;
    IzbTrace trace = {{receivers, framed.layout.has_receivers, triangles_of(vertices, framed.triangles),
                       light_of(framed.light_frame), queue, params.queue_capacity, counters},
                      framed.light_frame,
                      framed.layout,
                      positions,
                      order,
                      in_grid + slots,
                      in_grid + 2 * slots,
                      in_grid + 3 * slots,
                      offsets,
                      triangle_pairs,
                      records,
                      bounds,
                      visibility_bits};
    trace_pairs(&trace, GN_SHARED_RANGE(counters->references == GN_NO_LISTS ? 0u : counters->pairs),
                (WaitingPairs){texels, ends});
    add_in_group(trace.by_trace, &sum, &counters->decided_by_trace);
    add_in_group(trace.by_exact, &sum, &counters->decided_by_exact);
    // In two words, so that neither sum overflows.
    uint low = sum_of_group((uint)trace.tests & 0xFFFFu, &sum), high = sum_of_group((uint)(trace.tests >> 16), &sum);
    count_tests((low + ((ulong)high << 16)) * GN_LANES, counters);
    GN_END_SHARES;
}
