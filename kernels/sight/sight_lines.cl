// SPDX-License-Identifier: MIT
// Decides the open cells of a grid, one line of sight each; finds the heights from which cells are seen; sums answers.
#include "sight/sight_lines.clh"

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

// Opens the targets: the cells with a height in columns spans[2 y] to spans[2 y + 1] (exclusive) of each row y. Others
// are hidden, or absent.
__kernel void sight_begin(const SightGrid grid, __global const int* heights, __global const int* spans,
                          __global uchar* answers) {
    GN_FOR_EACH(i, grid.rows * (size_t)grid.columns) {
        int x = (int)(i % grid.columns), y = (int)(i / grid.columns);
        bool is_target = x >= spans[2 * y] && x < spans[2 * y + 1];
        answers[i] = (uchar)(heights[i] == NO_HEIGHT ? SIGHT_ABSENT : is_target ? SIGHT_OPEN : SIGHT_HIDDEN);
    }
}

// Decides the cells that are open.
__kernel void sight_decide(const SightGrid grid, __global const int* heights, __global const int* patch_tops,
                           __global uchar* answers GN_SHARES) {
    size_t first = grid.first_row * (size_t)grid.columns, count = grid.last_row * (size_t)grid.columns - first;
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(count)) {
        size_t cell = first + i;
        if (answers[cell] != SIGHT_OPEN) continue;
        SightLine line = sight_line(grid, (int)(cell % grid.columns), (int)(cell / grid.columns), heights[cell]);
        answers[cell] = (uchar)(is_hidden_anywhere(grid, heights, patch_tops, &line) ? SIGHT_HIDDEN : SIGHT_SEEN);
    }
    GN_END_SHARES;
}

// The least height above the ground, from the targets' height on, at which each open cell is seen, in steps; NO_HEIGHT
// for cells that are not open, INT_MAX for those that no height up to 2^31 - 2 steps serves.
__kernel void sight_heights(const SightGrid grid, __global const int* heights, __global const int* patch_tops,
                            __global const uchar* answers, __global int* least GN_SHARES) {
    GN_FOR_EACH_OF(cell, GN_SHARED_RANGE(grid.rows * (size_t)grid.columns)) {
        least[cell] = NO_HEIGHT;
        if (answers[cell] != SIGHT_OPEN) continue;
        SightLine line = sight_line(grid, (int)(cell % grid.columns), (int)(cell / grid.columns), heights[cell]);
        line.raises = true;
        is_hidden_anywhere(grid, heights, patch_tops, &line);
        long above_ground = line.height + grid.eye_height - heights[cell];
        least[cell] = line.height == HIGHEST_TARGET ? INT_MAX : (int)min(above_ground, (long)INT_MAX);
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
