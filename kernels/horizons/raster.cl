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

// Writes what raster_corners() and raster_check() write, from an implicit raster: columns and rows in rising order.
__kernel void raster_of_implicit(const RasterParams raster, __global const float* implicit, __global float* x,
                                 __global float* y, __global float* heights, __global uint* squares) {
    bool x_falls = raster_vertex(implicit, 0u, 1u, 0u).x < raster_vertex(implicit, 0u, 0u, 0u).x;
    bool y_falls = raster_vertex(implicit, 1u, 0u, 0u).y < raster_vertex(implicit, 0u, 0u, 0u).y;
    GN_FOR_EACH(i, raster.columns * (size_t)raster.rows) {
        uint column = (uint)(i / raster.rows), row = (uint)(i % raster.rows);
        uint at_column = x_falls ? raster.columns - 1u - column : column,
             at_row = y_falls ? raster.rows - 1u - row : row;
        float3 p = raster_vertex(implicit, at_row, at_column, 0u);
        x[column] = p.x;
        y[row] = p.y;
        heights[i] = GN_FINITE(p.z) ? p.z : NAN;
        if (column + 1u == raster.columns || row + 1u == raster.rows) continue;
        at_column -= x_falls ? 1u : 0u, at_row -= y_falls ? 1u : 0u;
        for (uint second = 0; second < 2u; ++second)
            if (is_finite_triangle(raster_triangle(implicit, at_row, at_column, second))) squares[i] |= 1u << second;
    }
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

// Of a copy: its lines, the vertices of a line, and its lines of tiles.
static uint lines_of_copy(const RasterCopies copies, uint copy) { return copy < 2u ? copies.columns : copies.rows; }
static uint rows_of_copy(const RasterCopies copies, uint copy) { return copy < 2u ? copies.rows : copies.columns; }
static uint lines_of_tiles(const RasterCopies copies, uint copy) {
    return (lines_of_copy(copies, copy) - 1u) / RASTER_TILE + 1u;
}

// Column and row of the vertex that a copy has on a line.
static uint2 vertex_of_copy(const RasterCopies copies, uint copy, uint line, uint row) {
    if (copy % 2u != 0u) row = rows_of_copy(copies, copy) - 1u - row;
    return copy < 2u ? (uint2)(line, row) : (uint2)(row, line);
}

__kernel void raster_copies(const RasterCopies copies, __global const float* heights, __global float* made) {
    for (uint copy = 0; copy < 4u; ++copy) {
        uint stride = copies.stride[copy];
        GN_FOR_EACH(i, lines_of_copy(copies, copy) * (size_t)stride) {
            int row = clamp((int)(i % stride) - RASTER_PAD, 0, (int)rows_of_copy(copies, copy) - 1);
            uint2 vertex = vertex_of_copy(copies, copy, (uint)(i / stride), (uint)row);
            made[copies.first[copy] - RASTER_PAD + i] =
                heights[vertex.x * (size_t)copies.rows + vertex.y] - copies.lowest;
        }
    }
}

__kernel void raster_tops(const RasterCopies copies, __global const float* made, __global float* tops) {
    for (uint copy = 0; copy < 4u; ++copy) {
        uint lines = lines_of_copy(copies, copy), rows = rows_of_copy(copies, copy), tiles = copies.tops_of_line[copy];
        GN_FOR_EACH(i, lines_of_tiles(copies, copy) * (size_t)tiles) {
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
static bool is_at_hole(const RasterCopies copies, __global const uint* squares, uint2 vertex) {
    for (uint c = max(vertex.x, 1u) - 1u; c < min(vertex.x + 1u, copies.columns - 1u); ++c)
        for (uint r = max(vertex.y, 1u) - 1u; r < min(vertex.y + 1u, copies.rows - 1u); ++r)
            if (popcount(squares[c * (size_t)copies.rows + r]) != 2u) return true;
    return false;
}

// holes: for each tile whether it has one.
__kernel void raster_holes(const RasterCopies copies, __global const uint* squares, __global uint* holes) {
    for (uint copy = 0; copy < 4u; ++copy) {
        uint lines = lines_of_copy(copies, copy), rows = rows_of_copy(copies, copy), tiles = copies.tops_of_line[copy];
        GN_FOR_EACH(i, lines_of_tiles(copies, copy) * (size_t)tiles) {
            uint line = (uint)(i / tiles) * RASTER_TILE, row = (uint)(i % tiles) * RASTER_TILE, found = 0u;
            for (uint a = line; a <= min(line + RASTER_TILE, lines - 1u); ++a)
                for (uint b = row; b <= min(row + RASTER_TILE, rows - 1u); ++b)
                    found |= is_at_hole(copies, squares, vertex_of_copy(copies, copy, a, b)) ? 1u : 0u;
            holes[copies.first_top[copy] + i] = found;
        }
    }
}

// Marks the greatest heights of tiles that have a hole or a neighbour with one.
__kernel void raster_mark_holes(const RasterCopies copies, __global const uint* holes, __global float* tops) {
    for (uint copy = 0; copy < 4u; ++copy) {
        int lines = (int)lines_of_tiles(copies, copy), tiles = (int)copies.tops_of_line[copy];
        GN_FOR_EACH(i, lines * (size_t)tiles) {
            int line = (int)(i / (size_t)tiles), tile = (int)(i % (size_t)tiles);
            uint near = 0u;
            for (int a = max(line - 1, 0); a <= min(line + 1, lines - 1); ++a)
                for (int b = max(tile - 1, 0); b <= min(tile + 1, tiles - 1); ++b)
                    near |= holes[copies.first_top[copy] + a * (size_t)tiles + b];
            if (near != 0u) tops[copies.first_top[copy] + i] = copysign(tops[copies.first_top[copy] + i], -1.0f);
        }
    }
}
