// SPDX-License-Identifier: MIT
// Decides the open cells of a grid, one line of sight each; finds the heights from which cells are seen; adds answers
// up.
#include "sight/sight_lines.clh"

#define OPENED 16

// The greatest height of a vertex of each patch; and into `found` whether any cell has no height, and whether any
// height is out of range.
__kernel void sight_patches(const SightGrid grid, __global const int* heights, __global int* patch_tops,
                            volatile __global uint* found) {
    GN_FOR_EACH(i, grid.patch_columns * (size_t)grid.patch_rows) {
        int x = (int)(i % grid.patch_columns) * SIGHT_PATCH, y = (int)(i / grid.patch_columns) * SIGHT_PATCH;
        int top = NO_HEIGHT, least = INT_MAX;
        bool is_whole = true;
        for (int row = y; row < min(y + SIGHT_PATCH + 1, grid.rows); ++row)
            for (int column = x; column < min(x + SIGHT_PATCH + 1, grid.columns); ++column) {
                int height = heights[row * (size_t)grid.columns + column];
                top = max(top, height);
                least = min(least, height == NO_HEIGHT ? INT_MAX : height);
                is_whole &= height != NO_HEIGHT;
            }
        patch_tops[i] = top;
        if (!is_whole) atomic_or(found, FOUND_ABSENT);
        if (top >= MAX_GRID_HEIGHT || least <= -MAX_GRID_HEIGHT) atomic_or(found, FOUND_WRONG);
    }
}

// Whether each cell can be a target: SIGHT_OPEN where it has a height.
__kernel void sight_targets(ulong count, __global const int* heights, __global uchar* targets) {
    GN_FOR_EACH(i, count) targets[i] = (uchar)(heights[i] == NO_HEIGHT ? SIGHT_HIDDEN : SIGHT_OPEN);
}

// Opens the targets in columns spans[2 i] to spans[2 i + 1] (exclusive) of row i of the band; before a sweep, which
// finds all others, the one under the eye alone. Others are hidden. An item takes OPENED cells of a row. has_absent:
// `targets` says which cells have heights; else all have.
__kernel void sight_begin(const SightGrid grid, uint sweeps, uint has_absent, __global const uchar* targets,
                          __global const int* spans, __global uchar* answers) {
    int pieces = (grid.columns + OPENED - 1) / OPENED;
    GN_FOR_EACH(i, (grid.band_last - grid.band_first) * (size_t)pieces) {
        int row = (int)(i / pieces), first = (int)(i % pieces) * OPENED, end = min(first + OPENED, grid.columns);
        __global const uchar* of_row = targets + (has_absent ? (grid.band_first + row) * (size_t)grid.columns : 0);
        __global uchar* answers_of_row = answers + row * (size_t)grid.columns;
        int first_target = spans[2 * row], end_target = spans[2 * row + 1];
        if (sweeps) {
            bool is_under = grid.eye_y == (grid.band_first + row) * SUBCELLS;
            first_target = is_under ? max(first_target, (grid.eye_x + SUBCELLS - 1) / SUBCELLS) : 0;
            end_target = is_under ? min(end_target, grid.eye_x / SUBCELLS + 1) : 0;
        }
        if (end == first + OPENED && (end <= first_target || first >= end_target)) {
            vstore16((uchar16)(SIGHT_HIDDEN), 0, answers_of_row + first);
            continue;
        }
        if (first >= first_target && end <= end_target && end == first + OPENED) {
            vstore16(has_absent ? vload16(0, of_row + first) : (uchar16)(SIGHT_OPEN), 0, answers_of_row + first);
            continue;
        }
        for (int x = first; x < end; ++x) {
            bool is_target = x >= first_target && x < end_target;
            answers_of_row[x] = (uchar)(!is_target ? SIGHT_HIDDEN : has_absent ? of_row[x] : SIGHT_OPEN);
        }
    }
}

// Decides a cell of the band if it is open. If it is seen, one is added to its count, and its bit is set in its word.
static void decide_cell(const SightGrid grid, __global const int* heights, __global const int* patch_tops,
                        __global uchar* answers, SightSum sum, __global uint* counts, __global uint* words, size_t i) {
    if (answers[i] == SIGHT_OPEN) {
        size_t cell = i + grid.band_first * (size_t)grid.columns;
        SightLine line = sight_line(grid, (int)(cell % grid.columns), (int)(cell / grid.columns), heights[cell]);
        answers[i] = (uchar)(is_hidden_anywhere(grid, heights, patch_tops, &line) ? SIGHT_HIDDEN : SIGHT_SEEN);
    }
    if (answers[i] != SIGHT_SEEN) return;
    if (sum.has_counts) ++counts[i];
    if (sum.has_words) words[i] |= 1u << sum.bit;
}

// Decides the cells of the band that are open, and adds the eye's answers to the sums. On a CPU hidden cells are passed
// over, eight at once.
__kernel void sight_decide(const SightGrid grid, const SightSum sum, __global const int* heights,
                           __global const int* patch_tops, __global uchar* answers, __global uint* counts,
                           __global uint* words GN_SHARES) {
    size_t count = (grid.band_last - grid.band_first) * (size_t)grid.columns;
#ifdef GN_CPU
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE((count + 7) / 8)) {
        if (8 * i + 8 <= count && as_ulong(vload8(i, answers)) == 0) continue;  // all are SIGHT_HIDDEN
        for (size_t k = 8 * i; k < min(8 * i + 8, count); ++k)
            decide_cell(grid, heights, patch_tops, answers, sum, counts, words, k);
    }
#else
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(count))
    decide_cell(grid, heights, patch_tops, answers, sum, counts, words, i);
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
