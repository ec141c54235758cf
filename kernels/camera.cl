// SPDX-License-Identifier: MIT
// Camera: visibility buffer by tiles, then shading points. Contract and proofs in camera.h.
//
// One work-item takes GN_LANES pixels of one row of a tile and walks the tile's triangle list, keeping the nearest in
// registers: no atomics, the same answer in any order. The records' margins tell which pixels are certain; the rest are
// decided per pixel, exactly. Needs double precision.
#include "camera.h"
#include "exact/det3.h"
#include "lanes.h"
#include "points.h"
#include "projection.h"
#include "triangle_setup.h"

#ifndef GN_FP64
#error "the camera stage needs double precision"
#endif

typedef struct Ray {
    float3 column_high, column_low, row_high, row_low;
} Ray;

static Ray load_ray(__global const float* rays, uint width, uint x, uint y) {
    __global const float* column = rays + RAY_FLOATS * x;
    __global const float* row = rays + RAY_FLOATS * (width + y);
    Ray ray;
    ray.column_high = vload3(0, column);
    ray.column_low = vload3(1, column);
    ray.row_high = vload3(0, row);
    ray.row_low = vload3(1, row);
    return ray;
}

// The ray in double, with the sizes of what was added, as det3_double wants it.
static Det3Row ray_row(Ray ray) {
    Det3Row row;
    double c_x = (double)ray.column_high.x + ray.column_low.x, r_x = (double)ray.row_high.x + ray.row_low.x;
    double c_y = (double)ray.column_high.y + ray.column_low.y, r_y = (double)ray.row_high.y + ray.row_low.y;
    double c_z = (double)ray.column_high.z + ray.column_low.z, r_z = (double)ray.row_high.z + ray.row_low.z;
    row.x = c_x + r_x;
    row.y = c_y + r_y;
    row.z = c_z + r_z;
    // Two roundings instead of one: doubling the size covers the second.
    row.size_x = 2.0 * (fabs(c_x) + fabs(r_x));
    row.size_y = 2.0 * (fabs(c_y) + fabs(r_y));
    row.size_z = 2.0 * (fabs(c_z) + fabs(r_z));
    return row;
}

static void accumulate_with_ray(Accumulator* sum, float3 u1, float3 u0, float3 v1, float3 v0, Ray ray) {
    accumulator_clear(sum);
    accumulator_add_det3(sum, u1, u0, v1, v0, ray.column_high, -ray.column_low);
    accumulator_add_det3(sum, u1, u0, v1, v0, ray.row_high, -ray.row_low);
}

// det(u1 - u0, v1 - v0, r): its sign for certain.
static int sign_with_ray(float3 u1, float3 u0, float3 v1, float3 v0, Ray ray) {
    double bound;
    double value = det3_double(det3_row(u1, u0), det3_row(v1, v0), ray_row(ray), &bound);
    if (fabs(value) > bound) return value > 0.0 ? 1 : -1;
    if (bound == 0.0) return 0;
    Accumulator sum;
    accumulate_with_ray(&sum, u1, u0, v1, v0, ray);
    return accumulator_sign(&sum);
}

// Values with a relative error below 2^-30.
#define GOOD_ENOUGH 9.0e-10

static double value_with_ray(float3 u1, float3 u0, float3 v1, float3 v0, Ray ray) {
    double bound;
    double value = det3_double(det3_row(u1, u0), det3_row(v1, v0), ray_row(ray), &bound);
    if (bound <= GOOD_ENOUGH * fabs(value)) return value;
    Accumulator sum;
    accumulate_with_ray(&sum, u1, u0, v1, v0, ray);
    return accumulator_to_double(&sum);
}

static double value_of_det3(float3 u1, float3 u0, float3 v1, float3 v0, float3 w1, float3 w0) {
    double bound;
    double value = det3_double(det3_row(u1, u0), det3_row(v1, v0), det3_row(w1, w0), &bound);
    if (bound <= GOOD_ENOUGH * fabs(value)) return value;
    Accumulator sum;
    accumulator_clear(&sum);
    accumulator_add_det3(&sum, u1, u0, v1, v0, w1, w0);
    return accumulator_to_double(&sum);
}

// Does the closed triangle cover the ray, t > 0? Exactly.
static bool covers(Triangle t, float3 eye, Ray ray) {
    int level = DET3_BY_FLOAT;
    int orientation = det3_sign(t.a, eye, t.b, eye, t.c, eye, &level);
    if (orientation == 0) return false;
    return sign_with_ray(t.a, eye, t.b, eye, ray) * orientation >= 0 &&
           sign_with_ray(t.b, eye, t.c, eye, ray) * orientation >= 0 &&
           sign_with_ray(t.c, eye, t.a, eye, ray) * orientation >= 0;
}

// 1 / t of the hit: (n . r) / (n . (a - eye)).
static double nearness(Triangle t, float3 eye, Ray ray) {
    return value_with_ray(t.b, t.a, t.c, t.a, ray) / value_of_det3(t.b, t.a, t.c, t.a, t.a, eye);
}

static bool is_nearer(Triangle t, uint id, Triangle best, uint best_id, float3 eye, Ray ray) {
    double mine = nearness(t, eye, ray), other = nearness(best, eye, ray);
    return mine > other || (mine == other && id < best_id);
}

__kernel void camera_visibility(__constant const Projection* projection, ulong first_float, uint record_capacity,
                                uint reference_capacity, __global const float* vertices, __global const float* rays,
                                __global const TriangleRecord* records, __global const uint* ids,
                                __global const uint* reference_offsets, __global const uint* references,
                                __global const FrameCounters* counters, __global uint* visible) {
    if (counters->survivors > record_capacity || counters->references > reference_capacity) return;
    const uint tile_pixels = 1u << CAMERA_TILE_LOG2;
    const uint blocks_per_tile = tile_pixels * tile_pixels / GN_LANES;
    const uint blocks_per_row = tile_pixels / GN_LANES;
    float3 eye = center_of(projection);
    uint width = projection->width, height = projection->height;
    GN_FOR_EACH(block, projection->bins_x * projection->bins_y * blocks_per_tile) {
        uint tile = (uint)block / blocks_per_tile, within = (uint)block % blocks_per_tile;
        uint first_x = (tile % projection->bins_x) * tile_pixels + (within % blocks_per_row) * GN_LANES;
        uint pixel_y = (tile / projection->bins_x) * tile_pixels + within / blocks_per_row;
        if (pixel_y >= height || first_x >= width) continue;
        LaneInt column = (int)first_x + LANE_INDEX;
        LaneInt present = LANE_COMPARE(column, <, (LaneInt)((int)width));
        LaneFloat x = (LaneFloat)((float)first_x + 0.5f);
        for (int lane = 0; lane < GN_LANES; ++lane) ((float*)&x)[lane] += (float)lane;
        LaneFloat y = (LaneFloat)((float)pixel_y + 0.5f);
        LaneFloat best_low = (LaneFloat)(-INFINITY), best_high = (LaneFloat)(-INFINITY);
        LaneInt best_id = (LaneInt)((int)GN_NO_ID);

        uint last = reference_offsets[tile + 1];
        for (uint i = reference_offsets[tile]; i < last; ++i) {
            uint slot = references[i];
            __global const TriangleRecord* r = &records[slot];
            LaneFloat e0 = lanes_linear(r->edge_x[0], r->edge_y[0], r->edge_0[0], x, y);
            LaneFloat e1 = lanes_linear(r->edge_x[1], r->edge_y[1], r->edge_0[1], x, y);
            LaneFloat e2 = lanes_linear(r->edge_x[2], r->edge_y[2], r->edge_0[2], x, y);
            LaneFloat inside = LANES_MIN(e0, LANES_MIN(e1, e2));
            LaneFloat z = lanes_linear(r->plane_x, r->plane_y, r->plane_0, x, y);
            LaneFloat z_low = z - (LaneFloat)(r->margin_plane), z_high = z + (LaneFloat)(r->margin_plane);
            LaneInt possible =
                present & ~LANE_COMPARE(inside, <, (LaneFloat)(-r->margin_edge)) & ~LANE_COMPARE(z_high, <, best_low);
            if (!LANES_ANY(possible)) continue;
            int id = (int)ids[slot];
            LaneInt certain =
                possible & LANE_COMPARE(inside, >, (LaneFloat)(r->margin_edge)) & LANE_COMPARE(z_low, >, best_high);
            LaneInt open = possible & ~certain;
            if (LANES_ANY(open)) {
                Triangle triangle = load_triangle(vertices + first_float, (uint)id);
                for (int lane = 0; lane < GN_LANES; ++lane) {
                    if (!((int*)&open)[lane]) continue;
                    Ray ray = load_ray(rays, width, first_x + (uint)lane, pixel_y);
                    uint other = (uint)((int*)&best_id)[lane];
                    bool wins = covers(triangle, eye, ray);
                    if (wins && other != GN_NO_ID)
                        wins = is_nearer(triangle, (uint)id, load_triangle(vertices + first_float, other), other, eye,
                                         ray);
                    ((int*)&certain)[lane] = wins ? -1 : 0;
                }
            }
            best_low = LANES_SELECT(best_low, z_low, certain);
            best_high = LANES_SELECT(best_high, z_high, certain);
            best_id = LANES_SELECT(best_id, (LaneInt)(id), certain);
        }
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (((int*)&present)[lane])
                visible[(size_t)pixel_y * width + first_x + (uint)lane] = (uint)((int*)&best_id)[lane];
    }
}

// ---- Shading points -------------------------------------------------------------------------------------------------

static float next_up(float x) {
    if (x == 0.0f) return as_float(1u);
    return as_float(x > 0.0f ? as_uint(x) + 1u : as_uint(x) - 1u);
}

// The nearest float to q on the side that `towards` points to; the nearest of all if it is 0. Never infinite.
static float rounded_towards(double q, double towards) {
    float x = convert_float_rte(q);
    if (!(fabs(x) <= FLT_MAX)) return q > 0.0 ? FLT_MAX : -FLT_MAX;
    if (towards > 0.0 && (double)x < q) x = next_up(x);
    if (towards < 0.0 && (double)x > q) x = -next_up(-x);
    return fabs(x) <= FLT_MAX ? x : copysign(FLT_MAX, x);
}

// One float32 ulp of a magnitude below 2^128.
static double ulp_of(double magnitude) {
    int exponent = magnitude > 0.0 ? max(ilogb(magnitude), -126) : -126;
    return ldexp(1.0, exponent - 23);
}

// The plane's normal, unnormalised, each coordinate with a small relative error; towards the eye.
static double3 normal_towards_eye(Triangle t, float3 eye) {
    const float3 none = (float3)(0.0f);
    double3 n = (double3)(value_of_det3(t.b, t.a, t.c, t.a, (float3)(1.0f, 0.0f, 0.0f), none),
                          value_of_det3(t.b, t.a, t.c, t.a, (float3)(0.0f, 1.0f, 0.0f), none),
                          value_of_det3(t.b, t.a, t.c, t.a, (float3)(0.0f, 0.0f, 1.0f), none));
    int level = DET3_BY_FLOAT;
    return det3_sign(t.b, t.a, t.c, t.a, eye, t.a, &level) < 0 ? -n : n;
}

static double largest_coordinate(double3 v) { return fmax(fmax(fabs(v.x), fabs(v.y)), fabs(v.z)); }

// Positions as a structure of arrays: x of all pixels, then y, then z. Sky: NaN.
__kernel void camera_points(uint width, uint height, float4 eye_and_zero, ulong first_float,
                            __global const float* vertices, __global const float* rays, __global const uint* visible,
                            __global float* positions) {
    size_t count = (size_t)width * height;
    float3 eye = eye_and_zero.xyz;
    GN_FOR_EACH(pixel, count) {
        float3 p = (float3)(NAN);
        if (visible[pixel] != GN_NO_ID) {
            Triangle t = load_triangle(vertices + first_float, visible[pixel]);
            Ray ray = load_ray(rays, width, (uint)(pixel % width), (uint)(pixel / width));
            double distance = 1.0 / nearness(t, eye, ray);
            Det3Row r = ray_row(ray);
            double3 hit = (double3)((double)eye.x + distance * r.x, (double)eye.y + distance * r.y,
                                    (double)eye.z + distance * r.z);
            double3 n = normal_towards_eye(t, eye);
            double3 eye_wide = (double3)((double)eye.x, (double)eye.y, (double)eye.z);
            double size = fmax(largest_coordinate(hit), largest_coordinate(eye_wide));
            double lift = LIFT_ULPS * ulp_of(size) / largest_coordinate(n);
            p = (float3)(rounded_towards(hit.x + lift * n.x, n.x), rounded_towards(hit.y + lift * n.y, n.y),
                         rounded_towards(hit.z + lift * n.z, n.z));
        }
        positions[pixel] = p.x;
        positions[pixel + count] = p.y;
        positions[pixel + 2 * count] = p.z;
    }
}

// Unit geometric normals facing the camera, packed xyz, for the host and for shading. Sky: 0.
__kernel void camera_normals(uint count, float4 eye_and_zero, ulong first_float, __global const float* vertices,
                             __global const uint* visible, __global float* normals) {
    GN_FOR_EACH(pixel, count) {
        float3 normal = (float3)(0.0f);
        if (visible[pixel] != GN_NO_ID) {
            double3 n = normal_towards_eye(load_triangle(vertices + first_float, visible[pixel]), eye_and_zero.xyz);
            n /= largest_coordinate(n);
            double length_of_n = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
            normal = (float3)(convert_float_rte(n.x / length_of_n), convert_float_rte(n.y / length_of_n),
                              convert_float_rte(n.z / length_of_n));
        }
        vstore3(normal, pixel, normals);
    }
}
