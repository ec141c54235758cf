// SPDX-License-Identifier: MIT
// Classifies footprints against the map and the triangles of their bins' lists. The test is that of the trace
// (trace_points.clh), for a region instead of a point: if one triangle blocks the whole footprint, the footprint is in
// shadow; if every triangle misses the whole footprint, it is lit; any other footprint is mixed, and its samples are
// traced one by one.
//
// An edge function e (and the plane's height above the receiver) is linear, so over a footprint it lies within
//     e(C) +- ext,    ext = |e . u| + |e . v| + |e_x| slack_x + |e_y| slack_y.
// Every sample's grid position lies in the footprint. If e at the centre is beyond margin + ext, the filter's result
// (table in numerics.md, 4) therefore holds for each sample whose position lies in the triangle's bins. A ray outside
// the bins misses the triangle: "misses" stays true, and "blocks" needs the whole footprint in the triangle's
// rectangle. The margin covers the rounding of e(C), but the centre may lie outside the bins: 4u |e| reach. The
// rounding of ext is below 8u of its terms. 16u |e| reach is added for both.
//
// The lists are complete for a sample that is not below its texel of the map, since every bin that a footprint touches
// knows the height of its lowest position (receiver_depth_pyramid). A sample below its texel is in the shadow of the
// triangle that covers the texel. The list has that triangle: its height there is above the bin's open height, which is
// at most the texel's. So that triangle does not miss, and no footprint with such a sample is classified as lit.
//
// On a CPU most remaining mixed footprints can be decided: the occluding mesh has an edge above them, with a triangle
// on either side, or the receiver's neighbours in the mesh touch them (clearance.clh). So the kernel keeps the first
// few triangles that may shadow a part of a footprint, its undecided occluders, and tests them at the end.
//
// The samples of mixed footprints are traced over the same lists: their grid positions lie in the footprints, and every
// bin lists the triangles for these positions. The lists do not cover fallback points: footprints that are unbounded,
// lie in no frame as a whole or are too large. If there is a fallback point, the samples get a frame of their own.
//
// A prepared light's lists are complete for every sample in the light's domain. So a footprint that lies in the domain
// as a whole is classified over them as over a run's own lists, which also lack triangles below the map. Any other
// footprint is mixed, and the prepared trace decides for each of its samples whether the lists cover it.
#include "occluders/bin_overlap.clh"
#include "occluders/triangle_setup.h"
#include "prepared/prepared_light.h"
#include "samples/classify_footprints.h"
#include "samples/clearance.clh"

// Bins (or texels) per side that a footprint may span; a larger footprint is mixed, whatever occluders there are.
#if GN_LANES == 1
#define FOOTPRINT_SPAN 3  // a GPU would wait longer for a few larger footprints than it takes to trace their samples
#else
#define FOOTPRINT_SPAN 8
#endif

typedef struct OccluderLists {
    __global const uint2* ranges;
    __global const BinEntries* entries;
    __global const TriangleRecord* records;
    __global const TriangleBounds* bounds;  // of the records
} OccluderLists;

// The classification of a block's footprints so far.
typedef struct FootprintClasses {
    LaneInt shadowed;
    LaneInt not_lit;  // the footprint is not lit as a whole
} FootprintClasses;

// Triangles that may shadow a part of each lane's footprint. An entry is 4 slot + edge if the footprint lies below the
// triangle, except for a part that may be beyond that single edge. Any other entry is 4 slot + 3.
#define MAX_UNDECIDED 6
typedef struct UndecidedOccluders {
    LaneInt counts;  // may exceed the capacity
    LaneInt kept[MAX_UNDECIDED];
} UndecidedOccluders;

static uint undecided_slot(int entry) { return (uint)entry >> 2; }

static void clear_undecided(UndecidedOccluders* undecided) {
    undecided->counts = (LaneInt)(0);
    for (int i = 0; i < MAX_UNDECIDED; ++i) undecided->kept[i] = (LaneInt)(-1);
}

// Every bin that a footprint and a triangle share lists the triangle; the footprint keeps the triangle once.
static void keep_undecided(UndecidedOccluders* undecided, uint slot, LaneInt lanes, LaneInt lone_edges) {
    LaneInt entry = (LaneInt)((int)(slot << 2)) | (lone_edges & 3);
    for (int i = 0; i < MAX_UNDECIDED; ++i) lanes &= ~LANE_COMPARE(undecided->kept[i], ==, entry);
    for (int i = 0; i < MAX_UNDECIDED; ++i) {
        LaneInt here = lanes & LANE_COMPARE(undecided->counts, ==, (LaneInt)(i));
        undecided->kept[i] = LANES_SELECT(undecided->kept[i], entry, here);
    }
    undecided->counts -= lanes;
}

static LaneFloat extent_over(float slope_x, float slope_y, const GridFootprint* grid) {
    return fabs(slope_x * grid->u.x + slope_y * grid->u.y) + fabs(slope_x * grid->v.x + slope_y * grid->v.y) +
           (fabs(slope_x) * (grid->slack.x + (16.0f * GN_U) * grid->reach.x) +
            fabs(slope_y) * (grid->slack.y + (16.0f * GN_U) * grid->reach.y));
}

// True if the whole footprint lies in the rectangle in which the record is valid.
static bool in_rectangle(TriangleBounds bounds, __constant const Projection* projection, const GridFootprint* grid,
                         int lane) {
    float x = LANE_OF_FLOAT(grid->centre.x, lane), y = LANE_OF_FLOAT(grid->centre.y, lane);
    float reach_x = LANE_OF_FLOAT(grid->reach.x, lane), reach_y = LANE_OF_FLOAT(grid->reach.y, lane);
    return bounds.x0 <= quantised_texel(x - reach_x, projection->width) &&
           quantised_texel(x + reach_x, projection->width) <= bounds.x1 &&
           bounds.y0 <= quantised_texel(y - reach_y, projection->height) &&
           quantised_texel(y + reach_y, projection->height) <= bounds.y1;
}

// The filter of the trace for footprints. `possible`: the triangle may block a part. `certain`: the triangle blocks the
// whole footprint if the footprint lies in its rectangle. `within`: the whole footprint is certainly within this edge.
// `below`: the triangle may block a part, and the whole footprint is certainly below its plane.
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

// The single edge that a part of the footprint may lie beyond, if the footprint is below the triangle otherwise; else
// -1. If the sum of the three masks, each 0 or -1, is -2, two masks are -1, and the third mask gives the edge.
static LaneInt lone_edges_of(const FootprintFilter* f) {
    LaneInt one_open = f->below & LANE_COMPARE(f->within[0] + f->within[1] + f->within[2], ==, (LaneInt)(-2));
    return LANES_SELECT((LaneInt)(-1), 3 + f->within[1] + 2 * f->within[2], one_open);
}

// The rectangle of texels and the least height that the footprints of `lanes` span.
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

// The footprints in the grid of one frame; a footprint that is not `usable` may be anywhere.
typedef struct ProjectedFootprints {
    GridFootprint grid;
    CellSpan span;  // of bins
    LaneInt usable;
} ProjectedFootprints;

static ProjectedFootprints project_footprints(__constant const Projection* projection, PointBlock centres,
                                              const FootprintBlock* world) {
    ProjectedFootprints projected;
    projected.grid = project_footprint(projection, centres, world);
    projected.span = footprint_cells(projection, &projected.grid, projection->bin_log2);
    projected.usable = projected.grid.usable & spans_below(&projected.span, FOOTPRINT_SPAN);
    return projected;
}

#if GN_LANES == 1

// A GPU stops at this number of occluders that may shadow a part of a footprint: tracing its samples takes less time
// than looking for a triangle that shadows all of it. (H100, classifying, points and trace, Sponza's balcony: 1, 2, 4,
// all .87, .87, .84, 1.2 ms.)
#define MAX_PARTIAL_OCCLUDERS 4u

// Tests a record of a list. Returns true if the triangle blocks the whole footprint; counts it if it may shadow a part.
static bool test_record(OccluderLists lists, __constant const Projection* projection, uint slot,
                        const GridFootprint* grid, int receiver, uint* partial) {
    TriangleBounds bounds = lists.bounds[slot];
    FootprintFilter found = filter_footprints(&lists.records[slot], grid, -1);
    // A receiver cannot shadow its own samples.
    if (!found.possible || (int)bounds.id == receiver) return false;
    if (found.certain && !is_masked(&lists.bounds[slot]) && in_rectangle(bounds, projection, grid, 0)) return true;
    ++*partial;
    return false;
}

// Tests the lists of all bins that the footprint touches. All items of a warp test a record together. No predicate
// runs: tracing samples costs less than the predicate's registers and the wait for the few items that would run it.
static void walk_lists(OccluderLists lists, __constant const Projection* projection, uint first_bin,
                       const ProjectedFootprints* projected, int receiver, FootprintClasses* classes) {
    const GridFootprint* grid = &projected->grid;
    const CellSpan* span = &projected->span;
    QuantisedBlock block = quantised_footprints(projection, grid, -1);
    int x = span->x0, y = span->y0;
    uint2 range = (uint2)(0u);
    uint next = 0u, first = 0u, meeting = 0u, partial = 0u;
    while (!classes->shadowed && partial < MAX_PARTIAL_OCCLUDERS) {
        if (meeting == 0u && next >= range.y) {
            if (y > span->y1) break;
            range = lists.ranges[first_bin + (uint)y * projection->bins_x + (uint)x];
            next = range.x;
            if (++x > span->x1) x = span->x0, ++y;
        }
        if (meeting == 0u && next < range.y) {
            first = next;
            meeting = next_that_meet(lists.entries, range, &next, block, GN_NO_ID);
        }
        if (meeting != 0u) {
            uint slot = ENTRY_SLOT(&lists.entries[first + take_lowest_bit(&meeting)], 0);
            if (test_record(lists, projection, slot, grid, receiver, &partial)) classes->shadowed = -1;
        }
    }
    if (partial != 0u) classes->not_lit = -1;
}
#else

// Tests one bin's list against the footprints in `lanes`, which touch the bin.
static void walk_bin(OccluderLists lists, __constant const Projection* projection, uint bin, LaneInt lanes,
                     const GridFootprint* grid, LaneInt receivers, FootprintClasses* classes,
                     UndecidedOccluders* undecided) {
    QuantisedBlock block = quantised_footprints(projection, grid, lanes);
    uint2 range = lists.ranges[bin];
    for (uint i = range.x; i < range.y; ++i) {
        uint meeting = entries_that_meet(&lists.entries[i], block);
        while (meeting != 0u) {
            uint slot = ENTRY_SLOT(&lists.entries[i], take_lowest_bit(&meeting));
            FootprintFilter found = filter_footprints(&lists.records[slot], grid, lanes);
            if (!LANES_ANY(found.possible)) continue;
            TriangleBounds bounds = lists.bounds[slot];
            if (is_masked(&lists.bounds[slot])) found.below = found.certain = (LaneInt)(0);
            // A receiver cannot shadow its own samples.
            LaneInt possible = found.possible & LANE_COMPARE(receivers, !=, (LaneInt)((int)bounds.id));
            LaneInt blocked = (LaneInt)(0);
            if (LANES_ANY(found.certain & possible))
                for (int lane = 0; lane < GN_LANES; ++lane)
                    if (LANE_OF_INT(found.certain, lane) && LANE_OF_INT(possible, lane) &&
                        in_rectangle(bounds, projection, grid, lane))
                        LANE_OF_INT(blocked, lane) = -1;
            classes->shadowed |= blocked;
            possible &= ~blocked;
            if (LANES_ANY(possible)) keep_undecided(undecided, slot, possible, lone_edges_of(&found));
            lanes &= ~blocked;
            if (!LANES_ANY(lanes)) return;
        }
    }
}

// Tests the lists of all bins that the footprints of one frame touch; first_bin: the first bin of the frame.
static void walk_footprints(OccluderLists lists, __constant const Projection* projection, uint first_bin, LaneInt lanes,
                            const ProjectedFootprints* projected, LaneInt receivers, FootprintClasses* classes,
                            UndecidedOccluders* undecided) {
    const CellSpan* span = &projected->span;
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
                LaneInt left = same_bins & ~classes->shadowed;
                if (LANES_ANY(left))
                    walk_bin(lists, projection, first_bin + (uint)y * projection->bins_x + (uint)x, left,
                             &projected->grid, receivers, classes, undecided);
            }
    }
}

// True if the whole footprint lies in the triangle's bins, where its record is valid.
static bool in_bins(TriangleBounds bounds, __constant const Projection* projection, const CellSpan* span, int lane) {
    int4 bins = convert_int4(bins_of_bounds(bounds, projection));
    return LANE_OF_INT(span->x0, lane) >= bins.x && LANE_OF_INT(span->y0, lane) >= bins.y &&
           LANE_OF_INT(span->x1, lane) <= bins.z && LANE_OF_INT(span->y1, lane) <= bins.w;
}

static int orientation_from(float4 light, Triangle t) {
    int level = DET3_BY_FLOAT;
    return det3_sign(t.b, t.a, t.c, t.a, light.xyz, light.w != 0.0f ? t.a : (float3)(0.0f), &level);
}

static bool same_position(float3 a, float3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

// True if both edges are the same edge, with a triangle on either side as seen from the light.
static bool meet_at_edge(float4 light, Triangle s, int edge_of_s, Triangle t, int edge_of_t) {
    const float3 vertices_of_s[4] = {s.a, s.b, s.c, s.a}, vertices_of_t[4] = {t.a, t.b, t.c, t.a};
    float3 s0 = vertices_of_s[edge_of_s], s1 = vertices_of_s[edge_of_s + 1];
    float3 t0 = vertices_of_t[edge_of_t], t1 = vertices_of_t[edge_of_t + 1];
    bool opposed = same_position(s0, t1) && same_position(s1, t0),
         alike = same_position(s0, t0) && same_position(s1, t1);
    if (!opposed && !alike) return false;
    int product = orientation_from(light, s) * orientation_from(light, t);
    return opposed ? product > 0 : product < 0;
}

// If two triangles meet at an edge and each covers a footprint except for the part beyond that edge, both together
// cover all of it: their functions of that edge differ by a factor below 0, so they are nowhere both negative.
static bool below_a_pair(OccluderLists lists, __global const float* vertices, __constant const Projection* projection,
                         const CellSpan* span, float4 light, const UndecidedOccluders* undecided, int lane) {
    Triangle others[MAX_UNDECIDED];
    int edges[MAX_UNDECIDED], count = 0;
    for (int i = 0; i < min(LANE_OF_INT(undecided->counts, lane), MAX_UNDECIDED); ++i) {
        int entry = LANE_OF_INT(undecided->kept[i], lane), edge = entry & 3;
        if (edge == 3) continue;
        TriangleBounds bounds = lists.bounds[undecided_slot(entry)];
        if (!in_bins(bounds, projection, span, lane)) continue;
        Triangle t = load_triangle(vertices, bounds.id);
        for (int j = 0; j < count; ++j)
            if (meet_at_edge(light, t, edge, others[j], edges[j])) return true;
        others[count] = t;
        edges[count++] = edge;
    }
    return false;
}

// Decides the lanes that have undecided occluders.
static void decide_undecided(OccluderLists lists, __global const float* vertices,
                             __constant const Projection* projection, LaneInt ids, LaneInt lanes, float3 eye,
                             float4 light, PointBlock centres, const FootprintBlock* around, const CellSpan* span,
                             const UndecidedOccluders* undecided, FootprintClasses* classes) {
    if (!LANES_ANY(lanes)) return;
    classes->not_lit |= lanes;
    for (int lane = 0; lane < GN_LANES; ++lane)
        if (LANE_OF_INT(lanes, lane) && below_a_pair(lists, vertices, projection, span, light, undecided, lane))
            LANE_OF_INT(classes->shadowed, lane) = -1;
    lanes &= ~classes->shadowed & LANE_COMPARE(undecided->counts, <=, (LaneInt)(MAX_UNDECIDED));
    if (!LANES_ANY(lanes)) return;
    ReceiverPlanes planes = find_receiver_planes(vertices, ids, lanes, eye, light, centres, around);
    for (int i = 0; i < MAX_UNDECIDED; ++i) {
        LaneInt active = lanes & LANE_COMPARE(undecided->counts, >, (LaneInt)(i)), occluders = (LaneInt)(0);
        if (!LANES_ANY(active)) break;
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(active, lane))
                LANE_OF_INT(occluders, lane) =
                    (int)lists.bounds[undecided_slot(LANE_OF_INT(undecided->kept[i], lane))].id;
        TriangleBlock t = load_triangles_of(vertices, occluders, active);
        lanes &= ~active | lanes_clear_of(&planes, &t, active);
    }
    classes->not_lit &= ~lanes;
}

#endif

// The lanes with a footprint below all texels of the map that the footprint touches.
static LaneInt footprints_below_map(__constant const Projection* projection, const GridFootprint* grid, LaneInt lanes,
                                    __global const uint* map) {
    CellSpan texels = footprint_cells(projection, grid, 0);
    lanes &= spans_below(&texels, FOOTPRINT_SPAN);
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

// Removes the lanes whose footprints a prepared light's lists do not cover as a whole (they are mixed), and the lanes
// of a frame without triangles (they are lit). A domain is made of intervals of coordinates, which round monotonically
// as a sample moves along them: so it contains a footprint if it contains both its extreme corners.
static LaneInt lanes_in_domain(ClassifyParams params, __global const uint2* ranges, uint frame, PointBlock centres,
                               const FootprintBlock* around, LaneInt lanes, FootprintClasses* classes) {
    __global const PreparedDomain* domain =
        (__global const PreparedDomain*)prepared_table(ranges, params.domains) + frame;
    LightFrame face = face_of(params.light_frame, frame);
    PointBlock reach = scaled(footprint_reach(around), (LaneFloat)(FOOTPRINT_SLACK));
    PointBlock low = difference(centres, reach), high = {centres.x + reach.x, centres.y + reach.y, centres.z + reach.z};
    PreparedAnswer at_low = prepared_answer(face, domain, low), at_high = prepared_answer(face, domain, high);
    LaneInt inside = at_low.inside & at_high.inside;
    classes->not_lit |= lanes & ~inside;
    return domain->has_triangles ? lanes & inside : (LaneInt)(0);
}

static void count_fallback_points(LaneInt fallback_points, __global FrameCounters* counters) {
    if (LANES_ANY(fallback_points)) atomic_add(&counters->fallback_points, count_lanes(fallback_points));
}

// Classifies open footprints: their visibility becomes 0, 1 or VISIBILITY_MIXED.
__kernel void classify_footprints(ClassifyParams params, __constant const Projection* projections,
                                  __global const float* vertices, __global const float* positions,
                                  __global const float* footprints, __global const uint* receivers,
                                  __global const uint* map, __global const uint2* ranges,
                                  __global const BinEntries* entries, __global const TriangleRecord* records,
                                  __global const TriangleBounds* bounds, __global float* visibility,
                                  __global FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    OccluderLists lists = {ranges, entries, records, bounds};
    LightFrame light_frame = params.light_frame;
    PointsLayout layout = params.layout;
    vertices += params.triangles.first_float;
    float4 light = light_of(light_frame);
    float3 eye = eye_of(layout);
    uint bin_count = light_frame.bins_x * light_frame.bins_y, texel_count = light_frame.width * light_frame.height;
    GN_FOR_EACH(block, block_count(layout)) {
        LaneFloat state = load_lanes(visibility, layout, block);
        LaneInt left = open_lanes(state);
        count_fallback_points(valid_lanes(layout, block) & LANE_COMPARE(state, ==, (LaneFloat)(VISIBILITY_MIXED)),
                              counters);
        if (!LANES_ANY(left)) continue;
        PointBlock centres = load_block(positions, layout, block);
        LaneInt frames = frames_of(light_frame, centres) - (int)params.first_frame;
        left &= LANE_COMPARE(frames, >=, (LaneInt)(0)) & LANE_COMPARE(frames, <, (LaneInt)((int)params.frame_count));
        LaneInt classified = left;
        FootprintBlock world = load_footprints(footprints, layout, block);
        LaneInt ids = load_lane_ids(receivers, layout, block);
        FootprintClasses classes = {(LaneInt)(0), (LaneInt)(0)};
        while (LANES_ANY(left)) {
            int frame = LANE_OF_INT(frames, first_lane(left));
            LaneInt same_frame = left & LANE_COMPARE(frames, ==, (LaneInt)(frame));
            left &= ~same_frame;
            if (params.domains != 0u)
                same_frame = lanes_in_domain(params, ranges, (uint)frame, centres, &world, same_frame, &classes);
            ProjectedFootprints projected = project_footprints(&projections[frame], centres, &world);
            classes.not_lit |= same_frame & ~projected.usable;
            count_fallback_points(same_frame & ~(projected.grid.usable & spans_below(&projected.span, LISTED_SPAN)),
                                  counters);
            same_frame &= projected.usable;
            if (params.has_map && LANES_ANY(same_frame))
                classes.shadowed |= footprints_below_map(&projections[frame], &projected.grid, same_frame,
                                                         map + (size_t)frame * texel_count);
#if GN_LANES == 1
            if (same_frame & ~classes.shadowed)
                walk_lists(lists, &projections[frame], (uint)frame * bin_count, &projected, ids, &classes);
#else
            UndecidedOccluders undecided;
            clear_undecided(&undecided);
            walk_footprints(lists, &projections[frame], (uint)frame * bin_count, same_frame & ~classes.shadowed,
                            &projected, ids, &classes, &undecided);
            LaneInt open = same_frame & ~classes.shadowed & LANE_COMPARE(undecided.counts, !=, (LaneInt)(0));
            decide_undecided(lists, vertices, &projections[frame], ids, open, eye, light, centres, &world,
                             &projected.span, &undecided, &classes);
#endif
        }
        LaneFloat result = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(VISIBILITY_MIXED), classes.not_lit);
        result = LANES_SELECT(result, (LaneFloat)(0.0f), classes.shadowed);
        store_lanes(LANES_SELECT(state, result, classified), visibility, layout, block);
    }
}
