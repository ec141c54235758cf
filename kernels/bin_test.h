// SPDX-License-Identifier: MIT
// Which bins a triangle is in, and in which of them it can matter: shared by the stages that go from triangles to bins
// (triangle_setup, conservative_map, bins).
//
// Bins are walked in tiles of 8 x 8: a tile is tested as a whole first, and is the unit in which the work is shared
// out. A tile's code holds its place and the part of it that lies in the triangle's rectangle (outside of which the
// record's margins do not hold).
#ifndef GN_BIN_TEST_H
#define GN_BIN_TEST_H

#include "bin_lists.h"
#include "claim.h"
#include "projection.h"
#include "record_blocks.h"
#include "triangle_setup.h"

#define TILE_LOG2 3u
#define TILE_LAST ((1u << TILE_LOG2) - 1u)

// ---- Bounds ---------------------------------------------------------------------------------------------------------

static void drop_bounds(__global TriangleBounds* bounds) {
    bounds->x0 = 65535;
    bounds->x1 = 0;
}

// Rectangles of bins, one in each lane; as uint4 elsewhere.
typedef struct BinRectangles {
    LaneInt x0, y0, x1, y1;
} BinRectangles;

// With s = texel_units, a whole number, fl(X s) lies between floor(X) s and (floor(X) + 1) s, since both are floats and
// rounding is monotone. So for q = quantised_texel(X):  (q - 1) / s <= floor(X) <= q / s  in whole numbers. Divided in
// floats: (q + 1/2) / s is at least 1/2 / s from every whole number, more than its rounding errors, 2^-21 q / s.
static LaneInt bins_of_quantised(LaneInt q, uint texels, uint bin_log2) {
    LaneInt texel = LANES_TO_INT((LANES_TO_FLOAT(q) + 0.5f) * (1.0f / texel_units(texels)));
    return min(texel, (LaneInt)((int)texels - 1)) >> (int)bin_log2;
}

// In texels, as (x0, y0, x1, y1).
static float4 square_of_bins(uint4 bins, __constant const Projection* projection) {
    float size = (float)(1u << projection->bin_log2);
    return (float4)((float)bins.x, (float)bins.y, (float)(bins.z + 1u), (float)(bins.w + 1u)) * size;
}

// ---- Tiles ----------------------------------------------------------------------------------------------------------

static uint tile_count_of(uint4 bins) {
    uint4 tiles = bins >> TILE_LOG2;
    return (tiles.z - tiles.x + 1u) * (tiles.w - tiles.y + 1u);
}

// Tile i of a rectangle of bins, row by row.
static uint tile_of_bins(uint4 bins, uint i) {
    uint4 tiles = bins >> TILE_LOG2;
    uint width = tiles.z - tiles.x + 1u;
    uint x = tiles.x + i % width, y = tiles.y + i / width;
    uint x0 = x == tiles.x ? bins.x & TILE_LAST : 0u, x1 = x == tiles.z ? bins.z & TILE_LAST : TILE_LAST;
    uint y0 = y == tiles.y ? bins.y & TILE_LAST : 0u, y1 = y == tiles.w ? bins.w & TILE_LAST : TILE_LAST;
    return x | y << 10 | x0 << 20 | x1 << 23 | y0 << 26 | y1 << 29;
}

static uint4 bins_of_tile(uint tile) {
    uint x = (tile & 1023u) << TILE_LOG2, y = (tile >> 10 & 1023u) << TILE_LOG2;
    return (uint4)(x + (tile >> 20 & TILE_LAST), y + (tile >> 26 & TILE_LAST), x + (tile >> 23 & TILE_LAST),
                   y + (tile >> 29));
}

// ---- Tests ----------------------------------------------------------------------------------------------------------

// Lowest height under a rectangle of bins, from a pyramid of minima (keys, 0xFFFFFFFF where there is no point): the
// level at which the rectangle spans at most 2 x 2 cells.
static float lowest_height_under(__global const uint* pyramid, __constant const Projection* projection, uint4 bins) {
    uint span = max(bins.z - bins.x, bins.w - bins.y);
    uint level = span <= 1u ? 0u : 32u - clz(span - 1u);
    uint width = projection->bins_x, height = projection->bins_y, first = 0;
    for (uint i = 0; i < level; ++i) {
        first += width * height;
        width = (width + 1) / 2;
        height = (height + 1) / 2;
    }
    uint4 cells = bins >> level;
    __global const uint* row_0 = pyramid + first + cells.y * width;
    __global const uint* row_1 = pyramid + first + cells.w * width;
    uint lowest = min(min(row_0[cells.x], row_0[cells.z]), min(row_1[cells.x], row_1[cells.z]));
    return lowest == 0xFFFFFFFFu ? INFINITY : key_to_float(lowest);
}

// The same for rectangles in lanes; those of other lanes need not be in order, but inside the grid.
static LaneFloat lanes_lowest_height_under(__global const uint* pyramid, __constant const Projection* projection,
                                           BinRectangles bins) {
    LaneInt span = max(bins.x1 - bins.x0, bins.y1 - bins.y0), level = (LaneInt)(0), first = (LaneInt)(0);
    uint width = projection->bins_x, height = projection->bins_y, start = 0;
    LaneInt row = (LaneInt)((int)width);
    for (int reach = 1;; reach *= 2) {
        LaneInt higher = LANE_COMPARE(span, >, (LaneInt)(reach));
        if (!LANES_ANY(higher)) break;
        start += width * height;
        width = (width + 1u) / 2u;
        height = (height + 1u) / 2u;
        level -= higher;
        first = LANES_SELECT(first, (LaneInt)((int)start), higher);
        row = LANES_SELECT(row, (LaneInt)((int)width), higher);
    }
    LaneInt row_0 = first + (bins.y0 >> level) * row, row_1 = first + (bins.y1 >> level) * row;
    LaneInt x0 = bins.x0 >> level, x1 = bins.x1 >> level, top = (LaneInt)((int)0x80000000);
    LaneInt corner_0 = row_0 + x0, corner_1 = row_0 + x1, corner_2 = row_1 + x0, corner_3 = row_1 + x1;
    __global const int* keys = (__global const int*)pyramid;
    LaneInt lowest_0 = min(LANES_GATHER(keys, corner_0) ^ top, LANES_GATHER(keys, corner_1) ^ top);
    LaneInt lowest_1 = min(LANES_GATHER(keys, corner_2) ^ top, LANES_GATHER(keys, corner_3) ^ top);
    LaneInt lowest = min(lowest_0, lowest_1);
    return LANES_SELECT(lanes_of_order(lowest), (LaneFloat)(INFINITY), LANE_COMPARE(lowest, ==, (LaneInt)(INT_MAX)));
}

static float highest_at_corners(float slope_x, float slope_y, float constant_term, float4 square) {
    float corner_x = slope_x > 0.0f ? square.z : square.x;
    float corner_y = slope_y > 0.0f ? square.w : square.y;
    return fma(slope_x, corner_x, fma(slope_y, corner_y, constant_term));
}

// Can the triangle block any open point in these bins? No if it certainly misses their square (an edge function below
// -margin at its best corner: conservative rasterization), or certainly lies below (farther than) the farthest point
// there, by its highest vertex or its plane's highest corner. `heights` is a pyramid as above.
static bool may_matter(const TriangleRecord* record, __constant const Projection* projection, uint4 bins,
                       uint has_heights, __global const uint* heights) {
    float4 square = square_of_bins(bins, projection);
    for (int i = 0; i < 3; ++i)
        if (highest_at_corners(record->edge_x[i], record->edge_y[i], record->edge_0[i], square) < -record->margin_edge)
            return false;
    if (!has_heights) return true;
    float lowest = lowest_height_under(heights, projection, bins);
    if (lowest == INFINITY) return false;  // no point is open here
    float highest =
        highest_at_corners(record->plane_x, record->plane_y, record->plane_0, square) + record->margin_plane;
    return record->z_high >= lowest && !(highest < lowest);
}

#ifdef GN_CPU
static LaneFloat lanes_highest_at_corners(LaneFloat slope_x, LaneFloat slope_y, LaneFloat constant_term, LaneFloat x,
                                          LaneFloat y, float size) {
    const LaneFloat zero = (LaneFloat)(0.0f), whole = (LaneFloat)(size);
    LaneFloat corner_x = x + LANES_SELECT(zero, whole, LANE_COMPARE(slope_x, >, zero));
    LaneFloat corner_y = y + LANES_SELECT(zero, whole, LANE_COMPARE(slope_y, >, zero));
    return fma(slope_x, corner_x, fma(slope_y, corner_y, constant_term));
}

// may_matter() of triangles for one bin each: the same values, so the same answers.
static LaneInt lanes_may_matter(const RecordBlock* record, __constant const Projection* projection, LaneInt bin_x,
                                LaneInt bin_y, uint has_heights, __global const uint* heights) {
    float size = (float)(1u << projection->bin_log2);
    LaneFloat x = LANES_TO_FLOAT(bin_x) * size, y = LANES_TO_FLOAT(bin_y) * size;
    LaneInt outside = (LaneInt)(0);
    for (int i = 0; i < 3; ++i)
        outside |=
            LANE_COMPARE(lanes_highest_at_corners(record->edge_x[i], record->edge_y[i], record->edge_0[i], x, y, size),
                         <, -record->margin_edge);
    if (!has_heights || !LANES_ANY(~outside)) return ~outside;
    LaneInt cells = bin_y * (int)projection->bins_x + bin_x;
    LaneInt keys = LANES_GATHER((__global const int*)heights, cells);
    LaneFloat lowest = lanes_of_order(keys ^ (LaneInt)((int)0x80000000));
    LaneFloat highest =
        lanes_highest_at_corners(record->plane_x, record->plane_y, record->plane_0, x, y, size) + record->margin_plane;
    LaneInt open = LANE_COMPARE(keys, !=, (LaneInt)(-1));
    return ~outside & open & LANE_COMPARE(record->z_high, >=, lowest) & ~LANE_COMPARE(highest, <, lowest);
}
#endif

// ---- The bins of a tile ---------------------------------------------------------------------------------------------

static uint bins_of_rectangle(uint4 bins) { return (bins.z - bins.x + 1u) * (bins.w - bins.y + 1u); }
static uint4 bin_of_rectangle(uint4 bins, uint i) {
    uint width = bins.z - bins.x + 1u;
    uint x = bins.x + i % width, y = bins.y + i / width;
    return (uint4)(x, y, x, y);
}

#endif
