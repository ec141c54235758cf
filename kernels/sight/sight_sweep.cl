// SPDX-License-Identifier: MIT
// Decides most cells around an eye by bounds of the ground over wedges of rays (sight_sweep.h): what it leaves hidden
// and what it writes is certain, but for the cells that it opens.
#include "sight/sight_sweep.h"

#include "sight/sight_lines.clh"
#include "simd/lanes.clh"

// Float arithmetic. A height from the eye, an interpolation between two heights and a quotient by the distance together
// have fewer than 2^5 roundings' worth of error (2^-24 each, of the heights' sum, with 2.5 ulp for a division): they
// are bounded by HEIGHT_SLACK. A crossing's distance is rounded by less than DISTANCE_SLACK, which counts near the eye.
#define HEIGHT_SLACK 0x1p-19f
#define DISTANCE_SLACK 0x1p-20f
#define NEAR_LINES 2
// A height for none: below all others, and so are all heights interpolated with it.
#define LOW_HEIGHT -0x1p31f
// Every so many lines the bounds are kept: a target near the edge of what is seen is compared with the bounds of some
// lines earlier, and exactly with the ground since.
#define LINES_KEPT 4
#define FAR_LINES_KEPT 64

#define PLACES_OF_CELL (1 << PLACE_BITS)
#define U_OF_1 (1 << U_BITS)
#define FINER_BITS (PLACE_BITS - U_BITS)

// Rays side by side: `u`, and their places on the last line, vertex b and a part of a cell. What follows from u; the
// ground's heights at vertices b and b + 1 there.
typedef struct Rays {
    LaneInt u, b, part;
    LaneFloat over_turn, over_sum;  // 1 / |u|, 1 / (1 + u)
    LaneInt low, high;
} Rays;

// Bounds of v where rays meet a line, and of all edges since the line before.
typedef struct Met {
    LaneFloat low, high, top_between;
    LaneInt vertex, height;  // the first vertex from the ray on
} Met;

// Wedges between neighbouring rays: on a CPU the last lane is the last wedge's far ray alone.
typedef struct Wedges {
    LaneFloat top, reached, top_kept[2], top_far[2];  // of lines_kept and lines_far, the earlier ones first
    int lines_kept[2], lines_far[2];
    Rays left;
#if GN_LANES == 1
    Rays right;
#endif
} Wedges;
#define WEDGES_OF_GROUP (GN_LANES == 1 ? 1 : GN_LANES - 1)
#if GN_LANES == 1
#define RIGHT_RAYS(of) (of)->right
#else
#define RIGHT_RAYS(of) (of)->left
// Of each lane's neighbour.
#define NEXT_LANES(v) (v).s123456789abcdeff
#endif
#define LAST_LANE (GN_LANES - 1)

GN_INLINE LaneInt heights_on_line(const SweepQuadrant of, __global const int* heights, int a, LaneInt b) {
    b = clamp(b, (LaneInt)of.first_b, (LaneInt)of.last_b);  // beyond the border a line goes on at its last height: no
                                                            // bound gets tighter
    __global const int* line = heights + (of.origin + (long)a * of.line_stride);
    LaneInt at = b * of.vertex_stride;
    return LANES_GATHER(line, at);
}

GN_INLINE LaneFloat from_eye(const SightGrid grid, LaneInt height) {
    return LANES_SELECT(LANES_TO_FLOAT(height - grid.eye_height), (LaneFloat)LOW_HEIGHT,
                        LANE_COMPARE(height, ==, (LaneInt)NO_HEIGHT));
}

// Sets the rays' heights on line a.
GN_INLINE void read_line(const SweepQuadrant of, __global const int* heights, int a, Rays* rays) {
    rays->low = heights_on_line(of, heights, a, rays->b);
    rays->high = heights_on_line(of, heights, a, rays->b + 1);
}

GN_INLINE Rays rays_from(const SweepQuadrant of, __global const int* heights, int first) {
    Rays rays;
    rays.u = clamp(of.first_u + (LANE_INDEX + first) * of.wedge_u, (LaneInt)-of.last_u, (LaneInt)of.last_u);
    LaneInt place = (of.eye_b * (PLACES_OF_CELL / SUBCELLS)) - rays.u * of.eye_a;  // on line 0; at most 2^31
    rays.b = place >> PLACE_BITS;
    rays.part = place & (PLACES_OF_CELL - 1);
    LaneFloat u = LANES_TO_FLOAT(rays.u) * (1.0f / U_OF_1);
    rays.over_turn = 1.0f / fabs(u);
    rays.over_sum = 1.0f / (1.0f + u);
    read_line(of, heights, 0, &rays);
    return rays;
}

// Moves the rays some lines on, at most SIGHT_PATCH.
GN_INLINE void advance(int lines, Rays* rays) {
    LaneInt part = (rays->part >> FINER_BITS) + rays->u * lines;
    rays->b += part >> U_BITS;
    rays->part = ((part & (U_OF_1 - 1)) << FINER_BITS) + (rays->part & ((1 << FINER_BITS) - 1));
}

// The greatest v of points of edges, a share t of the way from height `one` to `other`, at their distances.
GN_INLINE LaneFloat top_of_edges(LaneFloat one, LaneFloat other, LaneFloat t, float before, bool is_near) {
    LaneFloat height = one + t * (other - one) + HEIGHT_SLACK * (fabs(one) + fabs(other)), distance = before + t;
    if (!is_near) return height / distance;
    LaneFloat least = distance - DISTANCE_SLACK, most = distance + DISTANCE_SLACK;
    LaneFloat above = LANES_SELECT((LaneFloat)INFINITY, height / least, LANE_COMPARE(least, >, (LaneFloat)0.0f));
    LaneFloat v = LANES_SELECT(height / most, above, LANE_COMPARE(height, >, (LaneFloat)0.0f));
    return LANES_SELECT((LaneFloat)-INFINITY, v, LANE_COMPARE(most, >, (LaneFloat)0.0f));  // not behind the eye
}

// Moves the rays to line a. They cross one edge since the line before, or three where they pass to the next vertex.
GN_INLINE Met meet_line(const SightGrid grid, const SweepQuadrant of, __global const int* heights, int a, Rays* rays) {
    const bool is_near = a <= NEAR_LINES;
    const float eye_a = (float)of.eye_a / SUBCELLS, before = (float)(a - 1) - eye_a, over = 1.0f / ((float)a - eye_a);
    LaneInt b = rays->b;
    LaneFloat from = LANES_TO_FLOAT(rays->part) * (1.0f / PLACES_OF_CELL), left = 1.0f - from;
    LaneFloat low = from_eye(grid, rays->low), high = from_eye(grid, rays->high);
    advance(1, rays);
    read_line(of, heights, a, rays);
    LaneFloat to = LANES_TO_FLOAT(rays->part) * (1.0f / PLACES_OF_CELL);
    LaneFloat new_low = from_eye(grid, rays->low), new_high = from_eye(grid, rays->high);
    LaneInt is_back = LANE_COMPARE(rays->b, <, b), is_on = LANE_COMPARE(rays->b, >, b);
    // Back: the edge of constant b. Else the diagonal from vertex b + 1 to vertex b.
    LaneFloat one = LANES_SELECT(high, low, is_back), other = LANES_SELECT(new_low, new_high, is_back);
    LaneFloat t = LANES_SELECT(left * rays->over_sum, from * rays->over_turn, is_back);
    Met met;
    if (LANES_ANY(is_on)) {
        other = LANES_SELECT(other, from_eye(grid, heights_on_line(of, heights, a, b)), is_on);
        met.top_between = top_of_edges(one, other, t, before, is_near);
        LaneFloat side = top_of_edges(high, new_low, left * rays->over_turn, before, is_near);
        LaneFloat far = from_eye(grid, heights_on_line(of, heights, a - 1, b + 2));
        LaneFloat last = top_of_edges(far, new_low, (1.0f + left) * rays->over_sum, before, is_near);
        met.top_between = LANES_SELECT(met.top_between, LANES_MAX(met.top_between, LANES_MAX(side, last)), is_on);
    } else {
        met.top_between = top_of_edges(one, other, t, before, is_near);
    }
    LaneFloat height = new_low + to * (new_high - new_low), slack = HEIGHT_SLACK * (fabs(new_low) + fabs(new_high));
    met.low = (height - slack) * over;
    met.high = (height + slack) * over;
    // A vertex on a ray is the wedge's behind it, and at u = 1 that of the last one.
    LaneInt is_at = LANE_COMPARE(rays->part, ==, (LaneInt)0) & LANE_COMPARE(rays->u, !=, (LaneInt)U_OF_1);
    met.vertex = LANES_SELECT(rays->b + 1, rays->b, is_at);
    met.height = LANES_SELECT(rays->high, rays->low, is_at);
    return met;
}

// The column and the row of the cell (a, b) of a quadrant.
static int2 place_of(const SweepQuadrant of, int a, int b) {
    int main = of.nearest + of.direction * a, side = of.vertex_of_eye + of.direction * b;
    return abs(of.line_stride) != 1 ? (int2)(side, main) : (int2)(main, side);
}

// Decides the target (a, vertex) of a wedge by the ground since a line that was kept.
static void decide_exactly(const SightGrid grid, __global const int* heights, __global const int* patch_tops,
                           __global uchar* answer, int2 place, int height, int nearest) {
    SightLine line = sight_line(grid, place.x, place.y, height);
    *answer = (uchar)(is_hidden(grid, heights, patch_tops, nearest, &line) ? SIGHT_HIDDEN : SIGHT_SEEN);
}

// A line of sight to vertex b of line a crosses one edge since line a - 1 where b grows along it: the greatest v of
// that point of the diagonal from (a - 1, b) to (a, b - 1).
GN_INLINE LaneFloat top_before(const SightGrid grid, const SweepQuadrant of, __global const int* heights, int a,
                               LaneInt b) {
    float distance = (float)a - (float)of.eye_a / SUBCELLS;
    LaneFloat u = (LANES_TO_FLOAT(b) - (float)of.eye_b / SUBCELLS) / distance;
    LaneFloat one = from_eye(grid, heights_on_line(of, heights, a - 1, b));
    LaneFloat other = from_eye(grid, heights_on_line(of, heights, a, b - 1));
    LaneFloat v =
        top_of_edges(one, other, u / (1.0f + u), (float)(a - 1) - (float)of.eye_a / SUBCELLS, a <= NEAR_LINES);
    return LANES_SELECT((LaneFloat)-INFINITY, v, LANE_COMPARE(u, >, (LaneFloat)0.0f));
}

// Decides or opens the targets of line a that are not certainly hidden: a wedge's vertex, which counts where
// `has_vertex`.
GN_INLINE void decide_targets(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                              __global const int* patch_tops, __global const int* spans, __global uchar* answers, int a,
                              LaneInt has_vertex, const Met* met, const Wedges* wedges) {
    LaneInt vertex = met->vertex;
    has_vertex &= LANE_COMPARE(vertex, >=, (LaneInt)of.first_target_b);
    has_vertex &= LANE_COMPARE(vertex, <=, (LaneInt)of.last_target_b);
    has_vertex &= LANE_COMPARE(met->height, !=, (LaneInt)NO_HEIGHT);
    LaneInt steps = LANES_SELECT((LaneInt)0, met->height, has_vertex) + (grid.target_height - grid.eye_height);
    LaneFloat height = LANES_TO_FLOAT(steps), slack = HEIGHT_SLACK * fabs(height);
    LaneFloat over = 1.0f / ((float)a - (float)of.eye_a / SUBCELLS);
    LaneFloat low = (height - slack) * over, high = (height + slack) * over;
    uint left = lane_bits(has_vertex & LANE_COMPARE(wedges->reached, <, high));
    if (left == 0u) return;
    uint near = lane_bits(LANE_COMPARE(low, >, wedges->top_far[0])) & left, seen = 0u;
    uint above_kept[2] = {0u, 0u}, above_far = 0u;
    if (near != 0u) {
        LaneFloat top = LANES_MAX(wedges->top, top_before(grid, of, heights, a, vertex));
        seen = lane_bits(LANE_COMPARE(low, >, top)) & left;
        near &= ~seen;
        for (int i = 0; i < 2; ++i) above_kept[i] = lane_bits(LANE_COMPARE(low, >, wedges->top_kept[i]));
        above_far = lane_bits(LANE_COMPARE(low, >, wedges->top_far[1]));
    }
    while (left != 0u) {
        int lane = take_lane(&left);
        int2 place = place_of(of, a, LANE_OF_INT(vertex, lane));
        int row = place.y - grid.band_first;
        if (place.x < spans[2 * row] || place.x >= spans[2 * row + 1]) continue;  // no target
        __global uchar* answer = answers + (row * (long)grid.columns + place.x);
        int kept = above_kept[1] >> lane & 1u   ? wedges->lines_kept[1]
                   : above_kept[0] >> lane & 1u ? wedges->lines_kept[0]
                   : above_far >> lane & 1u     ? wedges->lines_far[1]
                                                : wedges->lines_far[0];
        if (near >> lane & 1u)
            decide_exactly(grid, heights, patch_tops, answer, place, LANE_OF_INT(met->height, lane),
                           of.nearest + of.direction * kept);
        else
            *answer = (uchar)(seen >> lane & 1u ? SIGHT_SEEN : SIGHT_OPEN);
    }
}

GN_INLINE void keep_bounds(int a, Wedges* wedges) {
    wedges->top_kept[0] = wedges->top_kept[1];
    wedges->top_kept[1] = wedges->top;
    wedges->lines_kept[0] = wedges->lines_kept[1];
    wedges->lines_kept[1] = a;
    if (a % FAR_LINES_KEPT != 0) return;
    wedges->top_far[0] = wedges->top_far[1];
    wedges->top_far[1] = wedges->top;
    wedges->lines_far[0] = wedges->lines_far[1];
    wedges->lines_far[1] = a;
}

// Decides the targets of line a, and takes the line into the wedges.
GN_INLINE void sweep_line(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                          __global const int* patch_tops, __global const int* spans, __global uchar* answers, int a,
                          Wedges* wedges) {
    Met left = meet_line(grid, of, heights, a, &wedges->left);
#if GN_LANES == 1
    Met right = meet_line(grid, of, heights, a, &wedges->right);
#else
    Met right = {NEXT_LANES(left.low), NEXT_LANES(left.high), NEXT_LANES(left.top_between), NEXT_LANES(left.vertex),
                 NEXT_LANES(left.height)};
#endif
    LaneInt has_vertex = LANE_COMPARE(left.vertex, <, right.vertex);
    LaneFloat top = LANES_MAX(wedges->top, LANES_MAX(left.top_between, right.top_between));
    if (a >= of.first_line) decide_targets(grid, of, heights, patch_tops, spans, answers, a, has_vertex, &left, wedges);
    LaneFloat over = 1.0f / ((float)a - (float)of.eye_a / SUBCELLS);
    LaneFloat height = from_eye(grid, left.height), slack = HEIGHT_SLACK * fabs(height);
    LaneFloat low = LANES_MIN(left.low, right.low), high = LANES_MAX(left.high, right.high);
    low = LANES_SELECT(low, LANES_MIN(low, (height - slack) * over), has_vertex);
    high = LANES_SELECT(high, LANES_MAX(high, (height + slack) * over), has_vertex);
    wedges->top = LANES_MAX(top, high);
    wedges->reached = LANES_MAX(wedges->reached, low);
    if (a % LINES_KEPT == 0) keep_bounds(a, wedges);
}

// The greatest height above the eye of ground or targets in the patches under lines `first` to `last` and vertices
// low_b to high_b.
static float top_of_patches(const SightGrid grid, const SweepQuadrant of, __global const int* patch_tops, int first,
                            int last, int low_b, int high_b) {
    bool is_main_y = abs(of.line_stride) != 1;
    int a = of.nearest + of.direction * first, a_end = of.nearest + of.direction * last;
    int b = of.vertex_of_eye + of.direction * clamp(low_b, of.first_b, of.last_b);
    int b_end = of.vertex_of_eye + of.direction * clamp(high_b, of.first_b, of.last_b), top = NO_HEIGHT;
    for (int i = min(a, a_end) / SIGHT_PATCH; i <= max(a, a_end) / SIGHT_PATCH; ++i)
        for (int j = min(b, b_end) / SIGHT_PATCH; j <= max(b, b_end) / SIGHT_PATCH; ++j)
            top = max(top, patch_tops[(is_main_y ? i : j) * (long)grid.patch_columns + (is_main_y ? j : i)]);
    return top == NO_HEIGHT ? LOW_HEIGHT : (float)((long)top + grid.target_height - grid.eye_height);
}

// If the patches under lines a to `last` lie so low that nearer ground hides all of them, goes on behind them: no bound
// changes there.
GN_INLINE bool skip_lines(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                          __global const int* patch_tops, int a, int last, Wedges* wedges) {
    float eye_a = (float)of.eye_a / SUBCELLS, near = (float)(a - 1) - eye_a, far = (float)last - eye_a;
    if (near <= 0.0f) return false;
    Rays left = wedges->left, right = RIGHT_RAYS(wedges);
    int first = LANE_OF_INT(left.b, 0), end = LANE_OF_INT(right.b, LAST_LANE);
    advance(last - a + 1, &left);
    advance(last - a + 1, &right);
    float top = top_of_patches(grid, of, patch_tops, a - 1, last, min(first, LANE_OF_INT(left.b, 0)),
                               max(end, LANE_OF_INT(right.b, LAST_LANE)) + 1);
    float slack = HEIGHT_SLACK * fabs(top), v = (top + slack) / (top > 0.0f ? near : far);
    if (LANES_ANY(LANE_COMPARE(wedges->reached, <, (LaneFloat)v))) return false;
    read_line(of, heights, last, &left);
    wedges->left = left;
#if GN_LANES == 1
    read_line(of, heights, last, &right);
    wedges->right = right;
#endif
    keep_bounds(last, wedges);
    return true;
}

// Sweeps WEDGES_OF_GROUP wedges from `first` on, from the eye outwards.
GN_NOINLINE_ON_CPU void sweep_wedges(const SightGrid grid, const SweepQuadrant of, __global const int* heights,
                                     __global const int* patch_tops, __global const int* spans, __global uchar* answers,
                                     int first) {
    Wedges wedges;
    wedges.top = wedges.reached = (LaneFloat)-INFINITY;
    for (int i = 0; i < 2; ++i) {
        wedges.top_kept[i] = wedges.top_far[i] = (LaneFloat)-INFINITY;
        wedges.lines_kept[i] = wedges.lines_far[i] = 0;
    }
    wedges.left = rays_from(of, heights, first);
#if GN_LANES == 1
    wedges.right = rays_from(of, heights, first + 1);
#endif
    for (int a = 1; a <= of.lines; ++a) {
        int last = min(a + SIGHT_PATCH - 1, of.lines);
        if (a % SIGHT_PATCH == 1 && skip_lines(grid, of, heights, patch_tops, a, last, &wedges))
            a = last;
        else
            sweep_line(grid, of, heights, patch_tops, spans, answers, a, &wedges);
        if (LANE_OF_INT(wedges.left.b, 0) > of.last_b || LANE_OF_INT(RIGHT_RAYS(&wedges).b, LAST_LANE) < of.first_b)
            break;  // out of the grid
    }
}

__kernel void sight_sweep(const SightGrid grid, const SweepQuadrants quadrants, __global const int* heights,
                          __global const int* patch_tops, __global const int* spans,
                          __global uchar* answers GN_SHARES) {
    GN_FOR_EACH_OF(group, GN_SHARED_RANGE((size_t)quadrants.of[3].end_group)) {
        int i = 0, before = 0;
        while ((int)group >= quadrants.of[i].end_group) before = quadrants.of[i++].end_group;
        // The last group begins so early that it has all its wedges: some are swept twice.
        int first = min(((int)group - before) * WEDGES_OF_GROUP, quadrants.of[i].wedges - WEDGES_OF_GROUP);
        sweep_wedges(grid, quadrants.of[i], heights, patch_tops, spans, answers, first);
    }
    GN_END_SHARES;
}
