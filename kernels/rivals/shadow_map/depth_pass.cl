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

// ---- A GPU: chunks of large casters, then spans of small ones -------------------------------------------------------

#ifndef GN_CPU
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

static Drawing drawing_of(const DepthPass* pass, __global const float* vertices, __global const MapView* views,
                          __global const float* tables, __global const uint* nearest, __global uint* output) {
    Drawing d = {*pass, triangles_of(vertices, pass->triangles), views, tables, nearest, output};
    d.home = (uint2)(0);
    d.reach = WHOLE_MAP;
    return d;
}

// A caster that waits in local memory for the group's items.
typedef struct WaitingCaster {
    Casters caster;
    uint view, id;
} WaitingCaster;
typedef char waiting_caster_has_its_size[sizeof(WaitingCaster) == 4 * WAITING_CASTER_WORDS ? 1 : -1];

// True if other casters hide all tiles that a small one touches.
static bool is_hidden(const Drawing* d, const Casters* caster, volatile __global uint* tile_keys) {
    TexelRectangle texels = covered_by(&caster->covered, 0);
    bool is_hidden = d->pass.pass != PASS_SECOND;
    for (uint t = 0; is_hidden && t < tile_count_of(texels); ++t)
        is_hidden =
            is_behind(&d->pass, caster->min_depth, GN_RELAXED_LOAD(key_of_tile(d, tile_keys, tile_of(texels, t))));
    return is_hidden;
}

// Puts an item's caster into local memory for the group, if it is cut into chunks or, without `takes_chunks`, if it is
// not. Returns the number of its chunks or spans, which the group's items share out.
GN_INLINE uint put_caster(Drawing* d, __global const MapView* views, uint2 of, bool takes_chunks,
                          volatile __global uint* tile_keys, __local WaitingCaster* waiting) {
    MapVertices h[3];
    WaitingCaster mine = {{{{0}}}, of.x, of.y};
    d->view = views + of.x;
    if (!load_one_caster(d, of.y, &mine.caster, h) || is_chunked(&mine.caster) != takes_chunks) return 0u;
    if (!takes_chunks && is_hidden(d, &mine.caster, tile_keys_of_view(d, tile_keys, of.x))) return 0u;
    make_casters(h, &mine.caster);
    *waiting = mine;
    TexelRectangle texels = covered_by(&mine.caster.covered, 0);
    return takes_chunks ? chunk_count_of(texels) : spans_of(texels);
}

// Lists the chunks of large casters, and in the first pass lowers the keys of the tiles that they cover: EMPTY_KEY
// before. Local memory: for each item its caster, and the end of its chunks. An item draws a chunk that finds no room
// at once.
__kernel void depth_pass_list(DepthPass pass, __global const float* vertices, __global const MapView* views,
                              __global const float* tables, __global const uint2* listed, __global const uint* nearest,
                              __global uint* output, __global Chunk* chunks, __global uint* chunk_count,
                              volatile __global uint* tile_keys, __local WaitingCaster* waiting) {
    __local uint reserved[GROUP_APPEND_WORDS];
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), count = listed_count(&pass, listed);
    __local uint* ends = (__local uint*)(waiting + items);
    if (item == 0u) reserved[0] = 0u;
    Drawing d = drawing_of(&pass, vertices, views, tables, nearest, output);
    GN_ROUNDS(round, count) {
        uint i = index_in_round(round, count), wanted = 0u;
        if (i < count)
            wanted = put_caster(&d, views, listed_triangle(&pass, listed, i), true, tile_keys, &waiting[item]);
        scan_group(wanted, ends);
        for (uint begin = 0, total = ends[items - 1u]; begin < total; begin += items) {
            WaitingCaster w;
            Chunk chunk;
            TexelRectangle texels;
            bool is_open = false;
            if (begin + item < total) {
                uint owner = item_of_piece(ends, begin + item);
                w = waiting[owner];
                chunk.id = w.id, chunk.view = w.view;
                chunk.chunk = piece_of_item(ends, owner, begin + item);
                d.view = views + w.view;
                texels = chunk_of(covered_by(&w.caster.covered, 0), chunk.chunk);
                TileBounds bounds = bounds_in(&d, &w.caster, texels);
                is_open = !bounds.missed;
                if (pass.pass == PASS_NEAREST)
                    lower_tile_keys(&d, bounds, w.id, texels, tile_keys_of_view(&d, tile_keys, w.view));
            }
            uint at = append_in_group(is_open ? 1u : 0u, reserved, chunk_count);
            if (!is_open) continue;
            if (at < pass.chunk_capacity)
                chunks[at] = chunk;
            else
                draw_alone(&d, &w.caster, w.id, texels);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// Loads a chunk's caster and view; returns its texels.
static TexelRectangle load_chunk(Drawing* d, __global const MapView* views, const Chunk* chunk, Casters* caster) {
    MapVertices h[3];
    d->view = views + chunk->view;
    load_one_caster(d, chunk->id, caster, h);
    make_casters(h, caster);
    return chunk_of(covered_by(&caster->covered, 0), chunk->chunk);
}

__kernel void depth_pass_chunks(DepthPass pass, __global const float* vertices, __global const MapView* views,
                                __global const float* tables, __global const uint* nearest, __global uint* output,
                                __global const Chunk* chunks, __global const uint* chunk_count,
                                volatile __global uint* tile_keys) {
    __local PartTiles tiles;
    Drawing d = drawing_of(&pass, vertices, views, tables, nearest, output);
    uint count = min(*chunk_count, pass.chunk_capacity);
    GN_FOR_EACH_BY_GROUP(uint, i, count) {
        Chunk chunk = chunks[i];
        Casters caster;
        TexelRectangle texels = load_chunk(&d, views, &chunk, &caster);
        volatile __global uint* keys = tile_keys_of_view(&d, tile_keys, chunk.view);
        draw_by_group(&d, &caster, chunk.id, texels, pass.pass == PASS_SECOND ? 0 : keys, &tiles);
    }
}

// Draws small casters: the group's items share out the spans of their casters evenly. Local memory: for each item its
// caster, and the end of its spans.
__kernel void depth_pass_small(DepthPass pass, __global const float* vertices, __global const MapView* views,
                               __global const float* tables, __global const uint2* listed, __global const uint* nearest,
                               __global uint* output, volatile __global uint* tile_keys,
                               __local WaitingCaster* waiting) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), count = listed_count(&pass, listed);
    __local uint* ends = (__local uint*)(waiting + items);
    Drawing d = drawing_of(&pass, vertices, views, tables, nearest, output);
    GN_ROUNDS(round, count) {
        uint i = index_in_round(round, count), wanted = 0u;
        if (i < count)
            wanted = put_caster(&d, views, listed_triangle(&pass, listed, i), false, tile_keys, &waiting[item]);
        scan_group(wanted, ends);
        for (uint k = item; k < ends[items - 1u]; k += items) {
            uint owner = item_of_piece(ends, k);
            WaitingCaster w = waiting[owner];
            CasterCutOut cut_out;
            d.view = views + w.view;
            load_caster_cut_out(&d, w.id, &cut_out);
            TexelGrid grid = grid_of(&d);
            TexelRectangle texels = covered_by(&w.caster.covered, 0);
            uint span = piece_of_item(ends, owner, k), across = spans_across(texels);
            // The quotient is half a span or more away from a whole number: it rounds as integers do.
            uint row = (uint)(((float)span + 0.5f) / (float)across);
            draw_span(&d, &grid, &w.caster, &cut_out, texels, row, span - row * across);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
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
