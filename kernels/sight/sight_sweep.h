// SPDX-License-Identifier: MIT
// Contract of the sweep, which decides most cells of a grid from one eye without following their lines of sight.
//
// Seen from the eye, a quadrant is full of rays that meet its lines a = 1, 2, ... (columns or rows). The rays divide
// it into wedges at most a cell wide at their far end, so that in a wedge a line has at most one vertex. With u = b /
// a, v = height / a (a, b, height from the eye) an edge of the grid is a straight segment of the (u, v) plane, and a
// target is hidden if a nearer segment is not below it. A wedge keeps two bounds over all u in it: `top`, which no
// nearer ground exceeds, and `reached`, which some nearer ground reaches at every u. A target that is neither above the
// first nor below the second is opened (docs/viewshed.md). All others are hidden before the sweep.
//
// A ray's u is a whole number of 2^-U_BITS, so its places on lines are whole numbers of 2^-PLACE_BITS: no ray is
// rounded, and each target lies in a wedge.
#pragma once

#include "sight/sight_lines.h"

#define U_BITS 22
#define PLACE_BITS 30

// Neighbouring vertices of a line, among which are all that the rays of a group meet.
#define STRIP_LENGTH 32

// A quadrant: a grows from the eye outwards, |b| < a, and a + b is constant along diagonals of the grid. Cell (a, b),
// counted from the eye's cell, is heights[origin + a * line_stride + b * vertex_stride], of the heights by rows or by
// columns.
GN_STRUCT_BEGIN(SweepQuadrant)
    long origin;
    int line_stride, vertex_stride;
    int first_line, lines;              // a of the first and the last line that have targets
    int first_b, last_b;                // the vertices of a line
    int first_target_b, last_target_b;  // those that are targets
    int eye_a, eye_b;                   // the eye's place in its cell, sub-cells: below SUBCELLS
    int wedges;
    int first_u, wedge_u;  // wedge i reaches from first_u + i * wedge_u to first_u + (i + 1) * wedge_u, but not beyond
    int last_u;         // -last_u and last_u: 1 where lines are columns, else below it, so that a diagonal has one side
    int nearest;        // x or y of line 0
    int direction;      // 1: x or y grows with a; -1
    int vertex_of_eye;  // y or x of vertex 0
    int end_group;      // of the groups of wedges of this quadrant and those before it
    int is_along_y;     // lines are rows
    int has_strips;     // the vertices of a line are neighbours in memory, and at least STRIP_LENGTH
GN_STRUCT_END(SweepQuadrant, 88)

GN_STRUCT_BEGIN(SweepQuadrants)
    SweepQuadrant of[4];
GN_STRUCT_END(SweepQuadrants, 352)
