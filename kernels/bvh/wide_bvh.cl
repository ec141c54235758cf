// SPDX-License-Identifier: MIT
// Makes the BVH that beams walk (beam.h): nodes of BVH_WIDTH children, level by level from the root of a binary
// tree (binary_tree.h), then the leaves.
#include "bvh/tree_costs.clh"
#include "exact/cut_outs.clh"

static void write_box_of_child(const WideBvhParams params, __global const float* vertices, __global const uint* numbers,
                               __global const BinaryNode* binary, uint child, __global float* node, uint k) {
    if ((child & TREE_TRIANGLE) != 0u) {
        Triangle t = load_triangle(vertices + params.triangles.first_float, numbers[child & ~TREE_TRIANGLE]);
        write_box(node, k, fmin(fmin(t.a, t.b), t.c), fmax(fmax(t.a, t.b), t.c));
    } else {
        write_box(node, k, vload3(0, binary[child].low), vload3(0, binary[child].high));
    }
}

// Makes the nodes of one level, and lists the roots of their children: of the next level's nodes, and of leaves. If
// there are more nodes than there is room for, the host enlarges the buffers and begins again.
__kernel void bvh_nodes(const WideBvhParams params, __global const float* vertices, __global const uint* numbers,
                        __global const BinaryNode* binary, __global const float* costs, __global const uint* cost_slots,
                        __global float* nodes, __global uint* node_roots, __global uint* leaf_roots,
                        __global WideBvhCounters* counters) {
    GN_FOR_EACH(i, params.count) {
        uint children[BVH_WIDTH];
        uint count = choose_children(binary, costs, cost_slots, node_roots[params.first + i], children);
        __global float* node = nodes + (params.first + i) * (BVH_NODE_ROWS * BVH_WIDTH);
        __global uint* codes = (__global uint*)node + 6u * BVH_WIDTH;
        for (uint k = 0; k < BVH_WIDTH; ++k) {
            codes[k] = 0u;
            if (k >= count) {
                write_box(node, k, (float3)(INFINITY), (float3)(-INFINITY));
                continue;
            }
            write_box_of_child(params, vertices, numbers, binary, children[k], node, k);
            bool is_leaf = is_small(slot_of_child(cost_slots, children[k]));
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
