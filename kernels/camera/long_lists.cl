// SPDX-License-Identifier: MIT
// Camera, on a GPU: the tiles with long lists, which camera_visibility leaves out. A work-group finds the nearest
// triangles of one chunk of such a list; then those of a tile's chunks are compared. The order of hits is total
// (camera.h), so the nearest of the chunks' nearest is the nearest of the list.
#include "camera/pixel_rays.clh"

#if GN_LANES == 1

// Writes for each pixel of a chunk's tile the slot of the chunk's nearest triangle, GN_NO_ID if there is none.
__kernel void camera_search_chunks(const CameraParams params, __constant const Projection* projection,
                                   __global const float* vertices, __global const float* rays,
                                   __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                                   __global const uint2* ranges, __global const BinEntries* entries,
                                   __global const uint* pixel_receivers, __global const ListChunk* chunks,
                                   __global uint* found) {
    __local ListBatch batch;
    Triangles triangles = triangles_of(vertices, params.triangles);
    TileLists lists = {ranges, entries, records, bounds, triangles, rays, params.picture};
    VisibilityWork work = {params, projection, lists, pixel_receivers, 0, GN_NO_ID};
    uint shares = groups_per_tile();
    GN_FOR_EACH_BY_GROUP(uint, i, params.chunk_count * shares) {
        ListChunk chunk = chunks[i / shares];
        uint2 range = ranges[chunk.tile];
        range.x += chunk.index * params.long_list;
        range.y = min(range.x + params.long_list, range.y);
        ItemPixel item = start_tile(&work, chunk.tile, i % shares, &batch);
        NearestSearch search = {lists, center_of(projection)};
        NearestLanes best = nearest_of_group(&search, range, i % shares, part_of_tile(item.in_tile), &item.block.rays,
                                             item.block.box, item.searching, &batch);
        if (item.in_tile < TILE_PIXELS) found[(size_t)(i / shares) * TILE_PIXELS + item.in_tile] = (uint)best.slot;
    }
}

// Writes the nearest of the triangles that were found in the chunks of a pixel's tile.
__kernel void camera_join_chunks(const CameraParams params, __constant const Projection* projection,
                                 __global const float* vertices, __global const float* rays,
                                 __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                                 __global const uint2* ranges, __global const uint* pixel_receivers,
                                 __global const ListChunk* chunks, __global const uint* found, __global uint* visible) {
    __local ListBatch batch;
    Triangles triangles = triangles_of(vertices, params.triangles);
    TileLists lists = {ranges, 0, records, bounds, triangles, rays, params.picture};
    VisibilityWork work = {params, projection, lists, pixel_receivers, visible, GN_NO_ID};
    uint shares = groups_per_tile();
    GN_FOR_EACH_BY_GROUP(uint, i, params.chunk_count * shares) {
        ListChunk chunk = chunks[i / shares];
        if (chunk.index != 0u) continue;
        ItemPixel item = start_tile(&work, chunk.tile, i % shares, &batch);
        NearestLanes best = nothing_near();
        uint count = item.searching ? chunks_of_list(ranges[chunk.tile], params.long_list) : 0u;
        for (uint k = 0; k < count; ++k) {
            uint slot = found[(size_t)(i / shares + k) * TILE_PIXELS + item.in_tile];
            if (slot != GN_NO_ID) test_record(lists, center_of(projection), &item.block.rays, slot, -1, &best);
        }
        store_visible(&item.block, item.searching ? best.id : item.own, visible + params.first_point);
    }
}

#endif
