// SPDX-License-Identifier: MIT
// Decides the vertices of a raster by sweeps (sweeps.h). All bounds are on the safe side; a light between them stays
// open.
//
// Bounds. Across a strip a line is straight but for one vertex. A straight line that is raised at both ends by as much
// as the vertex is above it is nowhere below the ground; lowered likewise, nowhere above it. Between two lines a ray
// meets at most one row and two diagonals. Where the ground bends down there by b (the difference of its slopes along
// the ray), it is above the straight line between both lines by at most b / 4, and bends add up. The highest of
// straight lines is, between two places, nowhere above the straight line between the highest at each place: so `high`
// keeps the highest of both ends, and `low` one of the lines that were met.
//
// Lit and dark are as in horizons.cl: a ray above all ground ahead meets none; one that is above the ground at the end
// of its first triangle and below it farther on meets a triangle in between, and so does one that is first below.
// Ground beyond the raster blocks nothing; it may only keep a light open.
//
// Holes. The ground of bounds has none (raster_fill): what is above it is above the raster, too. But a ray may go
// through a hole from above to below. So a light is dark only where there is no hole near the way from the vertex to
// the ground that blocks the ray: `low` begins anew behind each tile near a hole.
#include "horizons/height_field.h"
#include "horizons/sweep_rays.clh"

#if GN_LANES == 1
#define LOAD_LANES(values) (*(values))
#else
#define LOAD_LANES(values) vload16(0, values)
#endif

// Over the plane through the light's rays: at both sides of a strip.
typedef struct StripLine {
    LaneFloat at[2];
} StripLine;

typedef struct SweepStrips {
    StripLine high, low, last;  // last: the bound of the line that was met last
} SweepStrips;

static LaneFloat positive(LaneFloat x) {
    LaneFloat zero = (LaneFloat)(0.0f);
    return LANES_MAX(x, zero);
}

// The most by which the ground between two lines may be above the straight lines between them: h and n hold four rows
// of vertices of each.
static LaneFloat bend_between(const LaneFloat* h, const LaneFloat* n, float share, bool is_rising) {
    LaneFloat diagonals[3], bends[2];
    float of_diagonals = 0.25f * (is_rising ? 1.0f - share : -1.0f - share), of_rows = 0.25f * share;
    for (uint k = 0; k < 3u; ++k) diagonals[k] = positive(of_diagonals * ((h[k] - n[k]) + (n[k + 1u] - h[k + 1u])));
    for (uint k = 0; k < 2u; ++k) {
        LaneFloat row =
            is_rising ? (h[k + 1u] - h[k]) - (n[k + 2u] - n[k + 1u]) : (n[k + 1u] - n[k]) - (h[k + 2u] - h[k + 1u]);
        bends[k] = diagonals[k] + diagonals[k + 1u] + positive(of_rows * row);
    }
    return LANES_MAX(bends[0], bends[1]);
}

// A line of heights across a strip, over the plane, raised and lowered to both sides of its ground.
static void bounds_of_line(const LaneFloat* h, float rest, LaneFloat plane, StripLine* most, StripLine* least) {
    float share = 1.0f - rest;
    LaneFloat ends[2] = {h[0] + rest * (h[1] - h[0]), h[1] + rest * (h[2] - h[1])};
    LaneFloat over = h[1] - (ends[0] + share * (ends[1] - ends[0])), zero = (LaneFloat)(0.0f);
    LaneFloat up = positive(over), down = LANES_MIN(over, zero);
    for (uint k = 0; k < 2u; ++k) most->at[k] = (ends[k] + up) - plane, least->at[k] = (ends[k] + down) - plane;
}
static LaneFloat height_across(const StripLine* line, float share) {
    return line->at[0] + share * (line->at[1] - line->at[0]);
}

// The lanes that have, on a line, a vertex in a tile near a hole.
static LaneInt are_near_holes(__global const LightSweep* sweep, __global const float* tops, uint line, LaneInt row) {
    if (sweep->has_holes == 0u) return (LaneInt)(0);
    uint of_copy = sweep->line_stride < 0 ? sweep->lines - 1u - line : line;
    __global const float* of_line = tops + sweep->first_top + of_copy / RASTER_TILE * sweep->tops_of_line;
    LaneInt tile = clamp(row, (LaneInt)(0), (LaneInt)((int)sweep->rows - 1)) / RASTER_TILE;
    return LANE_COMPARE(LANES_GATHER((__global const int*)of_line, tile), <, (LaneInt)(0));
}

// Meets a line, and the ground between it and the one that was met last.
GN_INLINE_ON_CPU void meet_line(SweepStrips* strips, __global const float* heights, __global const float* tops,
                                __global const LightSweep* sweep, uint line, int block_row) {
    LaneFloat plane = (LaneFloat)(sweep->climb * (float)line);
    __global const float* at = heights + sweep->first + (long)line * sweep->line_stride + block_row;
    LaneFloat h[4], n[4];
    bool is_first = line + 1u == sweep->lines;
    for (uint k = 0; k < 4u; ++k) {
        h[k] = LOAD_LANES(at + k);
        n[k] = is_first ? h[k] : LOAD_LANES(at + sweep->line_stride + k);
    }
    LaneFloat bend = bend_between(h, n, sweep->share, sweep->is_rising != 0u);
    StripLine most, least;
    bounds_of_line(h, rest_at(sweep, line), plane, &most, &least);
    for (uint k = 0; k < 2u; ++k) {
        LaneFloat met = LANES_MAX(most.at[k], strips->last.at[k]) + bend;
        strips->high.at[k] = LANES_MAX(met, strips->high.at[k]);
    }
    strips->last = most;
    LaneInt row = (LaneInt)(block_row) + LANE_INDEX, last_row = (LaneInt)((int)sweep->rows - 4);
    LaneInt higher = LANE_COMPARE(least.at[0] + least.at[1], >, strips->low.at[0] + strips->low.at[1]) &
                     LANE_COMPARE(row, >=, (LaneInt)(1)) & LANE_COMPARE(row, <=, last_row);
    LaneInt near_hole = are_near_holes(sweep, tops, line, row);
    LaneFloat lowest = (LaneFloat)(LOWEST);
    for (uint k = 0; k < 2u; ++k) {
        LaneFloat low = LANES_SELECT(strips->low.at[k], least.at[k], higher);
        strips->low.at[k] = LANES_SELECT(low, lowest, near_hole);
    }
}

// The ground that a vertex's own ray meets on its way over the next lines, over the plane through the ray.
typedef struct NearGround {
    LaneFloat first;          // at the end of the first triangle
    LaneFloat most;           // farther on, also on rows that go on beyond the raster
    LaneFloat least, inside;  // farther on, the least and the greatest on the raster
    LaneInt has_first;        // the end of the first triangle is on the raster
} NearGround;

// Of an edge that a ray meets, over the plane through the ray.
static LaneFloat height_of_crossing(float share_low, LaneFloat low, float share_high, LaneFloat high, float climb) {
    return share_low * low + share_high * high - climb;
}

// The same for all lanes where no crossing is near the raster's borders, as nearly everywhere.
static bool is_far_from_borders(__global const LightSweep* sweep, uint line, int row) {
    return line + SWEEP_NEAR + 1u < sweep->lines && row >= 1 && row + GN_LANES + SWEEP_NEAR + 2 <= (int)sweep->rows;
}
static NearGround near_ground_far_from_borders(__global const float* at, __global const LightSweep* sweep) {
    LaneFloat lowest = (LaneFloat)(LOWEST);
    NearGround ground = {lowest, lowest, -lowest, lowest, (LaneInt)(-1)};
    for (uint k = 0; k < sweep->crossing_count; ++k) {
        // One load of low, high and both shares.
        int4 edge = *(__global const int4*)&sweep->crossings[k];
        LaneFloat height = height_of_crossing(as_float(edge.z), LOAD_LANES(at + edge.x), as_float(edge.w),
                                              LOAD_LANES(at + edge.y), sweep->crossings[k].climb);
        if (k == 0u) {
            ground.first = height;
            continue;
        }
        ground.most = LANES_MAX(height, ground.most);
        ground.least = LANES_MIN(height, ground.least);
    }
    ground.inside = ground.most;
    return ground;
}

static NearGround near_ground(__global const float* at, __global const LightSweep* sweep, uint line, LaneInt row) {
    LaneFloat lowest = (LaneFloat)(LOWEST);
    NearGround ground = {lowest, lowest, -lowest, lowest, (LaneInt)(0)};
    LaneInt last = (LaneInt)((int)sweep->rows - 2), is_inner = LANE_COMPARE(row, >=, (LaneInt)(1));
    for (uint k = 0; k < sweep->crossing_count; ++k) {
        __global const SweepCrossing* crossing = &sweep->crossings[k];
        if (line + crossing->lines >= sweep->lines) continue;
        LaneFloat height = height_of_crossing(crossing->share_low, LOAD_LANES(at + crossing->low), crossing->share_high,
                                              LOAD_LANES(at + crossing->high), crossing->climb);
        LaneInt inside = is_inner & LANE_COMPARE(row + crossing->rows, <=, last);
        if (k == 0u) {
            ground.first = height;
            ground.has_first = inside;
            continue;
        }
        ground.most = LANES_MAX(height, ground.most);
        LaneFloat least = LANES_MIN(height, ground.least), most = LANES_MAX(height, ground.inside);
        ground.least = LANES_SELECT(ground.least, least, inside);
        ground.inside = LANES_SELECT(ground.inside, most, inside);
    }
    return ground;
}

// The lanes whose rays rise above the highest height before they leave the raster.
static LaneInt leave_above(__global const LightSweep* sweep, uint line, LaneInt row, LaneFloat height) {
    LaneFloat lines = ((LaneFloat)(sweep->highest + sweep->margin) - height) / sweep->climb + 1.0f;
    lines *= 1.0001f;
    LaneFloat ahead = (LaneFloat)((float)(sweep->lines - 1u - line));
    LaneFloat beside = LANES_TO_FLOAT((LaneInt)((int)sweep->rows - 3) - row);
    return LANE_COMPARE(lines, <, ahead) & LANE_COMPARE(lines * sweep->share, <, beside);
}

// Answers for the vertices that the strips have on a line.
GN_INLINE_ON_CPU uint answer_line(const SweepStrips* strips, __global const float* heights, __global const float* tops,
                                  __global const LightSweep* sweep, uint line, int block_row) {
    __global const float* at = heights + sweep->first + (long)line * sweep->line_stride + block_row + 1;
    LaneInt row = (LaneInt)(block_row + 1) + LANE_INDEX;
    LaneFloat height = LOAD_LANES(at), margin = (LaneFloat)(sweep->margin);
    LaneInt is_vertex = LANE_COMPARE(row, >=, (LaneInt)(0)) & LANE_COMPARE(row, <, (LaneInt)((int)sweep->rows));
    if (line + 1u == sweep->lines) return lane_bits(is_vertex);  // their rays leave the raster
    NearGround ground = is_far_from_borders(sweep, line, block_row + 1) ? near_ground_far_from_borders(at, sweep)
                                                                        : near_ground(at, sweep, line, row);
    float share = 1.0f - rest_at(sweep, line);
    LaneFloat high = height_across(&strips->high, share), low = height_across(&strips->low, share);
    LaneFloat ray = height - sweep->climb * (float)line;
    LaneFloat below = height - sweep->near_margin, above = height + sweep->near_margin;
    LaneInt is_above = LANE_COMPARE(ground.first, <, below);
    LaneInt lit = is_vertex & is_above & LANE_COMPARE(ground.most, <, below) & LANE_COMPARE(high, <, ray - margin);
    LaneInt into = is_above & (LANE_COMPARE(ground.inside, >, above) | LANE_COMPARE(low, >, ray + margin));
    LaneInt leaves = sweep->has_holes != 0u ? (LaneInt)(0) : leave_above(sweep, line, row, height);
    LaneInt out_of = LANE_COMPARE(ground.first, >, above) & (LANE_COMPARE(ground.least, <, below) | leaves);
    LaneInt is_whole = ground.has_first & ~are_near_holes(sweep, tops, line, row);
    LaneInt open = is_vertex & ~(lit | (is_whole & (into | out_of)));
    return lane_bits(lit) | lane_bits(open) << 16;
}

static SweepStrips no_strips(void) {
    LaneFloat lowest = (LaneFloat)(LOWEST);
    StripLine none = {{lowest, lowest}};
    return (SweepStrips){none, none, none};
}

// Meets the line that is now SWEEP_NEAR lines ahead, and returns the answers for a line, or 0 beside the raster.
GN_INLINE_ON_CPU uint sweep_line(SweepStrips* strips, __global const float* heights, __global const float* tops,
                                 __global const LightSweep* sweep, uint line, int first_strip) {
    uint met = line + SWEEP_NEAR;
    int met_row = first_strip + (int)base_at(sweep, met), row = first_strip + (int)base_at(sweep, line);
    if (met < sweep->lines && met_row < (int)sweep->rows && met_row + GN_LANES >= 0)
        meet_line(strips, heights, tops, sweep, met, met_row);
    bool has_vertices = row + 1 < (int)sweep->rows && row + GN_LANES >= 0;
    return has_vertices ? answer_line(strips, heights, tops, sweep, line, row) : 0u;
}

GN_NOINLINE_ON_CPU void sweep_block(__global const float* heights, __global const float* tops,
                                    __global const LightSweep* sweep, uint block, __global uint* answers) {
    SweepStrips strips = no_strips();
    int first_strip = (int)(block * GN_LANES) - (int)sweep->shift;
    for (uint end = sweep->lines, first; end != 0u; end = first) {
        uint word = 0u;
        first = (end - 1u) / SWEEP_LINES_OF_WORD * SWEEP_LINES_OF_WORD;
        for (uint line = end; line-- > first;)
            word |= sweep_line(&strips, heights, tops, sweep, line, first_strip) << (line - first);
        answers[sweep->first_answer + first / SWEEP_LINES_OF_WORD * (size_t)sweep->blocks + block] = word;
        if (first_strip + (int)base_at(sweep, first) + GN_LANES < 0) break;
    }
}

// numbers: of the lights that have a sweep.
__kernel void sweeps(const SweepParams params, __global const LightSweep* of_lights, __global const uint* numbers,
                     __global const float* heights, __global const float* tops, __global uint* answers GN_SHARES) {
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(params.sweep_count * (size_t)params.most_blocks)) {
        __global const LightSweep* sweep = &of_lights[numbers[i / params.most_blocks]];
        uint block = (uint)(i % params.most_blocks);
        if (block < sweep->blocks) sweep_block(heights, tops, sweep, block, answers);
    }
    GN_END_SHARES;
}

// ---- Points ---------------------------------------------------------------------------------------------------------

// The vertex of each sorted point, or NO_VERTEX if it is at none, or lies on a receiver that does
// not have it as a corner.
__kernel void sweep_vertices(const RasterParams raster, const PointsLayout points, __global const float* vertices,
                             __global const float* x, __global const float* y, __global const float* heights,
                             __global const float* positions, __global const uint* receivers, __global uint* found,
                             __global uint* count) {
    uint at_vertices = 0u;
    GN_FOR_EACH(i, points.count) {
        float3 given = load_point(positions, points, i);
        float3 p = over_ground(raster.axis, given);
        float column = (p.x - raster.corner[0]) * raster.per_length[0];
        float row = (p.y - raster.corner[1]) * raster.per_length[1];
        bool is_over = column > -0.5f && row > -0.5f && column < (float)raster.columns - 0.5f &&
                       row < (float)raster.rows - 0.5f;  // false for NaN
        uint vertex = NO_VERTEX;
        if (is_over) {
            uint a = min((uint)convert_int_rte(column), raster.columns - 1u);
            uint b = min((uint)convert_int_rte(row), raster.rows - 1u);
            bool is_there = x[a] == p.x && y[b] == p.y && heights[a * (size_t)raster.rows + b] == p.z;
            if (is_there) vertex = a << 16 | b;
        }
        if (vertex != NO_VERTEX && points.has_receivers != 0u) {
            uint receiver = receivers[i];
            if (receiver != GN_NO_ID && receiver < raster.triangles.count) {
                Triangle t = load_triangle(vertices + raster.triangles.first_float, receiver);
                bool has_corner = all(t.a == given) || all(t.b == given) || all(t.c == given);
                if (!has_corner) vertex = NO_VERTEX;
            }
        }
        found[i] = vertex;
        if (vertex != NO_VERTEX) ++at_vertices;
    }
    if (at_vertices != 0u) atomic_add(count, at_vertices);
}

// The answers of a light for a block of points at vertices.
static LaneInt answers_of(__global const LightSweep* sweep, LaneInt vertex, __global const uint* answers,
                          LaneInt* open) {
    LaneInt column = (vertex >> 16) & 0xFFFF, row = vertex & 0xFFFF;
    bool is_along_y = sweep->is_along_y != 0u;
    LaneInt line = is_along_y ? row : column, side = is_along_y ? column : row;
    if (sweep->is_line_turned != 0u) line = (LaneInt)((int)sweep->lines - 1) - line;
    if (sweep->is_row_turned != 0u) side = (LaneInt)((int)sweep->rows - 1) - side;
    LaneInt strip = side - 1 + (int)sweep->shift - LANES_MUL_HIGH(sweep->slope, line);
    LaneInt pair = (line & (LaneInt)(SWEEP_LINES_OF_WORD - 1)) | (strip & (LaneInt)(GN_LANES - 1));
    LaneInt at = line / (LaneInt)(SWEEP_LINES_OF_WORD) * (int)sweep->blocks + strip / GN_LANES;
    LaneInt word = LANES_GATHER((__global const int*)(answers + sweep->first_answer), at);
    *open = (word >> (pair + 16)) & 1;
    return (word >> pair) & 1;
}

// masks: the lights that each point faces; afterwards those that are still open. lit: those that reach the point.
__kernel void sweeps_decide(const SweepParams params, __global const LightSweep* of_lights,
                            __global const uint* vertices, __global const uint* answers, __global uint* masks,
                            __global uint* lit) {
    uint blocks = block_count(params.points);
    GN_FOR_EACH(task, blocks * (size_t)params.bundle_count) {
        size_t number = task % blocks, bundle = task / blocks, first = bundle * params.mask_stride;
        LaneInt mask = LANES_AS_INT(load_lanes((__global const float*)(masks + first), params.points, number));
        LaneInt vertex = load_lane_ids(vertices + params.points.first / 3u, params.points, number);
        LaneInt usable = LANE_COMPARE(vertex, !=, (LaneInt)((int)NO_VERTEX)) & valid_lanes(params.points, number);
        vertex &= usable;
        LaneInt reached = (LaneInt)(0), still = mask & ~usable;
        for (uint left = LANES_ANY_BIT(mask & valid_lanes(params.points, number)); left != 0u;) {
            uint l = take_lowest_bit(&left);
            __global const LightSweep* sweep = &of_lights[bundle * MAX_BUNDLE_LIGHTS + l];
            LaneInt bit = (LaneInt)((int)(1u << l));
            if (sweep->crossing_count == 0u) {
                still |= mask & bit;
                continue;
            }
            LaneInt open, is_lit = answers_of(sweep, vertex, answers, &open);
            reached |= is_lit << (int)l;
            still |= mask & usable & (open << (int)l);
        }
        store_lanes(LANES_AS_FLOAT(still), (__global float*)(masks + first), params.points, number);
        store_lanes(LANES_AS_FLOAT(mask & usable & reached), (__global float*)(lit + first), params.points, number);
    }
}

// ---- Single rays ----------------------------------------------------------------------------------------------------

// Decides what the sweeps left open, ray by ray. A GPU's work-group first lists those of its tasks that have open
// lights, since few have (`listed`: WALK_WORDS for each item, and 2).
__kernel void sweeps_walk(const SweepParams params, __global const LightSweep* of_lights, __global const uint* vertices,
                          __global const float* heights, __global const float* tops, __global uint* masks,
                          __global uint* lit, __local uint* listed GN_SHARES) {
    vertices += params.points.first / 3u;
    OpenPairs pairs = {of_lights, vertices, heights, tops, masks, lit, params.points.count, params.mask_stride};
    size_t count = params.points.count * (size_t)params.bundle_count;
#ifdef GN_CPU
    GN_FOR_EACH_OF(task, GN_SHARED_RANGE(count)) { walk_mask(&pairs, task); }
    GN_END_SHARES;
#else
    uint items = (uint)get_local_size(0), window = WALK_ROUNDS * items;
    __local uint* counts = listed + window;
    GroupTasks group = {listed, counts, counts + 2, counts + 2 + items, 0};
    GN_FOR_EACH_BY_GROUP(size_t, i, (count + window - 1u) / window) {
        group.start = i * window;
        barrier(CLK_LOCAL_MEM_FENCE);  // all items have read the last tasks' number
        if (get_local_id(0) == 0) counts[0] = 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        GN_FOR_EACH_IN_GROUP(k, min(count - group.start, (size_t)window)) {
            if (masks[mask_of_task(&pairs, group.start + k)] != 0u) listed[atomic_inc(&counts[0])] = k;
        }
        barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
        walk_tasks(&pairs, &group);
    }
#endif
}
