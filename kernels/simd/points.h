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

// An implicit raster in place of such floats (gnomon/inputs.hpp, Raster), in a buffer of triangles: this head, then the
// x of the columns, the y of the rows, and the heights row by row.
GN_STRUCT_BEGIN(RasterHead)
    uint columns, rows;       // of vertices
    uint joins_first_corner;  // 1: diagonals join (row, column) and (row + 1, column + 1)
    uint is_mirrored;         // 1: x and y both rise, or both fall, with their indices
GN_STRUCT_END(RasterHead, 16)
#define RASTER_HEAD_FLOATS 4u

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

// Vertex `corner` of a raster's square, whose first vertex stands at (row, column): bit 0 is the next column, bit 1 the
// next row.
static float3 raster_vertex(__global const float* raster, uint row, uint column, uint corner) {
    __global const RasterHead* head = (__global const RasterHead*)raster;
    __global const float* x = raster + RASTER_HEAD_FLOATS;
    __global const float* y = x + head->columns;
    row += corner >> 1, column += corner & 1u;
    return (float3)(x[column], y[row], y[head->rows + row * (size_t)head->columns + column]);
}

// The first or the second triangle of a raster's square.
static Triangle raster_triangle(__global const float* raster, uint row, uint column, uint second) {
    __global const RasterHead* head = (__global const RasterHead*)raster;
    bool joins_first = head->joins_first_corner != 0u, is_mirrored = head->is_mirrored != 0u;
    float3 a = raster_vertex(raster, row, column, joins_first && second != 0u ? 3u : 2u);
    float3 b = raster_vertex(raster, row, column, second != 0u ? 1u : 3u);
    float3 c = raster_vertex(raster, row, column, joins_first || second != 0u ? 0u : 1u);
    return (Triangle){a, is_mirrored ? c : b, is_mirrored ? b : c};
}

#ifdef GN_RASTER
static Triangle load_triangle(__global const float* raster, size_t id) {
    uint squares = ((__global const RasterHead*)raster)->columns - 1u, square = (uint)(id >> 1);
    return raster_triangle(raster, square / squares, square % squares, (uint)id & 1u);
}
#else
static Triangle load_triangle(__global const float* vertices, size_t id) {
    __global const float* v = vertices + 9 * id;
    return (Triangle){(float3)(v[0], v[1], v[2]), (float3)(v[3], v[4], v[5]), (float3)(v[6], v[7], v[8])};
}
#endif

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
