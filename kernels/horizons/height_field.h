// SPDX-License-Identifier: MIT
// Contract of height fields: triangles that lie side by side over a plane, the ground, as those of a digital elevation
// model do. Over a rectangle of the ground each place has exactly one height, and heights are continuous there. A grid
// of cells over the ground lists each cell's triangles, and a pyramid over half cells has the least and the greatest
// height of squares.
#pragma once

#include "simd/points.h"

// A triangle that pokes less than this far into a cell or half cell may be missing there; it is found in the cell
// beside it. Readers look this far beyond what they look for, and as far again as coordinates round.
#define FIELD_SNAP 0x1p-7f
// Coordinates along the ground in half cells are wrong by less than FIELD_SNAP / 2 up to so many of them.
#define MOST_FIELD_HALVES 16384u
// Of triangles: differences of coordinates stay within the bounds of rounding.
#define FIELD_LARGEST_COORDINATE 0x1p19f
// A triangle over more cells than this is no part of a height field.
#define MAX_CELLS_OF_TRIANGLE 4096
// More triangles than this in a cell would be met one by one by each point near it; more entries for each triangle than
// this take too much memory.
#define MAX_TRIANGLES_OF_CELL 128u
#define MOST_ENTRIES_OF_TRIANGLE 16u
// Heights are whole numbers of units; a triangle's are from FIELD_LOWEST on, so that bounds may round.
#define FIELD_UNITS 65535.0f
#define FIELD_LOWEST 2.0f
// Bounds of heights lie this far, in units, beyond the heights.
#define FIELD_SLACK 0x1p-4f

GN_STRUCT_BEGIN(HeightField)
    TrianglesLayout triangles;
    float corner[2];     // of the grid: the least coordinates along the ground's axes
    float halves;        // half cells per unit of length
    float lowest;        // the height of 0 units
    float units;         // per unit of length
    float winding;       // seen from above: 1: the triangles are counter-clockwise, -1: clockwise
    uint columns, rows;  // of cells
    uint axis;           // of heights; the two axes of the ground are the next ones in turn
    float inside[4];     // of the rectangle with one height at each place: low x, low y, high x, high y
    uint padding[3];
GN_STRUCT_END(HeightField, 80)

// A level of the pyramid: its squares have 2^level half cells a side, and entry (x, y) has the bounds of squares x and
// x + 1 times y and y + 1: whatever is no wider than a square lies within one entry.
GN_STRUCT_BEGIN(FieldLevel)
    uint first, columns, rows;
    uint padding;
GN_STRUCT_END(FieldLevel, 16)

GN_STRUCT_BEGIN(FieldCounters)
    uint unfit;    // 1: some triangle is over too many cells, or some cell has too many triangles
    uint borders;  // edges without exactly one neighbour; so many entries have a list of them
GN_STRUCT_END(FieldCounters, 8)

#ifndef __cplusplus
// x and y along the ground, and the height.
static float3 over_ground(uint axis, float3 p) { return axis == 0u ? p.yzx : axis == 1u ? p.zxy : p; }

// The cells, or half cells, that an interval of the ground meets, of `count`.
static int2 cells_met(float low, float high, float corner, float per_length, uint count) {
    int first = clamp((int)floor((low - corner) * per_length + FIELD_SNAP), 0, (int)count - 1);
    return (int2)(first, clamp((int)floor((high - corner) * per_length - FIELD_SNAP), first, (int)count - 1));
}
#endif
