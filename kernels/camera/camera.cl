// SPDX-License-Identifier: MIT
// Camera: visibility buffer by tiles, then shading points. Contract and proofs in camera.h.
//
// One work-item takes GN_LANES pixels of one row of a tile and walks the tile's triangle list, keeping the nearest in
// registers: no atomics, and the same result in any order. The records' margins prove which pixels are certain; the
// rest are decided per pixel, exactly. Double precision is the device's own or made of integers (exact/wide.clh).
#include "camera/shading_point.clh"

#define BLOCKS_PER_TILE ((1u << 2 * CAMERA_TILE_LOG2) / GN_LANES)

// The nearest triangles of some of the blocks.
GN_NOINLINE_ON_CPU void find_visible(ItemRange items, CameraParams params, __constant const Projection* projection,
                                     TileLists lists, __global const uint* pixel_receivers, __global uint* visible) {
    const uint tile_pixels = 1u << CAMERA_TILE_LOG2;
    const uint blocks_per_row = tile_pixels / GN_LANES;
    float3 eye = center_of(projection);
    uint width = projection->width, height = projection->height;
    GN_FOR_EACH_OF(block, items) {
        uint tile = (uint)block / BLOCKS_PER_TILE, within = (uint)block % BLOCKS_PER_TILE;
        uint first_x = (tile % projection->bins_x) * tile_pixels + (within % blocks_per_row) * GN_LANES;
        uint pixel_y = (tile / projection->bins_x) * tile_pixels + within / blocks_per_row;
        if (pixel_y >= height || first_x >= width) continue;
        RayBlock block_rays;
        block_rays.column = (int)first_x + LANE_INDEX;
        block_rays.row = (LaneInt)((int)(width + pixel_y));
        LaneInt present = LANE_COMPARE(block_rays.column, <, (LaneInt)((int)width));
        block_rays.x = (LaneFloat)((float)first_x + 0.5f + params.offset[0]);
        for (int lane = 0; lane < GN_LANES; ++lane) LANE_OF_FLOAT(block_rays.x, lane) += (float)lane;
        block_rays.y = (LaneFloat)((float)pixel_y + 0.5f + params.offset[1]);
        LaneInt own = (LaneInt)((int)GN_NO_ID), searching = present;
        if (params.has_pixel_receivers) {
            Outline outline;
            uint outlined = GN_NO_ID;
            for (int lane = 0; lane < GN_LANES; ++lane) {
                if (!LANE_OF_INT(present, lane)) continue;
                uint receiver = pixel_receivers[(size_t)pixel_y * width + first_x + (uint)lane];
                if (receiver == GN_NO_ID) continue;
                if (receiver != outlined) outline = outline_of(load_triangle(lists.vertices, receiver), eye);
                outlined = receiver;
                if (!covers(&outline, eye, ray_of_lane(lists.rays, &block_rays, lane))) continue;
                LANE_OF_INT(own, lane) = (int)receiver;
                LANE_OF_INT(searching, lane) = 0;
            }
        }
        LaneInt nearest = nearest_of_tile(lists, projection, tile, block_rays, searching);
        nearest = LANES_SELECT(own, nearest, searching);
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(present, lane))
                visible[params.first_point + (size_t)pixel_y * width + first_x + (uint)lane] =
                    (uint)LANE_OF_INT(nearest, lane);
    }
}

// `rays` has one ray per pixel, through one sample. With pixel_receivers, a sample takes the receiver of its pixel if
// the sample's ray meets that receiver, even if another triangle hides it.
__kernel void camera_visibility(CameraParams params, __constant const Projection* projection,
                                __global const float* vertices, __global const float* rays,
                                __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                                __global const uint2* ranges, __global const BinEntries* entries,
                                __global const uint* pixel_receivers, __global uint* visible,
                                __global const FrameCounters* counters) {
    if (counters->references == GN_NO_LISTS) return;
    TileLists lists = {ranges, entries, records, bounds, vertices + params.first_float, rays, params.picture};
    find_visible(item_range(projection->bins_x * projection->bins_y * BLOCKS_PER_TILE), params, projection, lists,
                 pixel_receivers, visible);
}

// ---- Shading points -------------------------------------------------------------------------------------------------

static float3 eye_of_camera(CameraParams params) { return (float3)(params.eye[0], params.eye[1], params.eye[2]); }

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
            if (visible[point] != seen.id) seen = see_triangle(vertices + params.first_float, visible[point], eye);
            p = shading_point(&seen, eye, load_ray(rays, (uint)(pixel % width), width + (uint)(pixel / width)));
        }
        positions[point] = p.x;
        positions[point + params.point_count] = p.y;
        positions[point + 2 * (size_t)params.point_count] = p.z;
    }
}

// Positions as a structure of arrays: x of all points, then y, then z. Sky: NaN.
__kernel void camera_points(CameraParams params, __global const float* vertices, __global const float* rays,
                            __global const uint* visible, __global float* positions) {
    make_points(item_range(params.width * params.height), params, vertices, rays, visible, positions);
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
            if (id != GN_NO_ID) normal = unit_normal(load_triangle(vertices + params.first_float, id), eye);
        }
        vstore3(normal, pixel, normals);
    }
}

// Unit geometric normals facing the camera, packed xyz, for the host and for shading. Sky: 0.
__kernel void camera_normals(CameraParams params, __global const float* vertices, __global const uint* visible,
                             __global float* normals) {
    make_normals(item_range(params.width * params.height), params, vertices, visible, normals);
}

// ---- Points of a caller ---------------------------------------------------------------------------------------------

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
