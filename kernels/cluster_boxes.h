// SPDX-License-Identifier: MIT
// Boxes around clusters of triangles (clusters.h): how they are made, and which of them can matter to a projection. A
// box is the hull of its eight corners, and what a hull does not cover its triangles do not cover (hull_bounds.h).
#ifndef GN_CLUSTER_BOXES_H
#define GN_CLUSTER_BOXES_H

#include "clusters.h"
#include "hull_bounds.h"

// ---- Boxes ----------------------------------------------------------------------------------------------------------

// Signed integers in the order of the floats, as lanes_in_order(); it is its own inverse. NaN of either sign and
// infinities lie outside the finite numbers.
#define IN_ORDER(bits) ((bits) ^ (((bits) >> 31) & 0x7FFFFFFF))
#define LEAST_FINITE_IN_ORDER IN_ORDER((int)0xFF7FFFFF)
#define MOST_FINITE_IN_ORDER 0x7F7FFFFF
// The infinities.
#define LEAST_IN_ORDER IN_ORDER((int)0xFF800000)
#define MOST_IN_ORDER 0x7F800000

typedef struct Box {
    int low[3], high[3];  // in order
    int not_finite;
} Box;

static Box empty_box(void) {
    Box box;
    for (int c = 0; c < 3; ++c) {
        box.low[c] = MOST_IN_ORDER;
        box.high[c] = LEAST_IN_ORDER;
    }
    box.not_finite = 0;
    return box;
}

static void include_coordinate(Box* box, uint c, int low, int high) {
    box->low[c] = min(box->low[c], low);
    box->high[c] = max(box->high[c], high);
}

// The least of each coordinate, of as many lanes of x y z x y z ...
#if GN_LANES == 1
#define LOAD_LANES(bits, i) ((bits)[i])
static int3 least_of_points(LaneInt a, LaneInt b, LaneInt c) { return (int3)(a, b, c); }
#else
#define LOAD_LANES(bits, i) vload16(0, (bits) + (i))
static int3 least_of_points(LaneInt a, LaneInt b, LaneInt c) {
    int8 a8 = min(a.lo, b.hi), b8 = min(a.hi, c.lo), c8 = min(b.lo, c.hi);
    int4 a4 = min(a8.lo, b8.hi), b4 = min(a8.hi, c8.lo), c4 = min(b8.lo, c8.hi);
    return min(min(a4.xyz, (int3)(a4.w, b4.xy)), min((int3)(b4.zw, c4.x), c4.yzw));
}
#endif

// The bounds of some lanes.
typedef struct LaneBounds {
    LaneInt low, high;
} LaneBounds;

static LaneBounds no_bounds(void) {
    LaneBounds bounds = {(LaneInt)(MOST_IN_ORDER), (LaneInt)(LEAST_IN_ORDER)};
    return bounds;
}

static void include_lanes(LaneBounds* bounds, LaneInt bits) {
    LaneInt order = IN_ORDER(bits);
    bounds->low = min(bounds->low, order);
    bounds->high = max(bounds->high, order);
}

// Around all of these coordinates, xyzxyz.., finite or not.
static Box box_of_coordinates(__global const int* bits, uint count) {
    LaneBounds a = no_bounds(), b = no_bounds(), c = no_bounds();
    uint i = 0;
    for (; i + 3u * GN_LANES <= count; i += 3u * GN_LANES) {
        include_lanes(&a, LOAD_LANES(bits, i));
        include_lanes(&b, LOAD_LANES(bits, i + GN_LANES));
        include_lanes(&c, LOAD_LANES(bits, i + 2u * GN_LANES));
    }
    int3 least = least_of_points(a.low, b.low, c.low), most = ~least_of_points(~a.high, ~b.high, ~c.high);
    Box box = {{least.x, least.y, least.z}, {most.x, most.y, most.z}, 0};
    for (; i < count; ++i) include_coordinate(&box, i % 3u, IN_ORDER(bits[i]), IN_ORDER(bits[i]));
    return box;
}

static bool is_finite_box(const Box* box) {
    bool is_finite = true;
    for (int c = 0; c < 3; ++c)
        is_finite = is_finite && box->low[c] >= LEAST_FINITE_IN_ORDER && box->high[c] <= MOST_FINITE_IN_ORDER;
    return is_finite;
}

// Around the triangles that are finite.
static Box box_of_finite(__global const float* vertices, uint count) {
    Box box = empty_box();
    for (uint t = 0; t < count; ++t) {
        if (!is_finite_triangle(load_triangle(vertices, t))) {
            ++box.not_finite;
            continue;
        }
        for (uint i = 0; i < 9u; ++i) {
            int order = IN_ORDER(as_int(vertices[9u * t + i]));
            include_coordinate(&box, i % 3u, order, order);
        }
    }
    return box;
}

// Of GN_LANES clusters in a row; `vertices` of the scene's first triangle.
static void make_boxes(__global const float* vertices, uint triangle_count, size_t first_cluster, ClusterBoxes* boxes) {
    for (uint lane = 0; lane < GN_LANES; ++lane) {
        size_t first = (first_cluster + lane) * CLUSTER_TRIANGLES;
        uint count = first < triangle_count ? min(triangle_count - (uint)first, CLUSTER_TRIANGLES) : 0u;
        __global const float* mine = vertices + 9u * first;
        Box box = box_of_coordinates((__global const int*)mine, 9u * count);
        if (!is_finite_box(&box) && count != 0u) box = box_of_finite(mine, count);
        for (int c = 0; c < 3; ++c) {
            LANE_OF_FLOAT(boxes->low[c], lane) = as_float(IN_ORDER(box.low[c]));
            LANE_OF_FLOAT(boxes->high[c], lane) = as_float(IN_ORDER(box.high[c]));
        }
        LANE_OF_INT(boxes->not_finite, lane) = box.not_finite;
    }
}

// ---- Which of them matter -------------------------------------------------------------------------------------------

static void project_corners(const ClusterBoxes* boxes, __constant const Projection* projection, Projected* v) {
    PointBlock corners[8];
    for (int corner = 0; corner < 8; ++corner) {
        PointBlock p = {(corner & 1) ? boxes->high[0] : boxes->low[0], (corner & 2) ? boxes->high[1] : boxes->low[1],
                        (corner & 4) ? boxes->high[2] : boxes->low[2]};
        corners[corner] = p;
    }
    project_hulls(projection, corners, 8, v);
}

// Which of these boxes can matter, and which only the pyramid rules out (ignored unless `has_pyramid`).
static LaneInt boxes_that_matter(const ClusterBoxes* boxes, LaneInt lanes, __constant const Projection* projection,
                                 __global const uint* pyramid, bool has_pyramid, LaneInt* too_far) {
    *too_far = (LaneInt)(0);
    if (projection->indistinct) return lanes;
    Projected v[8];
    project_corners(boxes, projection, v);
    HullSides sides = sides_of_hulls(v, 8, projection);
    Rectangles rectangle;
    LaneInt inside = lanes & ~sides.wild & ~sides.behind;
    inside &= covered_rectangles(v, 8, projection, &rectangle);
    if (has_pyramid && LANES_ANY(inside)) {
        LaneFloat z_low, z_high;
        height_intervals(v, 8, sides.straddles, projection, &z_low, &z_high);
        *too_far = lanes_hidden(rectangle, z_high, inside, projection, pyramid);
    }
    return (lanes & sides.wild) | (inside & ~*too_far);
}

#endif
