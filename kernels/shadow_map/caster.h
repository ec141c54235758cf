// SPDX-License-Identifier: MIT
// Drawing one caster into one view's texels: what the depth pass and the pages of virtual maps share (contract:
// depth_pass.h).
#ifndef GN_CASTER_H
#define GN_CASTER_H

#include "../lanes.h"
#include "../points.h"
#include "depth_pass.h"

// e(P) = slope_u (P_u - at_u) + slope_v (P_v - at_v) + offset; the offset is for edges in the plane w = 0 alone.
typedef struct Edge {
    float slope_u, slope_v, at_u, at_v, offset;
} Edge;

typedef struct Caster {
    Edge edges[3];  // edge i lies opposite vertex i
    float depth[3];
    float2 n_slope, s_slope;            // along u and v, of N = sum of e_i d_i and S = sum of e_i: depth is N / S
    uint low_x, low_y, high_x, high_y;  // texels, inclusive
} Caster;

// Is a the vertex that an edge is measured from? A total order of the values, the same from both sides of the edge.
static bool comes_first(float4 a, float4 b) {
    if (fabs(a.z) != fabs(b.z)) return fabs(a.z) > fabs(b.z);
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    return a.z < b.z;
}

static Edge make_edge(float4 a, float4 b) {
    float sign = 1.0f;
    if (!comes_first(a, b)) {
        float4 swap = a;
        a = b;
        b = swap;
        sign = -1.0f;
    }
    Edge e;
    if (a.z == 0.0f) {  // and b.z too
        e.slope_u = e.slope_v = e.at_u = e.at_v = 0.0f;
        e.offset = sign * (a.x * b.y - a.y * b.x);
        return e;
    }
    e.offset = 0.0f;
    e.at_u = a.x / a.z;
    e.at_v = a.y / a.z;
    e.slope_u = -sign * a.z * (b.y - e.at_v * b.z);
    e.slope_v = sign * a.z * (b.x - e.at_u * b.z);
    return e;
}

static uint texel_below(float texels, uint size) { return (uint)clamp(texels, 0.0f, (float)(size - 1)); }

// False if the triangle casts nothing into the view.
static bool make_caster(__global const MapView* view, __global const float* tables, Triangle t, Caster* caster) {
    if (!is_finite_triangle(t)) return false;
    float4 h[3] = {map_homogeneous(view, t.a), map_homogeneous(view, t.b), map_homogeneous(view, t.c)};
    float nearest = fmin(h[0].w, fmin(h[1].w, h[2].w)), farthest = fmax(h[0].w, fmax(h[1].w, h[2].w));
    if (nearest >= 1.0f || farthest <= view->front_depth) return false;
    caster->low_x = caster->low_y = 0;
    caster->high_x = view->width - 1;
    caster->high_y = view->height - 1;
    bool in_front = h[0].z > 0.0f && h[1].z > 0.0f && h[2].z > 0.0f;
    bool behind = h[0].z < 0.0f && h[1].z < 0.0f && h[2].z < 0.0f;
    if (in_front || behind) {
        // The projection is a triangle too, within the bounds of its vertices; else it goes through infinity.
        float2 a = h[0].xy / h[0].z, b = h[1].xy / h[1].z, c = h[2].xy / h[2].z;
        float2 low = fmin(a, fmin(b, c)), high = fmax(a, fmax(b, c));
        if (low.x > 1.0f || low.y > 1.0f || high.x < 0.0f || high.y < 0.0f) return false;
        // One texel more on each side than the warp says: rounding of the warp and of its inverse.
        float2 from = map_texels(view, tables, low) - 1.5f, to = map_texels(view, tables, high) + 0.5f;
        caster->low_x = texel_below(from.x, view->width);
        caster->low_y = texel_below(from.y, view->height);
        caster->high_x = texel_below(to.x, view->width);
        caster->high_y = texel_below(to.y, view->height);
    }
    caster->n_slope = caster->s_slope = (float2)(0.0f);
    for (int i = 0; i < 3; ++i) {
        caster->edges[i] = make_edge(h[(i + 1) % 3], h[(i + 2) % 3]);
        caster->depth[i] = h[i].w;
        float2 slope = (float2)(caster->edges[i].slope_u, caster->edges[i].slope_v);
        caster->n_slope += slope * h[i].w;
        caster->s_slope += slope;
    }
    return true;
}

// Length of texels in u or v: taken once for a rectangle that is drawn, at most a small triangle's or a tile's, at the
// first texel of its tile.
static float texel_length(__global const float* centres, uint i, uint size) {
    uint first = i >> TILE_LOG2 << TILE_LOG2, next = min(first + 1, size - 1);
    return next > first ? centres[next] - centres[first] : 1.0f;
}

// GN_LANES centres from column x on. Those past the view are read from what follows, and ignored.
static LaneFloat load_centres(__global const float* centres, uint x, uint readable) {
#if GN_LANES == 1
    return centres[x];
#else
    if (x + GN_LANES <= readable) return vload16(0, centres + x);
    float copied[GN_LANES];
    for (uint i = 0; i < GN_LANES; ++i) copied[i] = centres[min(x + i, readable - 1)];
    return vload16(0, copied);
#endif
}

#if GN_LANES == 1
#define KEYS_OF(depth) as_int(depth)
#define DEPTHS_OF(keys) as_float(keys)
#define LOAD_KEYS(keys, at) ((int)(keys)[at])
#define STORE_KEYS(value, to) (*(to) = (value))
#define STORE_FLOATS(value, to) (*(to) = (value))
#else
#define KEYS_OF(depth) as_int16(depth)
#define DEPTHS_OF(keys) as_float16(keys)
#define LOAD_KEYS(keys, at) as_int16(vload16(0, (keys) + (at)))
#define STORE_KEYS(value, to) vstore16(value, 0, to)
#define STORE_FLOATS(value, to) vstore16(value, 0, to)
#endif

// Keys that others lower meanwhile: what is read may be larger than it is by the time of the atomic operation, never
// smaller (GN_LOOK).
static LaneInt look_at_keys(__global const uint* keys, size_t at) {
#ifdef GN_ATOMIC_LOOKS
    LaneInt seen;
    for (int i = 0; i < GN_LANES; ++i) LANE_OF_INT(seen, i) = (int)GN_LOOK((volatile __global uint*)keys + at + i);
    return seen;
#else
    return LOAD_KEYS(keys, at);
#endif
}

// Lanes whose texel the pass changes. Keys are the bits of floats from 0 to 1, so they order as signed integers.
static LaneInt lanes_to_write(uint pass, LaneInt keys, __global const uint* nearest, __global const uint* output,
                              size_t at) {
    LaneInt first = look_at_keys(nearest, at);
    if (pass == PASS_NEAREST) return LANE_COMPARE(keys, <, first);
    if (pass == PASS_SECOND) return LANE_COMPARE(keys, >, first) & LANE_COMPARE(keys, <, look_at_keys(output, at));
    return LANE_COMPARE(keys, ==, first) & LANE_COMPARE(keys, !=, (LaneInt)(EMPTY_KEY));
}

static void draw_rectangle(const DepthPass* pass, __global const MapView* view, __global const float* tables,
                           const Caster* caster, uint low_x, uint low_y, uint high_x, uint high_y,
                           __global uint* nearest, __global uint* output) {
    __global const float* columns = tables + view->centres_first;
    __global const float* rows = columns + view->width;
    const Edge* edges = caster->edges;
    bool with_slope = pass->slope_bias != 0.0f || pass->pass == PASS_SLOPE;
    float texel_u = texel_length(columns, low_x, view->width), texel_v = texel_length(rows, low_y, view->height);
    for (uint y = low_y; y <= high_y; ++y) {
        float base[3];
        for (int i = 0; i < 3; ++i) base[i] = edges[i].slope_v * (rows[y] - edges[i].at_v) + edges[i].offset;
        for (uint x = low_x; x <= high_x; x += GN_LANES) {
            LaneFloat u = load_centres(columns, x, view->width + view->height);
            LaneFloat e0 = edges[0].slope_u * (u - edges[0].at_u) + base[0];
            LaneFloat e1 = edges[1].slope_u * (u - edges[1].at_u) + base[1];
            LaneFloat e2 = edges[2].slope_u * (u - edges[2].at_u) + base[2];
            LaneInt inside = (LANE_COMPARE(e0, >=, 0.0f) & LANE_COMPARE(e1, >=, 0.0f) & LANE_COMPARE(e2, >=, 0.0f)) |
                             (LANE_COMPARE(e0, <=, 0.0f) & LANE_COMPARE(e1, <=, 0.0f) & LANE_COMPARE(e2, <=, 0.0f));
            inside &= LANE_COMPARE((LaneInt)(LANE_INDEX + (int)x), <=, (LaneInt)((int)high_x));
            if (!LANES_ANY(inside)) continue;
            LaneFloat reciprocal = 1.0f / (e0 + e1 + e2);
            LaneFloat depth = (e0 * caster->depth[0] + e1 * caster->depth[1] + e2 * caster->depth[2]) * reciprocal;
            // Where all edges are 0 depth is not a number, and the comparison false.
            inside &= LANE_COMPARE(depth, >, view->front_depth);
            // Modulo 2^32, which holds all texels of a map: a page of a virtual map lies at an offset that may wrap.
            uint at = view->first_texel + y * view->row_stride + x;
            LaneFloat squared_slope = (LaneFloat)(0.0f);
            if (with_slope) {
                // What lies behind the map already stays there when bias is added.
                if (pass->pass == PASS_NEAREST) inside &= LANE_COMPARE(depth, <, DEPTHS_OF(look_at_keys(nearest, at)));
                if (!LANES_ANY(inside)) continue;
                LaneFloat slope_x = fabs((caster->n_slope.x - depth * caster->s_slope.x) * reciprocal) * texel_u;
                LaneFloat slope_y = fabs((caster->n_slope.y - depth * caster->s_slope.y) * reciprocal) * texel_v;
                slope_x = LANES_MIN(slope_x, (LaneFloat)(1.0f));
                slope_y = LANES_MIN(slope_y, (LaneFloat)(1.0f));
                squared_slope = slope_x * slope_x + slope_y * slope_y;
                LaneFloat steepest = LANES_SELECT(slope_y, slope_x, LANE_COMPARE(slope_x, >, slope_y));
                depth += LANES_MIN(pass->slope_bias * steepest, (LaneFloat)(pass->slope_limit));
            }
            depth = LANES_SELECT(depth, (LaneFloat)(0.0f), LANE_COMPARE(depth, <, 0.0f));
            depth = LANES_MIN(depth, (LaneFloat)(1.0f));
            LaneInt keys = KEYS_OF(depth);
            inside &= lanes_to_write(pass->pass, keys, nearest, output, at);
            if (!LANES_ANY(inside)) continue;
            int key[GN_LANES], is_written[GN_LANES];
            float squared[GN_LANES];
            STORE_KEYS(keys, key);
            STORE_KEYS(inside, is_written);
            STORE_FLOATS(squared_slope, squared);
            for (uint i = 0; i < GN_LANES; ++i) {
                if (!is_written[i]) continue;
                if (pass->pass == PASS_SLOPE)
                    atomic_max(&output[at + i], as_uint(squared[i]));
                else
                    atomic_min(&output[at + i], (uint)key[i]);
            }
        }
    }
}

// Does some edge keep triangles of either sign out of the rectangle of centres? Its bounds there are sums of those
// along u and v; rounding keeps their order, so no centre that draw_rectangle finds inside is lost.
static bool misses_rectangle(const Caster* caster, float2 low, float2 high) {
    bool positive = true, negative = true;  // could the rectangle hold a point with all e >= 0? all e <= 0?
    for (int i = 0; i < 3; ++i) {
        const Edge* e = &caster->edges[i];
        float u0 = e->slope_u * (low.x - e->at_u), u1 = e->slope_u * (high.x - e->at_u);
        float v0 = e->slope_v * (low.y - e->at_v) + e->offset, v1 = e->slope_v * (high.y - e->at_v) + e->offset;
        if (fmax(u0, u1) + fmax(v0, v1) < 0.0f) positive = false;
        if (fmin(u0, u1) + fmin(v0, v1) > 0.0f) negative = false;
    }
    return !positive && !negative;
}

static uint texels_of(const Caster* c) { return (c->high_x - c->low_x + 1) * (c->high_y - c->low_y + 1); }

static uint tiles_across(uint low, uint high) { return (high >> TILE_LOG2) - (low >> TILE_LOG2) + 1; }

// The part of the caster that lies in a tile.
static void draw_tile(const DepthPass* pass, __global const MapView* view, __global const float* tables,
                      const Caster* caster, uint tile_x, uint tile_y, __global uint* nearest, __global uint* output) {
    __global const float* columns = tables + view->centres_first;
    __global const float* rows = columns + view->width;
    uint low_x = max(tile_x << TILE_LOG2, caster->low_x), low_y = max(tile_y << TILE_LOG2, caster->low_y);
    uint high_x = min(((tile_x + 1) << TILE_LOG2) - 1, caster->high_x);
    uint high_y = min(((tile_y + 1) << TILE_LOG2) - 1, caster->high_y);
    if (misses_rectangle(caster, (float2)(columns[low_x], rows[low_y]), (float2)(columns[high_x], rows[high_y])))
        return;
    draw_rectangle(pass, view, tables, caster, low_x, low_y, high_x, high_y, nearest, output);
}

#endif
