// SPDX-License-Identifier: MIT
// Shading points as the caller or the camera stage lays them out, and triangles as nine floats each.
#pragma once

#include "prelude.h"

// Coordinate c of point i: positions[first + i * point_stride + c * coordinate_stride].
GN_STRUCT_BEGIN(PointsLayout)
    uint first;
    uint point_stride;
    uint coordinate_stride;
    uint count;
    uint has_receivers;  // 0: the receivers buffer is a dummy
    uint has_eye;        // 1: the eye is known, and its side of the receivers decides backfacing
    float eye[2 + 1];
    uint picture_width;  // a multiple of 4: the points are whole rows of pictures, each a multiple of 4 rows; else 0
    uint is_lifted;      // 1: the camera stage made points from these triangles: with an eye; none may shadow itself
    uint padding;
GN_STRUCT_END(PointsLayout, 48)

// Triangle i: the nine floats from vertices[first_float + 9 * i] on.
GN_STRUCT_BEGIN(TrianglesLayout)
    ulong first_float;
    uint count;
    uint padding;
GN_STRUCT_END(TrianglesLayout, 16)

#ifndef __cplusplus

static float3 load_point(__global const float* positions, PointsLayout layout, size_t i) {
    size_t at = layout.first + i * layout.point_stride;
    return (float3)(positions[at], positions[at + layout.coordinate_stride],
                    positions[at + 2 * (size_t)layout.coordinate_stride]);
}

static float3 eye_of(PointsLayout layout) { return (float3)(layout.eye[0], layout.eye[1], layout.eye[2]); }

// An absent point (NaN or infinite): the sky of a view, or a caller's hole.
static bool is_present(float3 p) { return GN_FINITE(p.x) && GN_FINITE(p.y) && GN_FINITE(p.z); }

typedef struct Triangle {
    float3 a, b, c;
} Triangle;

// The corners of a triangle's box.
static float3 low_of(Triangle t) { return fmin(fmin(t.a, t.b), t.c); }
static float3 high_of(Triangle t) { return fmax(fmax(t.a, t.b), t.c); }

static Triangle load_triangle(__global const float* vertices, size_t id) {
    __global const float* v = vertices + 9 * id;
    return (Triangle){(float3)(v[0], v[1], v[2]), (float3)(v[3], v[4], v[5]), (float3)(v[6], v[7], v[8])};
}

// The triangles of a launch.
typedef struct Triangles {
    __global const float* vertices;  // from the first triangle on
    uint count;
} Triangles;

static Triangles triangles_of(__global const float* vertices, TrianglesLayout layout) {
    return (Triangles){vertices + layout.first_float, layout.count};
}

static bool is_finite_triangle(Triangle t) { return is_present(t.a) && is_present(t.b) && is_present(t.c); }

#endif
