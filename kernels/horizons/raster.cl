// SPDX-License-Identifier: MIT
// Finds out whether triangles are a raster (sweeps.h): their corners lie in rows and columns, and each square of the
// raster has at most its two triangles. Then each position has at most one height. A square that lacks a triangle is a
// hole; elsewhere heights are continuous.
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

// Gives each vertex that no triangle has, whose height is NaN, the height of one before it in its column, or else of
// the first one that has any: the ground is then a part of one without holes.
__kernel void raster_fill(const RasterParams raster, __global float* heights) {
    GN_FOR_EACH(column, raster.columns) {
        __global float* of_column = heights + column * (size_t)raster.rows;
        uint first = 0u;
        while (first + 1u < raster.rows && isnan(of_column[first])) ++first;
        float height = of_column[first];
        for (uint row = 0; row < raster.rows; ++row) {
            if (isnan(of_column[row])) of_column[row] = height;
            height = of_column[row];
        }
    }
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

// Whether a square around a vertex is a hole. squares: of raster_check().
static bool is_at_hole(const RasterCopies copies, __global const uint* squares, uint column, uint row) {
    for (uint c = max(column, 1u) - 1u; c < min(column + 1u, copies.columns - 1u); ++c)
        for (uint r = max(row, 1u) - 1u; r < min(row + 1u, copies.rows - 1u); ++r)
            if (popcount(squares[c * (size_t)copies.rows + r]) != 2u) return true;
    return false;
}

// holes: for each tile whether it has one.
__kernel void raster_holes(const RasterCopies copies, __global const uint* squares, __global uint* holes) {
    for (uint copy = 0; copy < 4u; ++copy) {
        uint lines = copy < 2u ? copies.columns : copies.rows, rows = copy < 2u ? copies.rows : copies.columns;
        uint tiles = copies.tops_of_line[copy], lines_of_tiles = (lines - 1u) / RASTER_TILE + 1u;
        GN_FOR_EACH(i, lines_of_tiles * (size_t)tiles) {
            uint line = (uint)(i / tiles) * RASTER_TILE, row = (uint)(i % tiles) * RASTER_TILE, found = 0u;
            for (uint a = line; a <= min(line + RASTER_TILE, lines - 1u); ++a)
                for (uint b = row; b <= min(row + RASTER_TILE, rows - 1u); ++b) {
                    uint along = copy % 2u != 0u ? rows - 1u - b : b;
                    found |= is_at_hole(copies, squares, copy < 2u ? a : along, copy < 2u ? along : a) ? 1u : 0u;
                }
            holes[copies.first_top[copy] + i] = found;
        }
    }
}

// Marks the greatest heights of tiles that have a hole or a neighbour with one.
__kernel void raster_mark_holes(const RasterCopies copies, __global const uint* holes, __global float* tops) {
    for (uint copy = 0; copy < 4u; ++copy) {
        int lines = (int)(copy < 2u ? copies.columns : copies.rows), tiles = (int)copies.tops_of_line[copy];
        int lines_of_tiles = (lines - 1) / RASTER_TILE + 1;
        GN_FOR_EACH(i, lines_of_tiles * (size_t)tiles) {
            int line = (int)(i / (size_t)tiles), tile = (int)(i % (size_t)tiles);
            uint near = 0u;
            for (int a = max(line - 1, 0); a <= min(line + 1, lines_of_tiles - 1); ++a)
                for (int b = max(tile - 1, 0); b <= min(tile + 1, tiles - 1); ++b)
                    near |= holes[copies.first_top[copy] + a * (size_t)tiles + b];
            if (near != 0u) tops[copies.first_top[copy] + i] = copysign(tops[copies.first_top[copy] + i], -1.0f);
        }
    }
}
