// SPDX-License-Identifier: MIT
// Contract of height fields: triangles that lie side by side over a plane, the ground, as those of a digital elevation
// model do. Over a rectangle of the ground each position has exactly one height, and heights are continuous there. A
// grid of cells over the ground lists each cell's triangles, and a pyramid over half cells has the least and the
// greatest height of squares of half cells.
#pragma once

#include "simd/points.h"

// A triangle that reaches less than this far (in cells or half cells) into a cell or half cell may be missing there;
// the neighbouring one has it. Readers extend what they look up by this and by the rounding of coordinates.
#define FIELD_SNAP 0x1p-7f
// Up to this number of half cells along an axis, coordinates in half cells are wrong by less than FIELD_SNAP / 2.
#define MAX_FIELD_HALVES 16384u
// The largest coordinate of triangles: differences of coordinates stay within the bounds of rounding.
#define FIELD_LARGEST_COORDINATE 0x1p19f
// Triangles with smaller cells are no height field. And a corner's distance (in half cells) is taken for FIELD_NEAR
// more: so products of two distances bound what underflow takes, too (tests/proofs/horizons.v).
#define FIELD_LEAST_CELL 0x1p-34f
#define FIELD_NEAR 0x1p-40f
// A triangle over more cells than this is not part of a height field.
#define MAX_CELLS_OF_TRIANGLE 4096
// A grid has at most this many triangles in a cell, since each point near it tests them one by one, and at most this
// many entries per triangle, since more would take too much memory.
#define MAX_TRIANGLES_OF_CELL 128u
#define MAX_ENTRIES_OF_TRIANGLE 16u
// The pyramid's heights are whole numbers of units up to FIELD_UNITS; the triangles' heights are at least FIELD_LOWEST
// away from either end, so that bounds have room to round.
#define FIELD_UNITS 65535.0f
#define FIELD_LOWEST 2.0f
// Bounds of heights lie this far, in units, beyond the heights.
#define FIELD_SLACK 0x1p-4f

GN_STRUCT_BEGIN(HeightField)
    TrianglesLayout triangles;
    float corner[2];     // of the grid: its least coordinates along the ground's axes
    float halves;        // half cells per unit of length
    float lowest;        // the height of 0 units
    float units;         // of height, per unit of length
    float winding;       // seen from above: 1: the triangles are counter-clockwise, -1: clockwise
    uint columns, rows;  // of cells
    uint axis;           // of heights; the next two axes, cyclically, are those of the ground
    float inside[4];     // the rectangle with one height at each position: low x, low y, high x, high y
    uint padding[3];
GN_STRUCT_END(HeightField, 80)

// A level of the pyramid. Its squares have 2^level half cells a side. Entry (x, y) has the bounds of the four squares
// with columns x and x + 1 and rows y and y + 1: any region that is no wider than a square lies within one entry.
GN_STRUCT_BEGIN(FieldLevel)
    uint first, columns, rows;
    uint padding;
GN_STRUCT_END(FieldLevel, 16)

GN_STRUCT_BEGIN(FieldCounters)
    uint unfit;    // 1: a triangle is over too many cells, or a cell has too many triangles
    uint borders;  // number of edges without exactly one neighbour, and of entries in their list
GN_STRUCT_END(FieldCounters, 8)

#ifndef __cplusplus
// The coordinates of p along the ground, and its height.
static float3 over_ground(uint axis, float3 p) { return axis == 0u ? p.yzx : axis == 1u ? p.zxy : p; }

// The first and the last of `count` cells, or half cells, that an interval of the ground meets.
static int2 cells_met(float low, float high, float corner, float per_length, uint count) {
    int first = clamp((int)floor((low - corner) * per_length + FIELD_SNAP), 0, (int)count - 1);
    return (int2)(first, clamp((int)floor((high - corner) * per_length - FIELD_SNAP), first, (int)count - 1));
}
#endif
