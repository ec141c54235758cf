// SPDX-License-Identifier: MIT
// Decides the open cells of a grid, one line of sight each; finds the heights from which cells are seen; sums answers.
#include "sight/sight_lines.clh"

#define OPENED 16

// The greatest height of a vertex of each patch.
__kernel void sight_patches(const SightGrid grid, __global const int* heights, __global int* patch_tops) {
    GN_FOR_EACH(i, grid.patch_columns * (size_t)grid.patch_rows) {
        int x = (int)(i % grid.patch_columns) * SIGHT_PATCH, y = (int)(i / grid.patch_columns) * SIGHT_PATCH;
        int top = NO_HEIGHT;
        for (int row = y; row < min(y + SIGHT_PATCH + 1, grid.rows); ++row)
            for (int column = x; column < min(x + SIGHT_PATCH + 1, grid.columns); ++column)
                top = max(top, heights[row * (size_t)grid.columns + column]);
        patch_tops[i] = top;
    }
}

// Opens the targets: the cells with a height in columns spans[2 i] to spans[2 i + 1] (exclusive) of row i of the band.
// Others are hidden. An item takes OPENED cells of a row.
__kernel void sight_begin(const SightGrid grid, __global const int* heights, __global const int* spans,
                          __global uchar* answers) {
    int pieces = (grid.columns + OPENED - 1) / OPENED;
    GN_FOR_EACH(i, (grid.band_last - grid.band_first) * (size_t)pieces) {
        int row = (int)(i / pieces), first = (int)(i % pieces) * OPENED, end = min(first + OPENED, grid.columns);
        __global const int* of_row = heights + (grid.band_first + row) * (size_t)grid.columns;
        __global uchar* answers_of_row = answers + row * (size_t)grid.columns;
        int first_target = spans[2 * row], last_target = spans[2 * row + 1];
        for (int x = first; x < end; ++x) {
            bool is_target = x >= first_target && x < last_target && of_row[x] != NO_HEIGHT;
            answers_of_row[x] = (uchar)(is_target ? SIGHT_OPEN : SIGHT_HIDDEN);
        }
    }
}

static void decide_cell(const SightGrid grid, __global const int* heights, __global const int* patch_tops,
                        __global uchar* answers, size_t i) {
    if (answers[i] != SIGHT_OPEN) return;
    size_t cell = i + grid.band_first * (size_t)grid.columns;
    SightLine line = sight_line(grid, (int)(cell % grid.columns), (int)(cell / grid.columns), heights[cell]);
    answers[i] = (uchar)(is_hidden_anywhere(grid, heights, patch_tops, &line) ? SIGHT_HIDDEN : SIGHT_SEEN);
}

// Decides the cells of the band that are open. On a CPU eight cells are passed over at once.
__kernel void sight_decide(const SightGrid grid, __global const int* heights, __global const int* patch_tops,
                           __global uchar* answers GN_SHARES) {
    size_t count = (grid.band_last - grid.band_first) * (size_t)grid.columns;
#ifdef GN_CPU
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE((count + 7) / 8)) {
        if (8 * i + 8 <= count && !any(vload8(i, answers) == (uchar8)(SIGHT_OPEN))) continue;
        for (size_t k = 8 * i; k < min(8 * i + 8, count); ++k) decide_cell(grid, heights, patch_tops, answers, k);
    }
#else
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(count))
    decide_cell(grid, heights, patch_tops, answers, i);
#endif
    GN_END_SHARES;
}

// The least height above the ground, from the targets' height on, at which each open cell is seen, in steps; NO_HEIGHT
// for cells that are not open, INT_MAX for those that no height up to 2^31 - 2 steps serves.
__kernel void sight_heights(const SightGrid grid, __global const int* heights, __global const int* patch_tops,
                            __global const uchar* answers, __global int* least GN_SHARES) {
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE((grid.band_last - grid.band_first) * (size_t)grid.columns)) {
        least[i] = NO_HEIGHT;
        if (answers[i] != SIGHT_OPEN) continue;
        size_t cell = i + grid.band_first * (size_t)grid.columns;
        SightLine line = sight_line(grid, (int)(cell % grid.columns), (int)(cell / grid.columns), heights[cell]);
        line.raises = true;
        is_hidden_anywhere(grid, heights, patch_tops, &line);
        long above_ground = line.height + grid.eye_height - heights[cell];
        least[i] = line.height == HIGHEST_TARGET ? INT_MAX : (int)min(above_ground, (long)INT_MAX);
    }
    GN_END_SHARES;
}

// Adds an eye's answers: one to the count of each seen cell, and, where there are words, its bit.
__kernel void sight_add(ulong count, uint bit, uint has_words, __global const uchar* answers, __global uint* counts,
                        __global uint* words) {
    GN_FOR_EACH(i, count) {
        if (answers[i] != SIGHT_SEEN) continue;
        ++counts[i];
        if (has_words) words[i] |= 1u << bit;
    }
}
