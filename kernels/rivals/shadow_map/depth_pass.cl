// SPDX-License-Identifier: MIT
// Depth pass: rasterizes the casters into all views of a shadow map (contract: depth_pass.h).
//
// A work-item draws a small triangle at once. It lists a larger triangle in chunks of CHUNK_TILES tiles, so that all
// work-items have about equal work; a tile that an edge excludes costs three evaluations.
#include "rivals/shadow_map/caster.clh"

__kernel void depth_pass_small(DepthPass pass, __global const float* vertices, __global const MapView* views,
                               __global const float* tables, __global uint* nearest, __global uint* output,
                               __global uint* chunk_count, __global uint2* chunks) {
    __global const MapView* view = views + pass.view_index;
    if (view->width == 0) return;
    GN_FOR_EACH(i, pass.triangle_count) {
        Caster caster;
        if (!load_caster(view, tables, vertices, &pass, (uint)i, &caster)) continue;
        if (texels_of(caster.covered) <= SMALL_TEXELS) {
            draw_rectangle(&pass, view, tables, &caster, caster.covered, nearest, output);
            continue;
        }
        uint2 tiles = tiles_of(caster.covered);
        uint count = (tiles.x * tiles.y + CHUNK_TILES - 1) / CHUNK_TILES;
        uint first = atomic_add(chunk_count, count);
        for (uint c = 0; c < count && first + c < pass.chunk_capacity; ++c) chunks[first + c] = (uint2)((uint)i, c);
    }
}

// On a CPU neighbouring work-items would take the chunks of one triangle, so groups take chunks in turn.
__kernel void depth_pass_large(DepthPass pass, __global const float* vertices, __global const MapView* views,
                               __global const float* tables, __global uint* nearest, __global uint* output,
                               __global const uint* chunk_count, __global const uint2* chunks) {
    __global const MapView* view = views + pass.view_index;
    if (view->width == 0) return;
    uint count = min(*chunk_count, pass.chunk_capacity);
    for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
        uint2 chunk = chunks[i];
        Caster caster;
        load_caster(view, tables, vertices, &pass, chunk.x, &caster);
        uint2 tiles = tiles_of(caster.covered);
        uint last = min((chunk.y + 1) * CHUNK_TILES, tiles.x * tiles.y);
        for (uint t = chunk.y * CHUNK_TILES + (uint)get_local_id(0); t < last; t += (uint)get_local_size(0))
            draw_tile(&pass, view, tables, &caster, (uint2)(t % tiles.x, t / tiles.x), nearest, output);
    }
}

// Dual depth layers (Weiskopf and Ertl 2003): the map lies half-way to the second layer, but no
// deeper than `limit` behind the first.
__kernel void depth_pass_midpoint(MapSet set, float limit, __global uint* nearest, __global const uint* second) {
    GN_FOR_EACH(i, set.texels) {
        float first = as_float(nearest[i]);
        nearest[i] = as_uint(first + fmin(0.5f * (as_float(second[i]) - first), limit));
    }
}
