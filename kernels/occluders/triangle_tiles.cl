// SPDX-License-Identifier: MIT
// Triangle tiles, the second pass of the triangle setup. Takes the triangles that triangle_bounds listed, or (for the
// conservative map) its candidates alone: the map is drawn first, and then hides many of the other triangles. Drops the
// triangles below the pyramid, makes the records of the rest, drops triangles that are exactly edge-on to the rays (by
// contract they never block), and cuts the bins of each triangle into tiles. Later stages walk tiles, not triangles:
// all tiles are of about the same size.
//
// A CPU's work-item takes its triangles in their order and appends the tiles that survive the cull, or with
// `count_rows` the pairs that their bins make. A GPU's work-group shares out the tiles of its triangles evenly, since
// one triangle may have thousands; the stages that walk the list cull its tiles (tile_bins.clh).
#include "occluders/eye_records.clh"
#include "occluders/tile_bins.clh"

// A GPU has a separate program for cameras (GN_EYE_RECORDS), so that neither kind of record takes the other's
// registers. A CPU has one program for both, which starts sooner.
#if defined(GN_EYE_RECORDS)
#define IS_CAMERA(params) 1
#elif defined(GN_CPU)
#define IS_CAMERA(params) ((params).samples_per_pixel != 0u)
#else
#define IS_CAMERA(params) 0
#endif

typedef struct TileWork {
    TriangleSetupParams params;
    __constant const Projection* projection;
    Triangles triangles;
    __global const uint* selection;  // with for_map: slots of the map's candidates; else with has_numbers: numbers
    __global const uint* pyramid;
    __global TriangleBounds* bounds;
    __global TriangleRecord* records;
    __global uint2* tiles;
    __global uint* tiles_wanted;
    uint hidden, edge_on, exact;
#ifdef GN_CPU
    Reservation slots;  // in `tiles`
    PairList pairs;     // with `count_rows`, in place of tiles
#endif
} TileWork;

// ---- Records --------------------------------------------------------------------------------------------------------

// Up to GN_LANES triangles that survived the cull, and their bins.
typedef struct RecordBatch {
    uint count;
    uint slots[GN_LANES], ids[GN_LANES];  // as triangle_bounds left them
    BinRectangles bins;
} RecordBatch;

// The triangles among GN_LANES neighbours in the list that survive the cull, and their bins.
typedef struct SurvivingLanes {
    LaneInt slots, lanes;
    BinRectangles bins;
} SurvivingLanes;

// Culls the triangles from the i-th on against the pyramid. Triangles dropped from the list of bounds get empty bounds.
static SurvivingLanes cull_batch(TileWork* work, uint i, uint count) {
    SurvivingLanes found;
    found.lanes = LANE_COMPARE((LaneInt)((int)min(count - i, (uint)GN_LANES)), >, LANE_INDEX);
    found.slots = LANES_SELECT((LaneInt)(0), LANE_INDEX, found.lanes) + (LaneInt)((int)i);
    __global const float* rows[GN_LANES];
    if (work->params.for_map) {
        for (int lane = 0; lane < GN_LANES; ++lane)
            rows[lane] = (__global const float*)&work->selection[(uint)LANE_OF_INT(found.slots, lane)];
        found.slots = LANES_AS_INT(LANES_OF_ROWS(rows, 0));
        found.lanes &= LANE_COMPARE(found.slots, !=, (LaneInt)((int)GN_NO_ID));
        found.slots = LANES_SELECT((LaneInt)(0), found.slots, found.lanes);
    }
    for (int lane = 0; lane < GN_LANES; ++lane)
        rows[lane] = (__global const float*)&work->bounds[(uint)LANE_OF_INT(found.slots, lane)];
    LaneInt low = LANES_AS_INT(LANES_OF_ROWS(rows, 0)), high = LANES_AS_INT(LANES_OF_ROWS(rows, 1));
    LaneInt x0 = low & 0xFFFF, y0 = low >> 16 & 0xFFFF, x1 = high & 0xFFFF, y1 = high >> 16 & 0xFFFF;
    found.lanes &= LANE_COMPARE(x0, <=, x1);
    if (!LANES_ANY(found.lanes)) return found;
    __constant const Projection* projection = work->projection;
    uint bin_log2 = projection->bin_log2;
    found.bins.x0 = bins_of_quantised(max(x0, 1) - 1, projection->width, bin_log2);
    found.bins.y0 = bins_of_quantised(max(y0, 1) - 1, projection->height, bin_log2);
    found.bins.x1 = bins_of_quantised(x1, projection->width, bin_log2);
    found.bins.y1 = bins_of_quantised(y1, projection->height, bin_log2);
    if (!work->params.has_pyramid) return found;
    LaneFloat lowest = lanes_lowest_height_under(work->pyramid, projection, found.bins);
    LaneInt z = LANES_AS_INT(LANES_OF_ROWS(rows, 2)) & 0xFFFF;
    LaneInt hidden = LANE_COMPARE(z, <, quantised((lowest - projection->z_origin) * projection->z_scale)) |
                     LANE_COMPARE(lowest, ==, (LaneFloat)(INFINITY));
    hidden &= found.lanes;
    if (!LANES_ANY(hidden)) return found;
    work->hidden += count_lanes(hidden);
    found.lanes &= ~hidden;
    if (work->params.for_map) return found;
    for (int lane = 0; lane < GN_LANES; ++lane)
        if (LANE_OF_INT(hidden, lane)) drop_bounds(&work->bounds[(uint)LANE_OF_INT(found.slots, lane)]);
    return found;
}

static uint4 lane_bins(const BinRectangles* bins, uint lane) {
    return (uint4)((uint)LANE_OF_INT(bins->x0, lane), (uint)LANE_OF_INT(bins->y0, lane),
                   (uint)LANE_OF_INT(bins->x1, lane), (uint)LANE_OF_INT(bins->y1, lane));
}
static void set_lane_bins(BinRectangles* bins, uint lane, uint4 of) {
    LANE_OF_INT(bins->x0, lane) = (int)of.x, LANE_OF_INT(bins->y0, lane) = (int)of.y;
    LANE_OF_INT(bins->x1, lane) = (int)of.z, LANE_OF_INT(bins->y1, lane) = (int)of.w;
}

static void add_to_batch(const TileWork* work, const SurvivingLanes* found, int lane, RecordBatch* batch) {
    uint slot = (uint)LANE_OF_INT(found->slots, lane);
    batch->slots[batch->count] = slot;
    batch->ids[batch->count] = work->bounds[slot].id;
    __global const float* vertices = work->triangles.vertices + 9 * (size_t)batch->ids[batch->count];
    GN_PREFETCH(vertices);
    GN_PREFETCH(vertices + 8);
    set_lane_bins(&batch->bins, batch->count, lane_bins(&found->bins, lane));
    ++batch->count;
}

// Makes the records of a batch that is not empty; returns the triangles to keep. The others are exactly edge-on.
static LaneInt make_batch_records(TileWork* work, RecordBatch* batch, RecordBlock* records) {
    __global const float* rows[GN_LANES];
    for (uint lane = 0; lane < GN_LANES; ++lane) {
        uint one = min(lane, batch->count - 1u);
        rows[lane] = work->triangles.vertices + 9 * (size_t)batch->ids[one];
        if (lane != one) set_lane_bins(&batch->bins, lane, lane_bins(&batch->bins, one));
    }
    TriangleBlock t = load_triangle_rows(rows);
    LaneInt lanes = LANE_COMPARE((LaneInt)((int)batch->count), >, LANE_INDEX);
    LaneInt kept = IS_CAMERA(work->params)
                       ? make_eye_records(&t, lanes, work->projection, work->params.picture, records, &work->exact)
                       : make_records(&t, lanes, work->projection, &batch->bins, records, &work->exact);
    LaneInt dropped = lanes & ~kept;
    if (!LANES_ANY(dropped)) return kept;
    work->edge_on += count_lanes(dropped);
    for (uint lane = 0; lane < batch->count; ++lane)
        if (LANE_OF_INT(dropped, lane)) drop_bounds(&work->bounds[batch->slots[lane]]);
    return kept;
}

// Stores the records to keep; returns the triangles that need tiles.
static LaneInt store_batch(const TileWork* work, const RecordBatch* batch, const RecordBlock* records, LaneInt kept) {
    store_records(records, kept, batch->slots, work->records);
    if (work->params.for_map) return kept & LANE_COMPARE(records->margin_plane, <, (LaneFloat)(INFINITY));
    if (!work->params.has_numbers) return kept;
    for (uint lane = 0; lane < batch->count; ++lane)
        if (LANE_OF_INT(kept, lane)) work->bounds[batch->slots[lane]].id = work->selection[batch->ids[lane]];
    return kept;
}

// ---- Tiles on a CPU -------------------------------------------------------------------------------------------------

#ifdef GN_CPU
static void append_tile(TileWork* work, uint slot, uint tile) {
    uint at = reservation(&work->slots, work->tiles_wanted);
    if (at < work->params.tile_capacity) work->tiles[at] = (uint2)(slot, tile);
}

// Appends the tiles of a triangle that survive the cull; with `count_rows`, their pairs.
static void append_surviving_tiles(TileWork* work, uint slot, uint4 bins) {
    TriangleRecord record = work->records[slot];
    RecordBlock in_lanes;
    if (work->params.count_rows) spread_record(&work->records[slot], &in_lanes);
    uint tile_count = tile_count_of(bins);
    for (uint i = 0; i < tile_count; ++i) {
        uint tile = tile_of_bins(bins, i);
        uint4 bins_of = bins_of_tile(tile);
        if (tile_count > 1u &&
            !survives_cull(&record, work->projection, bins_of, work->params.has_pyramid, work->pyramid))
            continue;
        if (work->params.count_rows)
            append_bins(&work->pairs, slot, &in_lanes, bins_of);
        else
            append_tile(work, slot, tile);
    }
}

// Most triangles are in four bins at most: 2 x 2 bins of GN_LANES triangles are culled at once, while their records are
// in registers, and no tile is made. Returns the triangles that were that small.
static LaneInt append_small_triangles(TileWork* work, const RecordBatch* batch, const RecordBlock* records,
                                      LaneInt kept) {
    const BinRectangles* bins = &batch->bins;
    LaneInt slots = LANES_AS_INT(LANES_STRIDED((const float*)batch->slots, 1));
    LaneInt small = kept & LANE_COMPARE((bins->x1 - bins->x0) | (bins->y1 - bins->y0), <=, (LaneInt)(1));
    for (int corner = 0; corner < 4; ++corner) {
        LaneInt right = bins->x0 + (corner & 1), down = bins->y0 + (corner >> 1);
        LaneInt x = min(right, bins->x1), y = min(down, bins->y1);
        LaneInt lanes = small & LANE_COMPARE(x, ==, right) & LANE_COMPARE(y, ==, down);
        if (!LANES_ANY(lanes)) continue;
        lanes &= lanes_survive_cull(records, work->projection, x, y, work->params.has_pyramid, work->pyramid);
        append_lanes(&work->pairs, slots, x, y, lanes);
    }
    return small;
}

// Appends the pairs of the triangles that are in few tiles; returns these triangles.
#define TILES_PAIRED_AT_ONCE 4u
static LaneInt append_batch_pairs(TileWork* work, const RecordBatch* batch, const RecordBlock* records, LaneInt kept) {
    LaneInt listed = append_small_triangles(work, batch, records, kept), others = kept & ~listed;
    if (!LANES_ANY(others)) return listed;
    for (uint lane = 0; lane < batch->count; ++lane) {
        if (!LANE_OF_INT(others, lane)) continue;
        uint4 bins = lane_bins(&batch->bins, lane);
        uint tile_count = tile_count_of(bins);
        if (tile_count > TILES_PAIRED_AT_ONCE) continue;
        RecordBlock record;
        spread_lane(records, lane, &record);
        for (uint tile = 0; tile < tile_count; ++tile)
            append_bins(&work->pairs, batch->slots[lane], &record, bins_of_tile(tile_of_bins(bins, tile)));
        LANE_OF_INT(listed, lane) = -1;
    }
    return listed;
}

// Appends the pairs or tiles of all triangles of the batch, and empties it.
GN_NOINLINE_ON_CPU void append_batch(TileWork* work, RecordBatch* batch) {
    RecordBlock records;
    LaneInt kept = make_batch_records(work, batch, &records), listed = (LaneInt)(0);
    // Before the records are stored: an atomic of a CPU waits for all stores before it.
    if (work->params.count_rows) listed = append_batch_pairs(work, batch, &records, kept);
    LaneInt wanted = store_batch(work, batch, &records, kept) & ~listed;
    if (!LANES_ANY(wanted)) batch->count = 0;
    for (uint lane = 0; lane < batch->count; ++lane) {
        if (!LANE_OF_INT(wanted, lane)) continue;
        append_surviving_tiles(work, batch->slots[lane], lane_bins(&batch->bins, lane));
    }
    batch->count = 0;
}

GN_NOINLINE_ON_CPU void clear_row(__global uint* counts, uint count) {
    for (uint i = 0; i < count; ++i) counts[i] = 0u;
}

// The item's list of pairs. Where each item has a row of counts, it clears its own (and so all rows are cleared).
GN_INLINE PairList started_pairs(TriangleSetupParams params, __constant const Projection* projection,
                                 __global const uint* pyramid, __global uint* bin_counts, __global Pair* pairs,
                                 __global FrameCounters* counters) {
    uint bin_count = projection->bins_x * projection->bins_y, item = (uint)get_global_id(0);
    bool shares_row = params.count_rows < get_global_size(0);
    PairList list = {projection,
                     pyramid,
                     bin_counts,
                     pairs,
                     &counters->pairs,
                     params.has_pyramid,
                     params.pair_capacity,
                     shares_row ? 0u : item * bin_count,
                     shares_row};
    for (uint row = item; !shares_row && row < params.count_rows; row += (uint)get_global_size(0))
        clear_row(bin_counts + (size_t)row * bin_count, bin_count);
    return list;
}

GN_NOINLINE_ON_CPU void append_tiles(ItemRange items, TileWork* work, uint count) {
    RecordBatch batch;
    batch.count = 0;
    GN_FOR_EACH_OF(block, items) {
        SurvivingLanes found = cull_batch(work, (uint)block * GN_LANES, count);
        if (!LANES_ANY(found.lanes)) continue;
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(found.lanes, lane)) continue;
            add_to_batch(work, &found, lane, &batch);
            if (batch.count == GN_LANES) append_batch(work, &batch);
        }
    }
    if (batch.count != 0u) append_batch(work, &batch);
    for (; work->slots.next < min(work->slots.end, work->params.tile_capacity); ++work->slots.next)
        work->tiles[work->slots.next] = (uint2)(GN_NO_ID, 0);
    close_pairs(&work->pairs);
}
#endif

// `selection`: with for_map the slots of the map's candidates; else, with has_numbers, the triangles' numbers. Local
// memory: bins, tile counts and slots of the group's triangles, 16 + 4 + 4 bytes for each item.
__kernel void triangle_tiles(TriangleSetupParams params, __constant const Projection* projection,
                             __global const float* vertices, __global const uint* selection,
                             __global const uint* pyramid, __global TriangleBounds* bounds,
                             __global TriangleRecord* records, __global uint2* tiles, __global uint* bin_counts,
                             __global Pair* pairs, __global FrameCounters* counters, __local uint4* ranges GN_SHARES) {
    __local uint sum;
    Triangles triangles = triangles_of(vertices, params.triangles);
    TileWork work = {params, projection, triangles, selection, pyramid, bounds, records, tiles};
    work.tiles_wanted = params.for_map ? &counters->map_tiles : &counters->tiles;
    uint count = min(params.for_map ? counters->map_slots : counters->slots, params.capacity);
    if (params.for_map && projection->map_disabled) count = 0;
#ifdef GN_CPU
    work.pairs = started_pairs(params, projection, pyramid, bin_counts, pairs, counters);
    append_tiles(GN_SHARED_RANGE((count + GN_LANES - 1u) / GN_LANES), &work, count);
    add_in_group(work.pairs.found, &sum, &counters->references);
#else
    __local uint reserved[GROUP_APPEND_WORDS];
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    __local uint* ends = (__local uint*)(ranges + items);
    __local uint* slots = ends + items;
    GN_ROUNDS(round, count) {
        uint i = index_in_round(round, count), tile_count = 0;
        RecordBatch batch;
        batch.count = 0;
        if (i < count) {
            SurvivingLanes found = cull_batch(&work, i, count);
            if (found.lanes) add_to_batch(&work, &found, 0, &batch);
        }
        RecordBlock block;
        LaneInt kept = batch.count == 0u ? 0 : make_batch_records(&work, &batch, &block);
        if (kept && store_batch(&work, &batch, &block, kept)) {
            slots[item] = batch.slots[0];
            ranges[item] = lane_bins(&batch.bins, 0);
            tile_count = tile_count_of(ranges[item]);
        }
        scan_group(tile_count, ends);
        uint total = ends[items - 1u], end;
        for (uint first = 0; first < total; first = end) {
            end = min(total, first + items * LARGEST_GROUP_APPEND);
            uint first_slot = reserve_for_group(end - first, reserved, work.tiles_wanted);
            for (uint k = first + item; k < end; k += items) {
                uint at = first_slot + (k - first), owner = item_of_piece(ends, k);
                if (at >= params.tile_capacity) break;
                uint tile = tile_of_bins(ranges[owner], piece_of_item(ends, owner, k));
                tiles[at] = (uint2)(slots[owner], tile);
            }
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
#endif
    add_in_group(work.edge_on, &sum, &counters->edge_on);
    add_in_group(work.exact, &sum, &counters->setup_exact);
    add_in_group(work.hidden, &sum, params.for_map ? &counters->map_hidden : &counters->hidden);
    GN_END_SHARES;
}
