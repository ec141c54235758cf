// SPDX-License-Identifier: MIT
// Turns a tree to a light (light_tree.h): the leaves, then the nodes level by level upwards. Lanes are triangles.
#include "shafts/light_tree.h"
#include "shafts/shaft_lanes.clh"

#if GN_LANES > 1
#define FOR_EACH_OF_GROUP(i, n) GN_FOR_EACH(i, n)
#define STORE_ROW(v, row) vstore16(v, 0, row)
#define IS_WRITER true
// Of a node's children.
#define FOR_EACH_CHILD(k) for (uint k = 0; k < SHAFT_WIDTH; ++k)
#define LEAST_OF_ROW(row) LANES_LEAST(vload16(0, row))
#define GREATEST_OF_ROW(row) (-LANES_LEAST(-vload16(0, row)))
#else
#define FOR_EACH_OF_GROUP(i, n) for (size_t i = get_group_id(0); i < (size_t)(n); i += get_num_groups(0))
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

static LaneFloat without_absent(LaneFloat v, LaneInt is_present, float instead) {
    return LANES_SELECT((LaneFloat)(instead), v, is_present);
}
GN_INLINE_ON_CPU LeafExtent extent_of(LaneFloat a, LaneFloat b, LaneFloat c, LaneInt is_present SHARED_PARAMETER) {
    LaneFloat least = LANES_MIN(a, b), greatest = LANES_MAX(a, b);
    least = LANES_MIN(least, c);
    greatest = LANES_MAX(greatest, c);
    LeafExtent extent;
    extent.low = -SHAFT_LARGEST(without_absent(-least, is_present, -INFINITY));
    extent.high = SHAFT_LARGEST(without_absent(greatest, is_present, -INFINITY));
    return extent;
}

static LaneFloat lanes_along_axis(const float* axis, LaneFloat x, LaneFloat y, LaneFloat z) {
    return fma((LaneFloat)(axis[0]), x, fma((LaneFloat)(axis[1]), y, axis[2] * z));
}
static float along_axis(const float* axis, const float* p) {
    return fma(axis[0], p[0], fma(axis[1], p[1], axis[2] * p[2]));
}

__kernel void light_leaves(const LightTreeParams params, __global const float* leaves, __global float* light_leaves,
                           __local uint* shared) {
    FOR_EACH_OF_GROUP(leaf, params.count) {
        __global const float* corners = leaves + leaf * (SHAFT_LEAF_ROWS * SHAFT_WIDTH);
        __global float* header = light_leaves + leaf * (LIGHT_LEAF_ROWS * SHAFT_WIDTH);
        LaneFloat at[9];
        for (uint row = 0; row < 9u; ++row) at[row] = SHAFT_LOAD_ROW(corners + row * SHAFT_WIDTH);
        LaneInt is_present = LANE_COMPARE(at[0], ==, at[0]);
        float origin[3], size = 0.0f;
        for (uint c = 0; c < 3u; ++c) {
            LeafExtent extent = extent_of(at[c], at[3u + c], at[6u + c], is_present SHARED);
            origin[c] = extent.low;
            size += extent.high - extent.low;
            if (IS_WRITER) header[c] = extent.low;
        }
        uint present = SHAFT_BITS(is_present);
        if (IS_WRITER) {
            header[LIGHT_LEAF_SIZE] = size;
            ((__global uint*)header)[LIGHT_LEAF_PRESENT] = present;
        }
        for (uint row = 0; row < 9u; ++row) at[row] -= origin[row % 3u];
        const float* const axes[3] = {params.axes.u, params.axes.v, params.axes.w};
        for (uint k = 0; k < 3u; ++k) {
            LaneFloat along[3];
            for (uint corner = 0; corner < 3u; ++corner) {
                along[corner] = lanes_along_axis(axes[k], at[3u * corner], at[3u * corner + 1u], at[3u * corner + 2u]);
                STORE_ROW(along[corner], header + (1u + 3u * corner + k) * SHAFT_WIDTH);
            }
            LeafExtent extent = extent_of(along[0], along[1], along[2], is_present SHARED);
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
    FOR_EACH_OF_GROUP(i, params.count) {
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
