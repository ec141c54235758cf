// SPDX-License-Identifier: MIT
// Decides most cells of a quadrant by bounds of the ground over wedges of rays (sight_sweep.h): what it writes is
// certain, and all other cells stay open.
#include "sight/sight_sweep.h"

#include "sight/sight_lines.clh"

// Float arithmetic. A height from the eye, an interpolation between two heights and a quotient by the distance together
// have fewer than 2^5 roundings' worth of error (2^-24 each, of the heights' sum, with 2.5 ulp for a division): they
// are bounded by HEIGHT_SLACK. A ray's place on a line is rounded too, by less than 2^-22 of its distance: the wedge's
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
    b = clamp(b, of.first_b, of.last_b);  // beyond the border a line goes on at its last height: no bound gets tighter
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

typedef struct Wedge {
    float top, reached;
    float top_kept[2];  // of lines_kept
} Wedge;

// Wedges side by side, and the rays between them: their u, and their places on the last line that was swept.
typedef struct SweptWedges {
    int count;
    int lines_kept[2];  // the earlier one first
    float u[SWEEP_WEDGES + 1], place[SWEEP_WEDGES + 1];
    Wedge wedges[SWEEP_WEDGES];
} SweptWedges;

// Decides the target (a, b) in a wedge, if it is open and the answer is certain.
static void decide_target(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                          __global const int* patch_tops, __global uchar* answers, int a, int b, float top,
                          const Wedge* wedge, int line_kept) {
    long cell = of.origin + a * of.line_stride + b * of.vertex_stride;
    if (answers[cell] != SIGHT_OPEN) return;
    int height = heights[cell];
    Bounds v = bounds_of((float)(height + grid.target_height - grid.eye_height), 0.0f, 0.0f, (float)a - of.eye_a);
    if (wedge->reached >= v.high)
        answers[cell] = SIGHT_HIDDEN;
    else if (v.low > top)
        answers[cell] = SIGHT_SEEN;
    else if (v.low > wedge->top_kept[0]) {
        SightLine line = sight_line(grid, (int)(cell % grid.columns), (int)(cell / grid.columns), height);
        int nearest = of.nearest + of.direction * line_kept;
        answers[cell] = (uchar)(is_hidden(grid, heights, patch_tops, nearest, &line) ? SIGHT_HIDDEN : SIGHT_SEEN);
    }
}

// Takes line a into a wedge between two rays, and the vertices between them.
static void add_line(const SightGrid grid, const SweepQuadrant of, __global const int* heights, int a, int first_b,
                     float end_b, Bounds left, Bounds right, float top, Wedge* wedge) {
    Bounds line = {fmin(left.low, right.low), fmax(top, fmax(left.high, right.high))};
    for (int b = first_b; (float)b < end_b; ++b) {
        Bounds vertex = bounds_of(height_at(grid, of, heights, a, b), 0.0f, 0.0f, (float)a - of.eye_a);
        line.low = fmin(line.low, vertex.low);
        line.high = fmax(line.high, vertex.high);
    }
    wedge->top = fmax(wedge->top, line.high);
    wedge->reached = fmax(wedge->reached, line.low);
}

// The greatest height above the eye of ground or targets in the patches under lines `first` to `last` and vertices
// low_b to high_b.
static float top_of_patches(const SightGrid grid, const SweepQuadrant of, __global const int* patch_tops, int first,
                            int last, int low_b, int high_b) {
    bool is_along_y = abs((int)of.line_stride) != 1;
    int a = of.nearest + of.direction * first, a_end = of.nearest + of.direction * last;
    int b = of.vertex_of_eye + of.direction * clamp(low_b, of.first_b, of.last_b);
    int b_end = of.vertex_of_eye + of.direction * clamp(high_b, of.first_b, of.last_b), top = NO_HEIGHT;
    for (int i = min(a, a_end) / SIGHT_PATCH; i <= max(a, a_end) / SIGHT_PATCH; ++i)
        for (int j = min(b, b_end) / SIGHT_PATCH; j <= max(b, b_end) / SIGHT_PATCH; ++j)
            top = max(top, patch_tops[(is_along_y ? i : j) * (long)grid.patch_columns + (is_along_y ? j : i)]);
    return top == NO_HEIGHT ? LOW_HEIGHT : (float)((long)top + grid.target_height - grid.eye_height);
}

// Hides the open targets of a line between two rays.
static void hide_targets(const SweepQuadrant of, __global uchar* answers, int a, float left_u, float right_u) {
    float distance = (float)a - of.eye_a;
    int b = max((int)ceil(of.eye_b + (left_u + U_SLACK) * distance), of.first_b);
    int end = min((int)floor(of.eye_b + (right_u - U_SLACK) * distance), of.last_b);
    long cell = of.origin + a * of.line_stride + b * of.vertex_stride;
    for (; b <= end; ++b, cell += of.vertex_stride)
        if (answers[cell] == SIGHT_OPEN) answers[cell] = SIGHT_HIDDEN;
}

// If the patches under lines a to `last` lie so low that nearer ground hides all of them, hides their targets, and goes
// on behind them: no bound changes there.
static bool skip_lines(const SightGrid grid, const SweepQuadrant of, __global const int* patch_tops,
                       __global uchar* answers, int a, int last, SweptWedges* swept) {
    float near = (float)(a - 1) - of.eye_a, far = (float)last - of.eye_a;
    if (near <= 0.0f) return false;
    float left = of.eye_b + swept->u[0] * far, right = of.eye_b + swept->u[swept->count] * far;
    float top = top_of_patches(grid, of, patch_tops, a - 1, last, (int)floor(fmin(swept->place[0], left)),
                               (int)ceil(fmax(swept->place[swept->count], right)));
    Bounds v = bounds_of(top, 0.0f, 0.0f, top > 0.0f ? near : far);
    for (int i = 0; i < swept->count; ++i)
        if (!(swept->wedges[i].reached >= v.high)) return false;
    for (; a <= last; ++a) hide_targets(of, answers, a, swept->u[0], swept->u[swept->count]);
    for (int i = 0; i <= swept->count; ++i) swept->place[i] = of.eye_b + swept->u[i] * far;
    for (int i = 0; i < swept->count; ++i)
        swept->wedges[i].top_kept[0] = swept->wedges[i].top_kept[1] = swept->wedges[i].top;
    swept->lines_kept[0] = swept->lines_kept[1] = last;
    return true;
}

// Decides the targets of line a, and takes the line into the wedges.
static void sweep_line(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                       __global const int* patch_tops, __global uchar* answers, int a, SweptWedges* swept) {
    float tops[SWEEP_WEDGES + 1], distance = (float)a - of.eye_a;
    Bounds on_line[SWEEP_WEDGES + 1];
    for (int i = 0; i <= swept->count; ++i) {
        float from = swept->place[i], to = swept->place[i] = of.eye_b + swept->u[i] * distance, b = floor(to);
        tops[i] = top_between_lines(grid, of, heights, a, from, to);
        on_line[i] = bounds_of(height_at(grid, of, heights, a, (int)b), height_at(grid, of, heights, a, (int)b + 1),
                               to - b, distance);
    }
    for (int i = 0; i < swept->count; ++i) {
        int b = (int)ceil(swept->place[i]);
        float top = fmax(swept->wedges[i].top, fmax(tops[i], tops[i + 1])), end = swept->place[i + 1];
        for (int target = max(b, of.first_b); (float)target < end && target <= of.last_b; ++target) {
            float at = ((float)target - of.eye_b) / distance;
            if (at > swept->u[i] + U_SLACK && at < swept->u[i + 1] - U_SLACK)
                decide_target(grid, of, heights, patch_tops, answers, a, target, top, &swept->wedges[i],
                              swept->lines_kept[0]);
        }
        add_line(grid, of, heights, a, b, end, on_line[i], on_line[i + 1], top, &swept->wedges[i]);
    }
    if (a % LINES_KEPT != 0) return;
    for (int i = 0; i < swept->count; ++i) {
        swept->wedges[i].top_kept[0] = swept->wedges[i].top_kept[1];
        swept->wedges[i].top_kept[1] = swept->wedges[i].top;
    }
    swept->lines_kept[0] = swept->lines_kept[1];
    swept->lines_kept[1] = a;
}

// Sweeps SWEEP_WEDGES wedges, or as many as there are from `first` on, from the eye outwards.
static void sweep_wedges(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                         __global const int* patch_tops, __global uchar* answers, int first) {
    SweptWedges swept;
    swept.count = min(SWEEP_WEDGES, of.wedges - first);
    swept.lines_kept[0] = swept.lines_kept[1] = 0;
    for (int i = 0; i <= swept.count; ++i) {
        swept.u[i] = of.first_u + (float)(first + i) * of.wedge_u;
        swept.place[i] = of.eye_b - swept.u[i] * of.eye_a;
    }
    for (int i = 0; i < swept.count; ++i) swept.wedges[i] = (Wedge){-INFINITY, -INFINITY, {-INFINITY, -INFINITY}};
    for (int a = 1; a <= of.lines; ++a) {
        int last = min(a + SIGHT_PATCH - 1, of.lines);
        if (a % SIGHT_PATCH == 1 && skip_lines(grid, of, patch_tops, answers, a, last, &swept))
            a = last;
        else
            sweep_line(grid, of, heights, patch_tops, answers, a, &swept);
        if (swept.place[0] > (float)of.last_b || swept.place[swept.count] < (float)of.first_b)
            break;  // out of the grid
    }
}

__kernel void sight_sweep(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                          __global const int* patch_tops, __global uchar* answers GN_SHARES) {
    size_t groups = ((size_t)of.wedges + SWEEP_WEDGES - 1) / SWEEP_WEDGES;
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(groups))
    sweep_wedges(grid, of, heights, patch_tops, answers, (int)i * SWEEP_WEDGES);
    GN_END_SHARES;
}
