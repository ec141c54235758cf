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
// knows the height of its lowest place (receiver_depth_pyramid). One that is below its texel is in the shadow of the
// triangle that covers the texel; and that one is listed, since its height there is above the bin's open height, which
// is at most the texel's. So it may be missed by nothing, and no footprint with such a sample is found to be lit.
//
// Most footprints that this leaves mixed are not: a mesh that shadows them has an edge above them, with a triangle on
// either side, or the receiver's neighbours in the mesh touch them (clearance.h). So the first few triangles that may
// shadow a footprint in part are kept, its doubts, and looked at in the end.
// The samples of mixed footprints are traced over the same lists: their places are footprints' places, and every bin
// knows of those. But for strays, which the bins were not told of (unbounded, in no frame as a whole, or too large):
// where there is one, the samples get a frame of their own.
#include "occluders/bin_test.clh"
#include "occluders/triangle_setup.h"
#include "samples/clearance.clh"

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

// Triangles that may shadow each lane, and none of which was found to as a whole: 4 slot + edge, if the lane lies below
// the triangle but for what may be beyond that one of its edges, else 4 slot + 3.
#define MOST_DOUBTS 6
typedef struct Doubts {
    LaneInt counts;  // may be more than are kept
    LaneInt kept[MOST_DOUBTS];
} Doubts;

static uint doubted_slot(int doubt) { return (uint)doubt >> 2; }

static void no_doubts(Doubts* doubts) {
    doubts->counts = (LaneInt)(0);
    for (int i = 0; i < MOST_DOUBTS; ++i) doubts->kept[i] = (LaneInt)(-1);
}

// A triangle comes once for each bin that a footprint shares with it.
static void keep_doubts(Doubts* doubts, uint slot, LaneInt lanes, LaneInt lone_edges) {
    LaneInt doubt = (LaneInt)((int)(slot << 2)) | (lone_edges & 3);
    for (int i = 0; i < MOST_DOUBTS; ++i) lanes &= ~LANE_COMPARE(doubts->kept[i], ==, doubt);
    for (int i = 0; i < MOST_DOUBTS; ++i) {
        LaneInt here = lanes & LANE_COMPARE(doubts->counts, ==, (LaneInt)(i));
        doubts->kept[i] = LANES_SELECT(doubts->kept[i], doubt, here);
    }
    doubts->counts -= lanes;
}

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
// where they lie in its rectangle. `within`: all of them is within each edge for certain; `below`: and below the plane.
typedef struct FootprintFilter {
    LaneInt possible, certain, below, within[3];
} FootprintFilter;

static FootprintFilter filter_footprints(__global const TriangleRecord* r, const GridFootprint* grid, LaneInt lanes) {
    FootprintFilter found;
    found.possible = lanes;
    for (int i = 0; i < 3; ++i) {
        LaneFloat e = lanes_linear(r->edge_x[i], r->edge_y[i], r->edge_0[i], grid->centre.x, grid->centre.y);
        LaneFloat far = (LaneFloat)(r->margin_edge) + FOOTPRINT_SLACK * extent_over(r->edge_x[i], r->edge_y[i], grid);
        found.possible &= ~LANE_COMPARE(e, <, -far);
        found.within[i] = LANE_COMPARE(e, >, far);
    }
    if (!LANES_ANY(found.possible)) return found;
    // height > 0: the plane is nearer to the light than the centre.
    LaneFloat z = grid->centre.z;
    LaneFloat height = lanes_linear(r->plane_x, r->plane_y, r->plane_0, grid->centre.x, grid->centre.y) - z;
    LaneFloat extent = fabs(r->plane_x * grid->u.x + r->plane_y * grid->u.y - grid->u.z) +
                       fabs(r->plane_x * grid->v.x + r->plane_y * grid->v.y - grid->v.z) +
                       (fabs(r->plane_x) * (grid->slack.x + (16.0f * GN_U) * grid->reach.x) +
                        fabs(r->plane_y) * (grid->slack.y + (16.0f * GN_U) * grid->reach.y) +
                        (grid->slack.z + (16.0f * GN_U) * grid->reach.z));
    LaneFloat far = r->margin_plane + FOOTPRINT_SLACK * extent + (4.0f * GN_U) * fabs(height);
    found.possible &= ~LANE_COMPARE(height, <, -far) & ~LANE_COMPARE(z - grid->reach.z, >, (LaneFloat)(r->z_high));
    found.below =
        found.possible & (LANE_COMPARE(height, >, far) | LANE_COMPARE(z + grid->reach.z, <, (LaneFloat)(r->z_low)));
    found.certain = found.below & found.within[0] & found.within[1] & found.within[2];
    return found;
}

// For footprints that lie below the triangle but for what may be beyond one of its edges, that edge; else -1. Of three
// that are 0 or -1, two are -1 if their sum is -2; and then it is the edge of the third.
static LaneInt lone_edges_of(const FootprintFilter* f) {
    LaneInt one_open = f->below & LANE_COMPARE(f->within[0] + f->within[1] + f->within[2], ==, (LaneInt)(-2));
    return LANES_SELECT((LaneInt)(-1), 3 + f->within[1] + 2 * f->within[2], one_open);
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
static void walk_bin(SettleLists lists, __constant const Projection* projection, uint bin, LaneInt lanes,
                     const GridFootprint* grid, LaneInt receivers, SettleAnswer* answer, Doubts* doubts) {
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
            possible &= ~blocked;
#if GN_LANES == 1
            // Tracing them is less work for a GPU than the predicates' registers and waiting for the few that ask.
            answer->doubted |= possible;
#else
            if (LANES_ANY(possible)) keep_doubts(doubts, slot, possible, lone_edges_of(&found));
#endif
            lanes &= ~blocked;
            if (!LANES_ANY(lanes)) return;
        }
    }
}

// Where footprints lie in the grid of one frame; those that are not `usable` may be anywhere.
typedef struct PlacedFootprints {
    GridFootprint grid;
    CellSpan span;  // of bins
    LaneInt usable;
} PlacedFootprints;

static PlacedFootprints place_footprints(__constant const Projection* projection, PointBlock centres,
                                         const FootprintBlock* world) {
    PlacedFootprints placed;
    placed.grid = project_footprint(projection, centres, world);
    placed.span = footprint_cells(projection, &placed.grid, projection->bin_log2);
    placed.usable = placed.grid.usable & small_spans(&placed.span);
    return placed;
}

// All bins' lists for footprints of one frame; first_bin: of the frame.
static void walk_footprints(SettleLists lists, __constant const Projection* projection, uint first_bin, LaneInt lanes,
                            const PlacedFootprints* placed, LaneInt receivers, SettleAnswer* answer, Doubts* doubts) {
    const CellSpan* span = &placed->span;
    while (LANES_ANY(lanes)) {
        int lane = first_lane(lanes);
        int x0 = LANE_OF_INT(span->x0, lane), x1 = LANE_OF_INT(span->x1, lane);
        int y0 = LANE_OF_INT(span->y0, lane), y1 = LANE_OF_INT(span->y1, lane);
        LaneInt same_bins = lanes & LANE_COMPARE(span->x0, ==, (LaneInt)(x0)) &
                            LANE_COMPARE(span->x1, ==, (LaneInt)(x1)) & LANE_COMPARE(span->y0, ==, (LaneInt)(y0)) &
                            LANE_COMPARE(span->y1, ==, (LaneInt)(y1));
        lanes &= ~same_bins;
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                LaneInt left = same_bins & ~answer->shadowed;
                if (LANES_ANY(left))
                    walk_bin(lists, projection, first_bin + (uint)y * projection->bins_x + (uint)x, left, &placed->grid,
                             receivers, answer, doubts);
            }
    }
}

// Do all places lie in bins of the triangle, for which its record holds?
static bool in_bins(TriangleBounds bounds, __constant const Projection* projection, const CellSpan* span, int lane) {
    LaneInt x0 = bins_of_quantised((LaneInt)(bounds.x0), projection->width, projection->bin_log2);
    LaneInt y0 = bins_of_quantised((LaneInt)(bounds.y0), projection->height, projection->bin_log2);
    LaneInt x1 = bins_of_quantised((LaneInt)(bounds.x1), projection->width, projection->bin_log2);
    LaneInt y1 = bins_of_quantised((LaneInt)(bounds.y1), projection->height, projection->bin_log2);
    return LANE_OF_INT(span->x0, lane) >= LANE_OF_INT(x0, 0) && LANE_OF_INT(span->y0, lane) >= LANE_OF_INT(y0, 0) &&
           LANE_OF_INT(span->x1, lane) <= LANE_OF_INT(x1, 0) && LANE_OF_INT(span->y1, lane) <= LANE_OF_INT(y1, 0);
}

static int orientation_from(float4 light, Triangle t) {
    int level = DET3_BY_FLOAT;
    return det3_sign(t.b, t.a, t.c, t.a, light.xyz, light.w != 0.0f ? t.a : (float3)(0.0f), &level);
}

static bool same_place(float3 a, float3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

// Are these edges one, with a triangle on either side as the light sees it?
static bool meet_at_edge(float4 light, Triangle s, int edge_of_s, Triangle t, int edge_of_t) {
    const float3 vertices_of_s[4] = {s.a, s.b, s.c, s.a}, vertices_of_t[4] = {t.a, t.b, t.c, t.a};
    float3 s0 = vertices_of_s[edge_of_s], s1 = vertices_of_s[edge_of_s + 1];
    float3 t0 = vertices_of_t[edge_of_t], t1 = vertices_of_t[edge_of_t + 1];
    bool opposed = same_place(s0, t1) && same_place(s1, t0), alike = same_place(s0, t0) && same_place(s1, t1);
    if (!opposed && !alike) return false;
    int product = orientation_from(light, s) * orientation_from(light, t);
    return opposed ? product > 0 : product < 0;
}

// Two triangles that meet at an edge, and of which each covers a footprint but for what lies beyond that edge, cover
// all of it: their edge functions there are one, times a factor below 0, so that nowhere both are negative.
static bool below_a_pair(SettleLists lists, __global const float* vertices, __constant const Projection* projection,
                         const CellSpan* span, float4 light, const Doubts* doubts, int lane) {
    Triangle others[MOST_DOUBTS];
    int edges[MOST_DOUBTS], count = 0;
    for (int i = 0; i < min(LANE_OF_INT(doubts->counts, lane), MOST_DOUBTS); ++i) {
        int doubt = LANE_OF_INT(doubts->kept[i], lane), edge = doubt & 3;
        if (edge == 3) continue;
        TriangleBounds bounds = lists.bounds[doubted_slot(doubt)];
        if (!in_bins(bounds, projection, span, lane)) continue;
        Triangle t = load_triangle(vertices, bounds.id);
        for (int j = 0; j < count; ++j)
            if (meet_at_edge(light, t, edge, others[j], edges[j])) return true;
        others[count] = t;
        edges[count++] = edge;
    }
    return false;
}

// What becomes of these lanes, all in doubt.
static void look_at_doubts(SettleLists lists, __global const float* vertices, __constant const Projection* projection,
                           LaneInt ids, LaneInt lanes, float3 eye, float4 light, PointBlock centres,
                           const FootprintBlock* around, const CellSpan* span, const Doubts* doubts,
                           SettleAnswer* answer) {
    answer->doubted |= lanes;
    for (int lane = 0; lane < GN_LANES; ++lane)
        if (LANE_OF_INT(lanes, lane) && below_a_pair(lists, vertices, projection, span, light, doubts, lane))
            LANE_OF_INT(answer->shadowed, lane) = -1;
    lanes &= ~answer->shadowed & LANE_COMPARE(doubts->counts, <=, (LaneInt)(MOST_DOUBTS));
    if (!LANES_ANY(lanes)) return;
    ReceiverPlanes planes = find_receiver_planes(vertices, ids, lanes, eye, light, centres, around);
    for (int i = 0; i < MOST_DOUBTS; ++i) {
        LaneInt asked = lanes & LANE_COMPARE(doubts->counts, >, (LaneInt)(i)), occluders = (LaneInt)(0);
        if (!LANES_ANY(asked)) break;
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(asked, lane))
                LANE_OF_INT(occluders, lane) = (int)lists.bounds[doubted_slot(LANE_OF_INT(doubts->kept[i], lane))].id;
        TriangleBlock t = load_triangles_of(vertices, occluders, asked);
        lanes &= ~asked | lanes_clear_of(&planes, &t, asked);
    }
    answer->doubted &= ~lanes;
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

static void count_strays(LaneInt fallback_points, __global FrameCounters* counters) {
    if (LANES_ANY(fallback_points)) atomic_add(&counters->fallback_points, count_lanes(fallback_points));
}

// Footprints of the frames from `first_frame` on, as trace() takes points. Those that are open become 0, 1 or
// VISIBILITY_MIXED.
__kernel void settle(LightFrame light_frame, uint first_frame, uint frame_count, PointsLayout layout,
                     __constant const Projection* projections, uint has_map, ulong first_float,
                     __global const float* vertices, __global const float* positions, __global const float* footprints,
                     __global const uint* receivers, __global const uint* map, __global const uint2* ranges,
                     __global const BinEntries* entries, __global const TriangleRecord* records,
                     __global const TriangleBounds* bounds, __global float* visibility,
                     __global FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    SettleLists lists = {ranges, entries, records, bounds};
    float4 light = light_of(light_frame);
    float3 eye = eye_of(layout);
    uint bin_count = light_frame.bins_x * light_frame.bins_y, texel_count = light_frame.width * light_frame.height;
    GN_FOR_EACH(block, block_count(layout)) {
        LaneFloat state = load_lanes(visibility, layout, block);
        LaneInt left = open_lanes(state);
        count_strays(valid_lanes(layout, block) & LANE_COMPARE(state, ==, (LaneFloat)(VISIBILITY_MIXED)), counters);
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
            PlacedFootprints placed = place_footprints(&projections[frame], centres, &world);
            answer.doubted |= same_frame & ~placed.usable;
            count_strays(same_frame & ~(placed.grid.usable & spans_below(&placed.span, LISTED_SPAN)), counters);
            same_frame &= placed.usable;
            if (has_map && LANES_ANY(same_frame))
                answer.shadowed |= footprints_below_map(&projections[frame], &placed.grid, same_frame,
                                                        map + (size_t)frame * texel_count);
            Doubts doubts;
            no_doubts(&doubts);
            walk_footprints(lists, &projections[frame], (uint)frame * bin_count, same_frame & ~answer.shadowed, &placed,
                            ids, &answer, &doubts);
#if GN_LANES > 1
            LaneInt in_doubt = same_frame & ~answer.shadowed & LANE_COMPARE(doubts.counts, !=, (LaneInt)(0));
            if (LANES_ANY(in_doubt))
                look_at_doubts(lists, vertices + first_float, &projections[frame], ids, in_doubt, eye, light, centres,
                               &world, &placed.span, &doubts, &answer);
#endif
        }
        LaneFloat result = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(VISIBILITY_MIXED), answer.doubted);
        result = LANES_SELECT(result, (LaneFloat)(0.0f), answer.shadowed);
        store_lanes(LANES_SELECT(state, result, looked_at), visibility, layout, block);
    }
}
