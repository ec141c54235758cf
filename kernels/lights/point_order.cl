// SPDX-License-Identifier: MIT
// Finds bounds and codes of points, and gathers their sorted copies (point_order.h).
#include "lights/point_order.h"
#include "simd/point_blocks.clh"

__kernel void point_bounds(const PointOrderParams params, __global const float* positions, __global uint* bounds) {
    uint low[3] = {GN_NO_ID, GN_NO_ID, GN_NO_ID}, high[3] = {0u, 0u, 0u};
    GN_FOR_EACH(i, params.points.count) {
        float3 p = load_point(positions, params.points, i);
        if (!is_present(p)) continue;
        uint key[3] = {float_to_key(p.x), float_to_key(p.y), float_to_key(p.z)};
        for (int c = 0; c < 3; ++c) {
            low[c] = min(low[c], key[c]);
            high[c] = max(high[c], key[c]);
        }
    }
    for (int c = 0; c < 3; ++c) {
        if (low[c] != GN_NO_ID) atomic_min(&bounds[c], low[c]);
        if (high[c] != 0u) atomic_max(&bounds[3 + c], high[c]);
    }
}

// The normal of a point's surface, of any length: the given normal, or else the receiver's, on the side of the eye if
// there is an eye. Zero: the point has none.
static float3 surface_normal(const PointOrderParams params, __global const float* vertices, float3 p, uint receiver,
                             float3 given) {
    if (params.has_normals != 0u) return is_present(given) ? given : (float3)(0.0f);
    if (params.points.has_receivers == 0u || receiver >= params.triangles.count) return (float3)(0.0f);
    Triangle t = load_triangle(vertices + params.triangles.first_float, receiver);
    float3 normal = cross(t.b - t.a, t.c - t.a);
    if (params.points.has_eye != 0u && dot(normal, eye_of(params.points) - p) < 0.0f) normal = -normal;
    return is_present(normal) ? normal : (float3)(0.0f);
}

// 0 to 5: the axis and sign of the largest coordinate.
static uint main_axis(float3 n) {
    float3 size = fabs(n);
    if (size.x >= size.y && size.x >= size.z) return n.x < 0.0f ? 0u : 1u;
    if (size.y >= size.z) return n.y < 0.0f ? 2u : 3u;
    return n.z < 0.0f ? 4u : 5u;
}

static float3 normal_of_point(const PointOrderParams params, __global const float* vertices,
                              __global const uint* receivers, __global const float* normals, float3 p, size_t i) {
    uint receiver = params.points.has_receivers != 0u ? receivers[i] : GN_NO_ID;
    float3 given = params.has_normals != 0u ? load_point(normals, params.normals, i) : (float3)(0.0f);
    return surface_normal(params, vertices, p, receiver, given);
}

__kernel void point_codes(const PointOrderParams params, __global const float* vertices,
                          __global const float* positions, __global const uint* receivers,
                          __global const float* normals, __global uint* low_codes, __global uint* high_codes,
                          __global uint* numbers) {
    GN_FOR_EACH(i, params.points.count) {
        float3 p = load_point(positions, params.points, i);
        numbers[i] = (uint)i;
        low_codes[i] = high_codes[i] = GN_NO_ID;
        if (!is_present(p)) continue;
        uint3 cell = morton_cell(params.grid, p * 0.5f, 2u * POINT_CODE_BITS);
        low_codes[i] = morton_code(cell & ((1u << POINT_CODE_BITS) - 1u));
        high_codes[i] = morton_code(cell >> POINT_CODE_BITS) |
                        main_axis(normal_of_point(params, vertices, receivers, normals, p, i)) << 3u * POINT_CODE_BITS;
    }
}

// The square of 4 x 4 pixels that is number i: first groups of 2 x 2 squares; then, if their number is odd, the squares
// of the last column and of the last row.
static uint square_in_order(uint i, uint columns, uint rows) {
    uint across = columns / 2u, fours = across * (rows / 2u), four = i / 4u;
    if (four < fours) return (four / across * 2u + i / 2u % 2u) * columns + four % across * 2u + i % 2u;
    i -= 4u * fours;
    if (columns % 2u != 0u) {
        if (i < rows) return i * columns + columns - 1u;
        i -= rows;
    }
    return (rows - 1u) * columns + i;
}

// Orders the points of a picture by squares of 4 x 4 pixels, without sorting: neighbours are together already.
__kernel void picture_order(const PointOrderParams params, __global uint* numbers) {
    uint columns = params.points.picture_width / 4u, rows = params.points.count / 16u / columns;
    GN_FOR_EACH(i, params.points.count) {
        BlockPlace square =
            place_in_picture(params.points.picture_width, square_in_order((uint)i / 16u, columns, rows));
        numbers[i] = (uint)point_in_place(square, (uint)i % 16u);
    }
}

// gathered[i] = values[numbers[i]].
__kernel void point_reorder(uint count, __global const uint* values, __global const uint* numbers,
                            __global uint* gathered) {
    GN_FOR_EACH(i, count) gathered[i] = values[numbers[i]];
}

// numbers[i]: every share-th run of POINTS_OF_RUN neighbours among the sorted points.
__kernel void point_sample(uint count, uint share, __global const uint* order, __global uint* numbers) {
    GN_FOR_EACH(i, count) numbers[i] = order[(i / POINTS_OF_RUN * share) * POINTS_OF_RUN + i % POINTS_OF_RUN];
}

// Asks for the inputs of a point that is gathered soon: in the sorted order they are strewn over the memory.
static void prefetch_point(const PointOrderParams params, __global const float* positions,
                           __global const uint* receivers, __global const float* normals, size_t number) {
    GN_PREFETCH(positions + params.points.first + number * params.points.point_stride);
    if (params.points.has_receivers != 0u) GN_PREFETCH(receivers + number);
    if (params.has_normals != 0u) GN_PREFETCH(normals + params.normals.first + number * params.normals.point_stride);
}
#define GATHER_AHEAD 16u

__kernel void point_gather(const PointOrderParams params, __global const float* vertices,
                           __global const float* positions, __global const uint* receivers,
                           __global const float* normals, __global const uint* numbers,
                           __global float* sorted_positions, __global uint* sorted_receivers,
                           __global float* sorted_normals, __global float* surface_normals) {
    uint last = params.points.count - 1u;
    GN_FOR_EACH(i, params.points.count) {
        uint number = numbers[i];
        prefetch_point(params, positions, receivers, normals, numbers[min((uint)i + GATHER_AHEAD, last)]);
        float3 p = load_point(positions, params.points, number);
        vstore3(p, i, sorted_positions);
        if (params.points.has_receivers != 0u) sorted_receivers[i] = receivers[number];
        if (params.has_normals != 0u) vstore3(load_point(normals, params.normals, number), i, sorted_normals);
        float3 n = normal_of_point(params, vertices, receivers, normals, p, number);
        float size = fabs(n.x) + fabs(n.y) + fabs(n.z);
        vstore3(size > 0.0f && size < INFINITY ? n / size : (float3)(0.0f), i, surface_normals);
    }
}
