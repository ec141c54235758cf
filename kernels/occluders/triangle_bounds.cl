// SPDX-License-Identifier: MIT
// Triangle bounds, the first pass of the triangle setup: the cull. Bounds every triangle in the grid, GN_LANES at a
// time, and appends the survivors to a list of 16 bytes each (TriangleBounds).
//
// A triangle is dropped, and counted, for a NaN or infinite vertex; behind the light or outside the grid; farther from
// the light than every point that it could cover (by the receiver depth pyramid). Survivors that may cover whole texels
// are listed as candidates of the conservative map, too. With cut-outs, a clear triangle is dropped, and a masked one
// is no candidate.
#include "exact/cut_outs.clh"
#include "lists/append.h"
#include "lists/group_scan.clh"
#include "occluders/cluster_boxes.clh"
#include "occluders/conservative_map.h"
#include "occluders/triangle_setup.h"

// ---- Candidates of the map ------------------------------------------------------------------------------------------

// The lanes with an interval that contains first_sample + n / per_pixel (a power of two) for a whole n >= 0. Both sides
// are rounded, but rounding is monotone and a sample's distance from the first one is exact: no interval with a sample
// loses it.
static LaneInt contains_sample(LaneFloat low, LaneFloat high, float first_sample, float per_pixel) {
    LaneFloat last = (high - first_sample) * per_pixel, first = (low - first_sample) * per_pixel;
    LaneInt inside = LANE_COMPARE(last, >=, (LaneFloat)(0.0f));
    LaneFloat sample = LANES_TO_FLOAT(LANES_TO_INT(LANES_MAX(last, (LaneFloat)(0.0f))));
    return inside & LANE_COMPARE(sample, >=, first);
}

// The same for the centres of this many texels.
static LaneInt contains_centre(LaneFloat low, LaneFloat high, uint texels) {
    return contains_sample(low, LANES_MIN(high, (LaneFloat)((float)texels + 0.5f)), 0.5f, 1.0f);
}

// The triangles that may cover a whole texel. This affects speed alone: a result that is off by rounding costs a test
// or a texel of the map, never a wrong shadow.
//
// A texel with its centre at p is covered if each barycentric coordinate at p is at least its loss towards the texel's
// worst corner: for the corner opposite the edge (x, y), s = (|x| + |y|) / 2 / (2 area). The three s sum up to S =
// (breadth + depth) / (2 area). If S > 1 there is no such p. Else the set of such p is a triangle, the original times 1
// - S, with its first corner at a + s_b ab + s_c ac + (1 - S) 0; and some texel's centre must be within its bounds. Its
// area, `expected`, is the number of texels that the original covers on average over all shifts of the grid.
static LaneInt can_cover_texel(const Projected* v, Rectangles rectangle, __constant const Projection* projection,
                               LaneInt lanes, LaneFloat* expected) {
    lanes &= LANE_COMPARE(rectangle.x1 - rectangle.x0, >=, (LaneFloat)(1.0f)) &
             LANE_COMPARE(rectangle.y1 - rectangle.y0, >=, (LaneFloat)(1.0f));
    if (!LANES_ANY(lanes)) return lanes;
    LaneFloat a_x = v[0].x / v[0].w, a_y = v[0].y / v[0].w;
    LaneFloat ab_x = v[1].x / v[1].w - a_x, ab_y = v[1].y / v[1].w - a_y;
    LaneFloat ac_x = v[2].x / v[2].w - a_x, ac_y = v[2].y / v[2].w - a_y;
    LaneFloat twice_area = fabs(ab_x * ac_y - ab_y * ac_x), zero = (LaneFloat)(0.0f);
    LaneFloat low_x = LANES_MIN(LANES_MIN(ab_x, ac_x), zero), high_x = LANES_MAX(LANES_MAX(ab_x, ac_x), zero);
    LaneFloat low_y = LANES_MIN(LANES_MIN(ab_y, ac_y), zero), high_y = LANES_MAX(LANES_MAX(ab_y, ac_y), zero);
    LaneFloat around = high_x - low_x + high_y - low_y;
    lanes &= LANE_COMPARE(twice_area, >=, around);
    if (!LANES_ANY(lanes)) return lanes;
    LaneFloat s_b = (fabs(ac_x) + fabs(ac_y)) * 0.5f / twice_area, s_c = (fabs(ab_x) + fabs(ab_y)) * 0.5f / twice_area;
    LaneFloat rest = (LaneFloat)(1.0f) - around / twice_area;
    LaneFloat first_x = a_x + s_b * ab_x + s_c * ac_x, first_y = a_y + s_b * ab_y + s_c * ac_y;
    LaneFloat area = twice_area * 0.5f * rest * rest;
    *expected = LANES_SELECT(*expected, LANES_MIN(area, *expected), lanes);
    return lanes & contains_centre(first_x + rest * low_x, first_x + rest * high_x, projection->width) &
           contains_centre(first_y + rest * low_y, first_y + rest * high_y, projection->height);
}

// ---- Bounds ---------------------------------------------------------------------------------------------------------

// TriangleBounds of GN_LANES triangles.
typedef struct BoundsBlock {
    LaneInt x0, y0, x1, y1, z, flags;
    LaneFloat expected;  // about how many texels a candidate of the map covers
} BoundsBlock;

// Bounds that exclude no point: every bin, or (indistinct) the one bin that all points share.
static BoundsBlock unbounded(__constant const Projection* projection) {
    BoundsBlock bounds;
    bounds.x0 = bounds.y0 = bounds.flags = (LaneInt)(0);
    bounds.x1 = (LaneInt)(projection->indistinct ? (int)(texel_units(projection->width) - 1.0f) : 65535);
    bounds.y1 = (LaneInt)(projection->indistinct ? (int)(texel_units(projection->height) - 1.0f) : 65535);
    bounds.z = (LaneInt)(65535);
    bounds.expected = (LaneFloat)(0.0f);
    return bounds;
}

// The finite triangles that survive the cull, and their bounds. `pyramid` is ignored unless params.has_pyramid.
static LaneInt bound_triangles(const TriangleBlock* t, LaneInt lanes, TriangleSetupParams params,
                               __constant const Projection* projection, __global const uint* pyramid,
                               BoundsBlock* bounds) {
    *bounds = unbounded(projection);
    if (projection->indistinct) return lanes;
    Projected v[3];
    HullSides sides = project_triangles(t, projection, v);
    Rectangles rectangle;
    LaneInt out_of_range = lanes & sides.out_of_range, inside = lanes & ~sides.out_of_range & ~sides.behind;
    inside &= covered_rectangles(v, 3, projection, &rectangle);
    if (params.samples_per_pixel) {
        float per_pixel = (float)params.samples_per_pixel;
        inside &= contains_sample(rectangle.x0, rectangle.x1, params.first_sample, per_pixel) &
                  contains_sample(rectangle.y0, rectangle.y1, params.first_sample, per_pixel);
    }
    if (!LANES_ANY(inside)) return out_of_range;
    LaneFloat z_low, z_high;
    height_intervals(v, 3, sides.straddles, projection, &z_low, &z_high);
    if (params.has_pyramid) inside &= ~lanes_hidden(rectangle, z_high, inside, projection, pyramid);
    if (!LANES_ANY(inside)) return out_of_range;
    float x_units = texel_units(projection->width), y_units = texel_units(projection->height);
    bounds->x0 = LANES_SELECT(bounds->x0, quantised(rectangle.x0 * x_units), inside);
    bounds->y0 = LANES_SELECT(bounds->y0, quantised(rectangle.y0 * y_units), inside);
    bounds->x1 = LANES_SELECT(bounds->x1, quantised(rectangle.x1 * x_units), inside);
    bounds->y1 = LANES_SELECT(bounds->y1, quantised(rectangle.y1 * y_units), inside);
    LaneInt z = projection->z_scale == 0.0f ? quantised_nearness(z_high)
                                            : quantised((z_high - projection->z_origin) * projection->z_scale);
    bounds->z = LANES_SELECT(bounds->z, z, inside);
    LaneInt for_map = inside & sides.straddles;
    bounds->expected = (rectangle.x1 - rectangle.x0) * (rectangle.y1 - rectangle.y0);  // no more than the grid has
    for_map |= can_cover_texel(v, rectangle, projection, inside & ~sides.straddles, &bounds->expected);
    bounds->flags = LANES_SELECT(bounds->flags, (LaneInt)(BOUNDS_FOR_MAP), for_map);
    return inside | out_of_range;
}

// The counts of a work-item, in triangles; `expected` in texels.
typedef struct BoundsCounts {
    uint survivors, candidates, finite, visited;
    LaneFloat expected;
} BoundsCounts;

// The survivors among GN_LANES triangles; *first is the first triangle.
static LaneInt bound_block(uint block, TriangleSetupParams params, __constant const Projection* projection,
                           __global const float* vertices, __global const uint* pyramid, uint* first,
                           BoundsBlock* found, BoundsCounts* counts) {
    *first = block * GN_LANES;
    if (*first >= params.triangles.count) return (LaneInt)(0);  // past the end of the last cluster
    uint count = min(params.triangles.count - *first, (uint)GN_LANES);
    TriangleBlock t = load_triangles(vertices, *first, params.triangles.count);
    LaneInt finite = LANE_COMPARE((LaneInt)((int)count), >, LANE_INDEX) & finite_triangles(&t);
    counts->visited += count;
    counts->finite += count_lanes(finite);
#ifdef GN_CUT_OUTS
    // A block's triangles are of one group of classes: GN_LANES divides CUT_OUT_GROUP.
    uint classes = cut_out_words((Triangles){vertices, params.triangles.count})[2u * (*first / CUT_OUT_GROUP)] >>
                   2u * (*first % CUT_OUT_GROUP);
    LaneInt of_lanes = (LaneInt)((int)classes) >> (2 * LANE_INDEX) & 3;
    LaneInt survivors = bound_triangles(&t, finite & LANE_COMPARE(of_lanes, !=, (LaneInt)((int)CUT_OUT_CLEAR)), params,
                                        projection, pyramid, found);
    LaneInt masked = LANE_COMPARE(of_lanes, ==, (LaneInt)((int)CUT_OUT_MASKED));
    found->flags = LANES_SELECT(found->flags, (LaneInt)((int)BOUNDS_MASKED), masked);
#else
    LaneInt survivors = bound_triangles(&t, finite, params, projection, pyramid, found);
#endif
    counts->survivors += count_lanes(survivors);
    return survivors;
}

// TriangleBounds, in the order of its members.
static uint4 lane_bounds(const BoundsBlock* found, uint lane, uint id) {
    return (uint4)((uint)LANE_OF_INT(found->x0, lane) | (uint)LANE_OF_INT(found->y0, lane) << 16,
                   (uint)LANE_OF_INT(found->x1, lane) | (uint)LANE_OF_INT(found->y1, lane) << 16,
                   (uint)LANE_OF_INT(found->z, lane) | (uint)LANE_OF_INT(found->flags, lane) << 16, id);
}

#ifdef GN_CPU
// The inputs of a CPU's work-item, the lists that its survivors go to, and its counts.
typedef struct BoundsWork {
    TriangleSetupParams params;
    __constant const Projection* projection;
    __global const float* vertices;  // from the first triangle on
    __global const uint* pyramid;
    __global TriangleBounds* bounds;
    __global uint* map_candidates;
    __global FrameCounters* counters;
    Reservation slots, candidate_slots;
    BoundsCounts counts;
} BoundsWork;

static void append_block(BoundsWork* work, uint block) {
    uint first;
    BoundsBlock found;
    LaneInt survivors = bound_block(block, work->params, work->projection, work->vertices, work->pyramid, &first,
                                    &found, &work->counts);
    if (!LANES_ANY(survivors)) return;
    work->counts.expected += LANES_SELECT((LaneFloat)(0.0f), found.expected,
                                          survivors & LANE_COMPARE(found.flags, ==, (LaneInt)((int)BOUNDS_FOR_MAP)));
    for (uint bits = lane_bits(survivors); bits != 0u;) {
        int lane = take_lane(&bits);
        bool for_map = LANE_OF_INT(found.flags, lane) == (int)BOUNDS_FOR_MAP;
        work->counts.candidates += for_map;
        uint slot = reservation(&work->slots, &work->counters->slots);
        if (slot >= work->params.capacity) continue;
        *(__global uint4*)&work->bounds[slot] = lane_bounds(&found, lane, first + (uint)lane);
        if (!for_map) continue;
        uint candidate = reservation(&work->candidate_slots, &work->counters->map_slots);
        if (candidate < work->params.capacity) work->map_candidates[candidate] = slot;
    }
}

// A CPU takes GN_LANES clusters at a time: the listed clusters, or (if no clusters are kept) the clusters with boxes,
// made on the way, that survive the cull. A box around triangles takes a small part of the time that bounding them one
// by one does; where it drops fewer than one in MIN_DROPPED clusters, the next groups skip the box.
#define BLOCKS_OF_CLUSTER (CLUSTER_TRIANGLES / GN_LANES)
#define MIN_DROPPED 4u
#define GROUPS_WITHOUT_BOXES 3u

typedef struct ClusterGroup {
    uint clusters[GN_LANES];
    uint count;
} ClusterGroup;

GN_NOINLINE_ON_CPU void cull_by_boxes(BoundsWork* work, uint first, uint count, ClusterGroup* group) {
    ClusterBoxes boxes;
    make_boxes(work->vertices, work->params.triangles.count, first, &boxes);
    LaneInt too_far, present = LANE_COMPARE(boxes.low[0], <=, boxes.high[0]);
    LaneInt visible =
        visible_boxes(&boxes, present, work->projection, work->pyramid, work->params.has_pyramid != 0u, &too_far);
    group->count = 0;
    for (uint lane = 0; lane < count; ++lane) {
        uint cluster = first + lane;
        if (LANE_OF_INT(visible, lane)) {
            group->clusters[group->count++] = cluster;
        } else {
            uint triangles = min(work->params.triangles.count - cluster * CLUSTER_TRIANGLES, CLUSTER_TRIANGLES);
            work->counts.visited += triangles;
            work->counts.finite += triangles - (uint)LANE_OF_INT(boxes.not_finite, lane);
        }
    }
}

// At its end the item marks its reserved but unused slots.
GN_NOINLINE_ON_CPU void bound_clusters(ItemRange items, uint cluster_count, __global const uint* clusters,
                                       BoundsWork* work) {
    uint without_boxes = 0, capacity = work->params.capacity;
    GN_FOR_EACH_OF(i, items) {
        uint first = (uint)i * GN_LANES;
        ClusterGroup group;
        group.count = min(cluster_count - first, (uint)GN_LANES);
        if (work->params.has_clusters || without_boxes != 0u) {
            for (uint k = 0; k < group.count; ++k)
                group.clusters[k] = work->params.has_clusters ? clusters[first + k] : first + k;
            without_boxes -= without_boxes != 0u;
        } else {
            uint count = group.count;
            cull_by_boxes(work, first, count, &group);
            if ((count - group.count) * MIN_DROPPED < count) without_boxes = GROUPS_WITHOUT_BOXES;
        }
        for (uint k = 0; k < group.count * BLOCKS_OF_CLUSTER; ++k)
            append_block(work, group.clusters[k / BLOCKS_OF_CLUSTER] * BLOCKS_OF_CLUSTER + k % BLOCKS_OF_CLUSTER);
    }
    for (; work->slots.next < min(work->slots.end, capacity); ++work->slots.next)
        drop_bounds(&work->bounds[work->slots.next]);
    for (; work->candidate_slots.next < min(work->candidate_slots.end, capacity); ++work->candidate_slots.next)
        work->map_candidates[work->candidate_slots.next] = GN_NO_ID;
}
#endif

// A GPU's work-group keeps its survivors in `found`, BOUNDS_AT_ONCE for each of its items, and reserves slots for all
// of them by one atomic: an atomic for each warp takes longer than the pass.
__kernel void triangle_bounds(TriangleSetupParams params, __constant const Projection* projection,
                              __global const float* vertices, __global const uint* clusters,
                              __global const uint* pyramid, __global TriangleBounds* bounds,
                              __global uint* map_candidates, __global FrameCounters* counters,
                              __local uint4* found GN_SHARES) {
    __local uint sum;
    vertices += params.triangles.first_float;
#ifdef GN_CPU
    uint cluster_count =
        params.triangles.count / CLUSTER_TRIANGLES + (params.triangles.count % CLUSTER_TRIANGLES != 0u);
    if (params.has_clusters) cluster_count = counters->clusters_listed;
    if (projection->active_points == 0u) cluster_count = 0u;
    BoundsWork work = {params, projection, vertices, pyramid, bounds, map_candidates, counters};
    bound_clusters(GN_SHARED_RANGE((cluster_count + GN_LANES - 1u) / GN_LANES), cluster_count, clusters, &work);
    BoundsCounts counts = work.counts;
    // No count is added beyond `enough`, by this item or to a sum that has reached `enough`, so that no sum overflows.
    uint enough = texels_worth_a_map(projection->width, projection->height);
    uint texels = (uint)LANES_SUM(LANES_TO_INT(LANES_MIN(counts.expected, (LaneFloat)((float)enough))));
    volatile __global uint* counted = &counters->map_expected;
    if (texels != 0 && GN_RELAXED_LOAD(counted) < enough) atomic_add(counted, min(texels, enough));
#else
    uint blocks = params.has_clusters ? counters->clusters_listed * CLUSTER_TRIANGLES : params.triangles.count;
    if (projection->active_points == 0u) blocks = 0u;
    BoundsCounts counts = {0u};
    __local uint reserved[GROUP_APPEND_WORDS];
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), many = items * BOUNDS_AT_ONCE;
    if (item == 0u) reserved[0] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint base = (uint)get_group_id(0) * many; base < blocks; base += (uint)get_num_groups(0) * many) {
        for (uint i = base + item; i < min(base + many, blocks); i += items) {
            uint id;
            BoundsBlock of;
            uint block =
                params.has_clusters ? clusters[i / CLUSTER_TRIANGLES] * CLUSTER_TRIANGLES + i % CLUSTER_TRIANGLES : i;
            if (bound_block(block, params, projection, vertices, pyramid, &id, &of, &counts))
                found[atomic_inc(&reserved[0])] = lane_bounds(&of, 0u, id);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        uint count = reserved[0], first = reserve_for_group(count, reserved, &counters->slots);
        if (item == 0u) reserved[0] = 0u;
        for (uint i = item; i < count; i += items) {
            bool for_map = (found[i].z >> 16 & BOUNDS_FOR_MAP) != 0u;
            counts.candidates += for_map;
            if (first + i >= params.capacity) continue;
            *(__global uint4*)&bounds[first + i] = found[i];
            if (!for_map) continue;
            uint candidate = reserve_slots(1u, &counters->map_slots);
            if (candidate < params.capacity) map_candidates[candidate] = first + i;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
#endif
    uint not_finite = counts.visited - counts.finite, outside = counts.finite - counts.survivors;
    add_in_group(counts.survivors, &sum, &counters->survivors);
    add_in_group(counts.candidates, &sum, &counters->map_candidates);
    add_in_group(not_finite, &sum, &counters->not_finite);
    add_in_group(outside, &sum, &counters->outside);
    GN_END_SHARES;
}
