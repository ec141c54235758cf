// SPDX-License-Identifier: MIT
// Contract of lines of sight over a grid of heights: whether each cell is seen from an eye above the ground, in integer
// arithmetic.
//
// The ground: cells are vertices at whole columns x and rows y (row 0 in the north), their heights whole steps. Four
// neighbours span two triangles; the diagonal runs from south-west (x, y + 1) to north-east (x + 1, y). A vertex, edge
// or triangle with a corner without height does not exist. A target stands `target_height` steps above its cell. It is
// seen if all of the open line between it and the eye that lies over the ground is strictly above the ground.
//
// Eye and target are not below the ground, and the eye is above it. Ground and line are linear over each triangle, so
// the line is compared where it crosses an edge, or a vertex, alone.
//
// Ranges: at most MAX_GRID_SIDE columns and rows, |heights| below MAX_GRID_HEIGHT. With S = SUBCELLS an edge's line
// lies fewer than 2^15 S sub-cells from the eye, so a weight has at most 15 + 2 x 8 = 31 bits, and a weight times a
// difference of heights at most 31 + 26 + 1: no sum of two such products leaves 64 bits.
#pragma once

#include "prelude.h"

// The eye's place is a whole number of these parts of a cell.
#define SUBCELLS 256
#define MAX_GRID_SIDE 16384
#define MAX_GRID_HEIGHT (1 << 25)
#define NO_HEIGHT (-2147483647 - 1)

// A target is raised up to this height above the eye: a weight times it has at most 62 bits.
#define HIGHEST_TARGET (1L << 31)

// Patches of the grid have SIGHT_PATCH x SIGHT_PATCH squares, and a table has the greatest height of a vertex of each.
#define SIGHT_PATCH 16

// What is known of a cell.
#define SIGHT_HIDDEN 0u
#define SIGHT_SEEN 1u
#define SIGHT_OPEN 2u

// What is found of the heights.
#define FOUND_ABSENT 1u
#define FOUND_WRONG 2u

GN_STRUCT_BEGIN(SightGrid)
    int columns, rows;
    int patch_columns, patch_rows;
    int eye_x, eye_y;                                    // sub-cells
    int eye_height;                                      // steps
    int target_height;                                   // steps above the ground
    int first_column, first_row, last_column, last_row;  // the box of the targets, its end exclusive
    int band_first, band_last;                           // the rows that have answers
    int has_spans;                                       // 0: all cells of the box are targets
GN_STRUCT_END(SightGrid, 60)

// Where an eye's answers are added: the counts of each cell, and bit `bit` of its word. Then all answers are hidden
// again, as the next eye's sweep needs them.
GN_STRUCT_BEGIN(SightSum)
    uint is_summed, bit, has_words;
GN_STRUCT_END(SightSum, 12)
