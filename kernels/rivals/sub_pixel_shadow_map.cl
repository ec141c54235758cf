// SPDX-License-Identifier: MIT
// Sub-pixel shadow map: stores the nearest triangle of each texel and tests points against the triangles near them.
//
// Bins are texels here (bin_log2 is 0), so that bin_overlap.clh rasterizes conservatively: a texel leaves a triangle
// out only if the triangle certainly misses the texel.
#include "rivals/sub_pixel_shadow_map.h"

#include "exact/decide_pair.clh"
#include "occluders/bin_overlap.clh"
#include "occluders/triangle_setup.h"

// Items that share a tile, which may have 64 texels; a power of two.
#ifdef GN_CPU
#define TILE_ITEMS 1u
#else
#define TILE_ITEMS 8u
#endif

// The triangle's greatest height in a texel, towards the light, as a key: its plane's highest corner, or its highest
// vertex. If a float cannot represent the height, the key is the farthest one, so that the triangle hides no other.
static uint height_key(const TriangleRecord* record, float4 square) {
    float plane = highest_at_corners(record->plane_x, record->plane_y, record->plane_0, square) + record->margin_plane;
    float height = fmin(plane, record->z_high);
    return float_to_key(height < INFINITY ? height : -INFINITY);
}

#ifdef GN_CUT_OUTS
// True if a masked triangle is clear where the light sees it in the texel's middle, or, where that is beside the
// triangle, on its border. The record's edges are barycentric coordinates times their sum (edge i lies opposite vertex
// i + 2), without bounds: where alpha is nearly the threshold, either is right. A record that leaves all to the exact
// predicate has none, and its triangle is stored.
static bool is_clear_in_texel(const CutOut* cut_out, const TriangleRecord* record, float4 square) {
    float2 middle = 0.5f * (square.xy + square.zw);
    float e[3];
    for (int i = 0; i < 3; ++i)
        e[i] = fmax(fma(record->edge_x[i], middle.x, fma(record->edge_y[i], middle.y, record->edge_0[i])), 0.0f);
    return class_of_hit(cut_out, weights_of(e[1], e[2], e[0], 0)) == CUT_OUT_CLEAR;
}
#endif

// Runs twice. The first run finds the nearest height of each texel, the second (stores_ids) the lowest id among the
// triangles at that height, so that the order of work does not change the map. Cleared before: heights 0, ids GN_NO_ID.
__kernel void sub_pixel_draw(SubPixelParams params, __constant const Projection* projection,
                             __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                             __global const uint2* tiles, __global const float* vertices, __global uint* heights,
                             __global uint* ids, __global FrameCounters* counters) {
    uint tile_count = min(counters->tiles, params.tile_capacity), texels = 0;
    GN_FOR_EACH(i, tile_count * TILE_ITEMS) {
        uint2 tile = tiles[i / TILE_ITEMS];
        if (tile.x == GN_NO_ID) continue;
        TriangleRecord record = records[tile.x];
        uint id = bounds[tile.x].id;
#ifdef GN_CUT_OUTS
        Triangles triangles = triangles_of(vertices, params.framed.triangles);
        bool is_masked = cut_out_class(triangles, id) == CUT_OUT_MASKED;
        CutOut cut_out;
        if (is_masked) cut_out = load_cut_out(triangles, id);
#endif
        uint4 rectangle = bins_of_tile(tile.y);
        uint count = bins_of_rectangle(rectangle);
        for (uint t = (uint)i % TILE_ITEMS; t < count; t += TILE_ITEMS) {
            uint4 texel = bin_of_rectangle(rectangle, t);
            if (!survives_cull(&record, projection, texel, 0u, heights)) continue;
            uint at = texel.y * projection->width + texel.x;
            float4 square = square_of_bins(texel, projection);
#ifdef GN_CUT_OUTS
            if (is_masked && is_clear_in_texel(&cut_out, &record, square)) continue;
#endif
            uint key = height_key(&record, square);
            if (!params.stores_ids)
                atomic_max(&heights[at], key);
            else if (heights[at] == key && atomic_min(&ids[at], id) == GN_NO_ID)
                ++texels;
        }
    }
    if (texels != 0) atomic_add(&counters->map_texels, texels);
}

// True if a stored triangle blocks the point. The map's texels at most `reach` away from (x, y) store the triangles.
static bool is_blocked(float3 point, uint receiver, int x, int y, int reach, __constant const Projection* projection,
                       float4 light, Triangles triangles, __global const uint* ids) {
    int last_x = min(x + reach, (int)projection->width - 1), last_y = min(y + reach, (int)projection->height - 1);
    uint tested = GN_NO_ID;  // neighbours mostly store the same triangle
    for (int v = max(y - reach, 0); v <= last_y; ++v)
        for (int u = max(x - reach, 0); u <= last_x; ++u) {
            uint id = ids[(uint)v * projection->width + (uint)u];
            if (id == GN_NO_ID || id == receiver || id == tested) continue;
            int level = DET3_BY_FLOAT;
            if (decide_pair(triangles, id, point, light, &level)) return true;
            tested = id;
        }
    return false;
}

// Decides the open points of one frame.
__kernel void sub_pixel_lookup(SubPixelParams params, __constant const Projection* projection,
                               __global const float* positions, __global const uint* receivers,
                               __global const float* vertices, __global const uint* ids, __global float* visibility,
                               __global FrameCounters* counters) {
    PointsLayout layout = params.framed.layout;
    float4 light = light_of(params.framed.light_frame);
    Triangles triangles = triangles_of(vertices, params.framed.triangles);
    uint in_shadow = 0;
    GN_FOR_EACH(block, block_count(layout)) {
        FrameBlock at;
        if (!load_frame_block(params.framed, projection, positions, visibility, block, &at)) continue;
        LaneInt x = texel_indices(at.in_grid.x, projection->width), y = texel_indices(at.in_grid.y, projection->height);
        LaneInt blocked = (LaneInt)(0);
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(at.lanes, lane)) continue;
            uint receiver = layout.has_receivers ? receivers[point_of_lane(layout, block, lane)] : GN_NO_ID;
            if (is_blocked(lane_point(at.points, lane), receiver, LANE_OF_INT(x, lane), LANE_OF_INT(y, lane),
                           (int)params.reach, projection, light, triangles, ids))
                LANE_OF_INT(blocked, lane) = -1;
        }
        in_shadow += count_lanes(blocked);
        store_frame_block(params.framed, &at, blocked, visibility, block);
    }
    if (in_shadow != 0) atomic_add(&counters->decided_by_exact, in_shadow);
}
