// SPDX-License-Identifier: MIT
// Turns a tree to a light (light_tree.h): the leaves, then the nodes level by level upwards. Lanes are triangles.
#include "shafts/light_tree.h"
#include "shafts/shaft_test.clh"

#if GN_LANES > 1
#define STORE_ROW(v, row) vstore16(v, 0, row)
#define IS_WRITER true
// Of a node's children.
#define FOR_EACH_CHILD(k) for (uint k = 0; k < SHAFT_WIDTH; ++k)
#define LEAST_OF_ROW(row) LANES_LEAST(vload16(0, row))
#define GREATEST_OF_ROW(row) (-LANES_LEAST(-vload16(0, row)))
#else
#define STORE_ROW(v, row) (row)[get_local_id(0)] = (v)
#define IS_WRITER (get_local_id(0) == 0)
#define FOR_EACH_CHILD(k) for (uint k = get_local_id(0); k < SHAFT_WIDTH; k += SHAFT_WIDTH)
#define LEAST_OF_ROW(row) least_of_row(row)
#define GREATEST_OF_ROW(row) greatest_of_row(row)
static float least_of_row(__global const float* row) {
    float least = row[0];
    for (uint k = 1; k < SHAFT_WIDTH; ++k) least = fmin(least, row[k]);
    return least;
}
static float greatest_of_row(__global const float* row) {
    float greatest = row[0];
    for (uint k = 1; k < SHAFT_WIDTH; ++k) greatest = fmax(greatest, row[k]);
    return greatest;
}
#endif

// Of all corners of a leaf; absent triangles do not count.
typedef struct LeafExtent {
    float low, high;
} LeafExtent;

GN_INLINE_ON_CPU LeafExtent extent_of(LaneFloat a, LaneFloat b, LaneFloat c, LaneInt is_present SHARED_PARAMETER) {
    LaneFloat least = LANES_MIN(a, b), greatest = LANES_MAX(a, b);
    least = LANES_MIN(least, c);
    greatest = LANES_MAX(greatest, c);
    LeafExtent extent;
    extent.low = -SHAFT_LARGEST(LANES_SELECT((LaneFloat)(-INFINITY), -least, is_present));
    extent.high = SHAFT_LARGEST(LANES_SELECT((LaneFloat)(-INFINITY), greatest, is_present));
    return extent;
}

__kernel void light_leaves(const LightTreeParams params, __global const float* leaves, __global float* light_leaves,
                           __local uint* shared) {
    SHAFT_FOR_EACH(leaf, params.count) {
        __global const float* corners = leaves + leaf * (SHAFT_LEAF_ROWS * SHAFT_WIDTH);
        __global float* header = light_leaves + leaf * (LIGHT_LEAF_ROWS * SHAFT_WIDTH);
        PointBlock a = load_corner(corners, 0u), b = load_corner(corners, 1u), c = load_corner(corners, 2u);
        LaneInt is_present = LANE_COMPARE(a.x, ==, a.x);
        LeafExtent x = extent_of(a.x, b.x, c.x, is_present SHARED), y = extent_of(a.y, b.y, c.y, is_present SHARED);
        LeafExtent z = extent_of(a.z, b.z, c.z, is_present SHARED);
        float3 origin = (float3)(x.low, y.low, z.low);
        uint present = SHAFT_BITS(is_present);
        if (IS_WRITER) {
            vstore3(origin, 0, header);
            header[LIGHT_LEAF_SIZE] = (x.high - x.low) + (y.high - y.low) + (z.high - z.low);
            ((__global uint*)header)[LIGHT_LEAF_PRESENT] = present;
        }
        PointBlock from = same_in_lanes(origin);
        a = lanes_difference(a, from), b = lanes_difference(b, from), c = lanes_difference(c, from);
        const float* const axes[3] = {params.axes.u, params.axes.v, params.axes.w};
        for (uint k = 0; k < 3u; ++k) {
            float3 axis = vload3(0, axes[k]);
            LaneFloat at_a = lanes_along(axis, a), at_b = lanes_along(axis, b), at_c = lanes_along(axis, c);
            __global float* row = header + (1u + k) * SHAFT_WIDTH;
            STORE_ROW(at_a, row);
            STORE_ROW(at_b, row + 3u * SHAFT_WIDTH);
            STORE_ROW(at_c, row + 6u * SHAFT_WIDTH);
            LeafExtent extent = extent_of(at_a, at_b, at_c, is_present SHARED);
            float from_zero = along_axis(axes[k], origin);
            if (IS_WRITER) {
                header[LIGHT_LEAF_BOX + 2u * k] = from_zero + extent.low;
                header[LIGHT_LEAF_BOX + 2u * k + 1u] = from_zero + extent.high;
            }
        }
    }
}

__kernel void light_nodes(const LightTreeParams params, __global const float* nodes, __global const float* light_leaves,
                          __global float* light_nodes) {
    SHAFT_FOR_EACH(i, params.count) {
        size_t index = params.first + i;
        __global const uint* codes =
            (__global const uint*)(nodes + index * (SHAFT_NODE_ROWS * SHAFT_WIDTH) + SHAFT_CODES);
        __global float* node = light_nodes + index * (LIGHT_NODE_ROWS * SHAFT_WIDTH);
        FOR_EACH_CHILD(k) {
            uint code = codes[k];
            ((__global uint*)node)[LIGHT_CODES * SHAFT_WIDTH + k] = code;
            for (uint row = 0; row < LIGHT_CODES; row += 2u) {
                float low = INFINITY, high = -INFINITY;
                if ((code & SHAFT_LEAF) != 0u) {
                    __global const float* leaf =
                        light_leaves + (size_t)(code & ~SHAFT_LEAF) * (LIGHT_LEAF_ROWS * SHAFT_WIDTH);
                    low = leaf[LIGHT_LEAF_BOX + row];
                    high = leaf[LIGHT_LEAF_BOX + row + 1u];
                } else if (code != 0u) {  // 0 is the root, and no child
                    __global const float* child =
                        light_nodes + (size_t)code * (LIGHT_NODE_ROWS * SHAFT_WIDTH) + row * SHAFT_WIDTH;
                    low = LEAST_OF_ROW(child);
                    high = GREATEST_OF_ROW(child + SHAFT_WIDTH);
                }
                node[row * SHAFT_WIDTH + k] = low;
                node[(row + 1u) * SHAFT_WIDTH + k] = high;
            }
        }
    }
}
