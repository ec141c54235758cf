// SPDX-License-Identifier: MIT
// Makes the BVH that beams walk (beam.h): nodes of BVH_WIDTH children, level by level from the root of a binary
// tree (binary_tree.h), then the leaves.
#include "bvh/binary_tree.h"
#include "bvh/bvh_rows.clh"
#include "exact/cut_outs.clh"

// Replaces child k by the parts of its unit. Returns the new number of children.
static uint open_unit(__global const BinaryNode* binary, __global const uint* ranks, uint* children, uint count,
                      uint k) {
    uint level = RANK_LEVEL(rank_of_child(ranks, children[k]));
    // Child k first, then the children that were added for it.
    for (uint added = count; k < count; k = k < added ? added : k + 1u)
        while (RANK_LEVEL(rank_of_child(ranks, children[k])) == level) {
            BinaryNode opened = binary[children[k]];
            children[k] = opened.left;
            children[count++] = opened.right;
        }
    return count;
}

// The number of children that replace a child when it is opened. A unit of leaves is replaced by all its parts, so that
// the lowest nodes are full; a higher unit by its two children in the binary tree. 0: the child is a leaf.
static uint parts_of_child(__global const uint* ranks, uint child) {
    uint rank = rank_of_child(ranks, child), level = RANK_LEVEL(rank);
    return level == 0u ? 0u : level == 1u ? RANK_PARTS(rank) : 2u;
}

// Finds the children of the node whose root in the binary tree is `root`: as long as the node has room, opens the child
// with the largest box. Returns their number.
static uint open_children(__global const BinaryNode* binary, __global const uint* ranks, uint root, uint* children) {
    uint count = 1u;
    children[0] = root;
    for (;;) {
        uint best = BVH_WIDTH;
        float largest = -1.0f;
        for (uint k = 0; k < count; ++k) {
            uint parts = parts_of_child(ranks, children[k]);
            if (parts == 0u || count - 1u + parts > BVH_WIDTH) continue;
            float3 size = vload3(0, binary[children[k]].high) - vload3(0, binary[children[k]].low);
            float area = size.x * size.y + size.y * size.z + size.z * size.x;
            if (!(area > largest)) continue;
            largest = area;
            best = k;
        }
        if (best == BVH_WIDTH) return count;
        if (RANK_LEVEL(ranks[children[best]]) == 1u) {
            count = open_unit(binary, ranks, children, count, best);
            continue;
        }
        BinaryNode opened = binary[children[best]];
        children[best] = opened.left;
        children[count++] = opened.right;
    }
}

static void write_box_of_child(const WideBvhParams params, __global const float* vertices, __global const uint* numbers,
                               __global const BinaryNode* binary, uint child, __global float* node, uint k) {
    if ((child & TREE_TRIANGLE) != 0u) {
        Triangle t = load_triangle(vertices + params.triangles.first_float, numbers[child & ~TREE_TRIANGLE]);
        write_box(node, k, fmin(fmin(t.a, t.b), t.c), fmax(fmax(t.a, t.b), t.c));
    } else {
        write_box(node, k, vload3(0, binary[child].low), vload3(0, binary[child].high));
    }
}

// Makes the nodes of one level, and lists the roots of their children: of the next level's nodes, and of leaves. If a
// counter exceeds its capacity, the host enlarges the buffers and begins again.
__kernel void bvh_nodes(const WideBvhParams params, __global const float* vertices, __global const uint* numbers,
                        __global const BinaryNode* binary, __global const uint* ranks, __global float* nodes,
                        __global uint* node_roots, __global uint* leaf_roots, __global WideBvhCounters* counters) {
    GN_FOR_EACH(i, params.count) {
        uint children[BVH_WIDTH];
        uint count = open_children(binary, ranks, node_roots[params.first + i], children);
        __global float* node = nodes + (params.first + i) * (BVH_NODE_ROWS * BVH_WIDTH);
        __global uint* codes = (__global uint*)node + 6u * BVH_WIDTH;
        for (uint k = 0; k < BVH_WIDTH; ++k) {
            codes[k] = 0u;
            if (k >= count) {
                write_box(node, k, (float3)(INFINITY), (float3)(-INFINITY));
                continue;
            }
            write_box_of_child(params, vertices, numbers, binary, children[k], node, k);
            bool is_leaf = RANK_LEVEL(rank_of_child(ranks, children[k])) == 0u;
            uint slot = atomic_inc(is_leaf ? &counters->leaves : &counters->nodes);
            if (slot < (is_leaf ? params.leaf_capacity : params.node_capacity))
                (is_leaf ? leaf_roots : node_roots)[slot] = children[k];
            codes[k] = is_leaf ? BVH_LEAF | slot : slot;
        }
    }
}

// Writes the triangles of each leaf, row by row. With cut-outs, clear triangles are absent, and masked triangles have
// BVH_MASKED in their ids.
__kernel void bvh_leaves(const WideBvhParams params, __global const float* vertices, __global const uint* numbers,
                         __global const BinaryNode* binary, __global const uint* leaf_roots, __global float* leaves,
                         __global uint* ids) {
    GN_FOR_EACH(leaf, params.count) {
        uint waiting[BVH_WIDTH], top = 1;
        waiting[0] = leaf_roots[leaf];
        for (uint k = 0; k < BVH_WIDTH;) {
            uint child = TREE_TRIANGLE, id = GN_NO_ID;
            bool is_present = top != 0u, is_masked = false;
            if (is_present) child = waiting[--top];
            if ((child & TREE_TRIANGLE) == 0u) {
                waiting[top++] = binary[child].right;
                waiting[top++] = binary[child].left;
                continue;
            }
            if (is_present) id = numbers[child & ~TREE_TRIANGLE];
#ifdef GN_CUT_OUTS
            if (is_present) {
                uint of_triangle = cut_out_class(triangles_of(vertices, params.triangles), id);
                is_present = of_triangle != CUT_OUT_CLEAR;
                is_masked = of_triangle == CUT_OUT_MASKED;
            }
#endif
            Triangle t = {(float3)(NAN), (float3)(NAN), (float3)(NAN)};
            if (is_present) t = load_triangle(vertices + params.triangles.first_float, id);
            ids[leaf * BVH_WIDTH + k] = is_masked ? id | BVH_MASKED : id;
            write_corners(leaves + leaf * (BVH_LEAF_ROWS * BVH_WIDTH), k++, t);
        }
    }
}
