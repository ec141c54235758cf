// SPDX-License-Identifier: MIT
// Finds out whether triangles are a height field, and makes its grid and pyramid (height_field.h).
//
// Over a rectangle each position lies under one triangle if these conditions hold. All triangles have one winding, seen
// from above. All edges but those outside of the rectangle are shared by two triangles, which run along them in
// opposite directions, so that the borders of all triangles cancel within the rectangle; then all positions in it lie
// under the same number of triangles. And one position lies under one triangle. The host checks the last condition.
#include "horizons/height_field.h"

static Triangle triangle_over_ground(const HeightField field, __global const float* vertices, size_t i) {
    Triangle t = load_triangle(vertices + field.triangles.first_float, i);
    return (Triangle){over_ground(field.axis, t.a), over_ground(field.axis, t.b), over_ground(field.axis, t.c)};
}

// Twice the area of a triangle with the edges e and f over the ground; *bound is more than its error
// (tests/proofs/winding.v).
static float area_over_ground(float3 e, float3 f, float* bound) {
    float left = e.x * f.y, right = e.y * f.x;
    float sizes = 1.0f + fabs(e.x) + fabs(e.y) + fabs(f.x) + fabs(f.y);
    *bound = 0x1p-20f * (fabs(left) + fabs(right)) + 0x1p-110f * sizes;
    return left - right;
}

// Sets bit k if some triangle, seen against axis k, is not certainly counter-clockwise, bit 3 + k if not certainly
// clockwise.
__kernel void field_windings(const TrianglesLayout layout, __global const float* vertices, __global uint* found) {
    uint bits = 0u;
    GN_FOR_EACH(i, layout.count) {
        Triangle t = load_triangle(vertices + layout.first_float, i);
        for (uint axis = 0u; axis < 3u; ++axis) {
            float3 e = over_ground(axis, t.b - t.a), f = over_ground(axis, t.c - t.a);
            float bound, area = area_over_ground(e, f, &bound);
            if (!(area > bound)) bits |= 1u << axis;
            if (!(area < -bound)) bits |= 8u << axis;
        }
        if (bits == 63u) break;
    }
    if (bits != 0u) atomic_or(found, bits);
}

typedef struct CellBox {
    int2 x, y;
} CellBox;

static CellBox box_of(const HeightField field, Triangle t, float per_length, uint columns, uint rows) {
    float3 low = low_of(t), high = high_of(t);
    return (CellBox){cells_met(low.x, high.x, field.corner[0], per_length, columns),
                     cells_met(low.y, high.y, field.corner[1], per_length, rows)};
}

__kernel void field_counts(const HeightField field, __global const float* vertices, __global uint* counts,
                           __global FieldCounters* counters) {
    GN_FOR_EACH(i, field.triangles.count) {
        Triangle t = triangle_over_ground(field, vertices, i);
        CellBox box = box_of(field, t, 0.5f * field.halves, field.columns, field.rows);
        if ((long)(box.x.y - box.x.x + 1) * (box.y.y - box.y.x + 1) > MAX_CELLS_OF_TRIANGLE) {
            atomic_max(&counters->unfit, 1u);
            continue;
        }
        for (int y = box.y.x; y <= box.y.y; ++y)
            for (int x = box.x.x; x <= box.x.y; ++x)
                if (atomic_inc(&counts[y * (size_t)field.columns + x]) >= MAX_TRIANGLES_OF_CELL)
                    atomic_max(&counters->unfit, 1u);
    }
}

// Lists the triangles of each cell. `slots`: the slot of the next entry of each cell.
__kernel void field_lists(const HeightField field, __global const float* vertices, __global uint* slots,
                          __global uint* list) {
    GN_FOR_EACH(i, field.triangles.count) {
        Triangle t = triangle_over_ground(field, vertices, i);
        CellBox box = box_of(field, t, 0.5f * field.halves, field.columns, field.rows);
        for (int y = box.y.x; y <= box.y.y; ++y)
            for (int x = box.x.x; x <= box.x.y; ++x) list[atomic_inc(&slots[y * (size_t)field.columns + x])] = (uint)i;
    }
}

// ---- Neighbours -----------------------------------------------------------------------------------------------------

static bool are_equal(float3 p, float3 q) { return p.x == q.x && p.y == q.y && p.z == q.z; }
static bool has_edge(Triangle t, float3 from, float3 to) {
    return (are_equal(t.a, from) && are_equal(t.b, to)) || (are_equal(t.b, from) && are_equal(t.c, to)) ||
           (are_equal(t.c, from) && are_equal(t.a, to));
}

// True if exactly one triangle runs along an edge of triangle i the other way, and no other triangle the same way.
static bool has_neighbour(const HeightField field, __global const float* vertices, __global const uint* starts,
                          __global const uint* list, uint i, float3 from, float3 to) {
    float2 at = 0.5f * (from.xy + to.xy), snap = (float2)(2.0f * FIELD_SNAP / field.halves);
    int2 x = cells_met(at.x - 2.0f * snap.x, at.x + 2.0f * snap.x, field.corner[0], 0.5f * field.halves, field.columns);
    int2 y = cells_met(at.y - 2.0f * snap.y, at.y + 2.0f * snap.y, field.corner[1], 0.5f * field.halves, field.rows);
    uint neighbour = GN_NO_ID;
    for (int row = y.x; row <= y.y; ++row)
        for (int column = x.x; column <= x.y; ++column) {
            size_t cell = row * (size_t)field.columns + column;
            for (uint k = starts[cell]; k < starts[cell + 1]; ++k) {
                if (list[k] == i || list[k] == neighbour) continue;
                Triangle other = triangle_over_ground(field, vertices, list[k]);
                if (has_edge(other, from, to)) return false;
                if (!has_edge(other, to, from)) continue;
                if (neighbour != GN_NO_ID) return false;
                neighbour = list[k];
            }
        }
    return neighbour != GN_NO_ID;
}

// Lists the edges without such a neighbour, by the positions of both ends.
__kernel void field_borders(const HeightField field, __global const float* vertices, __global const uint* starts,
                            __global const uint* list, uint capacity, __global float4* borders,
                            __global FieldCounters* counters) {
    GN_FOR_EACH(i, field.triangles.count) {
        Triangle t = triangle_over_ground(field, vertices, i);
        float3 corners[4] = {t.a, t.b, t.c, t.a};
        for (uint k = 0u; k < 3u; ++k) {
            if (has_neighbour(field, vertices, starts, list, (uint)i, corners[k], corners[k + 1u])) continue;
            if (GN_RELAXED_LOAD(&counters->borders) > capacity) return;
            uint slot = atomic_inc(&counters->borders);
            if (slot < capacity) borders[slot] = (float4)(corners[k].xy, corners[k + 1u].xy);
        }
    }
}

// ---- Heights --------------------------------------------------------------------------------------------------------

// A triangle over the ground, in half cells and units, and what bounds its shares (barycentric coordinates). The share
// of corner k is linear, 1 at corner k and 0 at the others: at a position it is (edge k x position) / area.
typedef struct FieldTriangle {
    float3 corners[3];
    float2 edges[3];  // from corner k + 1 to corner k + 2
    float area_inverse;
    float area_error;  // bound of the area's relative error
} FieldTriangle;

static FieldTriangle field_triangle(const HeightField field, Triangle t) {
    float3 corner = (float3)(field.corner[0], field.corner[1], field.lowest);
    float3 scale = (float3)(field.halves, field.halves, field.units);
    FieldTriangle made;
    made.corners[0] = (t.a - corner) * scale;
    made.corners[1] = (t.b - corner) * scale;
    made.corners[2] = (t.c - corner) * scale;
    for (uint k = 0u; k < 3u; ++k) made.edges[k] = made.corners[(k + 2u) % 3u].xy - made.corners[(k + 1u) % 3u].xy;
    float2 e = made.edges[0], f = made.edges[1];
    float left = e.x * f.y, right = e.y * f.x;
    made.area_inverse = 1.0f / (left - right);
    made.area_error = 0x1p-20f * (fabs(left) + fabs(right)) * fabs(made.area_inverse);
    return made;
}

// Bounds of the share of corner k over a half cell, which is enlarged by four times the rounding of coordinates.
static float2 shares_over(const FieldTriangle* t, uint k, float2 middle) {
    float2 e = t->edges[k], from = middle - t->corners[(k + 1u) % 3u].xy;
    float left = e.x * from.y * t->area_inverse, right = e.y * from.x * t->area_inverse;
    float radius = (0.5f + 2.0f * FIELD_SNAP) * (fabs(e.x) + fabs(e.y)) * fabs(t->area_inverse) +
                   0x1p-18f * (fabs(left) + fabs(right)) + 0x1p-11f;
    radius += 2.0f * t->area_error * (radius + fabs(left) + fabs(right));
    return (float2)(left - right - radius, left - right + radius);
}

// Notes bounds of a triangle's heights over a half cell. The height at a position is the height of corner k, plus for
// each other corner its share times how much higher it is than corner k. So bounds of shares bound it, in three ways.
static void note_heights(const FieldTriangle* t, float2 middle, __global uint* least, __global uint* greatest) {
    float2 shares[3];
    for (uint k = 0u; k < 3u; ++k) {
        shares[k] = shares_over(t, k, middle);
        // A triangle may have no area here, since coordinates are rounded. Its shares are then only known to be 0 to 1.
        bool is_flat = !(t->area_error < 0.25f);
        if (!is_flat && shares[k].y < 0.0f) return;  // the triangle does not meet the half cell
        shares[k].x = !is_flat && shares[k].x > 0.0f ? shares[k].x : 0.0f;
        shares[k].y = !is_flat && shares[k].y < 1.0f ? shares[k].y : 1.0f;
    }
    float low = 0.0f, high = FIELD_UNITS;
    for (uint k = 0u; k < 3u; ++k) {
        float height = t->corners[k].z, lower = height, higher = height;
        for (uint other = 1u; other < 3u; ++other) {
            uint j = (k + other) % 3u;
            float2 more = shares[j] * (t->corners[j].z - height);
            lower += fmin(more.x, more.y);
            higher += fmax(more.x, more.y);
        }
        low = fmax(low, lower);
        high = fmin(high, higher);
    }
    uint low_units = (uint)fmax(floor(low - FIELD_SLACK), 0.0f), high_units = (uint)ceil(high + FIELD_SLACK);
    if (low_units < GN_RELAXED_LOAD(least)) atomic_min(least, low_units);
    if (high_units > GN_RELAXED_LOAD(greatest)) atomic_max(greatest, min(high_units, (uint)FIELD_UNITS));
}

__kernel void field_heights(const HeightField field, __global const float* vertices, __global uint* least,
                            __global uint* greatest) {
    uint columns = 2u * field.columns, rows = 2u * field.rows;
    GN_FOR_EACH(i, field.triangles.count) {
        Triangle over = triangle_over_ground(field, vertices, i);
        CellBox box = box_of(field, over, field.halves, columns, rows);
        FieldTriangle t = field_triangle(field, over);
        for (int y = box.y.x; y <= box.y.y; ++y)
            for (int x = box.x.x; x <= box.x.y; ++x) {
                size_t at = y * (size_t)columns + x;
                note_heights(&t, (float2)(x + 0.5f, y + 0.5f), &least[at], &greatest[at]);
            }
    }
}

// ---- Pyramid --------------------------------------------------------------------------------------------------------

// Joins two words, each with a greatest height in the upper half and a least height in the lower half.
static uint joined(uint a, uint b) { return (max(a >> 16, b >> 16) << 16) | min(a & 0xFFFFu, b & 0xFFFFu); }

// Makes the lowest level, of half cells.
__kernel void field_lowest_level(const FieldLevel level, __global const uint* least, __global const uint* greatest,
                                 __global uint* pyramid) {
    GN_FOR_EACH(i, level.columns * (size_t)level.rows) {
        uint x = (uint)(i % level.columns), y = (uint)(i / level.columns), bounds = 0xFFFFu;
        for (uint row = y; row < min(y + 2u, level.rows); ++row)
            for (uint column = x; column < min(x + 2u, level.columns); ++column) {
                size_t at = row * (size_t)level.columns + column;
                bounds = joined(bounds, greatest[at] << 16 | least[at]);
            }
        pyramid[i] = bounds;
    }
}

__kernel void field_level(const FieldLevel below, const FieldLevel level, __global uint* pyramid) {
    GN_FOR_EACH(i, level.columns * (size_t)level.rows) {
        uint x = 2u * (uint)(i % level.columns), y = 2u * (uint)(i / level.columns), bounds = 0xFFFFu;
        for (uint row = y; row < min(y + 4u, below.rows); row += 2u)
            for (uint column = x; column < min(x + 4u, below.columns); column += 2u)
                bounds = joined(bounds, pyramid[below.first + row * (size_t)below.columns + column]);
        pyramid[level.first + i] = bounds;
    }
}
