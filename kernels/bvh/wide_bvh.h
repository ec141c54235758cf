// SPDX-License-Identifier: MIT
// Contract of the BVH over the triangles: nodes of BVH_WIDTH children, and leaves of up to BVH_WIDTH triangles. On a
// CPU the lanes of a work-item are the children; on a GPU the items of a work-group are.
#pragma once

#include "simd/points.h"

#define BVH_WIDTH_ON_CPU 16u
#define BVH_WIDTH_ON_GPU 32u
// The largest coordinate of triangles and points: their differences stay within the filter's range
// (beam_intersect.clh).
#define BVH_MAX_COORDINATE 0x1p19f
// The capacity of a walk's stack: the children that wait to be visited.
#define MAX_STACK_ENTRIES 768u

// The bit of a masked triangle (exact/cut_outs.h) in the ids of a leaf: the filter is never certain that it blocks.
// Scenes with cut-outs have fewer triangles than this.
#define BVH_MASKED 0x80000000u

// A BVH node has rows of BVH_WIDTH floats, one per child: low x, low y, low z, high x, high y, high z of the child's
// box, and the child's code: the index of a node, or BVH_LEAF and the index of a leaf. An absent child's box is
// empty. A leaf has up to BVH_WIDTH triangles, in rows for the coordinates of the corners; absent triangles are NaN.
#define BVH_NODE_ROWS 7u
#define BVH_LEAF_ROWS 9u
#define BVH_CODES (6u * BVH_WIDTH)
#define BVH_LEAF 0x80000000u

// bvh_nodes makes the nodes [first, first + count) of one level, bvh_leaves makes `count` leaves.
GN_STRUCT_BEGIN(WideBvhParams)
    TrianglesLayout triangles;
    uint first, count;
    uint node_capacity, leaf_capacity;
GN_STRUCT_END(WideBvhParams, 32)

GN_STRUCT_BEGIN(WideBvhCounters)
    uint nodes, leaves;
GN_STRUCT_END(WideBvhCounters, 8)
