// SPDX-License-Identifier: MIT
// Finds out whether triangles are a raster (sweeps.h): their corners lie in rows and columns, and each square of the
// raster is two triangles. Then each position has one height, and heights are continuous.
#include "horizons/height_field.h"
#include "horizons/sweeps.h"

static int2 place_of(const RasterParams raster, float3 p) {
    float2 at = ((float2)(p.x, p.y) - (float2)(raster.corner[0], raster.corner[1])) *
                (float2)(raster.per_length[0], raster.per_length[1]);
    return clamp(convert_int2_rte(at), (int2)(0), (int2)((int)raster.columns - 1, (int)raster.rows - 1));
}

// Writes the coordinates of all corners. Corners at one place write the same, or raster_check() finds it.
__kernel void raster_corners(const RasterParams raster, __global const float* vertices, __global float* x,
                             __global float* y, __global float* heights) {
    GN_FOR_EACH(i, 3 * (size_t)raster.triangles.count) {
        float3 p = over_ground(raster.axis, vload3(i, vertices + raster.triangles.first_float));
        int2 at = place_of(raster, p);
        x[at.x] = p.x;
        y[at.y] = p.y;
        heights[at.x * (size_t)raster.rows + at.y] = p.z;
    }
}

// Bit k of a square: there is the triangle without corner k, of (0, 0), (1, 0), (0, 1), (1, 1).
__kernel void raster_check(const RasterParams raster, __global const float* vertices, __global const float* x,
                           __global const float* y, __global const float* heights, __global uint* squares,
                           __global uint* found) {
    uint what = 0u;
    GN_FOR_EACH(i, raster.triangles.count) {
        Triangle t = load_triangle(vertices + raster.triangles.first_float, i);
        float3 corners[3] = {over_ground(raster.axis, t.a), over_ground(raster.axis, t.b),
                             over_ground(raster.axis, t.c)};
        int2 at[3], low = (int2)(INT_MAX);
        for (uint k = 0; k < 3u; ++k) {
            at[k] = place_of(raster, corners[k]);
            low = min(low, at[k]);
            bool is_there = x[at[k].x] == corners[k].x && y[at[k].y] == corners[k].y &&
                            heights[at[k].x * (size_t)raster.rows + at[k].y] == corners[k].z;
            if (!is_there) what |= RASTER_IS_NONE;
        }
        uint corners_of_square = 0u;
        for (uint k = 0; k < 3u; ++k) {
            int2 d = at[k] - low;
            if (d.x > 1 || d.y > 1)
                what |= RASTER_IS_NONE;
            else
                corners_of_square |= 1u << (d.x + 2 * d.y);
        }
        uint missing = ~corners_of_square & 15u;
        bool is_half = popcount(missing) == 1u && low.x + 1 < (int)raster.columns && low.y + 1 < (int)raster.rows;
        if (!is_half) {
            what |= RASTER_IS_NONE;
            continue;
        }
        what |= (missing & 6u) != 0u ? RASTER_RISES : RASTER_FALLS;
        uint before = atomic_or(&squares[low.x * (size_t)raster.rows + low.y], missing);
        if ((before & missing) != 0u) what |= RASTER_IS_NONE;
    }
    if (what != 0u) atomic_or(found, what);
}

__kernel void raster_copies(const RasterCopies copies, __global const float* heights, __global float* made) {
    for (uint copy = 0; copy < 4u; ++copy) {
        uint lines = copy < 2u ? copies.columns : copies.rows, rows = copy < 2u ? copies.rows : copies.columns;
        uint stride = copies.stride[copy];
        GN_FOR_EACH(i, lines * (size_t)stride) {
            uint line = (uint)(i / stride);
            int row = clamp((int)(i % stride) - RASTER_PAD, 0, (int)rows - 1);
            if (copy % 2u != 0u) row = (int)rows - 1 - row;
            size_t at = copy < 2u ? line * (size_t)copies.rows + row : row * (size_t)copies.rows + line;
            made[copies.first[copy] - RASTER_PAD + i] = heights[at] - copies.lowest;
        }
    }
}

__kernel void raster_tops(const RasterCopies copies, __global const float* made, __global float* tops) {
    for (uint copy = 0; copy < 4u; ++copy) {
        uint lines = copy < 2u ? copies.columns : copies.rows, rows = copy < 2u ? copies.rows : copies.columns;
        uint tiles = copies.tops_of_line[copy], lines_of_tiles = (lines - 1u) / RASTER_TILE + 1u;
        GN_FOR_EACH(i, lines_of_tiles * (size_t)tiles) {
            uint line = (uint)(i / tiles) * RASTER_TILE, row = (uint)(i % tiles) * RASTER_TILE;
            float top = 0.0f;
            for (uint a = line; a <= min(line + RASTER_TILE, lines - 1u); ++a)
                for (uint b = row; b <= min(row + RASTER_TILE, rows - 1u); ++b)
                    top = fmax(top, made[copies.first[copy] + a * (size_t)copies.stride[copy] + b]);
            tops[copies.first_top[copy] + i] = top;
        }
    }
}
