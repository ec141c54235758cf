// SPDX-License-Identifier: MIT
// Makes the binary tree over a scene's triangles (binary_tree.h), round by round.
#include "bvh/tree_costs.clh"

// The first cluster's value in a row.
static __global float* box_row(__global float* clusters, const BinaryTreeParams params, uint row) {
    return clusters + (size_t)row * params.stride + TREE_REACH;
}
static __global uint* word_row(__global float* clusters, const BinaryTreeParams params, uint row) {
    return (__global uint*)box_row(clusters, params, TREE_BOX_ROWS + row);
}

// Makes a cluster of each of the first `count` triangles along the curve.
__kernel void tree_leaves(const BinaryTreeParams params, __global const float* vertices, __global const uint* numbers,
                          __global float* clusters) {
    GN_FOR_EACH(i, params.count) {
        Triangle t = load_triangle(vertices + params.triangles.first_float, numbers[i]);
        float3 low = low_of(t), high = high_of(t);
        box_row(clusters, params, 0u)[i] = low.x;
        box_row(clusters, params, 1u)[i] = low.y;
        box_row(clusters, params, 2u)[i] = low.z;
        box_row(clusters, params, 3u)[i] = high.x;
        box_row(clusters, params, 4u)[i] = high.y;
        box_row(clusters, params, 5u)[i] = high.z;
        word_row(clusters, params, 0u)[i] = (uint)i | TREE_TRIANGLE;
        word_row(clusters, params, 1u)[i] = (uint)i;
    }
}

// Half the areas of the boxes around cluster i and each of GN_LANES clusters from `first` on; infinity past the last.
static LaneFloat joined_areas(__global float* clusters, const BinaryTreeParams params, int i, int first) {
    LaneFloat size[3];
    for (uint c = 0; c < 3u; ++c) {
        __global const float *low = box_row(clusters, params, c), *high = box_row(clusters, params, 3u + c);
        LaneFloat lows = TREE_LOAD(low + first), highs = TREE_LOAD(high + first);
        size[c] = LANES_MAX(highs, (LaneFloat)(high[i])) - LANES_MIN(lows, (LaneFloat)(low[i]));
    }
    LaneFloat area = size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
    LaneInt at = (LaneInt)(first) + LANE_INDEX;
    LaneInt are_clusters = LANE_COMPARE(at, >=, (LaneInt)(0)) & LANE_COMPARE(at, <, (LaneInt)((int)params.count));
    return LANES_SELECT((LaneFloat)(INFINITY), area, are_clusters);
}

// nearest[i]: the cluster that has the box of the least area together with cluster i. Among equal areas the kernel
// takes the index that differs from i in the lowest bits: then clusters choose each other even if all boxes are equal.
__kernel void tree_nearest(const BinaryTreeParams params, __global float* clusters, __global uint* nearest) {
    GN_FOR_EACH(item, params.count) {
        int i = (int)item;
        uint chosen = (uint)i ^ 1u;
        if (params.is_forced != 0u) {
            nearest[i] = chosen < params.count ? chosen : (uint)i;
            continue;
        }
        float least = INFINITY;
        uint difference = GN_NO_ID;
        for (int first = i - (int)TREE_REACH; first <= i + (int)TREE_REACH; first += GN_LANES) {
            if (first == i) first = i + 1;
            LaneFloat areas = joined_areas(clusters, params, i, first);
            float here = LANES_LEAST(areas);
            if (!(here <= least)) continue;
            if (here < least) difference = GN_NO_ID;
            least = here;
            for (uint bits = lane_bits(LANE_COMPARE(areas, ==, (LaneFloat)(here))); bits != 0u;) {
                uint other = (uint)(first + take_lane(&bits));
                if (other >= params.count || (other ^ (uint)i) >= difference) continue;
                difference = other ^ (uint)i;
                chosen = other;
            }
        }
        nearest[i] = chosen < params.count ? chosen : (uint)i;
    }
}

static bool is_second_of_pair(__global const uint* nearest, uint i) {
    return nearest[i] < i && nearest[nearest[i]] == i;
}

// kept[i]: 1, or 0 if cluster i becomes part of an earlier one.
__kernel void tree_kept(const BinaryTreeParams params, __global const uint* nearest, __global uint* kept) {
    GN_FOR_EACH(i, params.count) kept[i] = is_second_of_pair(nearest, (uint)i) ? 0u : 1u;
}

static void load_box(__global float* clusters, const BinaryTreeParams params, uint i, float* box) {
    for (uint row = 0; row < TREE_BOX_ROWS; ++row) box[row] = box_row(clusters, params, row)[i];
}

// Half the area of a box.
static float area_of_box(const float* box) {
    float3 size = {box[3] - box[0], box[4] - box[1], box[5] - box[2]};
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

// Writes the clusters of the next round, cluster i to slots[i], and the nodes and costs of the joined clusters.
__kernel void tree_join(const BinaryTreeParams params, __global float* clusters, __global const uint* nearest,
                        __global const uint* slots, __global float* joined, __global BinaryNode* nodes,
                        __global uint* cost_slots, __global float* costs, volatile __global uint* used_slots) {
    GN_FOR_EACH(item, params.count) {
        uint i = (uint)item, other = nearest[i], slot = slots[i];
        if (is_second_of_pair(nearest, i)) continue;
        float box[TREE_BOX_ROWS];
        load_box(clusters, params, i, box);
        __global const uint *children = word_row(clusters, params, 0u), *owners = word_row(clusters, params, 1u);
        uint child = children[i];
        if (other > i && nearest[other] == i) {
            uint right = children[other], node = owners[other], first = slot_of_child(cost_slots, child),
                 second = slot_of_child(cost_slots, right);
            float others[TREE_BOX_ROWS], area = area_of_box(box);
            load_box(clusters, params, other, others);
            for (uint row = 0; row < 3u; ++row) {
                box[row] = fmin(box[row], others[row]);
                box[3u + row] = fmax(box[3u + row], others[3u + row]);
            }
            nodes[node] = (BinaryNode){{box[0], box[1], box[2]}, child, {box[3], box[4], box[5]}, right};
            if (is_small(first) && is_small(second) && is_small(first + second))
                cost_slots[node] = first + second;
            else
                cost_slots[node] = store_costs(costs, used_slots, params.slot_capacity,
                                               costs_of_both(costs_of_child(costs, first, area),
                                                             costs_of_child(costs, second, area_of_box(others))),
                                               area_of_box(box));
            child = node;
        }
        for (uint row = 0; row < TREE_BOX_ROWS; ++row) box_row(joined, params, row)[slot] = box[row];
        word_row(joined, params, 0u)[slot] = child;
        word_row(joined, params, 1u)[slot] = owners[i];
    }
}
