// SPDX-License-Identifier: MIT
// Depth pass: rasterizes the casters into all views of a shadow map (contract: depth_pass.h).
#include "rivals/rasterizer/caster_chunks.clh"
#include "rivals/rasterizer/caster_windows.clh"

// ---- A CPU: covers of clusters, then windows ------------------------------------------------------------------------

#ifdef GN_CPU
// Adds a cluster's triangles to its cover.
static void cover_cluster(const Drawing* d, size_t first, int lane, ClusterCovers* covers) {
    LaneInt low_x = (LaneInt)(INT_MAX), low_y = low_x, high_x = (LaneInt)(-1), high_y = high_x;
    LaneFloat least = (LaneFloat)(INFINITY);
    LaneInt large = (LaneInt)(0);
    for (uint i = 0; i < CLUSTER_TRIANGLES && first < d->triangles.count; i += GN_LANES, first += GN_LANES) {
        Casters c;
        MapVertices h[3];
        TriangleBlock t = load_triangles(d->triangles.vertices, first, d->triangles.count);
        LaneInt lanes = LANE_COMPARE((LaneInt)((int)min(d->triangles.count - first, (size_t)GN_LANES)), >, LANE_INDEX);
        lanes = load_casters(d, &t, LANE_INDEX + (int)first, lanes, &c, h);
        low_x = min(low_x, LANES_SELECT(low_x, c.covered.low_x, lanes));
        low_y = min(low_y, LANES_SELECT(low_y, c.covered.low_y, lanes));
        high_x = max(high_x, LANES_SELECT(high_x, c.covered.high_x, lanes));
        high_y = max(high_y, LANES_SELECT(high_y, c.covered.high_y, lanes));
        large |= lanes & large_lanes(&c.covered);
        least = fmin(least, LANES_SELECT(least, c.min_depth, lanes));
    }
    LANE_OF_INT(covers->covered.low_x, lane) = LANES_MINIMUM(low_x);
    LANE_OF_INT(covers->covered.low_y, lane) = LANES_MINIMUM(low_y);
    LANE_OF_INT(covers->covered.high_x, lane) = LANES_MAXIMUM(high_x);
    LANE_OF_INT(covers->covered.high_y, lane) = LANES_MAXIMUM(high_y);
    LANE_OF_FLOAT(covers->min_depth, lane) = LANES_LEAST(least);
    LANE_OF_INT(covers->has_large, lane) = LANES_ANY(large) ? -1 : 0;
}

// covers[view blocks + block]: of GN_LANES neighbouring clusters.
__kernel void depth_pass_covers(DepthPass pass, __global const float* vertices, __global const ClusterBoxes* boxes,
                                __global const MapView* views, __global const float* tables,
                                __global ClusterCovers* covers) {
    uint blocks = (pass.cluster_count + GN_LANES - 1u) / GN_LANES;
    Drawing d = {pass, triangles_of(vertices, pass.triangles)};
    d.tables = tables;
    d.reach = WHOLE_MAP;
    GN_FOR_EACH(i, pass.view_count * blocks) {
        d.view = views + (uint)i / blocks * pass.view_step;
        uint block = (uint)i % blocks, first = block * GN_LANES;
        ClusterCovers some = {{(LaneInt)(INT_MAX), (LaneInt)(INT_MAX), (LaneInt)(-1), (LaneInt)(-1)},
                              (LaneFloat)(INFINITY),
                              (LaneInt)(0)};
        LaneInt lanes = LANE_COMPARE((LaneInt)((int)min(pass.cluster_count - first, (uint)GN_LANES)), >, LANE_INDEX);
        if (d.view->width == 0u) lanes = (LaneInt)(0);
        if (pass.has_boxes && LANES_ANY(lanes)) {
            ClusterBoxes of_block = boxes[block];
            lanes &= boxes_may_cast(d.view, &of_block);
        }
        for (uint bits = lane_bits(lanes); bits != 0u;) {
            int lane = take_lane(&bits);
            cover_cluster(&d, (first + (uint)lane) * (size_t)CLUSTER_TRIANGLES, lane, &some);
        }
        covers[i] = some;
    }
}

// Windows of a view, across and down.
static uint2 windows_of(__global const MapView* view) {
    return (uint2)(view->width + (1u << WINDOW_LOG2) - 1u, view->height + (1u << WINDOW_LOG2) - 1u) >> WINDOW_LOG2;
}

__kernel void depth_pass_windows(DepthPass pass, __global const float* vertices, __global const MapView* views,
                                 __global const float* tables, __global const ClusterCovers* covers,
                                 __global const uint* nearest, __global uint* output) {
    uint blocks = (pass.cluster_count + GN_LANES - 1u) / GN_LANES, total = 0;
    for (uint v = 0; v < pass.view_count; ++v) total += windows_of(views + v).x * windows_of(views + v).y;
    GN_FOR_EACH(i, total) {
        uint v = 0, window = (uint)i;
        uint2 windows = windows_of(views);
        while (window >= windows.x * windows.y) {
            window -= windows.x * windows.y;
            windows = windows_of(views + ++v);
        }
        uint2 low = (uint2)(window % windows.x, window / windows.x) << WINDOW_LOG2;
        TexelRectangle square = square_of_texels(low, WINDOW_LOG2);
        Drawing d = {pass,   triangles_of(vertices, pass.triangles),       views + v, tables, nearest,
                     output, common_texels(square, whole_view(views + v)), (uint2)(0)};
        draw_window(&d, covers + v * blocks, 0u);
    }
}
#endif

// ---- A GPU: tiny casters at once, chunks of the others --------------------------------------------------------------

#ifndef GN_CPU
// An entry of the list has the view above this bit, and the chunk below it.
#define VIEW_SHIFT 22u

// Lists (view, cluster) of the clusters that may cast something into a view. listed[0].x: 0 before.
__kernel void depth_pass_clusters(DepthPass pass, __global const ClusterBoxes* boxes, __global const MapView* views,
                                  __global uint2* listed) {
    __local uint reserved[GROUP_APPEND_WORDS];
    if (get_local_id(0) == 0) reserved[0] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint count = pass.view_count * pass.cluster_count;
    GN_ROUNDS(round, count) {
        uint i = index_in_round(round, count);
        uint2 pair = (uint2)(i / pass.cluster_count, i % pass.cluster_count);
        bool wanted = false;
        if (i < count && views[pair.x].width != 0u) {
            ClusterBoxes box = boxes[pair.y];
            wanted = boxes_may_cast(views + pair.x, &box) != 0;
        }
        uint slot = append_in_group(wanted ? 1u : 0u, reserved, (__global uint*)listed);
        if (wanted) listed[1u + slot] = pair;
    }
}

// Draws a triangle if it is tiny; returns the number of chunks of any other.
static uint draw_or_count(Drawing* d, uint id) {
    Casters caster;
    MapVertices h[3];
    if (!load_one_caster(d, id, &caster, h)) return 0u;
    TexelRectangle covered = covered_by(&caster.covered, 0);
    if (texels_of(covered) > TINY_TEXELS) return chunk_count_of(covered);
    make_casters(h, &caster);
    draw_alone(d, &caster, id, covered);
    return 0u;
}

static void draw_chunk_alone(Drawing* d, uint id, uint chunk) {
    Casters caster;
    MapVertices h[3];
    load_one_caster(d, id, &caster, h);
    make_casters(h, &caster);
    draw_alone(d, &caster, id, chunk_of(covered_by(&caster.covered, 0), chunk));
}

// Local memory: for each item its triangle, and the end of its chunks. An item draws a chunk that finds no room at
// once.
__kernel void depth_pass_scatter(DepthPass pass, __global const float* vertices, __global const MapView* views,
                                 __global const float* tables, __global const uint2* listed,
                                 __global const uint* nearest, __global uint* output, __global uint2* chunks,
                                 __global uint* chunk_count, __local uint2* owners) {
    __local uint reserved[GROUP_APPEND_WORDS];
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), count = listed_count(&pass, listed);
    __local uint* ends = (__local uint*)(owners + items);
    Drawing d = {pass, triangles_of(vertices, pass.triangles), views, tables, nearest, output};
    d.home = (uint2)(0);
    d.reach = WHOLE_MAP;
    GN_ROUNDS(round, count) {
        uint i = index_in_round(round, count), wanted = 0u;
        if (i < count) {
            owners[item] = listed_triangle(&pass, listed, i);
            d.view = views + owners[item].x;
            wanted = draw_or_count(&d, owners[item].y);
        }
        scan_group(wanted, ends);
        uint total = ends[items - 1u], end;
        for (uint begin = 0; begin < total; begin = end) {
            end = min(total, begin + items * LARGEST_GROUP_APPEND);
            uint first = reserve_for_group(end - begin, reserved, chunk_count);
            for (uint k = begin + item; k < end; k += items) {
                uint owner = item_of_piece(ends, k), chunk = k - (owner == 0u ? 0u : ends[owner - 1u]);
                uint at = first + (k - begin);
                d.view = views + owners[owner].x;
                if (at < pass.chunk_capacity)
                    chunks[at] = (uint2)(owners[owner].y, owners[owner].x << VIEW_SHIFT | chunk);
                else
                    draw_chunk_alone(&d, owners[owner].y, chunk);
            }
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// tile_keys: EMPTY_KEY before.
__kernel void depth_pass_chunks(DepthPass pass, __global const float* vertices, __global const MapView* views,
                                __global const float* tables, __global const uint* nearest, __global uint* output,
                                __global const uint2* chunks, __global const uint* chunk_count,
                                volatile __global uint* tile_keys) {
    __local uint is_drawn[MAX_TILES];
    Drawing d = {pass, triangles_of(vertices, pass.triangles), views, tables, nearest, output};
    d.home = (uint2)(0);
    d.reach = WHOLE_MAP;
    uint count = min(*chunk_count, pass.chunk_capacity);
    for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
        uint2 chunk = chunks[i];
        uint view_index = chunk.y >> VIEW_SHIFT;
        Casters caster;
        MapVertices h[3];
        d.view = views + view_index;
        load_one_caster(&d, chunk.x, &caster, h);
        make_casters(h, &caster);
        draw_by_group(&d, &caster, chunk.x,
                      chunk_of(covered_by(&caster.covered, 0), chunk.y & ((1u << VIEW_SHIFT) - 1u)),
                      pass.pass == PASS_NEAREST ? tile_keys : 0, view_index, is_drawn);
    }
}
#endif

// Dual depth layers (Weiskopf and Ertl 2003): the map lies half-way to the second layer, but no
// deeper than `limit` behind the first.
__kernel void depth_pass_midpoint(MapSet set, float limit, __global uint* nearest, __global const uint* second) {
    GN_FOR_EACH(i, set.texels) {
        float first = as_float(nearest[i]);
        nearest[i] = as_uint(first + fmin(0.5f * (as_float(second[i]) - first), limit));
    }
}
