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

// Writes the heights one column after the other.
__kernel void sight_columns(const SightGrid grid, __global const int* heights, __global int* by_columns) {
    GN_FOR_EACH(i, grid.patch_columns * (size_t)grid.patch_rows) {
        int x = (int)(i % grid.patch_columns) * SIGHT_PATCH, y = (int)(i / grid.patch_columns) * SIGHT_PATCH;
        for (int column = x; column < min(x + SIGHT_PATCH, grid.columns); ++column)
            for (int row = y; row < min(y + SIGHT_PATCH, grid.rows); ++row)
                by_columns[column * (size_t)grid.rows + row] = heights[row * (size_t)grid.columns + column];
    }
}

// Whether each cell can be a target: SIGHT_OPEN where it has a height.
__kernel void sight_targets(ulong count, __global const int* heights, __global uchar* targets) {
    GN_FOR_EACH(i, count) targets[i] = (uchar)(heights[i] == NO_HEIGHT ? SIGHT_HIDDEN : SIGHT_OPEN);
}

// Opens the targets in columns spans[2 i] to spans[2 i + 1] (exclusive) of row i of the band; others are hidden. An
// item takes OPENED cells of a row. has_absent: `targets` says which cells have heights; else all have.
__kernel void sight_begin(const SightGrid grid, uint has_absent, __global const uchar* targets,
                          __global const int* spans, __global uchar* answers) {
    int pieces = (grid.columns + OPENED - 1) / OPENED;
    GN_FOR_EACH(i, (grid.band_last - grid.band_first) * (size_t)pieces) {
        int row = (int)(i / pieces), first = (int)(i % pieces) * OPENED, end = min(first + OPENED, grid.columns);
        __global const uchar* of_row = targets + (has_absent ? (grid.band_first + row) * (size_t)grid.columns : 0);
        __global uchar* answers_of_row = answers + row * (size_t)grid.columns;
        for (int x = first; x < end; ++x) {
            bool is_target = x >= spans[2 * row] && x < spans[2 * row + 1];
            answers_of_row[x] = (uchar)(!is_target ? SIGHT_HIDDEN : has_absent ? of_row[x] : SIGHT_OPEN);
        }
    }
}

// Opens the target under the eye, which no sweep meets. All others are hidden.
__kernel void sight_under_eye(const SightGrid grid, __global const int* heights, __global const int* spans,
                              __global uchar* answers) {
    int x = grid.eye_x / SUBCELLS, y = grid.eye_y / SUBCELLS, row = y - grid.band_first;
    GN_FOR_EACH(i, 1) {
        if (x * SUBCELLS != grid.eye_x || y * SUBCELLS != grid.eye_y || row < 0 || y >= grid.band_last) continue;
        if (x < spans[2 * row] || x >= spans[2 * row + 1]) continue;
        if (heights[y * (size_t)grid.columns + x] != NO_HEIGHT) answers[row * (size_t)grid.columns + x] = SIGHT_OPEN;
    }
}

// Decides a cell of the band that is open.
static uchar decided(const SightGrid grid, __global const int* heights, __global const int* patch_tops, size_t i) {
    size_t cell = i + grid.band_first * (size_t)grid.columns;
    SightLine line = sight_line(grid, (int)(cell % grid.columns), (int)(cell / grid.columns), heights[cell]);
    return (uchar)(is_hidden_anywhere(grid, heights, patch_tops, &line) ? SIGHT_HIDDEN : SIGHT_SEEN);
}

// Decides a cell of the band if it is open. If answers are summed and it is seen, one is added to its count, and its
// bit is set in its word.
static void decide_cell(const SightGrid grid, __global const int* heights, __global const int* patch_tops,
                        __global uchar* answers, SightSum sum, __global uint* counts, __global uint* words, size_t i) {
    if (answers[i] == SIGHT_OPEN) answers[i] = decided(grid, heights, patch_tops, i);
    if (!sum.is_summed || answers[i] != SIGHT_SEEN) return;
    answers[i] = SIGHT_HIDDEN;
    ++counts[i];
    if (sum.has_words) words[i] |= 1u << sum.bit;
}

#ifdef GN_CPU
// The same of cells 8 i to 8 i + 7.
static void decide_eight(const SightGrid grid, __global const int* heights, __global const int* patch_tops,
                         __global uchar* answers, SightSum sum, __global uint* counts, __global uint* words, size_t i) {
    ulong open = as_ulong(vload8(i, answers)) & (SIGHT_OPEN * 0x0101010101010101ul);
    for (; open != 0; open &= open - 1) {
        size_t cell = 8 * i + (63 - clz(open & -open)) / 8;
        answers[cell] = decided(grid, heights, patch_tops, cell);
    }
    uchar8 seen = vload8(i, answers);
    if (!sum.is_summed || as_ulong(seen) == 0) return;
    vstore8((uchar8)(SIGHT_HIDDEN), i, answers);
    vstore8(vload8(i, counts) + convert_uint8(seen), i, counts);
    if (sum.has_words) vstore8(vload8(i, words) | convert_uint8(seen) << sum.bit, i, words);
}
#endif

// Decides the cells of the band that are open, and adds the eye's answers to the sums.
__kernel void sight_decide(const SightGrid grid, const SightSum sum, __global const int* heights,
                           __global const int* patch_tops, __global uchar* answers, __global uint* counts,
                           __global uint* words GN_SHARES) {
    size_t count = (grid.band_last - grid.band_first) * (size_t)grid.columns;
#ifdef GN_CPU
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE((count + 31) / 32)) {
        if (32 * i + 32 > count) {
            for (size_t k = 32 * i; k < count; ++k)
                decide_cell(grid, heights, patch_tops, answers, sum, counts, words, k);
            continue;
        }
        ulong4 cells = vload4(i, (__global const ulong*)answers);
        if ((cells.x | cells.y | cells.z | cells.w) == 0) continue;  // most are hidden, all 32
        for (size_t k = 4 * i; k < 4 * i + 4; ++k)
            decide_eight(grid, heights, patch_tops, answers, sum, counts, words, k);
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
