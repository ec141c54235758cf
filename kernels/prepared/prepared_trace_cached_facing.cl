// SPDX-License-Identifier: MIT
// As prepared_trace.cl, for points on a CPU under a direction, none of them doubtful, each coordinate in a row of its
// own: the map may settle blocks of points at once, and which way the others' receivers face is looked up
// (receiver_answers.h).
#define TRACE_KERNEL prepared_trace_cached_facing
#define TRACE_IN_PLACE 0
#define TRACE_MORE_PARAMETERS , uint triangle_count, __global const PreparedDomain *domains, FacingCache answers
#define TRACE_MORE_OF_POINTS               \
    __global const PreparedDomain* domain; \
    FacingCache answers;                   \
    uint triangle_count;
#define TRACE_MORE_VALUES , domains, answers, triangle_count
#include "prepared/prepared_light.h"
#include "receivers/facing_cache.clh"
#include "trace/trace_blocks.clh"

// The coordinates in the order of the frame's axes.
typedef struct CoordinateRows {
    __global const float *x, *y, *z;
} CoordinateRows;

static CoordinateRows rows_in_order(const TracePoints* of, LightFrame light_frame) {
    __global const float* first = of->positions + of->layout.first;
    size_t stride = of->layout.coordinate_stride;
    CoordinateRows rows = {first + stride * light_frame.axis_x, first + stride * light_frame.axis_y,
                           first + stride * light_frame.axis_z};
    return rows;
}

static PointBlock load_rows(CoordinateRows rows, BlockPlace place) {
    PointBlock points = {load_strided(rows.x, 1u, place), load_strided(rows.y, 1u, place),
                         load_strided(rows.z, 1u, place)};
    return points;
}

// Whole blocks by the map first: what it hides is dark whichever way it faces, so that its receivers need not be
// loaded. Up to there coordinates are in the order of the frame's axes: to choose them block by block takes longer than
// to load some of them once more.
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
        uint map_says = MAP_MAY_HIDE;
        if (sees_map && is_inside) map_says = map_hides(&grid, frames.projections, &bounds, frames.map);
        if (map_says == MAP_HIDES_ALL) {
            counts.minus_by_map += left;
            store_at(LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), left), to.visibility, place);
            continue;
        }
        LaneInt ids = LANES_AS_INT(load_strided((__global const float*)to.receivers, 1u, place));
        LaneInt away = cached_backfacing(to.answers, pairs.vertices, ids, left & lanes_below(ids, to.triangle_count),
                                         to.triangle_count, layout, light, &counts.facing_exact);
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
        BlockAnswer answer = no_answer();
        counts.tests += trace_block(&pairs, &frames, lists, sees_map && map_says != MAP_HIDES_NONE, (LaneInt)(0), left,
                                    state, &points, &answer);
        finish_block(&pairs, &points, left, state, &answer, to.visibility, &counts);
    }
    *total = counts;
}

#include "trace/trace_kernel.clh"
