// SPDX-License-Identifier: MIT
// Shadow volumes: each casting triangle's shadow is a half-open prism, and a point is in shadow if it lies inside one.
// The pixel's ray counts them: entering a volume is +1, leaving it -1 (Crow 1977; with a stencil buffer Heidmann 1991,
// z-fail Bilodeau and Songy 1999 and Carmack 2000).
//
// Two neighbouring triangles share sides; the kernels draw such sides only where they do not cancel. A sum per edge
// decides: each casting triangle, turned so that it faces the light, adds +1 or -1 for its direction along the edge;
// the sum is the number of sides to draw there (Bergeron 1986; Kim et al. 2008, "A shadow volume algorithm for opaque
// and transparent non-manifold casters"). So open and non-manifold meshes need no special care, and no adjacency is
// stored: edges meet in a hash table, by their vertices' positions.
#include "exact/blocks.clh"
#include "lists/append.h"
#include "receivers/facing.clh"
#include "rivals/shadow_volumes.h"

// ---- Edges ----------------------------------------------------------------------------------------------------------

// The triangle with its winding turned towards the light; false if it casts no shadow.
static bool casting_triangle(Triangle t, VolumeParams params, Triangle* facing) {
    if (!is_finite_triangle(t)) return false;
    int level = DET3_BY_FLOAT;
    int side = side_of_light(t, params.light, &level);
    if (side == 0 || (side < 0 && params.both_faces == 0u)) return false;
    *facing = t;
    if (side < 0) facing->b = t.c, facing->c = t.b;
    return true;
}

static float3 corner_of(Triangle t, uint i) { return i == 0u ? t.a : i == 1u ? t.b : t.c; }

// Bits of a position, with one zero: -0 and 0 are the same coordinate.
static uint3 position_bits(float3 v) { return as_uint3(v + 0.0f); }

static bool is_before(float3 u, float3 v) {
    uint3 a = position_bits(u), b = position_bits(v);
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

static bool is_same_position(float3 u, float3 v) { return all(position_bits(u) == position_bits(v)); }

// Murmur3's finaliser over the six coordinates.
static uint mixed(uint hash, uint word) {
    hash = (hash ^ word) * 0x85EBCA6Bu;
    hash = (hash ^ (hash >> 13)) * 0xC2B2AE35u;
    return hash ^ (hash >> 16);
}

static uint hash_of_edge(float3 u, float3 v) {
    uint3 a = position_bits(u), b = position_bits(v);
    uint hash = mixed(mixed(mixed(0u, a.x), a.y), a.z);
    return mixed(mixed(mixed(hash, b.x), b.y), b.z);
}

// Edge 3 id + i of the triangle soup, its ends in their canonical order.
static void load_edge(__global const float* vertices, uint edge, float3* first, float3* second) {
    Triangle t = load_triangle(vertices, edge / 3u);
    float3 u = corner_of(t, edge % 3u), v = corner_of(t, (edge % 3u + 1u) % 3u);
    bool in_order = is_before(u, v);
    *first = in_order ? u : v;
    *second = in_order ? v : u;
}

// The slot of an edge: it stores one of the edges between the same two positions.
static uint slot_of_edge(uint edge, uint slot_mask, __global const float* vertices, __global uint* slot_edges) {
    float3 u, v;
    load_edge(vertices, edge, &u, &v);
    uint slot = hash_of_edge(u, v) & slot_mask;
    for (;;) {
        uint there = atomic_cmpxchg(&slot_edges[slot], GN_NO_ID, edge);
        if (there == GN_NO_ID || there == edge) return slot;
        float3 other_u, other_v;
        load_edge(vertices, there, &other_u, &other_v);
        if (is_same_position(u, other_u) && is_same_position(v, other_v)) return slot;
        slot = (slot + 1u) & slot_mask;
    }
}

// Sums up the sides of every edge. Without cancellation each edge of each triangle has its own slot.
__kernel void shadow_volumes_edges(VolumeParams params, __global const float* vertices_all, __global uint* slot_edges,
                                   __global int* slot_weights, __global VolumeCounters* counters) {
    __global const float* vertices = vertices_all + params.first_float;
    float3 eye = params.eye.xyz;
    uint casting = 0, edges = 0, around_eye = 0;
    GN_FOR_EACH(id, params.triangle_count) {
        Triangle t = load_triangle(vertices, id), facing;
        if (!casting_triangle(t, params, &facing)) continue;
        ++casting;
        int level = DET3_BY_FLOAT;
        if (params.z_fail == 0u && blocks(t, eye, params.light, &level)) ++around_eye;
        bool turned = !is_same_position(facing.b, t.b);
        for (uint i = 0; i < 3u; ++i) {
            float3 u = corner_of(t, i), v = corner_of(t, (i + 1u) % 3u);
            if (is_same_position(u, v)) continue;
            ++edges;
            uint edge = 3u * (uint)id + i;
            int direction = is_before(u, v) != turned ? 1 : -1;
            uint slot = params.cancels ? slot_of_edge(edge, params.slot_count - 1u, vertices, slot_edges) : edge;
            if (!params.cancels) slot_edges[slot] = edge;
            atomic_add(&slot_weights[slot], direction);
        }
    }
    if (casting != 0) atomic_add(&counters->casting, casting);
    if (edges != 0) atomic_add(&counters->edges, edges);
    if (around_eye != 0) atomic_add(&counters->eye_inside, around_eye);
}

// ---- Sides ----------------------------------------------------------------------------------------------------------

// The form n . ray.
static float3 ray_form(float3 n, VolumeParams params) {
    return (float3)(dot(n, params.right.xyz), dot(n, params.up.xyz), dot(n, params.forward.xyz));
}

static float form_at(float3 form, float x, float y) { return fma(form.x, x, fma(form.y, y, form.z)); }

// An edge of a cone of rays: det(u, v, ray), computed from the canonical order of u and v. The two sides that share the
// edge thus get the same value with opposite signs, and a ray exactly on the edge belongs to one side.
static void set_cone_edge(VolumeSide* side, uint i, float3 u, float3 v, VolumeParams params) {
    bool in_order = is_before(u, v);
    vstore3(ray_form(in_order ? cross(u, v) : -cross(v, u), params), i, side->edges);
    if (in_order) side->flags |= 1u << i;
}

// The cone of three vectors from the eye, all in the plane n . x = n . start; n points out of the volume.
static VolumeSide make_side(float3 u, float3 v, float3 w, float3 n, float3 start, int weight, VolumeParams params) {
    VolumeSide side;
    side.flags = 0;
    set_cone_edge(&side, 0, u, v, params);
    set_cone_edge(&side, 1, v, w, params);
    set_cone_edge(&side, 2, w, u, params);
    // Turned so that the inside is where all three are positive.
    if (dot(cross(u, v), w) < 0.0f) {
        for (uint i = 0; i < 9u; ++i) side.edges[i] = -side.edges[i];
        side.flags ^= 7u;
    }
    vstore3(ray_form(n, params), 0, side.plane);
    side.plane_start = dot(n, start);
    side.weight = weight;
    side.cap_of = GN_NO_ID;
    return side;
}

// From a point towards infinity, away from the light.
static float3 away_from_light(float3 a, float3 eye, VolumeParams params) {
    float3 light = params.light.xyz;
    return params.light.w != 0.0f ? (a + eye) - light : -light;
}

// A slot's side is one cone for a directional light, two for a point light.
__kernel void shadow_volumes_sides(VolumeParams params, __global const float* vertices_all,
                                   __global const uint* slot_edges, __global const int* slot_weights,
                                   __global uint* cursor, __global VolumeSide* sides) {
    float3 eye = params.eye.xyz;
    GN_FOR_EACH(slot, params.slot_count) {
        int weight = slot_edges[slot] == GN_NO_ID ? 0 : slot_weights[slot];
        if (weight == 0) continue;
        float3 a, b;
        load_edge(vertices_all + params.first_float, slot_edges[slot], &a, &b);
        a -= eye;
        b -= eye;
        float3 c_a = away_from_light(a, eye, params), c_b = away_from_light(b, eye, params);
        // Seen from the light the triangle lies to the left of a -> b, so this points out of its volume.
        float3 n = cross(c_a, b - a);
        bool two = params.light.w != 0.0f;
        uint at = atomic_add(cursor, two ? 2u : 1u);
        if (at + (two ? 2u : 1u) > params.side_capacity) continue;
        sides[at] = make_side(a, b, c_a, n, a, weight, params);
        if (two) sides[at + 1] = make_side(b, c_b, c_a, n, a, weight, params);
    }
}

// Caps, which z-fail needs: the triangle itself and, for a point light, its shadow at infinity.
__kernel void shadow_volumes_caps(VolumeParams params, __global const float* vertices_all, __global uint* cursor,
                                  __global VolumeSide* sides) {
    float3 eye = params.eye.xyz;
    uint each = params.light.w != 0.0f ? 2u : 1u;
    GN_FOR_EACH(id, params.triangle_count) {
        Triangle t;
        if (!casting_triangle(load_triangle(vertices_all + params.first_float, id), params, &t)) continue;
        float3 a = t.a - eye, b = t.b - eye, c = t.c - eye;
        uint at = atomic_add(cursor, each);
        if (at + each > params.side_capacity) continue;
        sides[at] = make_side(a, b, c, cross(b - a, c - a), a, 1, params);
        sides[at].cap_of = (uint)id;
        if (each == 1u) continue;
        float3 u = away_from_light(a, eye, params), v = away_from_light(b, eye, params),
               w = away_from_light(c, eye, params);
        sides[at + 1] = make_side(u, v, w, -cross(v - u, w - u), u, 1, params);
        sides[at + 1].flags |= VOLUME_AT_INFINITY;
    }
}

// ---- Tiles ----------------------------------------------------------------------------------------------------------

// The view depth of x is forward_unit . x with ray's forward component 1: given by the cross product of the axes.
static float view_depth(VolumeParams params, float3 p) {
    float3 axis = cross(params.right.xyz, params.up.xyz);
    return dot(axis, p - params.eye.xyz) * (1.0f / dot(axis, params.forward.xyz));
}

// Nearest and farthest view depth of each tile's points; (inf, -inf) for a tile without points.
__kernel void shadow_volumes_depths(VolumeParams params, PointsLayout layout, __global const float* positions,
                                    __global float2* tile_depths) {
    GN_FOR_EACH(tile, params.tiles_x * params.tiles_y) {
        uint x0 = (uint)(tile % params.tiles_x) * VOLUME_TILE, y0 = (uint)(tile / params.tiles_x) * VOLUME_TILE;
        float2 range = (float2)(INFINITY, -INFINITY);
        for (uint y = y0; y < min(y0 + VOLUME_TILE, params.height); ++y)
            for (uint x = x0; x < min(x0 + VOLUME_TILE, params.width); ++x) {
                float3 p = load_point(positions, layout, (size_t)y * params.width + x);
                if (!is_present(p)) continue;
                float depth = view_depth(params, p);
                range = (float2)(fmin(range.x, depth), fmax(range.y, depth));
            }
        tile_depths[tile] = range;
    }
}

// Least and greatest value of a form over a rectangle (x0, y0, x1, y1).
static float2 range_over(float3 form, float4 rectangle) {
    float2 x = form.x > 0.0f ? rectangle.xz : rectangle.zx, y = form.y > 0.0f ? rectangle.yw : rectangle.wy;
    return (float2)(form_at(form, x.x, y.x), form_at(form, x.y, y.y));
}

#define MISSED 0
#define PARTLY 1
#define WHOLLY 2

static int cone_over(__global const VolumeSide* side, float4 rectangle) {
    int result = WHOLLY;
    for (int i = 0; i < 3; ++i) {
        float2 range = range_over(vload3(i, side->edges), rectangle);
        if (range.y < 0.0f) return MISSED;
        if (range.x <= 0.0f) result = PARTLY;
    }
    return result;
}

// The eye counts as outside of the half-space n . x <= n . a only if its n . x - n . a = -(n . a) is positive.
static bool is_eye_outside(__global const VolumeSide* side) { return side->plane_start < 0.0f; }

static bool is_at_infinity(__global const VolumeSide* side) { return (side->flags & VOLUME_AT_INFINITY) != 0u; }

// Whether the side's plane lies between the eye and each (WHOLLY), none (MISSED) or some (PARTLY) of a tile's points.
// The result is PARTLY near the plane, where single precision could err.
static int plane_over(__global const VolumeSide* side, float4 rectangle, float2 depths) {
    if (is_at_infinity(side)) return MISSED;
    float2 slope = range_over(vload3(0, side->plane), rectangle);
    float low = fmin(slope.x * depths.x, slope.x * depths.y);
    float high = fmax(slope.y * depths.x, slope.y * depths.y);
    float margin = 32.0f * GN_U * (fmax(fabs(low), fabs(high)) + fabs(side->plane_start));
    bool all_outside = low - margin > side->plane_start, all_inside = high + margin <= side->plane_start;
    if (!all_outside && !all_inside) return PARTLY;
    return all_outside == is_eye_outside(side) ? MISSED : WHOLLY;
}

// The weight that a crossing of the side adds to the count. z-pass: entered before the point +1, left -1. z-fail: the
// opposite, beyond the point; `slope` is n . ray.
static int crossing_of(VolumeParams params, __global const VolumeSide* side, float slope) {
    if (params.z_fail) return slope < 0.0f ? -side->weight : side->weight;
    return is_eye_outside(side) ? side->weight : -side->weight;
}

static float4 tile_rectangle(VolumeParams params, uint x, uint y, uint side) {
    return (float4)((float)(x * side) + 0.5f, (float)(y * side) + 0.5f,
                    (float)min((x + 1u) * side, params.width) - 0.5f,
                    (float)min((y + 1u) * side, params.height) - 0.5f);
}

// ---- Pixels ---------------------------------------------------------------------------------------------------------

static bool is_in_cone(__global const VolumeSide* side, float x, float y) {
    for (uint i = 0; i < 3u; ++i) {
        float e = form_at(vload3(i, side->edges), x, y);
        if (e < 0.0f || (e == 0.0f && (side->flags & (1u << i)) == 0u)) return false;
    }
    return true;
}

// The pixels of a picture, and their counts.
typedef struct VolumePixels {
    PointsLayout layout;
    __global const float* positions;
    __global const uint* receivers;
    __global int* counts;
} VolumePixels;

// Counts a side at the pixels of a tile's row; returns the number of pixels written.
static uint count_in_row(VolumeParams params, const VolumePixels* of, __global const VolumeSide* side, uint tile,
                         uint row) {
    uint x0 = (tile % params.tiles_x) * VOLUME_TILE, y = (tile / params.tiles_x) * VOLUME_TILE + row, written = 0;
    if (y >= params.height) return 0u;
    for (uint x = x0; x < min(x0 + VOLUME_TILE, params.width); ++x) {
        float pixel_x = (float)x + 0.5f, pixel_y = (float)y + 0.5f;
        if (!is_in_cone(side, pixel_x, pixel_y)) continue;
        size_t pixel = (size_t)y * params.width + x;
        float3 p = load_point(of->positions, of->layout, pixel);
        if (!is_present(p)) continue;
        float slope = form_at(vload3(0, side->plane), pixel_x, pixel_y);
        float depth = view_depth(params, p);
        bool is_outside = slope * depth > side->plane_start;
        bool is_own_cap = of->layout.has_receivers && side->cap_of != GN_NO_ID && of->receivers[pixel] == side->cap_of;
        bool crossed_before = !is_at_infinity(side) && !is_own_cap && is_outside != is_eye_outside(side);
        if (crossed_before == (params.z_fail != 0u)) continue;
        atomic_add(&of->counts[pixel], crossing_of(params, side, slope));
        ++written;
    }
    return written;
}

static void add_written(__global VolumeCounters* counters, uint written) {
    if (written == 0) return;
    uint before = atomic_add(&counters->pixels_written_low, written);
    if (before + written < before) atomic_inc(&counters->pixels_written_high);
}

// ---- Drawing --------------------------------------------------------------------------------------------------------

// One work-item takes one (side of the slice, block of tiles): it counts whole tiles at once, and queues the others or,
// where the queue has no room, counts at their pixels.
__kernel void shadow_volumes_tiles(VolumeParams params, PointsLayout layout, __global const float* positions,
                                   __global const uint* receivers, __global const VolumeSide* sides,
                                   __global const float2* tile_depths, __global int* tile_counts, __global uint2* pairs,
                                   __global uint* pair_count, __global int* pixel_counts,
                                   __global VolumeCounters* counters) {
    VolumePixels pixels = {layout, positions, receivers, pixel_counts};
    uint block_count = params.blocks_x * params.blocks_y;
    uint whole = 0, written = 0;
    GN_FOR_EACH(i, (size_t)params.side_count * block_count) {
        uint index = params.first_side + (uint)(i / block_count), block = (uint)(i % block_count);
        __global const VolumeSide* side = &sides[index];
        uint block_x = block % params.blocks_x, block_y = block / params.blocks_x;
        if (cone_over(side, tile_rectangle(params, block_x, block_y, VOLUME_TILE * VOLUME_BLOCK)) == MISSED) continue;
        for (uint y = block_y * VOLUME_BLOCK; y < min((block_y + 1u) * VOLUME_BLOCK, params.tiles_y); ++y)
            for (uint x = block_x * VOLUME_BLOCK; x < min((block_x + 1u) * VOLUME_BLOCK, params.tiles_x); ++x) {
                uint tile = y * params.tiles_x + x;
                float2 depths = tile_depths[tile];
                if (!(depths.x <= depths.y)) continue;
                float4 rectangle = tile_rectangle(params, x, y, VOLUME_TILE);
                int cone = cone_over(side, rectangle);
                if (cone == MISSED) continue;
                int before = plane_over(side, rectangle, depths);
                if (before == (params.z_fail ? WHOLLY : MISSED)) continue;
                float2 slope = range_over(vload3(0, side->plane), rectangle);
                bool one_way = params.z_fail == 0u || slope.x >= 0.0f || slope.y < 0.0f;
                if (cone == WHOLLY && before != PARTLY && one_way) {
                    atomic_add(&tile_counts[tile], crossing_of(params, side, slope.x));
                    ++whole;
                    continue;
                }
                uint at = reserve_slots(1u, pair_count);
                if (at < params.pair_capacity) {
                    pairs[at] = (uint2)(index, tile);
                    continue;
                }
                for (uint row = 0; row < VOLUME_TILE; ++row) written += count_in_row(params, &pixels, side, tile, row);
            }
    }
    if (whole != 0) atomic_add(&counters->tiles_whole, whole);
    add_written(counters, written);
}

// One work-item per row of a queued tile.
__kernel void shadow_volumes_pixels(VolumeParams params, PointsLayout layout, __global const float* positions,
                                    __global const uint* receivers, __global const VolumeSide* sides,
                                    __global const uint2* pairs, __global const uint* pair_count,
                                    __global int* pixel_counts, __global VolumeCounters* counters) {
    VolumePixels pixels = {layout, positions, receivers, pixel_counts};
    uint written = 0;
    GN_FOR_EACH(i, (size_t)min(*pair_count, params.pair_capacity) * VOLUME_TILE) {
        uint2 pair = pairs[i / VOLUME_TILE];
        written += count_in_row(params, &pixels, &sides[pair.x], pair.y, (uint)(i % VOLUME_TILE));
    }
    add_written(counters, written);
}

// A point is in shadow if it is backfacing or lies in a volume. Absent points are lit.
__kernel void shadow_volumes_resolve(VolumeParams params, PointsLayout layout, __global const float* positions,
                                     __global const uint* receivers, __global const float* vertices,
                                     __global const int* tile_counts, __global const int* pixel_counts,
                                     __global const VolumeCounters* counters, __global float* visibility) {
    GN_FOR_EACH(pixel, layout.count) {
        visibility[pixel] = 1.0f;
        if (!is_present(load_point(positions, layout, pixel))) continue;
        int level = DET3_BY_FLOAT;
        bool has_receiver = layout.has_receivers && receivers[pixel] < params.triangle_count;
        uint tile =
            (uint)(pixel / params.width) / VOLUME_TILE * params.tiles_x + (uint)(pixel % params.width) / VOLUME_TILE;
        if ((has_receiver && is_backfacing(load_triangle(vertices + params.first_float, receivers[pixel]), params.light,
                                           params.eye.xyz, &level)) ||
            tile_counts[tile] + pixel_counts[pixel] + (int)counters->eye_inside != 0)
            visibility[pixel] = 0.0f;
    }
}
