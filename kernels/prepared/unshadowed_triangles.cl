// SPDX-License-Identifier: MIT
// Lit receivers: finds, of a prepared direction's triangles, those that nothing shadows (unshadowed_triangles.h).
//
// Why. With D towards the light, n R's normal, s = sign(n . D) and Q any point in R's interior, another triangle T
// meets no ray Q + t D, t > 0, if
//   - no vertex of T is above R's plane, s n . (v - a) <= 0: on the ray that grows from 0; or
//   - no vertex of R is below T's plane: then Q is not, and the ray leaves it; or
//   - an edge of one has the other beyond it, or on it, as the light sees them: Q lies strictly on its own side of R's
//     edges, and strictly beyond an edge of T that all of R is beyond.
// All signs are certain. Most pairs that touch are kept apart by this: a mesh's neighbours share an edge or lie below.
//
// Which T are asked: what the lists of all bins under R's rectangle name, and what by its bounds may be above R's least
// height. T blocks Q only where both their rectangles are, in the bin of Q's real place, where T is listed, for lists
// hold for all errors of places (docs/numerics.md, 5); or T and Q lie below what one triangle K covers the whole texel
// with (6). Then K blocks Q, it is listed there, and it is not R, which has no point below Q on its ray but Q: R is not
// found to be lit.
#include "prepared/unshadowed_triangles.h"

#include "occluders/bin_test.clh"
#include "receivers/light_frame.h"

// True, and the sign, if float or double tell. The integers' level is not asked: on a GPU it took three quarters of
// preparing, and what it alone could tell are rare triangles' planes.
static bool is_sign_told(float3 u1, float3 u0, float3 v1, float3 v0, float3 w1, float3 w0, int* sign) {
    if (det3_sign_float(u1, u0, v1, v0, w1, w0, sign)) return true;
#ifdef GN_FP64
    return det3_sign_double(u1, u0, v1, v0, w1, w0, sign);
#else
    return false;
#endif
}

// The side of the light, 0 where it is not told.
static int told_side(const Triangle* t, float3 towards_light) {
    int side;
    return is_sign_told(t->b, t->a, t->c, t->a, towards_light, (float3)(0.0f), &side) ? side : 0;
}

// Is det(u1 - u0, v1 - v0, p - w0) `side` <= 0 for certain at all vertices p?
static bool has_none_beyond(const Triangle* t, float3 u1, float3 u0, float3 v1, float3 v0, float3 w0, int side) {
    const float3 vertices[3] = {t->a, t->b, t->c};
    for (int i = 0; i < 3; ++i) {
        int sign;
        if (!is_sign_told(u1, u0, v1, v0, vertices[i], w0, &sign) || sign * side > 0) return false;
    }
    return true;
}

// Has `other` nothing above the plane of t, which the light sees from `side`? With the side's sign turned: below?
static bool has_none_above(const Triangle* other, const Triangle* t, int side) {
    return has_none_beyond(other, t->b, t->a, t->c, t->a, t->a, side);
}

// Does the light see `other` beyond one of t's edges, or on it? A point p is beyond the edge from e to f if
// det(f - e, D, p - e) has the sign of n . D: the third vertex has the other one.
static bool is_beyond_an_edge(const Triangle* other, const Triangle* t, int side, float3 towards_light) {
    const float3 edges[4] = {t->a, t->b, t->c, t->a};
    for (int i = 0; i < 3; ++i)
        if (has_none_beyond(other, edges[i + 1], edges[i], towards_light, (float3)(0.0f), edges[i], -side)) return true;
    return false;
}

// False if t blocks no point in the interior of `receiver`, of which `side` is the light's.
static bool may_shadow(const Triangle* t, const Triangle* receiver, int side, float3 towards_light) {
    if (has_none_above(t, receiver, side) || is_beyond_an_edge(t, receiver, side, towards_light)) return false;
    int own_side = told_side(t, towards_light);
    if (own_side == 0) return true;
    return !has_none_above(receiver, t, -own_side) && !is_beyond_an_edge(receiver, t, own_side, towards_light);
}

typedef struct LitLists {
    __global const uint2* ranges;
    __global const BinEntries* entries;
    __global const TriangleBounds* bounds;  // of the records, for their ids
    __global const float* vertices;         // from the first triangle on
} LitLists;

// Work of an item, beyond which a receiver is not found to be lit.
#define LIT_MOST_BINS 128u
#define LIT_MOST_TESTS 64u

// How many triangles an item has asked of a receiver, and the last few, which neighbouring bins mostly share.
typedef struct LitTests {
    uint count;
    uint4 last;
} LitTests;

// A triangle that is asked whether it is lit, its `side` of the light, and the place that others may shadow it in.
typedef struct LitQuestion {
    Triangle receiver;
    float3 towards_light;
    QuantisedBlock around;
    uint id;
    int side;
} LitQuestion;

// Of one bin's list.
static bool any_may_shadow(const LitLists* lists, uint bin, const LitQuestion* question, LitTests* tests) {
    uint2 range = lists->ranges[bin];
    for (uint i = range.x; i < range.y; ++i) {
        uint meeting = entries_that_meet(&lists->entries[i], question->around);
        while (meeting != 0u) {
            uint other = lists->bounds[ENTRY_SLOT(&lists->entries[i], take_lowest_bit(&meeting))].id;
            if (other == question->id || any(tests->last == other)) continue;
            Triangle t = load_triangle(lists->vertices, other);
            if (++tests->count > LIT_MOST_TESTS) return true;
            if (may_shadow(&t, &question->receiver, question->side, question->towards_light)) return true;
            tests->last = (uint4)(other, tests->last.xyz);
        }
    }
    return false;
}

static uint bin_of_quantised(ushort q, uint texels, uint bin_log2) {
    LaneInt bins = bins_of_quantised((LaneInt)(q), texels, bin_log2);
    return (uint)LANE_OF_INT(bins, 0);
}

// A sample of records: one of each `step` in a row, not always the same, since neighbours follow a pattern.
static uint sampled(uint i, uint step) { return i * step + ((i * 2654435761u) >> 16) % step; }

// Sets the bits of a sample's triangles.
__kernel void unshadowed_candidates(uint record_count, uint step, __global const TriangleBounds* bounds,
                                    volatile __global uint* lit) {
    GN_FOR_EACH(i, record_count / step) {
        uint id = bounds[sampled((uint)i, step)].id;
        atomic_or(&lit[id / UNSHADOWED_WORD_BITS], lit_bit(id));
    }
}

// Of the same sample, clears the bits of those that may be shadowed.
__kernel void unshadowed_triangles(LightFrame light_frame, __constant const Projection* projection, ulong first_float,
                                   uint record_count, uint step, __global const float* vertices,
                                   __global const uint2* ranges, __global const BinEntries* entries,
                                   __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                                   volatile __global uint* lit) {
    LitLists lists = {ranges, entries, bounds, vertices + first_float};
    GN_FOR_EACH(i, (size_t)(record_count / step) * UNSHADOWED_TEAM) {
        uint slot = sampled((uint)(i / UNSHADOWED_TEAM), step), member = (uint)(i % UNSHADOWED_TEAM);
        TriangleBounds own = bounds[slot];
        uint x0 = bin_of_quantised(own.x0, projection->width, projection->bin_log2);
        uint y0 = bin_of_quantised(own.y0, projection->height, projection->bin_log2);
        uint x1 = bin_of_quantised(own.x1, projection->width, projection->bin_log2);
        uint y1 = bin_of_quantised(own.y1, projection->height, projection->bin_log2);
        uint width = x1 - x0 + 1u, bin_count = width * (y1 - y0 + 1u);
        uint each = (bin_count + UNSHADOWED_TEAM - 1u) / UNSHADOWED_TEAM, end = min((member + 1u) * each, bin_count);
        LitQuestion question;
        question.receiver = load_triangle(lists.vertices, own.id);
        question.towards_light = light_of(light_frame).xyz;
        QuantisedBlock around = {own.x0, own.y0, own.x1, own.y1,
                                 quantised_height(records[slot].z_low, projection->z_origin, projection->z_scale)};
        question.around = around;
        question.id = own.id;
        question.side = told_side(&question.receiver, question.towards_light);
        LitTests tests = {0u, (uint4)(own.id)};
        volatile __global uint* word = &lit[own.id / UNSHADOWED_WORD_BITS];
        bool shadowed = question.side == 0 || each > LIT_MOST_BINS;
        for (uint b = member * each; b < end && !shadowed; ++b) {
            if ((GN_RELAXED_LOAD(word) & lit_bit(own.id)) == 0u) break;  // another member knows
            uint bin = (y0 + b / width) * projection->bins_x + x0 + b % width;
            shadowed = any_may_shadow(&lists, bin, &question, &tests);
        }
        if (shadowed) atomic_and(word, ~lit_bit(own.id));
    }
}
