// SPDX-License-Identifier: MIT
// Unshadowed triangles: finds the triangles that no triangle shadows under a prepared directional light
// (unshadowed_triangles.h).
//
// Proof. With D towards the light, n R's normal, s = sign(n . D) and Q any point in R's interior, another triangle T
// meets no ray Q + t D, t > 0, if
//   - no vertex of T is above R's plane, s n . (v - a) <= 0: on the ray that grows from 0; or
//   - no vertex of R is below T's plane: then Q is not, and the ray leaves it; or
//   - an edge of one has the other beyond it, or on it, in the light's view: Q lies strictly on its own side of R's
//     edges, and strictly beyond an edge of T that all of R is beyond.
// All signs are certain. These tests separate most pairs that touch: a mesh's neighbours share an edge or lie below.
//
// The tested T are the triangles in the lists of all bins under R's rectangle that may be above R's least height by
// their bounds. T blocks Q only where both their rectangles are, in the bin of Q's real grid position. T is listed
// there, since lists allow for all errors of grid positions (docs/numerics.md, 5); or T and Q lie below one triangle K
// that covers the whole texel (6). Then K blocks Q, K is listed there, and K is not R, which has no point below Q on
// its ray but Q: R is not found to be unshadowed.
#include "prepared/unshadowed_triangles.h"

#include "occluders/bin_overlap.clh"
#include "prepared/prepared_light.h"

// True, and the sign, if float or double are certain of it. The integers' level is left out: on a GPU it took three
// quarters of the time to prepare, and only rare triangles' planes need it.
static bool is_sign_certain(float3 u1, float3 u0, float3 v1, float3 v0, float3 w1, float3 w0, int* sign) {
    if (det3_sign_float(u1, u0, v1, v0, w1, w0, sign)) return true;
#ifdef GN_FP64
    return det3_sign_double(u1, u0, v1, v0, w1, w0, sign);
#else
    return false;
#endif
}

// The side of the light, 0 where it is not certain.
static int certain_side(const Triangle* t, float3 towards_light) {
    int side;
    return is_sign_certain(t->b, t->a, t->c, t->a, towards_light, (float3)(0.0f), &side) ? side : 0;
}

// True if det(u1 - u0, v1 - v0, p - w0) `side` is certainly <= 0 at all vertices p.
static bool has_none_beyond(const Triangle* t, float3 u1, float3 u0, float3 v1, float3 v0, float3 w0, int side) {
    const float3 vertices[3] = {t->a, t->b, t->c};
    for (int i = 0; i < 3; ++i) {
        int sign;
        if (!is_sign_certain(u1, u0, v1, v0, vertices[i], w0, &sign) || sign * side > 0) return false;
    }
    return true;
}

// True if no point of `other` is above the plane of t; `side` is that plane's side of the light. With the side's sign
// turned: no point is below the plane.
static bool has_none_above(const Triangle* other, const Triangle* t, int side) {
    return has_none_beyond(other, t->b, t->a, t->c, t->a, t->a, side);
}

// True if `other` is beyond one of t's edges, or on it, in the light's view. A point p is beyond the edge from e to f
// if det(f - e, D, p - e) has the sign of n . D: the third vertex has the other one.
static bool is_beyond_an_edge(const Triangle* other, const Triangle* t, int side, float3 towards_light) {
    const float3 edges[4] = {t->a, t->b, t->c, t->a};
    for (int i = 0; i < 3; ++i)
        if (has_none_beyond(other, edges[i + 1], edges[i], towards_light, (float3)(0.0f), edges[i], -side)) return true;
    return false;
}

// False if t blocks no point in the interior of `receiver`; `side` is the receiver's side of the light.
static bool may_shadow(const Triangle* t, const Triangle* receiver, int side, float3 towards_light) {
    if (has_none_above(t, receiver, side) || is_beyond_an_edge(t, receiver, side, towards_light)) return false;
    int own_side = certain_side(t, towards_light);
    if (own_side == 0) return true;
    return !has_none_above(receiver, t, -own_side) && !is_beyond_an_edge(receiver, t, own_side, towards_light);
}

typedef struct SearchLists {
    __global const uint2* ranges;
    __global const BinEntries* entries;
    __global const TriangleBounds* bounds;  // of the records, for their ids
    __global const float* vertices;         // from the first triangle on
} SearchLists;

// A triangle that takes an item more bins or tests than this does not count as unshadowed.
#define SEARCH_MAX_BINS 128u
#define SEARCH_MAX_TESTS 64u

// The number of triangles that an item has tested, and the last few of them, which neighbouring bins mostly share.
typedef struct SearchTests {
    uint count;
    uint4 last;
} SearchTests;

// The receiver of the search: its `side` of the light, and the part of the grid where other triangles may shadow it.
typedef struct SearchedTriangle {
    Triangle receiver;
    float3 towards_light;
    QuantisedBlock around;
    uint id;
    int side;
} SearchedTriangle;

static bool any_may_shadow(const SearchLists* lists, uint bin, const SearchedTriangle* searched, SearchTests* tests) {
    uint2 range = lists->ranges[bin];
    for (uint i = range.x; i < range.y; ++i) {
        uint meeting = entries_that_meet(&lists->entries[i], searched->around);
        while (meeting != 0u) {
            uint other = lists->bounds[ENTRY_SLOT(&lists->entries[i], take_lowest_bit(&meeting))].id;
            if (other == searched->id || any(tests->last == other)) continue;
            Triangle t = load_triangle(lists->vertices, other);
            if (++tests->count > SEARCH_MAX_TESTS) return true;
            if (may_shadow(&t, &searched->receiver, searched->side, searched->towards_light)) return true;
            tests->last = (uint4)(other, tests->last.xyz);
        }
    }
    return false;
}

// A sample of records: one of each `step` in a row; which one varies, since neighbours follow a pattern.
static uint sampled(uint i, uint step) { return i * step + ((i * 2654435761u) >> 16) % step; }

// Sets the bits of a sample's triangles.
__kernel void unshadowed_candidates(const PreparedParams params, __global const TriangleBounds* bounds,
                                    __global float4* tables) {
    volatile __global uint* unshadowed = (volatile __global uint*)(tables + params.tables.unshadowed);
    GN_FOR_EACH(i, params.record_count / params.sample_step) {
        uint id = bounds[sampled((uint)i, params.sample_step)].id;
        atomic_or(&unshadowed[id / UNSHADOWED_WORD_BITS], unshadowed_bit(id));
    }
}

// Clears the bits of the same sample's triangles that may be shadowed.
__kernel void unshadowed_triangles(const PreparedParams params, __constant const Projection* projection,
                                   __global const float* vertices, __global const BinEntries* entries,
                                   __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                                   __global float4* tables) {
    SearchLists lists = {(__global const uint2*)tables, entries, bounds, vertices + params.triangles.first_float};
    volatile __global uint* unshadowed = (volatile __global uint*)(tables + params.tables.unshadowed);
    GN_FOR_EACH(i, (size_t)(params.record_count / params.sample_step) * UNSHADOWED_TEAM) {
        uint slot = sampled((uint)(i / UNSHADOWED_TEAM), params.sample_step), member = (uint)(i % UNSHADOWED_TEAM);
        TriangleBounds own = bounds[slot];
        uint4 bins = bins_of_bounds(own, projection);
        uint bin_count = bins_of_rectangle(bins);
        uint each = (bin_count + UNSHADOWED_TEAM - 1u) / UNSHADOWED_TEAM, end = min((member + 1u) * each, bin_count);
        ushort z = quantised_height(records[slot].z_low, projection->z_origin, projection->z_scale);
        SearchedTriangle searched = {load_triangle(lists.vertices, own.id),
                                     light_of(params.light_frame).xyz,
                                     {own.x0, own.y0, own.x1, own.y1, z},
                                     own.id,
                                     0};
        searched.side = certain_side(&searched.receiver, searched.towards_light);
        SearchTests tests = {0u, (uint4)(own.id)};
        volatile __global uint* word = &unshadowed[own.id / UNSHADOWED_WORD_BITS];
        bool shadowed = searched.side == 0 || each > SEARCH_MAX_BINS;
        for (uint b = member * each; b < end && !shadowed; ++b) {
            if ((GN_RELAXED_LOAD(word) & unshadowed_bit(own.id)) == 0u) break;  // another member found it shadowed
            uint4 bin = bin_of_rectangle(bins, b);
            shadowed = any_may_shadow(&lists, bin.y * projection->bins_x + bin.x, &searched, &tests);
        }
        if (shadowed) atomic_and(word, ~unshadowed_bit(own.id));
    }
}
