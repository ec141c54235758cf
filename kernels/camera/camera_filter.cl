// SPDX-License-Identifier: MIT
// Camera, on a GPU: finds the visibility buffer from records only, then decides the pairs of a pixel and a triangle
// that records leave open. The order of hits is total (camera.h), so a pixel's nearest triangle is the nearest of its
// certain one and of its open ones, in whatever order they are compared. A masked triangle is always open. Searches
// that begin with receivers, and views with more open pairs than fit, take camera_visibility, which decides in place.
#define GN_OPEN_PAIRS
#include "camera/pixel_rays.clh"

#if GN_LANES == 1

__kernel void camera_filter(const CameraParams params, __constant const Projection* projection,
                            __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                            __global const uint2* ranges, __global const BinEntries* entries, __global uint* visible,
                            __global uint2* open_pairs, uint open_capacity, __global FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    __local ListBatch batch;
    __local uint reserved[GROUP_APPEND_WORDS];
    if (get_local_id(0) == 0) reserved[0] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    TileLists lists = {ranges, entries, records, bounds, {0, 0u}, 0, params.picture};
    VisibilityWork work = {params, projection, lists, 0, visible, GN_NO_ID};
    uint shares = groups_per_tile(), count = projection->bins_x * projection->bins_y * shares;
    GN_FOR_EACH_BY_GROUP(uint, i, count) {
        uint tile = i / shares;
        uint2 range = ranges[tile];
        ItemPixel item = start_tile(&work, tile, i % shares, &batch);
        if (range.y - range.x > params.long_list) range.y = range.x;  // see camera_visibility
        NearestSearch search = {lists,
                                center_of(projection),
                                {open_pairs, open_capacity, &counters->open_pairs},
                                (uint)item.block.pixels,
                                GN_NO_ID,
                                0.0f};
        NearestLanes best = nearest_of_group(&search, range, i % shares, part_of_tile(item.in_tile), &item.block.rays,
                                             item.block.box, item.searching, &batch);
        bool holds = search.held != GN_NO_ID && search.held_high >= best.low;
        uint at = append_in_group(holds, reserved, &counters->open_pairs);
        if (holds) store_open_pair(&search, at);
        int id = best.slot == (int)GN_NO_ID ? best.slot : (int)bounds[best.slot].id;
        store_visible(&item.block, id, visible + params.first_point);
    }
}

__kernel void camera_open_pairs(const CameraParams params, __global const float* vertices, __global const float* rays,
                                __global const TriangleBounds* bounds, __global const uint2* open_pairs,
                                uint open_capacity, __global uint* visible, __global const FrameCounters* counters) {
    uint count = counters->references == GN_NO_LISTS ? 0u : counters->open_pairs;
    if (count > open_capacity) return;
    Triangles triangles = triangles_of(vertices, params.triangles);
    TileLists lists = {0, 0, 0, bounds, triangles, rays, params.picture};
    float3 eye = (float3)(params.eye[0], params.eye[1], params.eye[2]);
    visible += params.first_point;
    GN_FOR_EACH(i, count) {
        uint pixel = open_pairs[i].x, id = bounds[open_pairs[i].y].id;
        Ray ray = load_ray(rays, pixel % params.width, params.width + pixel / params.width);
        Outline outline = outline_of(load_triangle(triangles.vertices, id), eye);
        if (!covers(&outline, eye, ray) || !is_seen_opaque(&lists, id, eye, ray)) continue;
        for (uint other = GN_RELAXED_LOAD((volatile __global uint*)&visible[pixel]);;) {
            if (other != GN_NO_ID && !is_nearer(&lists, eye, ray, id, other)) break;
            uint before = atomic_cmpxchg(&visible[pixel], other, id);
            if (before == other) break;
            other = before;
        }
    }
}

#endif
