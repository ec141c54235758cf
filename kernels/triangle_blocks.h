// SPDX-License-Identifier: MIT
// Triangles as the setup takes them: GN_LANES at a time, a coordinate in one vector each; and their projection with the
// bounds of its errors (projection.h).
#ifndef GN_TRIANGLE_BLOCKS_H
#define GN_TRIANGLE_BLOCKS_H

#include "point_blocks.h"
#include "projection.h"

// Functions take blocks by pointer: what PoCL does not inline it would copy, byte by byte.
typedef struct TriangleBlock {
    PointBlock a, b, c;
} TriangleBlock;

static PointBlock same_point(float x, float y, float z) {
    PointBlock p = {(LaneFloat)(x), (LaneFloat)(y), (LaneFloat)(z)};
    return p;
}

// Those whose nine floats begin at rows[lane].
static TriangleBlock load_triangle_rows(__global const float* const* rows) {
    TriangleBlock t;
    t.a.x = LANES_OF_ROWS(rows, 0), t.a.y = LANES_OF_ROWS(rows, 1), t.a.z = LANES_OF_ROWS(rows, 2);
    t.b.x = LANES_OF_ROWS(rows, 3), t.b.y = LANES_OF_ROWS(rows, 4), t.b.z = LANES_OF_ROWS(rows, 5);
    t.c.x = LANES_OF_ROWS(rows, 6), t.c.y = LANES_OF_ROWS(rows, 7), t.c.z = LANES_OF_ROWS(rows, 8);
    return t;
}

// `first` and those that follow; lanes past the last of `count` repeat it.
static TriangleBlock load_triangles(__global const float* vertices, size_t first, uint count) {
    __global const float* v = vertices + 9 * first;
    if (count - first >= GN_LANES) {
        TriangleBlock t;
        t.a.x = LANES_STRIDED(v, 9), t.a.y = LANES_STRIDED(v + 1, 9), t.a.z = LANES_STRIDED(v + 2, 9);
        t.b.x = LANES_STRIDED(v + 3, 9), t.b.y = LANES_STRIDED(v + 4, 9), t.b.z = LANES_STRIDED(v + 5, 9);
        t.c.x = LANES_STRIDED(v + 6, 9), t.c.y = LANES_STRIDED(v + 7, 9), t.c.z = LANES_STRIDED(v + 8, 9);
        return t;
    }
    __global const float* rows[GN_LANES];
    for (uint lane = 0; lane < GN_LANES; ++lane) rows[lane] = v + 9 * min((size_t)lane, (size_t)count - 1u - first);
    return load_triangle_rows(rows);
}

// One triangle in all lanes.
static TriangleBlock same_triangle(Triangle one) {
    TriangleBlock t = {same_point(one.a.x, one.a.y, one.a.z), same_point(one.b.x, one.b.y, one.b.z),
                       same_point(one.c.x, one.c.y, one.c.z)};
    return t;
}

// Lanes that are not `asked`, of which there is one at least, take the number of one that is. True if all are the same.
static bool repeat_asked(LaneInt* ids, LaneInt asked) {
    LaneInt first = (LaneInt)(LANE_OF_INT(*ids, first_lane(asked)));
    *ids = LANES_SELECT(first, *ids, asked);
    return !LANES_ANY(LANE_COMPARE(*ids, !=, first));
}

// Those of these numbers; lanes that are not `asked` repeat one that is.
static TriangleBlock load_triangles_of(__global const float* vertices, LaneInt ids, LaneInt asked) {
    if (repeat_asked(&ids, asked)) return same_triangle(load_triangle(vertices, (uint)LANE_OF_INT(ids, 0)));
    __global const float* rows[GN_LANES];
    for (int lane = 0; lane < GN_LANES; ++lane) rows[lane] = vertices + 9 * (size_t)(uint)LANE_OF_INT(ids, lane);
    return load_triangle_rows(rows);
}

static Triangle lane_triangle(const TriangleBlock* t, int lane) {
    Triangle triangle = {lane_point(t->a, lane), lane_point(t->b, lane), lane_point(t->c, lane)};
    return triangle;
}

static LaneInt largest_triangle_bits(const TriangleBlock* t) {
    return max(max(largest_size_bits(t->a), largest_size_bits(t->b)), largest_size_bits(t->c));
}
static LaneInt finite_triangles(const TriangleBlock* t) {
    return LANE_COMPARE(largest_triangle_bits(t), <, (LaneInt)(BITS_OF_INFINITY));
}

static PointBlock difference(PointBlock a, PointBlock b) {
    PointBlock d = {a.x - b.x, a.y - b.y, a.z - b.z};
    return d;
}
static PointBlock magnitudes(PointBlock a) {
    PointBlock size = {fabs(a.x), fabs(a.y), fabs(a.z)};
    return size;
}
static LaneFloat largest_of(PointBlock v) {
    PointBlock size = magnitudes(v);
    LaneFloat largest = LANES_MAX(size.x, size.y);
    return LANES_MAX(size.z, largest);
}

// Projected positions before the division, and the bounds of the errors of their coordinates.
typedef struct Projected {
    LaneFloat x, y, w, z;
    LaneFloat error;    // of x and y
    LaneFloat error_w;  // of w
    LaneFloat error_z;  // of z (parallel only; in perspective z is made from w)
} Projected;

// Of the magnitudes of d.
static LaneFloat lanes_row_size(__constant const float* row, PointBlock size) {
    float row_sum = fabs(row[0]) + fabs(row[1]) + fabs(row[2]);
    LaneFloat sum = size.x + size.y + size.z;
    return size.x * fabs(row[0]) + size.y * fabs(row[1]) + size.z * fabs(row[2]) + fabs(row[3]) +
           sum * (0x1p-20f * row_sum);
}

// Of the vertices of GN_LANES hulls. An error grows with the magnitudes of d = vertex - center (lanes_row_size is
// monotone in each, roundings included), so the largest of each coordinate give one bound for all vertices of a hull.
GN_WITHIN void project_hulls(__constant const Projection* projection, const PointBlock* world, int count,
                             Projected* v) {
    float3 center = center_of(projection);
    PointBlock middle = same_point(center.x, center.y, center.z), largest = same_point(0.0f, 0.0f, 0.0f);
    for (int i = 0; i < count; ++i) {
        PointBlock d = difference(world[i], middle), size = magnitudes(d);
        v[i].x = lanes_row_dot(projection->row_x, d);
        v[i].y = lanes_row_dot(projection->row_y, d);
        v[i].z = lanes_row_dot(projection->row_z, d);
        largest.x = LANES_MAX(size.x, largest.x);
        largest.y = LANES_MAX(size.y, largest.y);
        largest.z = LANES_MAX(size.z, largest.z);
    }
    LaneFloat size_x = lanes_row_size(projection->row_x, largest), size_y = lanes_row_size(projection->row_y, largest);
    LaneFloat error = LANES_MAX(size_x, size_y) * PROJECTION_ERROR + PROJECTION_UNDERFLOW;
    LaneFloat depth_error = lanes_row_size(projection->row_z, largest) * PROJECTION_ERROR + PROJECTION_UNDERFLOW;
    const LaneFloat zero = (LaneFloat)(0.0f), one = (LaneFloat)(1.0f);
    for (int i = 0; i < count; ++i) {
        v[i].error = error;
        v[i].w = IS_PERSPECTIVE(*projection) ? v[i].z : one;
        v[i].error_w = IS_PERSPECTIVE(*projection) ? depth_error : zero;
        v[i].error_z = IS_PERSPECTIVE(*projection) ? zero : depth_error;
        if (IS_PERSPECTIVE(*projection)) v[i].z = one / v[i].w;
    }
}

#endif
