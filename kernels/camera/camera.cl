// SPDX-License-Identifier: MIT
// Camera: visibility buffer by tiles, then shading points. Contract and proofs in camera.h.
//
// A CPU's work-item takes blocks of GN_LANES pixels and walks their tile's triangle list; a GPU's work-group takes a
// tile (nearest_gpu.clh), several groups one with a long list. The nearest stay in registers: no atomics, and the same
// result in any order. The records' margins prove which pixels are certain; the rest are decided per pixel, exactly.
// Double precision is the device's own or made of integers (exact/wide.clh).
#include "camera/pixel_rays.clh"
#include "camera/shading_lanes.clh"
#include "camera/shading_point.clh"

#if GN_LANES == 1
static void find_visible(VisibilityWork* work, __local ListBatch* batch) {
    float3 eye = center_of(work->projection);
    uint shares = groups_per_tile(), count = work->projection->bins_x * work->projection->bins_y * shares;
    GN_FOR_EACH_BY_GROUP(uint, i, count) {
        uint tile = i / shares;
        uint2 range = work->lists.ranges[tile];
        ItemPixel item = start_tile(work, tile, i % shares, batch);
        if (range.y - range.x > work->params.long_list) {
            // long_lists.cl writes these pixels, but camera_points reads them before.
            store_visible(&item.block, (int)GN_NO_ID, work->visible + work->params.first_point);
            continue;
        }
        NearestSearch search = {work->lists, eye};
        NearestLanes best = nearest_of_group(&search, range, i % shares, part_of_tile(item.in_tile), &item.block.rays,
                                             item.block.box, item.searching, batch);
        store_visible(&item.block, item.searching ? best.id : item.own, work->visible + work->params.first_point);
    }
}
#else
GN_NOINLINE_ON_CPU void find_visible(ItemRange items, VisibilityWork* work) {
    __constant const Projection* projection = work->projection;
    TileBlocks tile;
    GN_FOR_EACH_OF(i, items) {
        start_tile(work, (uint)i, &tile);
        for (uint within = 0; within < GN_LANES; ++within) {
            uint first_x = tile.first_x + within % BLOCKS_PER_ROW * BLOCK_SIDE;
            uint first_y = tile.first_y + within / BLOCKS_PER_ROW * BLOCK_SIDE;
            if (first_y >= projection->height || first_x >= projection->width) continue;
            PixelRays block = rays_of_pixels(work, first_x, first_y);
            LaneInt own, searching = lanes_to_search(work, &block, &own);
            LaneInt nearest = nearest_of_block(work, &tile, within, &block, searching);
            store_visible(&block, LANES_SELECT(own, nearest, searching), work->visible + work->params.first_point);
        }
    }
}
#endif

// `rays` has one ray per pixel, through one sample. With pixel_receivers, a sample takes the receiver of its pixel if
// the sample's ray meets that receiver, even if another triangle hides it. On a GPU the tiles with long lists are
// left to long_lists.cl.
__kernel void camera_visibility(CameraParams params, __constant const Projection* projection,
                                __global const float* vertices, __global const float* rays,
                                __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                                __global const uint2* ranges, __global const BinEntries* entries,
                                __global const uint* pixel_receivers, __global uint* visible,
                                __global const FrameCounters* counters GN_SHARES) {
#if GN_LANES == 1
    if (counters->references == GN_NO_LISTS) return;
#endif
    Triangles triangles = triangles_of(vertices, params.triangles);
    TileLists lists = {ranges, entries, records, bounds, triangles, rays, params.picture};
    VisibilityWork work = {params, projection, lists, pixel_receivers, visible, GN_NO_ID};
#if GN_LANES == 1
    __local ListBatch batch;
    find_visible(&work, &batch);
#else
    uint tiles = counters->references == GN_NO_LISTS ? 0u : projection->bins_x * projection->bins_y;
    find_visible(GN_SHARED_RANGE(tiles), &work);
    GN_END_SHARES;
#endif
}

#if GN_LANES == 1
// Lists the chunks of all long lists, those of a list one after the other.
__kernel void camera_chunks(uint tile_count, uint long_list, __global const uint2* ranges, __global ListChunk* chunks,
                            __global FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    GN_FOR_EACH(tile, tile_count) {
        uint count = chunks_of_list(ranges[tile], long_list);
        if (count == 0u) continue;
        uint first = atomic_add(&counters->chunks, count);
        for (uint i = 0; i < count; ++i) chunks[first + i] = (ListChunk){(uint)tile, i};
    }
}
#endif

static float3 eye_of_camera(CameraParams params) { return (float3)(params.eye[0], params.eye[1], params.eye[2]); }

#if GN_LANES == 1 || !defined(GN_FP64)
GN_NOINLINE_ON_CPU void make_points(ItemRange items, CameraParams params, __global const float* vertices,
                                    __global const float* rays, __global const uint* visible,
                                    __global float* positions) {
    float3 eye = eye_of_camera(params);
    uint width = params.width;
    SeenTriangle seen;
    seen.id = GN_NO_ID;
    GN_FOR_EACH_OF(pixel, items) {
        float3 p = (float3)(NAN);
        size_t point = params.first_point + pixel;
        if (visible[point] != GN_NO_ID) {
            if (visible[point] != seen.id)
                seen = see_triangle(vertices + params.triangles.first_float, visible[point], eye);
            p = shading_point(&seen, eye, load_ray(rays, (uint)(pixel % width), width + (uint)(pixel / width)));
        }
        positions[point] = p.x;
        positions[point + params.point_count] = p.y;
        positions[point + 2 * (size_t)params.point_count] = p.z;
    }
}

#endif

// Positions as a structure of arrays: x of all points, then y, then z. Sky: NaN.
__kernel void camera_points(CameraParams params, __global const float* vertices, __global const float* rays,
                            __global const uint* visible, __global float* positions,
                            __global const FrameCounters* counters GN_SHARES) {
    bool has_lists = counters->references != GN_NO_LISTS;
#if GN_LANES > 1 && defined(GN_FP64)
    PointsWork work = {params,
                       eye_of_camera(params),
                       vertices + params.triangles.first_float,
                       rays,
                       visible,
                       positions,
                       largest_sizes(params.picture, params.width, params.height)};
    const uint side = 1u << CAMERA_TILE_LOG2;
    uint tiles = ((params.width + side - 1u) >> CAMERA_TILE_LOG2) * ((params.height + side - 1u) >> CAMERA_TILE_LOG2);
    make_points_of_tiles(GN_SHARED_RANGE(has_lists ? tiles : 0u), &work);
#else
    uint pixels = has_lists ? params.width * params.height : 0u;
    make_points(GN_SHARED_RANGE(pixels), params, vertices, rays, visible, positions);
#endif
    GN_END_SHARES;
}

static float3 unit_normal(Triangle t, float3 eye) {
    Wide3 n = normal_towards_eye(det3_cross(det3_row(t.b, t.a), det3_row(t.c, t.a)), t, eye);
    Wide largest = largest_coordinate(n);
    n.x = wide_div(n.x, largest);
    n.y = wide_div(n.y, largest);
    n.z = wide_div(n.z, largest);
    Wide length_of_n = wide_sqrt(wide_dot(n.x, n.y, n.z, n.x, n.y, n.z));
    return (float3)(float_of_wide(wide_div(n.x, length_of_n)), float_of_wide(wide_div(n.y, length_of_n)),
                    float_of_wide(wide_div(n.z, length_of_n)));
}

GN_NOINLINE_ON_CPU void make_normals(ItemRange items, CameraParams params, __global const float* vertices,
                                     __global const uint* visible, __global float* normals) {
    float3 eye = eye_of_camera(params);
    uint id = GN_NO_ID;  // the triangle of `normal`
    float3 normal = (float3)(0.0f);
    GN_FOR_EACH_OF(pixel, items) {
        if (visible[pixel] != id) {
            id = visible[pixel];
            normal = (float3)(0.0f);
            if (id != GN_NO_ID) normal = unit_normal(load_triangle(vertices + params.triangles.first_float, id), eye);
        }
        vstore3(normal, pixel, normals);
    }
}

// Unit geometric normals facing the camera, packed xyz, for the host and for shading. Sky: 0.
__kernel void camera_normals(CameraParams params, __global const float* vertices, __global const uint* visible,
                             __global float* normals GN_SHARES) {
    make_normals(GN_SHARED_RANGE(params.width * params.height), params, vertices, visible, normals);
    GN_END_SHARES;
}

// Lifts each point off its receiver as camera.h describes it for the camera's points; the given point is used as the
// hit. A point that is absent, or has no receiver with a plane, is not moved. Packed xyz.
__kernel void lift_points(LiftParams params, __global const float* vertices, __global const float* positions,
                          __global const uint* receivers, __global float* lifted_positions) {
    float3 eye = (float3)(params.eye[0], params.eye[1], params.eye[2]);
    GN_FOR_EACH(i, params.layout.count) {
        float3 p = load_point(positions, params.layout, i);
        if (receivers[i] < params.triangle_count && is_present(p)) {
            Triangle t = load_triangle(vertices + params.first_float, receivers[i]);
            if (is_finite_triangle(t)) {
                Wide3 hit;
                hit.x = wide_of_float(p.x);
                hit.y = wide_of_float(p.y);
                hit.z = wide_of_float(p.z);
                Wide3 n = normal_towards_eye(det3_cross(det3_row(t.b, t.a), det3_row(t.c, t.a)), t, eye);
                if (!wide_is_zero(largest_coordinate(n)))
                    p = lifted(hit, n, lift_of(wide_max(largest_coordinate(hit), eye_size_of(eye))));
            }
        }
        vstore3(p, i, lifted_positions);
    }
}
