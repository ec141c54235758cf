// SPDX-License-Identifier: MIT
// The trace under a prepared light, of all points. It decides facing on the way (prepared_facing.clh), since reading
// points and writing visibility take most of such a run and are then done once. Two variants are for some points only:
//     PREPARED_PLANE_SIDE     GPU, lifted points: a point whose receiver's plane leaves its facing undecided becomes a
//                             fallback point, for which the variant without defines has to run
//     PREPARED_CACHED_FACING  CPU, directional light, points that cannot shadow themselves, each coordinate in a row of
//                             its own: the map may decide whole blocks, and the facing of the other points' receivers
//                             is read from a cache (receivers/facing_cache.clh)
#define TRACE_IN_PLACE 0
#define TRACE_KEPT_LISTS
#ifdef PREPARED_CACHED_FACING
#define TRACE_RECORDS_BY_ID
#define TRACE_KERNEL prepared_trace_cached_facing
#define TRACE_TABLE FacingCache
#define TRACE_MORE_OF_POINTS               \
    __global const PreparedDomain* domain; \
    FacingCache cache;
#define TRACE_MORE_VALUES , prepared_domains_of(params.tables, ranges), table
#else
#ifdef PREPARED_PLANE_SIDE
#define TRACE_KERNEL prepared_trace_plane_side
#else
#define TRACE_KERNEL prepared_trace
#endif
#define TRACE_TABLE __global const uint*
#define TRACE_MORE_OF_POINTS PreparedReceivers prepared;
#define TRACE_MORE_VALUES , prepared_receivers(&params, ranges, vertices)
#endif
// Outside of conditions: the host pastes a header where it first finds its name.
#include "prepared/prepared_facing.clh"
#include "receivers/facing_cache.clh"
#include "trace/walk_cpu.clh"
#include "trace/walk_gpu.clh"

#ifdef PREPARED_CACHED_FACING

// The coordinates in the order of the frame's axes.
typedef struct CoordinateRows {
    __global const float *x, *y, *z;
} CoordinateRows;

static CoordinateRows rows_in_order(const TracePoints* of, LightFrame light_frame) {
    __global const float* first = of->positions + of->layout.first;
    size_t stride = of->layout.coordinate_stride;
    return (CoordinateRows){first + stride * light_frame.axis_x, first + stride * light_frame.axis_y,
                            first + stride * light_frame.axis_z};
}

static PointBlock load_rows(CoordinateRows rows, BlockPlace place) {
    return (PointBlock){load_strided(rows.x, 1u, place), load_strided(rows.y, 1u, place),
                        load_strided(rows.z, 1u, place)};
}

// The map decides whole blocks first: the points that it hides are in shadow for either facing, so that their receivers
// need not be loaded. This part uses coordinates in the order of the frame's axes: choosing them block by block takes
// longer than loading some of them once more.
GN_NOINLINE_ON_CPU void trace_blocks(ItemRange items, LightFrame light_frame, TraceFrames frames, TraceLists lists,
                                     ExactPairs pairs, TracePoints to, TraceCounts* total) {
    PointsLayout layout = to.layout;
    BlockGrid grid = block_grid(light_frame, frames.projections, 0u);
    bool sees_map = frames.has_map && map_is_enabled(frames.projections);
    PreparedDomain domain = domain_in_order(to.domain, light_frame);
    float4 light = light_of(light_frame);
    CoordinateRows rows = rows_in_order(&to, light_frame);
    TraceCounts counts = *total;
    GN_FOR_EACH_OF(block, items) {
        BlockPlace place = place_of_block(layout, block);
        PointBlock at = load_rows(rows, place);
        LaneInt valid = valid_lanes(layout, block), left = valid & present_lanes(at);
        counts.minus_absent += valid & ~left;
        if (!LANES_ANY(left)) {
            store_at((LaneFloat)(1.0f), to.visibility, place);
            continue;
        }
        PointBlock values = {at.x - light_frame.shear_x * at.z, at.y - light_frame.shear_y * at.z, at.z};
        BlockBounds bounds = bounds_of_block(light_frame, values, left);
        bool is_inside =
            block_stays_open(&domain, light_frame, &bounds) || !LANES_ANY(left & ~lanes_stay_open(&domain, at, values));
        uint coverage = MAP_MAY_HIDE;
        if (sees_map && is_inside) coverage = map_hides(&grid, frames.projections, &bounds, frames.map);
        if (coverage == MAP_HIDES_ALL) {
            counts.minus_by_map += left;
            store_at(LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), left), to.visibility, place);
            continue;
        }
        LaneInt ids = LANES_AS_INT(load_strided((__global const float*)to.receivers, 1u, place));
        LaneInt away =
            cached_backfacing(to.cache, pairs.triangles.vertices, ids, left & lanes_below(ids, pairs.triangles.count),
                              pairs.triangles.count, layout, light, &counts.facing_exact);
        counts.minus_away += away;
        left &= ~away;
        LaneFloat state = visibility_of_lanes(away, left);
        if (!LANES_ANY(left)) {
            store_at(state, to.visibility, place);
            continue;
        }
        BlockPoints points = load_points(to.positions, to.receivers, layout, block);
        if (!is_inside) {
            LaneInt fallback_points, open = prepared_lanes(light_frame, to.domain, points.at, left, &fallback_points);
            counts.minus_fallback_points += fallback_points;
            state = LANES_SELECT(state, (LaneFloat)(1.0f), left & ~open & ~fallback_points);
            left = open;
        }
        BlockResult result = empty_result();
        counts.tests += trace_block(&pairs, &frames, lists, sees_map && coverage != MAP_HIDES_NONE, (LaneInt)(0), left,
                                    state, &points, &result);
        finish_block(&pairs, &points, left, state, &result, to.visibility, &counts);
    }
    *total = counts;
}

#else

static LaneFloat state_of_points(const PreparedFacing* facing) {
    LaneFloat state = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), facing->away);
    state = LANES_SELECT(state, (LaneFloat)(VISIBILITY_OPEN), facing->open);
    return LANES_SELECT(state, (LaneFloat)(VISIBILITY_MAY_SELF_SHADOW), facing->open & facing->may_self_shadow);
}

static void count_facing(const PreparedFacing* facing, TraceCounts* counts) {
    counts->minus_absent += facing->absent;
    counts->minus_away += facing->away;
    counts->minus_fallback_points += facing->fallback_points;
}

#if GN_LANES > 1

GN_NOINLINE_ON_CPU void trace_blocks(ItemRange items, LightFrame light_frame, TraceFrames frames, TraceLists lists,
                                     ExactPairs pairs, TracePoints to, TraceCounts* total) {
    PointsLayout layout = to.layout;
    TraceCounts counts = *total;
    GN_FOR_EACH_OF(block, items) {
        BlockPoints points = load_points(to.positions, to.receivers, layout, block);
        PreparedFacing facing =
            face_points(&to.prepared, light_frame, layout, block, &points.at, points.receivers, &counts.facing_exact);
        count_facing(&facing, &counts);
        LaneFloat state = state_of_points(&facing);
        if (!LANES_ANY(facing.open)) {
            store_lanes(state, to.visibility, layout, block);
            continue;
        }
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
        LaneInt left = facing.open & lanes_in_frames(&frames, lane_frames);
        BlockResult result = empty_result();
        counts.tests +=
            trace_block(&pairs, &frames, lists, frames.has_map != 0u, lane_frames, left, state, &points, &result);
        finish_block(&pairs, &points, left, state, &result, to.visibility, &counts);
    }
    *total = counts;
}

#else

static uint receiver_slot(const TracePoints* to, size_t point) {
    if (!to->layout.has_receivers) return GN_NO_ID;
    uint id = to->receivers[point];
    return id < to->prepared.triangles.count ? to->prepared.slots[id] : GN_NO_ID;
}

// Then the point need not be queued: its own receiver cannot block it.
static bool list_holds_only_receiver(const TracePoints* to, TraceLists lists, uint2 range, size_t point) {
    return range.y - range.x == 1u && ENTRY_SLOT(&lists.entries[range.x], 0) == receiver_slot(to, point);
}

// A point that is loaded while the previous point is tested.
typedef struct PointAhead {
    PointBlock at;
    LaneInt receiver;
} PointAhead;

static PointAhead load_ahead(const TracePoints* of, size_t point) {
    PointAhead ahead = {load_block(of->positions, of->layout, point), (LaneInt)((int)GN_NO_ID)};
    if (of->layout.has_receivers) ahead.receiver = load_lane_ids(of->receivers, of->layout, point);
    return ahead;
}

static void queue_walks(ItemRange items, LightFrame light_frame, TraceFrames frames, TraceLists lists, ExactPairs pairs,
                        TracePoints to, TraceCounts* total, const WalkQueue* queue) {
    PointsLayout layout = to.layout;
    TraceCounts counts = *total;
    PointAhead ahead = load_ahead(&to, min(items.first, items.end - 1));
    GN_FOR_EACH_OF(point, items) {
        PointAhead loaded = ahead;
        ahead = load_ahead(&to, min(point + items.step, items.end - 1));
        BlockPoints points = {loaded.at, layout, point};
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
        PreparedFacing facing =
            face_points(&to.prepared, light_frame, layout, point, &points.at, loaded.receiver, &counts.facing_exact);
        count_facing(&facing, &counts);
        LaneFloat state = state_of_points(&facing);
        if (!LANES_ANY(facing.open)) {
            store_lanes(state, to.visibility, layout, point);
            continue;
        }
        PointLookUp found = look_up(&frames, lists, lane_frames, points.at);
        LaneInt left = facing.open & lanes_in_frames(&frames, lane_frames);
        BlockResult result = empty_result();
        if (apply_map(&found, left, state, &result) && !list_holds_only_receiver(&to, lists, found.range, point)) {
            queue_point(queue, point, state, &result);
            continue;
        }
        finish_block(&pairs, &points, left, state, &result, to.visibility, &counts);
    }
    *total = counts;
}

#endif
#endif

#include "trace/trace_kernel.clh"
