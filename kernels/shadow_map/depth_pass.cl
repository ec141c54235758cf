// SPDX-License-Identifier: MIT
// Depth pass: rasterizes the casters into all views of a shadow map (contract: depth_pass.h).
//
// A work-item draws a small triangle at once. A larger one is listed in chunks of CHUNK_TILES tiles, so that no
// work-item has much more to do than another; a tile that an edge excludes costs three evaluations.
#include "../points.h"
#include "depth_pass.h"

// e(P) = slope_u (P_u - at_u) + slope_v (P_v - at_v) + offset; the offset is for edges in the plane w = 0 alone.
typedef struct Edge {
    float slope_u, slope_v, at_u, at_v, offset;
} Edge;

typedef struct Caster {
    Edge edges[3];  // edge i lies opposite vertex i
    float depth[3];
    uint low_x, low_y, high_x, high_y;  // texels, inclusive
} Caster;

static float edge_at(const Edge* e, float2 p) {
    return e->slope_u * (p.x - e->at_u) + e->slope_v * (p.y - e->at_v) + e->offset;
}

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
    for (int i = 0; i < 3; ++i) {
        caster->edges[i] = make_edge(h[(i + 1) % 3], h[(i + 2) % 3]);
        caster->depth[i] = h[i].w;
    }
    return true;
}

// Depth per texel along x and y at P: of the quotient N / S, N the sum of e_i d_i, S of e_i.
static float2 depth_slope(const Caster* caster, float n, float s, float2 texel) {
    float n_u = 0.0f, n_v = 0.0f, s_u = 0.0f, s_v = 0.0f;
    for (int i = 0; i < 3; ++i) {
        n_u += caster->edges[i].slope_u * caster->depth[i];
        n_v += caster->edges[i].slope_v * caster->depth[i];
        s_u += caster->edges[i].slope_u;
        s_v += caster->edges[i].slope_v;
    }
    float depth = n / s;
    return clamp((float2)(n_u - depth * s_u, n_v - depth * s_v) / s * texel, -1.0f, 1.0f);
}

// Length of a texel in u or v: the distance of the centres beside it.
static float texel_length(__global const float* centres, uint i, uint size) {
    uint low = i > 0 ? i - 1 : 0, high = min(i + 1, size - 1);
    return high > low ? (centres[high] - centres[low]) / (float)(high - low) : 1.0f;
}

static void draw_texel(const DepthPass* pass, __global const MapView* view, __global const float* columns,
                       __global const float* rows, const Caster* caster, uint x, uint y, float2 p,
                       __global uint* nearest, __global uint* output) {
    float e0 = edge_at(&caster->edges[0], p), e1 = edge_at(&caster->edges[1], p), e2 = edge_at(&caster->edges[2], p);
    bool inside = (e0 >= 0.0f && e1 >= 0.0f && e2 >= 0.0f) || (e0 <= 0.0f && e1 <= 0.0f && e2 <= 0.0f);
    float s = e0 + e1 + e2;
    if (!inside || s == 0.0f) return;
    float n = e0 * caster->depth[0] + e1 * caster->depth[1] + e2 * caster->depth[2];
    float depth = n / s;
    if (!(depth > view->front_depth)) return;
    float2 slope = (float2)(0.0f);
    if (pass->slope_bias != 0.0f || pass->pass == PASS_SLOPE) {
        float2 texel = (float2)(texel_length(columns, x, view->width), texel_length(rows, y, view->height));
        slope = depth_slope(caster, n, s, texel);
    }
    float steepest = fmax(fabs(slope.x), fabs(slope.y));
    depth += fmin(pass->slope_bias * steepest, pass->slope_limit);
    uint key = as_uint(clamp(depth, 0.0f, 1.0f));
    size_t at = view->first_texel + (size_t)y * view->row_stride + x;
    if (pass->pass == PASS_NEAREST) {
        if (key < nearest[at]) atomic_min(&nearest[at], key);
    } else if (pass->pass == PASS_SECOND) {
        if (key > nearest[at] && key < output[at]) atomic_min(&output[at], key);
    } else if (key == nearest[at] && key != EMPTY_KEY) {
        atomic_max(&output[at], as_uint(slope.x * slope.x + slope.y * slope.y));
    }
}

static void draw_rectangle(const DepthPass* pass, __global const MapView* view, __global const float* tables,
                           const Caster* caster, uint low_x, uint low_y, uint high_x, uint high_y,
                           __global uint* nearest, __global uint* output) {
    __global const float* columns = tables + view->centres_first;
    __global const float* rows = columns + view->width;
    for (uint y = low_y; y <= high_y; ++y)
        for (uint x = low_x; x <= high_x; ++x)
            draw_texel(pass, view, columns, rows, caster, x, y, (float2)(columns[x], rows[y]), nearest, output);
}

// Does some edge keep both signs' triangles out of the rectangle of centres? Linear functions: corners decide.
static bool misses_rectangle(const Caster* caster, float2 low, float2 high) {
    bool positive = true, negative = true;  // could the rectangle hold a point with all e >= 0? all e <= 0?
    for (int i = 0; i < 3; ++i) {
        const Edge* e = &caster->edges[i];
        float a = edge_at(e, low), b = edge_at(e, high), c = edge_at(e, (float2)(low.x, high.y)),
              d = edge_at(e, (float2)(high.x, low.y));
        if (a < 0.0f && b < 0.0f && c < 0.0f && d < 0.0f) positive = false;
        if (a > 0.0f && b > 0.0f && c > 0.0f && d > 0.0f) negative = false;
    }
    return !positive && !negative;
}

static uint texels_of(const Caster* c) { return (c->high_x - c->low_x + 1) * (c->high_y - c->low_y + 1); }

static uint tiles_across(uint low, uint high) { return (high >> TILE_LOG2) - (low >> TILE_LOG2) + 1; }

__kernel void depth_pass_clear(MapSet set, uint word, __global uint* keys) {
    GN_FOR_EACH(i, set.texels) keys[i] = word;
}

__kernel void depth_pass_small(DepthPass pass, MapSet set, uint view_index, ulong first_float,
                               __global const float* vertices, __global const MapView* views,
                               __global const float* tables, __global uint* nearest, __global uint* output,
                               __global uint* chunk_count, __global uint2* chunks) {
    __global const MapView* view = views + view_index;
    if (view->width == 0) return;
    GN_FOR_EACH(i, pass.triangle_count) {
        Caster caster;
        if (!make_caster(view, tables, load_triangle(vertices + first_float, i), &caster)) continue;
        if (texels_of(&caster) <= SMALL_TEXELS) {
            draw_rectangle(&pass, view, tables, &caster, caster.low_x, caster.low_y, caster.high_x, caster.high_y,
                           nearest, output);
            continue;
        }
        uint tiles = tiles_across(caster.low_x, caster.high_x) * tiles_across(caster.low_y, caster.high_y);
        uint count = (tiles + CHUNK_TILES - 1) / CHUNK_TILES;
        uint first = atomic_add(chunk_count, count);
        for (uint c = 0; c < count && first + c < pass.chunk_capacity; ++c) chunks[first + c] = (uint2)((uint)i, c);
    }
}

// Chunks on neighbouring work-items of a CPU would be those of one triangle: groups take them in turn.
__kernel void depth_pass_large(DepthPass pass, MapSet set, uint view_index, ulong first_float,
                               __global const float* vertices, __global const MapView* views,
                               __global const float* tables, __global uint* nearest, __global uint* output,
                               __global const uint* chunk_count, __global const uint2* chunks) {
    __global const MapView* view = views + view_index;
    if (view->width == 0) return;
    __global const float* columns = tables + view->centres_first;
    __global const float* rows = columns + view->width;
    uint count = min(*chunk_count, pass.chunk_capacity);
    for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
        uint2 chunk = chunks[i];
        Caster caster;
        make_caster(view, tables, load_triangle(vertices + first_float, chunk.x), &caster);
        uint across = tiles_across(caster.low_x, caster.high_x), down = tiles_across(caster.low_y, caster.high_y);
        uint last = min((chunk.y + 1) * CHUNK_TILES, across * down);
        for (uint t = chunk.y * CHUNK_TILES + (uint)get_local_id(0); t < last; t += (uint)get_local_size(0)) {
            uint tile_x = (caster.low_x >> TILE_LOG2) + t % across, tile_y = (caster.low_y >> TILE_LOG2) + t / across;
            uint low_x = max(tile_x << TILE_LOG2, caster.low_x), low_y = max(tile_y << TILE_LOG2, caster.low_y);
            uint high_x = min(((tile_x + 1) << TILE_LOG2) - 1, caster.high_x);
            uint high_y = min(((tile_y + 1) << TILE_LOG2) - 1, caster.high_y);
            if (misses_rectangle(&caster, (float2)(columns[low_x], rows[low_y]),
                                 (float2)(columns[high_x], rows[high_y])))
                continue;
            draw_rectangle(&pass, view, tables, &caster, low_x, low_y, high_x, high_y, nearest, output);
        }
    }
}

// Dual depth layers (Weiskopf and Ertl 2003; survey slide 141): the map lies half-way to the second layer, but no
// deeper than `limit` behind the first.
__kernel void depth_pass_midpoint(MapSet set, float limit, __global uint* nearest, __global const uint* second) {
    GN_FOR_EACH(i, set.texels) {
        float first = as_float(nearest[i]);
        nearest[i] = as_uint(first + fmin(0.5f * (as_float(second[i]) - first), limit));
    }
}
