// SPDX-License-Identifier: MIT
// Clusters: boxes around triangles that follow each other (once for a scene that does not change), and which of them
// can matter to a projection (in every run). The tests are triangle_bounds' own, asked of a box: nothing is dropped
// unless it lies behind the light or outside the grid, or is farther from the light than every point it could cover. A
// box is the hull of its eight corners, and what a hull does not cover its triangles do not cover (hull_bounds.h).
#include "clusters.h"
#include "group_scan.h"
#include "hull_bounds.h"

// ---- Boxes ----------------------------------------------------------------------------------------------------------

// Signed integers in the order of the floats, as lanes_in_order(); it is its own inverse. NaN of either sign and
// infinities lie outside the finite numbers.
#define IN_ORDER(bits) ((bits) ^ (((bits) >> 31) & 0x7FFFFFFF))
#define LEAST_FINITE_IN_ORDER IN_ORDER((int)0xFF7FFFFF)
#define MOST_FINITE_IN_ORDER 0x7F7FFFFF

typedef struct Box {
    int low[3], high[3];  // in order
    int not_finite;
} Box;

static Box empty_box(void) {
    Box box;
    for (int c = 0; c < 3; ++c) {
        box.low[c] = IN_ORDER(as_int(INFINITY));
        box.high[c] = IN_ORDER(as_int(-INFINITY));
    }
    box.not_finite = 0;
    return box;
}

static void include_coordinate(Box* box, uint c, int low, int high) {
    box->low[c] = min(box->low[c], low);
    box->high[c] = max(box->high[c], high);
}

#if GN_LANES == 1
#define LOAD_LANES(bits, i) ((bits)[i])
#else
#define LOAD_LANES(bits, i) vload16(0, (bits) + (i))
#endif

// Around all of these coordinates, xyzxyz.., finite or not: as the loads take them, whose lane k holds coordinate
// (i + k) % 3 of a vertex.
static Box box_of_coordinates(__global const int* bits, uint count) {
    Box box = empty_box();
    LaneInt low[3], high[3];
    for (int j = 0; j < 3; ++j) {
        low[j] = (LaneInt)(INT_MAX);
        high[j] = (LaneInt)(INT_MIN);
    }
    uint i = 0;
    for (; i + 3u * GN_LANES <= count; i += 3u * GN_LANES)
        for (uint j = 0; j < 3u; ++j) {
            LaneInt order = LOAD_LANES(bits, i + j * GN_LANES);
            order = IN_ORDER(order);
            low[j] = min(low[j], order);
            high[j] = max(high[j], order);
        }
    for (uint j = 0; j < 3u; ++j)
        for (uint lane = 0; lane < GN_LANES; ++lane)
            include_coordinate(&box, (j * GN_LANES + lane) % 3u, LANE_OF_INT(low[j], lane), LANE_OF_INT(high[j], lane));
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

__kernel void make_clusters(uint triangle_count, ulong first_float, uint cluster_count, __global const float* vertices,
                            __global ClusterBoxes* boxes) {
    GN_FOR_EACH(block, (cluster_count + GN_LANES - 1u) / GN_LANES) {
        for (uint lane = 0; lane < GN_LANES; ++lane) {
            size_t first = (block * GN_LANES + lane) * CLUSTER_TRIANGLES;
            uint count = first < triangle_count ? min(triangle_count - (uint)first, CLUSTER_TRIANGLES) : 0u;
            __global const float* mine = vertices + first_float + 9u * first;
            Box box = box_of_coordinates((__global const int*)mine, 9u * count);
            if (!is_finite_box(&box) && count != 0u) box = box_of_finite(mine, count);
            for (int c = 0; c < 3; ++c) {
                ((__global int*)&boxes[block].low[c])[lane] = IN_ORDER(box.low[c]);
                ((__global int*)&boxes[block].high[c])[lane] = IN_ORDER(box.high[c]);
            }
            ((__global int*)&boxes[block].not_finite)[lane] = box.not_finite;
        }
    }
}

// ---- Order ----------------------------------------------------------------------------------------------------------

// Two zeros between each two bits.
static uint spread_bits(uint x) {
    x = (x | x << 16) & 0x030000FFu;
    x = (x | x << 8) & 0x0300F00Fu;
    x = (x | x << 4) & 0x030C30C3u;
    return (x | x << 2) & 0x09249249u;
}

// The middle of three coordinates' interval, as a part of the code. No sum here can overflow.
static uint code_of_middle(float a, float b, float c, float origin, float scale) {
    float half_low = fmin(fmin(a, b), c) * 0.5f, half_high = fmax(fmax(a, b), c) * 0.5f;
    float place = ((half_low + half_high) * 0.5f - origin) * scale;
    return spread_bits((uint)clamp(place, 0.0f, (float)((1u << CLUSTER_CODE_BITS) - 1u)));
}

__kernel void cluster_codes(ClusterGrid grid, uint triangle_count, ulong first_float, __global const float* vertices,
                            __global uint* codes, __global uint* numbers) {
    GN_FOR_EACH(i, triangle_count) {
        Triangle t = load_triangle(vertices + first_float, (uint)i);
        uint code = GN_NO_ID;
        if (is_finite_triangle(t))
            code = code_of_middle(t.a.x, t.b.x, t.c.x, grid.origin[0], grid.scale) |
                   code_of_middle(t.a.y, t.b.y, t.c.y, grid.origin[1], grid.scale) << 1 |
                   code_of_middle(t.a.z, t.b.z, t.c.z, grid.origin[2], grid.scale) << 2;
        codes[i] = code;
        numbers[i] = (uint)i;
    }
}

__kernel void cluster_gather(uint triangle_count, ulong first_float, __global const float* vertices,
                             __global const uint* numbers, __global float* gathered) {
    GN_FOR_EACH(i, triangle_count) {
        __global const float* from = vertices + first_float + 9 * (size_t)numbers[i];
        for (uint k = 0; k < 9u; ++k) gathered[9 * i + k] = from[k];
    }
}

// ---- Which of them matter -------------------------------------------------------------------------------------------

static void project_corners(__global const ClusterBoxes* boxes, __constant const Projection* projection, Projected* v) {
    PointBlock corners[8];
    for (int corner = 0; corner < 8; ++corner) {
        PointBlock p = {(corner & 1) ? boxes->high[0] : boxes->low[0], (corner & 2) ? boxes->high[1] : boxes->low[1],
                        (corner & 4) ? boxes->high[2] : boxes->low[2]};
        corners[corner] = p;
    }
    project_hulls(projection, corners, 8, v);
}

// Which of these boxes can matter, and which only the pyramid rules out (ignored unless `has_pyramid`).
static LaneInt boxes_that_matter(__global const ClusterBoxes* boxes, LaneInt lanes,
                                 __constant const Projection* projection, __global const uint* pyramid,
                                 bool has_pyramid, LaneInt* too_far) {
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

// Lists the clusters that can matter; the triangles of the others are counted here as triangle_bounds would.
__kernel void cull_clusters(__constant const Projection* projection, uint triangle_count, uint cluster_count,
                            uint has_pyramid, __global const ClusterBoxes* boxes, __global const uint* pyramid,
                            __global uint* listed, __global FrameCounters* counters) {
    __local uint sum;
    uint outside = 0, too_far = 0, triangles_outside = 0, triangles_not_finite = 0;
    uint blocks = projection->active_points == 0u ? 0u : (cluster_count + GN_LANES - 1u) / GN_LANES;
    GN_FOR_EACH(block, blocks) {
        LaneInt clusters = (LaneInt)((int)block * GN_LANES) + LANE_INDEX;
        LaneInt present = LANE_COMPARE(boxes[block].low[0], <=, boxes[block].high[0]);
        LaneInt far, matter = boxes_that_matter(&boxes[block], present, projection, pyramid, has_pyramid != 0u, &far);
        outside += count_lanes(present & ~matter & ~far);
        too_far += count_lanes(far);
        LaneInt left_out = boxes[block].not_finite;
        uint place = 0, wanted = count_lanes(matter);
        if (wanted != 0u) place = atomic_add(&counters->clusters_listed, wanted);
        for (int lane = 0; lane < GN_LANES; ++lane) {
            uint cluster = (uint)LANE_OF_INT(clusters, lane);
            if (LANE_OF_INT(matter, lane)) {
                listed[place++] = cluster;
            } else if (cluster < cluster_count) {
                uint mine = min(triangle_count - cluster * CLUSTER_TRIANGLES, CLUSTER_TRIANGLES);
                triangles_not_finite += (uint)LANE_OF_INT(left_out, lane);
                triangles_outside += mine - (uint)LANE_OF_INT(left_out, lane);
            }
        }
    }
    add_in_group(outside, &sum, &counters->clusters_outside);
    add_in_group(too_far, &sum, &counters->clusters_too_far);
    add_in_group(triangles_not_finite, &sum, &counters->not_finite);
    add_in_group(triangles_outside, &sum, &counters->outside);
}
