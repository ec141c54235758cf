// SPDX-License-Identifier: MIT
// Decides most cells around an eye by bounds of the ground over wedges of rays (sight_sweep.h): what it leaves hidden
// and what it writes is certain, but for the cells that it opens.
#include "sight/sight_sweep.h"

#include "sight/sight_crossings.clh"
#include "sight/sight_lines.clh"
#include "simd/lanes.clh"

// A crossing's distance is rounded by less than DISTANCE_SLACK, which counts near the eye.
#define DISTANCE_SLACK 0x1p-20f
#define NEAR_LINES 2
// A height for none: below all others, and so are all heights interpolated with it.
#define LOW_HEIGHT -0x1p31f
// Every so many lines the bounds are kept, the latest two of each: a target near the edge of what is seen is compared
// with the bounds of some lines earlier, and with the ground since, by floats first, then exactly.
#define KEPT_LEVELS 5
#define BOUNDS_KEPT (2 * KEPT_LEVELS)
#define FIRST_LINES_KEPT 4
#define MORE_LINES_KEPT 4  // of each further level

// Once a patch's lines were passed over, those of so many patches are passed over at once where all lie low enough.
#define PATCHES_AHEAD 4

#define PLACES_OF_CELL (1 << PLACE_BITS)
#define U_OF_1 (1 << U_BITS)
#define FINER_BITS (PLACE_BITS - U_BITS)

// Vertices of a line: the one at `b` is vertices[b * vertex_stride - first].
typedef struct Strip {
    __global const int* vertices;
    int first;
} Strip;

// Rays side by side: `u`, and their places on the last line, vertex b and a part of a cell. What follows from u; the
// ground's heights at vertices b and b + 1 there.
typedef struct Rays {
    LaneInt u, b, part;
    LaneFloat over_turn, over_sum;  // 1 / |u|, 1 / (1 + u)
    LaneInt low, high;
    Strip strip;  // of the line
} Rays;

// Bounds of v where rays meet a line, and of all edges since the line before.
typedef struct Met {
    LaneFloat low, high, top_between;
    LaneFloat at_vertex;     // high where a ray meets a vertex, else -INFINITY
    LaneInt vertex, height;  // the first vertex from the ray on
} Met;

// Wedges between neighbouring rays: on a CPU the last lane is the last wedge's far ray alone.
typedef struct Wedges {
    LaneFloat top, reached;
    LaneFloat top_before;             // as top, without the edges of the last line
    LaneFloat top_kept[BOUNDS_KEPT];  // of lines_kept; those of a level side by side, the later one first
    int lines_kept[BOUNDS_KEPT];
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

// The vertices of line a: where lines have strips, those around rays at `b`, which the rays do not leave in two lines.
GN_INLINE Strip strip_of(const SweepQuadrant of, __global const int* lines, int a, LaneInt b) {
    Strip strip = {lines + (of.origin + (long)a * of.line_stride), 0};
    if (!of.has_strips) return strip;
    // Places grow or fall from lane to lane, but on line 0, where all rays are within one cell.
    int low = min(of.first_b * of.vertex_stride, of.last_b * of.vertex_stride);
    int nearest = min(LANE_OF_INT(b, 0) * of.vertex_stride, LANE_OF_INT(b, LAST_LANE) * of.vertex_stride);
    strip.first = clamp(nearest - 4, low, low + of.last_b - of.first_b + 1 - STRIP_LENGTH);
    strip.vertices += strip.first;
    return strip;
}

GN_INLINE LaneInt heights_on_line(const SweepQuadrant of, const Strip* strip, LaneInt b) {
    b = clamp(b, (LaneInt)of.first_b, (LaneInt)of.last_b);  // beyond the border a line goes on at its last height: no
                                                            // bound gets tighter
    LaneInt at = b * of.vertex_stride - strip->first;
    return of.has_strips ? LANES_OF_STRIP(strip->vertices, at) : LANES_GATHER(strip->vertices, at);
}

GN_INLINE LaneFloat from_eye(const SightGrid grid, LaneInt height) {
    return LANES_SELECT(LANES_TO_FLOAT(height - grid.eye_height), (LaneFloat)LOW_HEIGHT,
                        LANE_COMPARE(height, ==, (LaneInt)NO_HEIGHT));
}

// Sets the rays' heights on a line.
GN_INLINE void read_line(const SweepQuadrant of, Strip strip, Rays* rays) {
    rays->strip = strip;
    rays->low = heights_on_line(of, &strip, rays->b);
    rays->high = heights_on_line(of, &strip, rays->b + 1);
}

GN_INLINE Rays rays_from(const SweepQuadrant of, __global const int* lines, int first) {
    Rays rays;
    rays.u = clamp(of.first_u + (LANE_INDEX + first) * of.wedge_u, (LaneInt)-of.last_u, (LaneInt)of.last_u);
    LaneInt place = (of.eye_b * (PLACES_OF_CELL / SUBCELLS)) - rays.u * of.eye_a;  // on line 0; at most 2^31
    rays.b = place >> PLACE_BITS;
    rays.part = place & (PLACES_OF_CELL - 1);
    LaneFloat u = LANES_TO_FLOAT(rays.u) * (1.0f / U_OF_1);
    rays.over_turn = 1.0f / fabs(u);
    rays.over_sum = 1.0f / (1.0f + u);
    read_line(of, strip_of(of, lines, 0, rays.b), &rays);
    return rays;
}

// Moves the rays some lines on, at most PATCHES_AHEAD * SIGHT_PATCH.
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
GN_INLINE Met meet_line(const SightGrid grid, const SweepQuadrant of, __global const int* lines, int a, Rays* rays) {
    const bool is_near = a <= NEAR_LINES;
    const float eye_a = (float)of.eye_a / SUBCELLS, before = (float)(a - 1) - eye_a, over = 1.0f / ((float)a - eye_a);
    LaneInt b = rays->b;
    LaneFloat from = LANES_TO_FLOAT(rays->part) * (1.0f / PLACES_OF_CELL), left = 1.0f - from;
    LaneFloat low = from_eye(grid, rays->low), high = from_eye(grid, rays->high);
    const Strip before_strip = rays->strip;
    advance(1, rays);
    read_line(of, strip_of(of, lines, a, b), rays);
    LaneFloat to = LANES_TO_FLOAT(rays->part) * (1.0f / PLACES_OF_CELL);
    LaneFloat new_low = from_eye(grid, rays->low), new_high = from_eye(grid, rays->high);
    LaneInt is_back = LANE_COMPARE(rays->b, <, b), is_on = LANE_COMPARE(rays->b, >, b);
    // Back: the edge of constant b. Else the diagonal from vertex b + 1 to vertex b.
    LaneFloat one = LANES_SELECT(high, low, is_back), other = LANES_SELECT(new_low, new_high, is_back);
    LaneFloat t = LANES_SELECT(left * rays->over_sum, from * rays->over_turn, is_back);
    Met met;
    if (LANES_ANY(is_on)) {
        other = LANES_SELECT(other, from_eye(grid, heights_on_line(of, &rays->strip, b)), is_on);
        met.top_between = top_of_edges(one, other, t, before, is_near);
        LaneFloat side = top_of_edges(high, new_low, left * rays->over_turn, before, is_near);
        LaneFloat far = from_eye(grid, heights_on_line(of, &before_strip, b + 2));
        LaneFloat last = top_of_edges(far, new_low, (1.0f + left) * rays->over_sum, before, is_near);
        met.top_between = LANES_SELECT(met.top_between, LANES_MAX(met.top_between, LANES_MAX(side, last)), is_on);
    } else {
        met.top_between = top_of_edges(one, other, t, before, is_near);
    }
    LaneFloat height = new_low + to * (new_high - new_low), slack = HEIGHT_SLACK * (fabs(new_low) + fabs(new_high));
    met.low = (height - slack) * over;
    met.high = (height + slack) * over;
    LaneInt is_at = LANE_COMPARE(rays->part, ==, (LaneInt)0);
    met.at_vertex = LANES_SELECT((LaneFloat)-INFINITY, met.high, is_at);
    // A vertex on a ray is the wedge's behind it, and at u = 1 that of the last one.
    is_at &= LANE_COMPARE(rays->u, !=, (LaneInt)U_OF_1);
    met.vertex = LANES_SELECT(rays->b + 1, rays->b, is_at);
    met.height = LANES_SELECT(rays->high, rays->low, is_at);
    return met;
}

// The column and the row of the cell (a, b) of a quadrant.
static int2 place_of(const SweepQuadrant of, int a, int b) {
    int main = of.nearest + of.direction * a, side = of.vertex_of_eye + of.direction * b;
    return of.is_along_y ? (int2)(side, main) : (int2)(main, side);
}

static bool is_in_span(const SightGrid grid, __global const int* spans, int2 place) {
    __global const int* span = spans + 2 * (place.y - grid.band_first);
    return place.x >= span[0] && place.x < span[1];
}

// Decides a target of a wedge by the ground of lines `nearest`, which was kept, to `farthest`.
static void decide_exactly(const SightGrid grid, const SightHeights lines, __global const int* patch_tops,
                           __global uchar* answer, int2 place, int height, int nearest, int farthest) {
    SightLine line = sight_line(grid, place.x, place.y, height);
    *answer = (uchar)(is_hidden(grid, lines, patch_tops, nearest, farthest, &line) ? SIGHT_HIDDEN : SIGHT_SEEN);
}

// Bounds of v on the last of the lines of sight to vertices `b` of line a: where they cross line a - 1, and the
// diagonal from (a - 1, b) to (a, b - 1) if b grows along them.
typedef struct LastMet {
    LaneFloat low, high;
} LastMet;
GN_INLINE LastMet last_met(const SightGrid grid, const SweepQuadrant of, __global const int* lines, int a, LaneInt b) {
    const Strip before = strip_of(of, lines, a - 1, b), strip = strip_of(of, lines, a, b);
    float distance = (float)a - (float)of.eye_a / SUBCELLS,
          before_distance = (float)(a - 1) - (float)of.eye_a / SUBCELLS;
    float over = 1.0f / before_distance;
    LaneFloat u = (LANES_TO_FLOAT(b) - (float)of.eye_b / SUBCELLS) * (1.0f / distance);
    LaneInt grows = LANE_COMPARE(u, >, (LaneFloat)0.0f);
    LaneFloat at_b = from_eye(grid, heights_on_line(of, &before, b));
    LaneFloat beside = from_eye(grid, heights_on_line(of, &before, b - LANES_SELECT((LaneInt)-1, (LaneInt)1, grows)));
    LaneFloat diagonal = from_eye(grid, heights_on_line(of, &strip, b - 1));
    LaneFloat height = at_b + fabs(u) * (beside - at_b), slack = HEIGHT_SLACK * (fabs(at_b) + fabs(beside));
    LastMet met = {(height - slack) * over, (height + slack) * over};
    LaneFloat v = top_of_edges(at_b, diagonal, u / (1.0f + u), before_distance, false);
    met.high = LANES_SELECT(met.high, LANES_MAX(met.high, v), grows);
    return met;
}

// Decides or opens the targets of line a that are not certainly hidden: a wedge's vertex, which counts where
// `has_vertex`.
GN_INLINE void decide_targets(const SightGrid grid, const SweepQuadrant of, __global const int* lines,
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
    uint near = lane_bits(LANE_COMPARE(low, >, wedges->top_kept[BOUNDS_KEPT - 1])) & left, seen = 0u;
    uint above[BOUNDS_KEPT];
    if (near != 0u) {
        if (a > NEAR_LINES) {
            LastMet last = last_met(grid, of, lines, a, vertex);
            seen = lane_bits(LANE_COMPARE(low, >, LANES_MAX(wedges->top_before, last.high))) & left;
            left &= ~lane_bits(LANE_COMPARE(last.low, >, high));
        }
        near &= left & ~seen;
        for (int i = 0; near != 0u && i < BOUNDS_KEPT; ++i)
            above[i] = lane_bits(LANE_COMPARE(low, >, wedges->top_kept[i]));
    }
    const long line_stride = abs(of.line_stride), vertex_stride = abs(of.vertex_stride);
    const SightHeights all = {lines, of.is_along_y ? vertex_stride : line_stride,
                              of.is_along_y ? line_stride : vertex_stride};
    const int2 first = place_of(of, a, 0);
    const long answer_stride = of.direction * (of.is_along_y ? 1 : (long)grid.columns);
    __global uchar* of_line = answers + answer_of(grid, first.y * (long)grid.columns + first.x);
    uint unknown = left & ~seen;
    for (left &= seen; left != 0u;) {
        int lane = take_lane(&left), b = LANE_OF_INT(vertex, lane);
        if (grid.has_spans && !is_in_span(grid, spans, place_of(of, a, b))) continue;
        of_line[b * answer_stride] = (uchar)SIGHT_SEEN;
    }
    while (unknown != 0u) {
        int lane = take_lane(&unknown), b = LANE_OF_INT(vertex, lane);
        if (grid.has_spans && !is_in_span(grid, spans, place_of(of, a, b))) continue;
        __global uchar* answer = of_line + b * answer_stride;
        *answer = (uchar)SIGHT_OPEN;
        if (!(near >> lane & 1u)) continue;
        int kept = 0, clear_from = a;
        while (!(above[kept] >> lane & 1u)) ++kept;
        const int nearest = wedges->lines_kept[kept], height = LANE_OF_INT(met->height, lane);
#if GN_LANES != 1
        if (nearest > 0) {
            const float above_eye = (float)((long)height + grid.target_height - grid.eye_height);
            uint found = decide_by_floats(&grid, &of, lines, a, b, above_eye, nearest, &clear_from);
            *answer = (uchar)found;
            if (found != SIGHT_OPEN) continue;
        }
#endif
        decide_exactly(grid, all, patch_tops, answer, place_of(of, a, b), height, of.nearest + of.direction * nearest,
                       of.nearest + of.direction * clear_from);
    }
}

GN_INLINE void keep_bounds(int a, Wedges* wedges) {
    int lines = FIRST_LINES_KEPT;
    for (int i = 0; i < BOUNDS_KEPT && a % lines == 0; i += 2, lines *= MORE_LINES_KEPT) {
        wedges->top_kept[i + 1] = wedges->top_kept[i];
        wedges->top_kept[i] = wedges->top;
        wedges->lines_kept[i + 1] = wedges->lines_kept[i];
        wedges->lines_kept[i] = a;
    }
}

// Decides the targets of line a, and takes the line into the wedges.
GN_INLINE void sweep_line(const SightGrid grid, const SweepQuadrant of, __global const int* lines,
                          __global const int* patch_tops, __global const int* spans, __global uchar* answers, int a,
                          Wedges* wedges) {
    Met left = meet_line(grid, of, lines, a, &wedges->left);
#if GN_LANES == 1
    Met right = meet_line(grid, of, lines, a, &wedges->right);
#else
    Met right = {NEXT_LANES(left.low),       NEXT_LANES(left.high),   NEXT_LANES(left.top_between),
                 NEXT_LANES(left.at_vertex), NEXT_LANES(left.vertex), NEXT_LANES(left.height)};
#endif
    LaneInt has_vertex = LANE_COMPARE(left.vertex, <, right.vertex);
    LaneFloat top = LANES_MAX(wedges->top, LANES_MAX(left.top_between, right.top_between));
    if (a >= of.first_line) decide_targets(grid, of, lines, patch_tops, spans, answers, a, has_vertex, &left, wedges);
    LaneFloat over = 1.0f / ((float)a - (float)of.eye_a / SUBCELLS);
    LaneFloat height = from_eye(grid, left.height), slack = HEIGHT_SLACK * fabs(height);
    LaneFloat low = LANES_MIN(left.low, right.low), high = LANES_MAX(left.high, right.high);
    low = LANES_SELECT(low, LANES_MIN(low, (height - slack) * over), has_vertex);
    // An edge since the line before is highest at one of the wedge's rays or where it ends, at a vertex in the wedge.
    LaneFloat ends = LANES_SELECT(top, LANES_MAX(top, (height + slack) * over), has_vertex);
    wedges->top_before = LANES_MAX(ends, LANES_MAX(left.at_vertex, right.at_vertex));
    wedges->top = LANES_MAX(ends, high);
    wedges->reached = LANES_MAX(wedges->reached, low);
    keep_bounds(a, wedges);
}

// The greatest height above the eye of ground or targets in the patches under lines `first` to `last` and vertices
// low_b to high_b.
static float top_of_patches(const SightGrid grid, const SweepQuadrant of, __global const int* patch_tops, int first,
                            int last, int low_b, int high_b) {
    int a = of.nearest + of.direction * first, a_end = of.nearest + of.direction * last;
    int b = of.vertex_of_eye + of.direction * clamp(low_b, of.first_b, of.last_b);
    int b_end = of.vertex_of_eye + of.direction * clamp(high_b, of.first_b, of.last_b), top = NO_HEIGHT;
    int a_stride = of.is_along_y ? grid.patch_columns : 1, b_stride = of.is_along_y ? 1 : grid.patch_columns;
    uint first_i = (uint)min(a, a_end) / SIGHT_PATCH, last_i = (uint)max(a, a_end) / SIGHT_PATCH;
    uint first_j = (uint)min(b, b_end) / SIGHT_PATCH, last_j = (uint)max(b, b_end) / SIGHT_PATCH;
    for (uint i = first_i; i <= last_i; ++i)
        for (uint j = first_j; j <= last_j; ++j) top = max(top, patch_tops[i * a_stride + j * b_stride]);
    return top == NO_HEIGHT ? LOW_HEIGHT : (float)((long)top + grid.target_height - grid.eye_height);
}

// The vertex of a ray some lines on.
static int vertex_after(const Rays* rays, int lane, int lines) {
    int part = (LANE_OF_INT(rays->part, lane) >> FINER_BITS) + LANE_OF_INT(rays->u, lane) * lines;
    return LANE_OF_INT(rays->b, lane) + (part >> U_BITS);
}

// If the patches under lines a to `last` lie so low that nearer ground hides all of them, goes on behind them: no bound
// changes there.
GN_INLINE bool skip_lines(const SightGrid grid, const SweepQuadrant of, __global const int* lines,
                          __global const int* patch_tops, int a, int last, Wedges* wedges) {
    float eye_a = (float)of.eye_a / SUBCELLS, near = (float)(a - 1) - eye_a, far = (float)last - eye_a;
    if (near <= 0.0f) return false;
    Rays *left = &wedges->left, *right = &RIGHT_RAYS(wedges);
    const int skipped = last - a + 1;
    float top =
        top_of_patches(grid, of, patch_tops, a - 1, last, min(LANE_OF_INT(left->b, 0), vertex_after(left, 0, skipped)),
                       max(LANE_OF_INT(right->b, LAST_LANE), vertex_after(right, LAST_LANE, skipped)) + 1);
    float slack = HEIGHT_SLACK * fabs(top), v = (top + slack) / (top > 0.0f ? near : far);
    if (LANES_ANY(LANE_COMPARE(wedges->reached, <, (LaneFloat)v))) return false;
    advance(skipped, left);
    read_line(of, strip_of(of, lines, last, left->b), left);
#if GN_LANES == 1
    advance(skipped, right);
    read_line(of, strip_of(of, lines, last, right->b), right);
#endif
    wedges->top_before = wedges->top;
    keep_bounds(last, wedges);
    return true;
}

// Sweeps WEDGES_OF_GROUP wedges from `first` on, from the eye outwards.
GN_NOINLINE_ON_CPU void sweep_wedges(const SightGrid grid, const SweepQuadrant of, __global const int* lines,
                                     __global const int* patch_tops, __global const int* spans, __global uchar* answers,
                                     int first) {
    Wedges wedges;
    wedges.top = wedges.top_before = wedges.reached = (LaneFloat)-INFINITY;
    for (int i = 0; i < BOUNDS_KEPT; ++i) {
        wedges.top_kept[i] = (LaneFloat)-INFINITY;
        wedges.lines_kept[i] = 0;
    }
    wedges.left = rays_from(of, lines, first);
#if GN_LANES == 1
    wedges.right = rays_from(of, lines, first + 1);
#endif
    int patches = 1;
    for (int a = 1; a <= of.lines; ++a) {
        bool skips = false;
        if (a % SIGHT_PATCH == 1) {
            int last = min(a + patches * SIGHT_PATCH - 1, of.lines), near_last = min(a + SIGHT_PATCH - 1, of.lines);
            skips = skip_lines(grid, of, lines, patch_tops, a, last, &wedges);
            if (!skips && patches > 1) {
                last = near_last;
                skips = skip_lines(grid, of, lines, patch_tops, a, last, &wedges);
            }
            patches = skips ? PATCHES_AHEAD : 1;
            if (skips) a = last;
        }
        if (!skips) sweep_line(grid, of, lines, patch_tops, spans, answers, a, &wedges);
        if (LANE_OF_INT(wedges.left.b, 0) > of.last_b || LANE_OF_INT(RIGHT_RAYS(&wedges).b, LAST_LANE) < of.first_b)
            break;  // out of the grid
    }
}

__kernel void sight_sweep(const SightGrid grid, const SweepQuadrants quadrants, __global const int* heights,
                          __global const int* by_columns, __global const int* patch_tops, __global const int* spans,
                          __global uchar* answers GN_SHARES) {
    GN_FOR_EACH_OF(group, GN_SHARED_RANGE((size_t)quadrants.of[3].end_group)) {
        int i = 0, before = 0;
        while ((int)group >= quadrants.of[i].end_group) before = quadrants.of[i++].end_group;
        // The last group begins so early that it has all its wedges: some are swept twice.
        int first = min(((int)group - before) * WEDGES_OF_GROUP, quadrants.of[i].wedges - WEDGES_OF_GROUP);
        sweep_wedges(grid, quadrants.of[i], quadrants.of[i].is_along_y ? heights : by_columns, patch_tops, spans,
                     answers, first);
    }
    GN_END_SHARES;
}
