// SPDX-License-Identifier: MIT
// Turns a tree to a light (light_tree.h) on a GPU: the leaves, then the nodes level by level upwards. A group's items
// are a leaf's triangles, or a node's children.
#include "shafts/light_tree.h"
#include "shafts/shaft_test.clh"

#if GN_LANES == 1

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

// Of all corners of a leaf; absent triangles do not count.
typedef struct LeafExtent {
    float low, high;
} LeafExtent;

static LeafExtent extent_of(LaneFloat a, LaneFloat b, LaneFloat c, LaneInt is_present, __local uint* shared) {
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
        LeafExtent x = extent_of(a.x, b.x, c.x, is_present, shared), y = extent_of(a.y, b.y, c.y, is_present, shared);
        LeafExtent z = extent_of(a.z, b.z, c.z, is_present, shared);
        float3 origin = (float3)(x.low, y.low, z.low);
        uint present = SHAFT_BITS(is_present);
        if (get_local_id(0) == 0) {
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
            row[get_local_id(0)] = at_a;
            row[3u * SHAFT_WIDTH + get_local_id(0)] = at_b;
            row[6u * SHAFT_WIDTH + get_local_id(0)] = at_c;
            LeafExtent extent = extent_of(at_a, at_b, at_c, is_present, shared);
            float from_zero = along_axis(axes[k], origin);
            if (get_local_id(0) == 0) {
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
        for (uint k = get_local_id(0); k < SHAFT_WIDTH; k += SHAFT_WIDTH) {
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
                    low = least_of_row(child);
                    high = greatest_of_row(child + SHAFT_WIDTH);
                }
                node[row * SHAFT_WIDTH + k] = low;
                node[(row + 1u) * SHAFT_WIDTH + k] = high;
            }
        }
    }
}

#endif
