// SPDX-License-Identifier: MIT
// Settle: footprints against the map and their bins' triangles. The trace (trace_points.h), asked of a region instead
// of a point: one triangle that blocks all of it settles it as shadow; if all triangles miss all of it, it is lit;
// anything else is mixed, and its samples are traced one by one.
//
// An edge function e (and the plane's height above the receiver) is linear, so over a footprint it lies within
//     e(C) +- ext,    ext = |e . u| + |e . v| + |e_x| slack_x + |e_y| slack_y.
// Every sample's place is in the footprint; what the filter's table (numerics.md, 4) says of a place with e beyond
// margin + ext at the centre holds for each of them, as long as the place is in the triangle's bins. Where it is not,
// the ray misses: enough for "misses", and for "blocks" the whole footprint must lie in the triangle's rectangle. The
// rounding of e(C) is in the margin, but for what the centre may lie outside the bins, 4u |e| reach; that of ext is
// below 8u of its terms: 16u |e| reach is added for both.
//
// The lists are complete for a sample that is not below its texel of the map, since every bin that a footprint touches
// knows the height of its lowest place (farthest_height). One that is below its texel is in the shadow of the triangle
// that covers the texel; and that one is listed, since its height there is above the bin's open height, which is at
// most the texel's. So it may be missed by nothing, and no footprint with such a sample is found to be lit.
#include "bin_lists.h"
#include "footprint.h"
#include "triangle_setup.h"

typedef struct SettleLists {
    __global const uint2* ranges;
    __global const BinEntries* entries;
    __global const TriangleRecord* records;
    __global const TriangleBounds* bounds;  // of the records
} SettleLists;

// What is known of a block's footprints.
typedef struct SettleAnswer {
    LaneInt shadowed;
    LaneInt doubted;  // cannot be lit as a whole
} SettleAnswer;

static LaneFloat extent_over(float slope_x, float slope_y, const GridFootprint* grid) {
    return fabs(slope_x * grid->u.x + slope_y * grid->u.y) + fabs(slope_x * grid->v.x + slope_y * grid->v.y) +
           (fabs(slope_x) * (grid->slack.x + (16.0f * GN_U) * grid->reach.x) +
            fabs(slope_y) * (grid->slack.y + (16.0f * GN_U) * grid->reach.y));
}

// Do all places lie in the rectangle in which the record is valid?
static bool in_rectangle(TriangleBounds bounds, __constant const Projection* projection, const GridFootprint* grid,
                         int lane) {
    float x = LANE_OF_FLOAT(grid->centre.x, lane), y = LANE_OF_FLOAT(grid->centre.y, lane);
    float reach_x = LANE_OF_FLOAT(grid->reach.x, lane), reach_y = LANE_OF_FLOAT(grid->reach.y, lane);
    return bounds.x0 <= quantised_texel(x - reach_x, projection->width) &&
           quantised_texel(x + reach_x, projection->width) <= bounds.x1 &&
           bounds.y0 <= quantised_texel(y - reach_y, projection->height) &&
           quantised_texel(y + reach_y, projection->height) <= bounds.y1;
}

// The filter of trace.h for footprints: those that the triangle may block in part, and those that it blocks as a whole,
// where they lie in its rectangle.
typedef struct FootprintFilter {
    LaneInt possible, certain;
} FootprintFilter;

static FootprintFilter filter_footprints(__global const TriangleRecord* r, const GridFootprint* grid, LaneInt lanes) {
    LaneFloat x = grid->centre.x, y = grid->centre.y, z = grid->centre.z;
    LaneFloat margin = (LaneFloat)(r->margin_edge);
    FootprintFilter found;
    found.possible = found.certain = lanes;
    for (int i = 0; i < 3; ++i) {
        LaneFloat e = lanes_linear(r->edge_x[i], r->edge_y[i], r->edge_0[i], x, y);
        LaneFloat far = margin + FOOTPRINT_SLACK * extent_over(r->edge_x[i], r->edge_y[i], grid);
        found.possible &= ~LANE_COMPARE(e, <, -far);
        found.certain &= LANE_COMPARE(e, >, far);
    }
    if (!LANES_ANY(found.possible)) return found;
    // height > 0: the plane is nearer to the light than the centre.
    LaneFloat height = lanes_linear(r->plane_x, r->plane_y, r->plane_0, x, y) - z;
    LaneFloat extent = fabs(r->plane_x * grid->u.x + r->plane_y * grid->u.y - grid->u.z) +
                       fabs(r->plane_x * grid->v.x + r->plane_y * grid->v.y - grid->v.z) +
                       (fabs(r->plane_x) * (grid->slack.x + (16.0f * GN_U) * grid->reach.x) +
                        fabs(r->plane_y) * (grid->slack.y + (16.0f * GN_U) * grid->reach.y) +
                        (grid->slack.z + (16.0f * GN_U) * grid->reach.z));
    LaneFloat far = r->margin_plane + FOOTPRINT_SLACK * extent + (4.0f * GN_U) * fabs(height);
    found.possible &= ~LANE_COMPARE(height, <, -far) & ~LANE_COMPARE(z - grid->reach.z, >, (LaneFloat)(r->z_high));
    found.certain &=
        found.possible & (LANE_COMPARE(height, >, far) | LANE_COMPARE(z + grid->reach.z, <, (LaneFloat)(r->z_low)));
    return found;
}

// The square and the least height that the footprints of some lanes span.
static QuantisedBlock quantised_footprints(__constant const Projection* projection, const GridFootprint* grid,
                                           LaneInt lanes) {
    const float most = 65535.0f;
    float x_units = texel_units(projection->width), y_units = texel_units(projection->height);
    LaneFloat z = grid->centre.z - grid->reach.z;
    LaneInt x0 = LANES_TO_INT(clamp((grid->centre.x - grid->reach.x) * x_units, 0.0f, most));
    LaneInt y0 = LANES_TO_INT(clamp((grid->centre.y - grid->reach.y) * y_units, 0.0f, most));
    LaneInt x1 = LANES_TO_INT(clamp((grid->centre.x + grid->reach.x) * x_units, 0.0f, most));
    LaneInt y1 = LANES_TO_INT(clamp((grid->centre.y + grid->reach.y) * y_units, 0.0f, most));
    LaneInt lowest = LANES_TO_INT(clamp((z - projection->z_origin) * projection->z_scale, 0.0f, most));
    return block_of_lanes(x0, y0, x1, y1, lowest, lanes);
}

// One bin's list for some footprints that touch it.
static void walk_footprints(SettleLists lists, __constant const Projection* projection, uint bin, LaneInt lanes,
                            const GridFootprint* grid, LaneInt receivers, SettleAnswer* answer) {
    QuantisedBlock block = quantised_footprints(projection, grid, lanes);
    uint2 range = lists.ranges[bin];
    for (uint i = range.x; i < range.y; ++i) {
        uint meeting = entries_that_meet(&lists.entries[i], block);
        while (meeting != 0u) {
            uint slot = ENTRY_SLOT(&lists.entries[i], take_lowest_bit(&meeting));
            FootprintFilter found = filter_footprints(&lists.records[slot], grid, lanes);
            if (!LANES_ANY(found.possible)) continue;
            TriangleBounds bounds = lists.bounds[slot];
            // A receiver shadows none of its own samples.
            LaneInt possible = found.possible & LANE_COMPARE(receivers, !=, (LaneInt)((int)bounds.id));
            LaneInt blocked = (LaneInt)(0);
            if (LANES_ANY(found.certain & possible))
                for (int lane = 0; lane < GN_LANES; ++lane)
                    if (LANE_OF_INT(found.certain, lane) && LANE_OF_INT(possible, lane) &&
                        in_rectangle(bounds, projection, grid, lane))
                        LANE_OF_INT(blocked, lane) = -1;
            answer->shadowed |= blocked;
            answer->doubted |= possible;
            lanes &= ~blocked;
            if (!LANES_ANY(lanes)) return;
        }
    }
}

// Footprints below all texels of the map that they touch.
static LaneInt footprints_below_map(__constant const Projection* projection, const GridFootprint* grid, LaneInt lanes,
                                    __global const uint* map) {
    CellSpan texels = footprint_cells(projection, grid, 0);
    lanes &= small_spans(&texels);
    LaneInt highest = lanes_in_order(grid->centre.z + grid->reach.z);
    for (int lane = 0; lane < GN_LANES; ++lane) {
        if (!LANE_OF_INT(lanes, lane)) continue;
        int least = INT_MAX;
        for (int y = LANE_OF_INT(texels.y0, lane); y <= LANE_OF_INT(texels.y1, lane); ++y)
            for (int x = LANE_OF_INT(texels.x0, lane); x <= LANE_OF_INT(texels.x1, lane); ++x)
                least = min(least, key_to_order(map[(size_t)y * projection->width + x]));
        if (LANE_OF_INT(highest, lane) >= least) LANE_OF_INT(lanes, lane) = 0;
    }
    return lanes;
}

// Footprints of the frames from `first_frame` on, as trace() takes points. Those that are open become 0, 1 or
// VISIBILITY_MIXED.
__kernel void settle(LightFrame light_frame, uint first_frame, uint frame_count, PointsLayout layout,
                     __constant const Projection* projections, uint has_map, __global const float* positions,
                     __global const float* footprints, __global const uint* receivers, __global const uint* map,
                     __global const uint2* ranges, __global const BinEntries* entries,
                     __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                     __global float* visibility, __global FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    SettleLists lists = {ranges, entries, records, bounds};
    uint bin_count = light_frame.bins_x * light_frame.bins_y, texel_count = light_frame.width * light_frame.height;
    GN_FOR_EACH(block, block_count(layout)) {
        LaneFloat state = load_lanes(visibility, layout, block);
        LaneInt left = open_lanes(state);
        if (!LANES_ANY(left)) continue;
        PointBlock centres = load_block(positions, layout, block);
        LaneInt frames = frames_of(light_frame, centres) - (int)first_frame;
        left &= LANE_COMPARE(frames, >=, (LaneInt)(0)) & LANE_COMPARE(frames, <, (LaneInt)((int)frame_count));
        LaneInt looked_at = left;
        FootprintBlock world = load_footprints(footprints, layout, block);
        LaneInt ids = load_lane_ids(receivers, layout, block);
        SettleAnswer answer = {(LaneInt)(0), (LaneInt)(0)};
        while (LANES_ANY(left)) {
            int frame = LANE_OF_INT(frames, first_lane(left));
            LaneInt same_frame = left & LANE_COMPARE(frames, ==, (LaneInt)(frame));
            left &= ~same_frame;
            GridFootprint grid = project_footprint(&projections[frame], centres, &world);
            CellSpan span = footprint_cells(&projections[frame], &grid, light_frame.bin_log2);
            LaneInt usable = grid.usable & small_spans(&span);
            answer.doubted |= same_frame & ~usable;
            same_frame &= usable;
            if (has_map && LANES_ANY(same_frame))
                answer.shadowed |=
                    footprints_below_map(&projections[frame], &grid, same_frame, map + (size_t)frame * texel_count);
            same_frame &= ~answer.shadowed;
            while (LANES_ANY(same_frame)) {
                int lane = first_lane(same_frame);
                int x0 = LANE_OF_INT(span.x0, lane), x1 = LANE_OF_INT(span.x1, lane);
                int y0 = LANE_OF_INT(span.y0, lane), y1 = LANE_OF_INT(span.y1, lane);
                LaneInt same_bins = same_frame & LANE_COMPARE(span.x0, ==, (LaneInt)(x0)) &
                                    LANE_COMPARE(span.x1, ==, (LaneInt)(x1)) &
                                    LANE_COMPARE(span.y0, ==, (LaneInt)(y0)) & LANE_COMPARE(span.y1, ==, (LaneInt)(y1));
                same_frame &= ~same_bins;
                for (int y = y0; y <= y1; ++y)
                    for (int x = x0; x <= x1; ++x) {
                        LaneInt lanes = same_bins & ~answer.shadowed;
                        uint bin = (uint)frame * bin_count + (uint)y * light_frame.bins_x + (uint)x;
                        if (LANES_ANY(lanes))
                            walk_footprints(lists, &projections[frame], bin, lanes, &grid, ids, &answer);
                    }
            }
        }
        LaneFloat result = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(VISIBILITY_MIXED), answer.doubted);
        result = LANES_SELECT(result, (LaneFloat)(0.0f), answer.shadowed);
        store_lanes(LANES_SELECT(state, result, looked_at), visibility, layout, block);
    }
}
