// SPDX-License-Identifier: MIT
// Contract of the binary tree over the finite triangles of a scene, made from the leaves up by parallel locally-ordered
// clustering (PLOC; Meister and Bittner, IEEE TVCG 24(3), 2018). Each triangle begins as a cluster, in the order of a
// Morton curve. In each round a cluster looks at the TREE_REACH clusters on either side for the nearest one: the box
// around both has the least area. Two clusters that are nearest to each other become one. The tree affects only speed.
//
// Boxes are made by comparing and copying vertices. A device that flushes denormals may move a side by 2^-126.
#pragma once

#include "simd/points.h"

// The number of neighbours on one side that a cluster looks at: a CPU looks at all of them at once.
#define TREE_REACH 16u

// A child is the index of a node or, with this bit, the index of a triangle along the curve.
#define TREE_TRIANGLE 0x80000000u

// A node of at most `width` triangles is small. Its word in `cost_slots` is their number; that of another node is
// TREE_FIRST_SLOT(width) + the slot of its costs, `width` floats (tree_costs.clh).
#define TREE_FIRST_SLOT(width) ((width) + 1u)

GN_STRUCT_BEGIN(BinaryNode)
    float low[3];
    uint left;
    float high[3];
    uint right;
GN_STRUCT_END(BinaryNode, 32)

// The clusters of a round: rows of `stride` floats, low x, low y, low z, high x, high y, high z, with TREE_REACH floats
// before the first cluster and after the last; then two rows of words, the cluster's node or triangle and its owner.
// The owner is the first triangle of the cluster along the curve. Node o joins two clusters, the second of which has
// the owner o, so no two nodes have the same index.
GN_STRUCT_BEGIN(BinaryTreeParams)
    TrianglesLayout triangles;
    uint count;  // clusters of the round
    uint stride;
    uint is_forced;      // 1: each cluster with an even index joins the next one
    uint slot_capacity;  // of costs
GN_STRUCT_END(BinaryTreeParams, 32)

#define TREE_BOX_ROWS 6u
#define TREE_ROWS 8u
