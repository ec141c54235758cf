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
#include "horizons/height_field.h"
#include "horizons/sweeps.h"
#include "simd/point_blocks.clh"

#if GN_LANES == 1
#define LOAD_LANES(values) (*(values))
#else
#define LOAD_LANES(values) vload16(0, values)
#endif
#define LOWEST (-1e30f)
#if GN_LANES == 1
#define LANES_MUL_HIGH(a, b) ((int)mul_hi((uint)(a), (uint)(b)))
#define LANES_OF_PART(part) ((float)as_uint(part) * 0x1p-32f)
#else
#define LANES_MUL_HIGH(a, b) as_int16(mul_hi((uint16)(a), as_uint16(b)))
#define LANES_OF_PART(part) (convert_float16(as_uint16(part)) * 0x1p-32f)
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

// Meets a line, and the ground between it and the one that was met last.
GN_INLINE_ON_CPU void meet_line(SweepStrips* strips, __global const float* heights, __global const LightSweep* sweep,
                                uint line, int block_row) {
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
    for (uint k = 0; k < 2u; ++k) strips->low.at[k] = LANES_SELECT(strips->low.at[k], least.at[k], higher);
}

// The ground that a vertex's own ray meets on its way over the next lines, over the plane through the ray.
typedef struct NearGround {
    LaneFloat first;          // at the end of the first triangle
    LaneFloat most;           // farther on, also on rows that go on beyond the raster
    LaneFloat least, inside;  // farther on, the least and the greatest on the raster
    LaneInt has_first;        // the end of the first triangle is on the raster
} NearGround;

// Of an edge that a ray meets, over the plane through the ray: between two heights by shares, or by one share.
static LaneFloat height_of_crossing(float share_low, LaneFloat low, float share_high, LaneFloat high, float climb) {
    return share_low * low + share_high * high - climb;
}
static LaneFloat height_of_edge(LaneFloat a, LaneFloat b, LaneFloat share, float climb, LaneFloat farther) {
    return (a + share * (b - a)) - climb * farther;
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
GN_INLINE_ON_CPU uint answer_line(const SweepStrips* strips, __global const float* heights,
                                  __global const LightSweep* sweep, uint line, int block_row) {
    __global const float* at = heights + sweep->first + (long)line * sweep->line_stride + block_row + 1;
    LaneInt row = (LaneInt)(block_row + 1) + LANE_INDEX;
    LaneFloat height = LOAD_LANES(at), margin = (LaneFloat)(sweep->margin);
    LaneInt is_vertex = LANE_COMPARE(row, >=, (LaneInt)(0)) & LANE_COMPARE(row, <, (LaneInt)((int)sweep->rows));
    if (line + 1u == sweep->lines) return lane_bits(is_vertex);  // their rays leave the raster
    NearGround ground = near_ground(at, sweep, line, row);
    float share = 1.0f - rest_at(sweep, line);
    LaneFloat high = height_across(&strips->high, share), low = height_across(&strips->low, share);
    LaneFloat ray = height - sweep->climb * (float)line;
    LaneFloat below = height - sweep->near_margin, above = height + sweep->near_margin;
    LaneInt is_above = LANE_COMPARE(ground.first, <, below);
    LaneInt lit = is_vertex & is_above & LANE_COMPARE(ground.most, <, below) & LANE_COMPARE(high, <, ray - margin);
    LaneInt into = is_above & (LANE_COMPARE(ground.inside, >, above) | LANE_COMPARE(low, >, ray + margin));
    LaneInt out_of = LANE_COMPARE(ground.first, >, above) &
                     (LANE_COMPARE(ground.least, <, below) | leave_above(sweep, line, row, height));
    LaneInt open = is_vertex & ~(lit | (ground.has_first & (into | out_of)));
    return lane_bits(lit) | lane_bits(open) << 16;
}

static SweepStrips no_strips(void) {
    LaneFloat lowest = (LaneFloat)(LOWEST);
    StripLine none = {{lowest, lowest}};
    return (SweepStrips){none, none, none};
}

GN_NOINLINE_ON_CPU void sweep_block(__global const float* heights, __global const LightSweep* sweep, uint block,
                                    __global uint* answers) {
    SweepStrips strips = no_strips();
    int first_strip = (int)(block * GN_LANES) - (int)sweep->shift;
    for (uint line = sweep->lines; line-- > 0u;) {
        uint met = line + SWEEP_NEAR;
        int met_row = first_strip + (int)base_at(sweep, met), row = first_strip + (int)base_at(sweep, line);
        if (met < sweep->lines && met_row < (int)sweep->rows && met_row + GN_LANES >= 0)
            meet_line(&strips, heights, sweep, met, met_row);
        if (row + 1 >= (int)sweep->rows) continue;
        if (row + GN_LANES < 0) break;
        answers[sweep->first_answer + line * (size_t)sweep->blocks + block] =
            answer_line(&strips, heights, sweep, line, row);
    }
}

// tasks: for each block of strips its sweep's number and its own.
__kernel void sweeps(const SweepParams params, __global const LightSweep* of_lights, __global const uint2* tasks,
                     __global const float* heights, __global uint* answers GN_SHARES) {
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(params.task_count)) {
        sweep_block(heights, &of_lights[tasks[i].x], tasks[i].y, answers);
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
static LaneInt answers_of(__global const LightSweep* sweep, LaneInt vertex, __global const int* bases,
                          __global const uint* answers, LaneInt* open) {
    LaneInt column = (vertex >> 16) & 0xFFFF, row = vertex & 0xFFFF;
    bool is_along_y = sweep->is_along_y != 0u;
    LaneInt line = is_along_y ? row : column, side = is_along_y ? column : row;
    if (sweep->is_line_turned != 0u) line = (LaneInt)((int)sweep->lines - 1) - line;
    if (sweep->is_row_turned != 0u) side = (LaneInt)((int)sweep->rows - 1) - side;
    LaneInt strip = side - 1 + (int)sweep->shift - LANES_GATHER(bases + sweep->first_base, line);
    LaneInt lane = strip & (LaneInt)(GN_LANES - 1), at = line * (int)sweep->blocks + strip / GN_LANES;
    LaneInt word = LANES_GATHER((__global const int*)(answers + sweep->first_answer), at);
    *open = (word >> (lane + 16)) & 1;
    return (word >> lane) & 1;
}

// masks: the lights that each point faces; afterwards those that are still open. lit: those that reach the point.
__kernel void sweeps_decide(const SweepParams params, __global const LightSweep* of_lights, __global const int* bases,
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
        for (uint l = 0; l < MAX_BUNDLE_LIGHTS; ++l) {
            __global const LightSweep* sweep = &of_lights[bundle * MAX_BUNDLE_LIGHTS + l];
            LaneInt bit = (LaneInt)((int)(1u << l));
            if (sweep->crossing_count == 0u) {
                still |= mask & bit;
                continue;
            }
            LaneInt open, is_lit = answers_of(sweep, vertex, bases, answers, &open);
            reached |= is_lit << (int)l;
            still |= mask & usable & (open << (int)l);
        }
        store_lanes(LANES_AS_FLOAT(still), (__global float*)(masks + first), params.points, number);
        store_lanes(LANES_AS_FLOAT(mask & usable & reached), (__global float*)(lit + first), params.points, number);
    }
}

// ---- Single rays ----------------------------------------------------------------------------------------------------

// The ray of a vertex to a light, with its place on the sweep's lines.
typedef struct RasterRay {
    __global const LightSweep* sweep;
    __global const float* at;  // the vertex's height
    int line, row;
    float height;
} RasterRay;

// The highest that the ground is over the plane through the ray: where the ray meets edges, also those that reach
// beyond the last row; and where it surely is on the raster.
typedef struct GroundMet {
    LaneFloat most, inside;
} GroundMet;

// Meets the edges of one kind from number k on, one in each lane.
static void meet_edges(GroundMet* met, const RasterRay* ray, uint kind, int k) {
    __global const LightSweep* sweep = ray->sweep;
    LaneInt number = (LaneInt)(k) + LANE_INDEX, lines, low, high;
    LaneFloat share, farther;
    if (kind == SWEEP_LINES) {
        lines = number;
        low = LANES_MUL_HIGH(sweep->slope, number);
        high = low + 1;
        share = LANES_OF_PART((LaneInt)((int)sweep->slope) * number);
        farther = LANES_TO_FLOAT(lines);
    } else {
        __global const SweepEdges* edges = &sweep->edges[kind];
        lines = number * (int)edges->lines + LANES_MUL_HIGH(edges->part, number);
        share = LANES_OF_PART((LaneInt)((int)edges->part) * number);
        farther = LANES_TO_FLOAT(lines) + share;
        low = high = number;
        if (kind == SWEEP_DIAGONALS) {
            low = sweep->is_rising != 0u ? lines - number : number - lines;
            high = sweep->is_rising != 0u ? low + 1 : low - 1;
        }
    }
    int ahead = kind == SWEEP_LINES ? 0 : 1, next = ahead * sweep->line_stride;
    LaneInt least = min(low, high), last = (LaneInt)((int)sweep->rows - 1 - ray->row);
    LaneInt is_met = LANE_COMPARE(number, >=, (LaneInt)(1)) & LANE_COMPARE(least, <=, last) &
                     LANE_COMPARE(lines, <, (LaneInt)((int)sweep->lines - ray->line - ahead));
    LaneInt from = (lines * sweep->line_stride + low) & is_met,
            to = (lines * sweep->line_stride + high + next) & is_met;
    LaneFloat a = LANES_AS_FLOAT(LANES_GATHER((__global const int*)ray->at, from));
    LaneFloat b = LANES_AS_FLOAT(LANES_GATHER((__global const int*)ray->at, to));
    LaneFloat height = height_of_edge(a, b, share, sweep->climb, farther);
    LaneFloat most = LANES_MAX(height, met->most), inside = LANES_MAX(height, met->inside);
    met->most = LANES_SELECT(met->most, most, is_met);
    met->inside = LANES_SELECT(met->inside, inside, is_met & LANE_COMPARE(least, <, last - 1));
}

// A part of a ray, over one line of tiles.
typedef struct RayPart {
    int tile, next_line;
    float from, to;  // distances in lines
} RayPart;

// The part from a line on. Tiles are those of the copy's lines.
static RayPart part_from(const RasterRay* ray, int line) {
    __global const LightSweep* sweep = ray->sweep;
    bool is_turned = sweep->line_stride < 0;
    int of_copy = is_turned ? (int)sweep->lines - 2 - line : line, tile = of_copy / RASTER_TILE;
    int next = is_turned ? (int)sweep->lines - 1 - tile * RASTER_TILE : (tile + 1) * RASTER_TILE;
    return (RayPart){tile, next, (float)(line - ray->line), (float)(next - ray->line)};
}

// The greatest height of the tiles that a part is over.
static float top_over(const RasterRay* ray, __global const float* tops, const RayPart* part) {
    __global const LightSweep* sweep = ray->sweep;
    __global const float* of_line = tops + sweep->first_top + part->tile * (int)sweep->tops_of_line;
    int last_tile = (int)sweep->tops_of_line - 1;
    int first = ((int)(ray->row + sweep->share * part->from) - 1) / RASTER_TILE;
    int last = ((int)(ray->row + sweep->share * part->to) + 1) / RASTER_TILE;
    float top = 0.0f;
    for (int tile = max(first, 0); tile <= min(last, last_tile); ++tile) top = fmax(top, of_line[tile]);
    return top;
}

// Whether a ray that is above the end of its first triangle certainly reaches the light (1) or is certainly blocked
// (-1).
static int walk_above(const RasterRay* ray, __global const float* tops) {
    __global const LightSweep* sweep = ray->sweep;
    float above = ray->height + sweep->margin, below = ray->height - sweep->margin;
    LaneFloat lowest = (LaneFloat)(LOWEST);
    GroundMet met = {lowest, lowest};
    for (int line = ray->line; line + 1 < (int)sweep->lines;) {
        RayPart part = part_from(ray, line);
        line = part.next_line;
        float least = ray->height + sweep->climb * part.from - sweep->margin;
        if (least > sweep->highest || ray->row + sweep->share * part.from > (float)sweep->rows) break;
        if (top_over(ray, tops, &part) < least) continue;
        for (uint kind = 0; kind < 3u; ++kind) {
            float rate = sweep->edges[kind].rate;
            if (rate == 0.0f) continue;
            int last = (int)(part.to * rate) + 1;
            for (int k = max((int)(part.from * rate) - 1, 1); k <= last; k += GN_LANES) meet_edges(&met, ray, kind, k);
        }
        if (LANES_ANY(LANE_COMPARE(met.inside, >, (LaneFloat)(above)))) return -1;
    }
    return LANES_ANY(LANE_COMPARE(met.most, >=, (LaneFloat)(below))) ? 0 : 1;
}

// Whether a ray that is below the end of its first triangle is certainly blocked (-1): it comes to be above the ground.
static int walk_below(const RasterRay* ray, __global const float* tops) {
    __global const LightSweep* sweep = ray->sweep;
    for (int line = ray->line; line + 1 < (int)sweep->lines;) {
        RayPart part = part_from(ray, line);
        line = part.next_line;
        if (ray->row + sweep->share * part.to > (float)((int)sweep->rows - 3)) return 0;
        if (top_over(ray, tops, &part) < ray->height + sweep->climb * part.from - sweep->margin) return -1;
    }
    return 0;
}

// 0: it stays open.
static int walk_ray(const RasterRay* ray, __global const float* tops) {
    __global const LightSweep* sweep = ray->sweep;
    __global const SweepCrossing* first = &sweep->crossings[0];
    if (ray->line + first->lines >= sweep->lines || ray->row < 1 || ray->row + first->rows > (int)sweep->rows - 2)
        return 0;
    float ground = first->share_low * ray->at[first->low] + first->share_high * ray->at[first->high] - first->climb;
    if (ground < ray->height - sweep->near_margin) return walk_above(ray, tops);
    return ground > ray->height + sweep->near_margin ? walk_below(ray, tops) : 0;
}

static RasterRay ray_of(__global const LightSweep* sweep, __global const float* heights, uint vertex) {
    int column = (int)(vertex >> 16), row = (int)(vertex & 0xFFFFu);
    RasterRay ray = {sweep, 0, sweep->is_along_y != 0u ? row : column, sweep->is_along_y != 0u ? column : row, 0.0f};
    if (sweep->is_line_turned != 0u) ray.line = (int)sweep->lines - 1 - ray.line;
    if (sweep->is_row_turned != 0u) ray.row = (int)sweep->rows - 1 - ray.row;
    ray.at = heights + sweep->first + (long)ray.line * sweep->line_stride + ray.row;
    ray.height = *ray.at;
    return ray;
}

// Decides what the sweeps left open, ray by ray.
__kernel void sweeps_walk(const SweepParams params, __global const LightSweep* of_lights, __global const uint* vertices,
                          __global const float* heights, __global const float* tops, __global uint* masks,
                          __global uint* lit GN_SHARES) {
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(params.points.count * (size_t)params.bundle_count)) {
        uint point = (uint)(i % params.points.count), bundle = (uint)(i / params.points.count);
        size_t at = bundle * (size_t)params.mask_stride + point;
        uint vertex = vertices[params.points.first / 3u + point], open = masks[at];
        if (vertex == NO_VERTEX || open == 0u) continue;
        uint decided = 0u, reached = 0u;
        for (uint left = open; left != 0u;) {
            uint l = take_lowest_bit(&left);
            __global const LightSweep* sweep = &of_lights[bundle * MAX_BUNDLE_LIGHTS + l];
            if (sweep->crossing_count == 0u) continue;
            RasterRay ray = ray_of(sweep, heights, vertex);
            int answer = walk_ray(&ray, tops);
            if (answer != 0) decided |= 1u << l;
            if (answer > 0) reached |= 1u << l;
        }
        masks[at] = open & ~decided;
        lit[at] |= reached;
    }
    GN_END_SHARES;
}
