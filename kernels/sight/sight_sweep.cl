// SPDX-License-Identifier: MIT
// Decides most cells of a quadrant by bounds of the ground over bins of rays (sight_sweep.h): what it writes is
// certain, and all other cells stay open.
#include "sight/sight_sweep.h"

#include "sight/sight_lines.clh"

// Float arithmetic. A height from the eye, an interpolation between two heights and a quotient by the distance together
// have fewer than 2^5 roundings' worth of error (2^-24 each, of the heights' sum, with 2.5 ulp for a division): they
// are bounded by HEIGHT_SLACK. A ray's place on a line is rounded too, by less than 2^-22 of its distance: the bin's
// border is that rounded polygon, and a target that lies within U_SLACK of a ray is left open.
#define HEIGHT_SLACK 0x1p-19f
#define U_SLACK 0x1p-20f
// A height for none: below all others, and so are all heights interpolated with it.
#define LOW_HEIGHT -0x1p31f
// Every so many lines the bounds are kept: a target near the edge of what is seen is compared with the bounds of some
// lines earlier, and exactly with the ground since.
#define LINES_KEPT 8

typedef struct Bounds {
    float low, high;
} Bounds;

static float height_at(const SightGrid grid, const SweepQuadrant of, __global const int* heights, int a, int b) {
    b = clamp(b, of.first_b,
              of.last_b);  // beyond the border its last vertex stands for the line: bounds are no tighter
    int height = heights[of.origin + a * of.line_stride + b * of.vertex_stride];
    return height == NO_HEIGHT ? LOW_HEIGHT : (float)(height - grid.eye_height);
}

// Bounds of v at a share `t` of an edge from height `one` to `other`, at a distance.
static Bounds bounds_of(float one, float other, float t, float distance) {
    float height = one + t * (other - one), slack = HEIGHT_SLACK * (fabs(one) + fabs(other));
    Bounds bounds = {(height - slack) / distance, (height + slack) / distance};
    return bounds;
}

// The largest v of the edges that a ray crosses between line a - 1, at b = `from`, and line a, at `to`.
static float top_between_lines(const SightGrid grid, const SweepQuadrant of, __global const int* heights, int a,
                               float from, float to) {
    float top = -INFINITY, before = (float)(a - 1) - of.eye_a, turn = to - from;
    float side = floor(fmax(from, to));
    if (side > fmin(from, to)) {  // an edge of constant b
        float t = (side - from) / turn;
        if (before + t > 0.0f)
            top = bounds_of(height_at(grid, of, heights, a - 1, (int)side), height_at(grid, of, heights, a, (int)side),
                            t, before + t)
                      .high;
    }
    // Diagonals from (a - 1, b) to (a, b - 1).
    for (float b = floor(from) + 1.0f; b < to + 1.0f; b += 1.0f) {
        float t = (b - from) / (1.0f + turn);
        if (before + t > 0.0f)
            top = fmax(top, bounds_of(height_at(grid, of, heights, a - 1, (int)b),
                                      height_at(grid, of, heights, a, (int)b - 1), t, before + t)
                                .high);
    }
    return top;
}

typedef struct Bin {
    float top, reached;
    float top_kept[2];  // of lines_kept[0] and lines_kept[1], the earlier one first
} Bin;

// Decides the target (a, b) in a bin, if it is certain.
static void decide_target(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                          __global const int* block_tops, __global const int* spans, __global uchar* answers, int a,
                          int b, float top, const Bin* bin, int line_kept) {
    long cell = of.origin + a * of.line_stride + b * of.vertex_stride;
    int height = heights[cell], x = (int)(cell % grid.columns), y = (int)(cell / grid.columns);
    if (height == NO_HEIGHT || x < spans[2 * y] || x >= spans[2 * y + 1]) return;
    SightLine line = sight_line(grid, x, y, height);
    Bounds v = bounds_of((float)line.height, 0.0f, 0.0f, (float)a - of.eye_a);
    if (bin->reached >= v.high)
        answers[cell] = SIGHT_HIDDEN;
    else if (v.low > top)
        answers[cell] = SIGHT_SEEN;
    else if (v.low > bin->top_kept[0])
        answers[cell] =
            (uchar)(is_hidden(grid, heights, block_tops, of.nearest + of.direction * line_kept, &line) ? SIGHT_HIDDEN
                                                                                                       : SIGHT_SEEN);
}

// Takes line a into a bin between two rays, and the vertices between them.
static void add_line(const SightGrid grid, const SweepQuadrant of, __global const int* heights, int a, int first_b,
                     float end_b, Bounds left, Bounds right, float top, Bin* bin) {
    Bounds line = {fmin(left.low, right.low), fmax(top, fmax(left.high, right.high))};
    for (int b = first_b; (float)b < end_b; ++b) {
        Bounds vertex = bounds_of(height_at(grid, of, heights, a, b), 0.0f, 0.0f, (float)a - of.eye_a);
        line.low = fmin(line.low, vertex.low);
        line.high = fmax(line.high, vertex.high);
    }
    bin->top = fmax(bin->top, line.high);
    bin->reached = fmax(bin->reached, line.low);
}

// Sweeps SWEEP_BINS bins from the eye outwards.
static void sweep_bins(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                       __global const int* block_tops, __global const int* spans, __global uchar* answers, int first) {
    int count = min(SWEEP_BINS, of.bins - first), lines_kept[2] = {0, 0};
    Bin bins[SWEEP_BINS];
    float u[SWEEP_BINS + 1], place[SWEEP_BINS + 1], tops[SWEEP_BINS + 1];
    Bounds on_line[SWEEP_BINS + 1];
    for (int i = 0; i <= count; ++i) {
        u[i] = of.first_u + (float)(first + i) * of.bin_u;
        place[i] = of.eye_b - u[i] * of.eye_a;
    }
    for (int i = 0; i < count; ++i) bins[i] = (Bin){-INFINITY, -INFINITY, {-INFINITY, -INFINITY}};
    for (int a = 1; a <= of.lines; ++a) {
        float distance = (float)a - of.eye_a;
        for (int i = 0; i <= count; ++i) {
            float from = place[i], to = place[i] = of.eye_b + u[i] * distance;
            float b = floor(to);
            tops[i] = top_between_lines(grid, of, heights, a, from, to);
            on_line[i] = bounds_of(height_at(grid, of, heights, a, (int)b), height_at(grid, of, heights, a, (int)b + 1),
                                   to - b, distance);
        }
        if (place[0] > (float)of.last_b || place[count] < (float)of.first_b) break;  // out of the grid for good
        for (int i = 0; i < count; ++i) {
            int b = (int)ceil(place[i]);
            float top = fmax(bins[i].top, fmax(tops[i], tops[i + 1]));
            for (int target = max(b, of.first_b); (float)target < place[i + 1] && target <= of.last_b; ++target) {
                float at = ((float)target - of.eye_b) / distance;
                if (at > u[i] + U_SLACK && at < u[i + 1] - U_SLACK)
                    decide_target(grid, of, heights, block_tops, spans, answers, a, target, top, &bins[i],
                                  lines_kept[0]);
            }
            add_line(grid, of, heights, a, b, place[i + 1], on_line[i], on_line[i + 1], top, &bins[i]);
        }
        if (a % LINES_KEPT != 0) continue;
        for (int i = 0; i < count; ++i) {
            bins[i].top_kept[0] = bins[i].top_kept[1];
            bins[i].top_kept[1] = bins[i].top;
        }
        lines_kept[0] = lines_kept[1];
        lines_kept[1] = a;
    }
}

__kernel void sight_sweep(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                          __global const int* block_tops, __global const int* spans,
                          __global uchar* answers GN_SHARES) {
    size_t groups = ((size_t)of.bins + SWEEP_BINS - 1) / SWEEP_BINS;
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(groups))
    sweep_bins(grid, of, heights, block_tops, spans, answers, (int)i * SWEEP_BINS);
    GN_END_SHARES;
}
