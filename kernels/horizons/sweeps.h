// SPDX-License-Identifier: MIT
// Contract of sweeps: over a raster, a height field whose vertices stand in rows and columns, one walk for each light
// decides nearly all of the vertices. A raster has four copies of its heights (RasterCopies). A copy's lines lie one
// after the other, each with RASTER_PAD vertices more on either side, as high as the vertex at the line's end.
//
// A light is seen in the copy and the direction in which its rays go from line to line, and on each line by `slope`
// vertices to the side, from 0 to 1. Rays of one light do not cross; a strip has those that are less than a vertex
// apart. So each line has one vertex of each strip, and a walk along the strip, from the light's side, meets all ground
// that may block it. With heights over the plane through the rays, the walk keeps two bounds, straight lines across the
// strip: no ground that was met is above `high`, and some of it is at `low` or above. The next lines of each vertex,
// SWEEP_NEAR of them, are met along the vertex's own ray. A pair that stays open is walked alone, along its ray, where
// the ground may be as high (RASTER_TILE).
#pragma once

#include "lights/light_bundle.h"

#define RASTER_PAD 32
#define MAX_RASTER_SIDE 16384u
#define SWEEP_NEAR 4
// A ray meets, on its way over SWEEP_NEAR lines, at most as many lines, rows and twice as many diagonals.
#define MAX_SWEEP_CROSSINGS 16
// A point's vertex is column << 16 | row.
// What the crossings of a vertex's own ray are off by, as a share of the greatest height and of the ray's climb over
// them; and what underflow takes at most of a height (tests/proofs/sweeps.v).
#define SWEEP_CROSSING_ERROR (14.0f / 16777216.0f)
#define SWEEP_LOST 0x1p-77f
// What bounds across a strip are off by, in half ulps of the greatest height and of a ray's climb over all lines.
#define SWEEP_HEIGHT_ROUNDINGS 128.0f
#define SWEEP_CLIMB_ROUNDINGS 24.0f
// A tile has so many lines and rows, and one more of each, which it shares with the next tile. Its greatest height has
// the sign of -1 if the tile or one of its neighbours has a hole, a square that lacks a triangle.
#define RASTER_TILE 16
// A word holds the answers of 16 pairs, bit k that pair k is lit and bit 16 + k that it stays open: on a CPU those of a
// block of strips on one line, on a GPU, where a block is one strip, those of the strip on neighbouring lines.
#ifdef __cplusplus
namespace gnomon {
constexpr uint sweep_lines_of_word(uint lanes) { return 16 / lanes; }
}  // namespace gnomon
#else
#define SWEEP_LINES_OF_WORD (16u / GN_LANES)
#endif
// The masks that a GPU's work-group looks at, for each of its items, before it walks rays, and the words of local
// memory for each item.
#define WALK_ROUNDS 8u
#define WALK_WORDS (WALK_ROUNDS + 2u)
#define NO_VERTEX 0xFFFFFFFFu

GN_STRUCT_BEGIN(RasterParams)
    TrianglesLayout triangles;
    float corner[2], per_length[2];  // of columns and rows, along the ground's axes
    uint columns, rows;              // of vertices
    uint axis;                       // of heights (horizons/height_field.h)
    uint padding;
GN_STRUCT_END(RasterParams, 48)

// What raster_check() finds: bits that say that the triangles are no raster, or which diagonals there are.
#define RASTER_IS_NONE 1u
#define RASTER_RISES 2u  // diagonals along which row and column both grow
#define RASTER_FALLS 4u

// Copies of heights, one after the other, float by float. In copies 0 and 1 the lines are columns, in 2 and 3 rows; in
// 1 and 3 vertices of a line follow one another from the last to the first.
GN_STRUCT_BEGIN(RasterCopies)
    ulong first[4];  // of the first line's vertex
    uint stride[4];  // of lines
    uint columns, rows;
    float lowest;       // which is subtracted from all heights
    uint first_top[4];  // of the greatest heights of tiles: tops[first_top + line of tiles * tops_of_line + tile]
    uint tops_of_line[4];
    uint has_holes;
GN_STRUCT_END(RasterCopies, 96)

// Where a ray from a vertex meets an edge: between two vertices, at floats from the vertex's own.
GN_STRUCT_BEGIN(SweepCrossing)
    int low, high;  // the edge's ends
    float share_low, share_high;
    float climb;  // of the ray up to there
    uint lines;   // which the ray needs ahead
    int rows;     // which it needs to the side
    uint padding;
GN_STRUCT_END(SweepCrossing, 32)

// The edges of one kind that a ray meets: edge k (from 1 on) after k times this many lines.
GN_STRUCT_BEGIN(SweepEdges)
    uint lines, part;  // whole lines, and a rest, whole numbers of 2^-32
    float rate;        // edges to a line; 0: the ray meets none on the raster
GN_STRUCT_END(SweepEdges, 12)
#define SWEEP_LINES 0
#define SWEEP_ROWS 1
#define SWEEP_DIAGONALS 2

GN_STRUCT_BEGIN(LightSweep)
    ulong first;                // of the line that is farthest from the light
    int line_stride;            // to the next line towards the light
    uint lines, rows;           // lines, and vertices of a line
    uint slope;                 // vertices to the side on each line, whole numbers of 2^-32
    float climb;                // of a ray from line to line
    float margin, near_margin;  // more than all errors of bounds; of crossings
    float highest;              // the greatest height
    uint crossing_count;        // 0: the light has no sweep
    uint shift;                 // strip of a vertex: its row - its line's base - 1 + shift
    uint blocks;                // of GN_LANES strips
    uint first_answer;          // answers[first_answer + line / SWEEP_LINES_OF_WORD * blocks + block]
    uint is_rising;             // of the copy's diagonals, as the light's rays go
    uint is_along_y, is_line_turned, is_row_turned;  // from column and row to line and row of the sweep
    float share;                                     // slope, as a float
    uint first_top, tops_of_line;                    // of the copy
    SweepEdges edges[3];                             // lines, rows, diagonals
    uint has_holes, padding;
    SweepCrossing crossings[MAX_SWEEP_CROSSINGS];  // the nearest first; at a multiple of 16 bytes
GN_STRUCT_END(LightSweep, 640)

GN_STRUCT_BEGIN(SweepParams)
    PointsLayout points;  // of a part of the sorted points
    uint bundle_count, mask_stride;
    uint sweep_count;  // the lights that have a sweep
    uint most_blocks;  // that one of them has
GN_STRUCT_END(SweepParams, 64)

#ifndef __cplusplus
// Whole vertices and the rest to the side, at a line.
static uint base_at(__global const LightSweep* sweep, uint line) { return mul_hi(sweep->slope, line); }
static float rest_at(__global const LightSweep* sweep, uint line) { return (float)(sweep->slope * line) * 0x1p-32f; }
#endif
