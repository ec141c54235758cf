// SPDX-License-Identifier: MIT
// Contract of the binary tree over the finite triangles of a scene, made from the leaves up by parallel locally-ordered
// clustering (Meister and Bittner, IEEE TVCG 24(3), 2018). Triangles stand in the order of a Morton curve, each a
// cluster of its own. In each round a cluster seeks, among the TREE_REACH clusters on either side of it, the one with
// which it has the box of the least area; two clusters that choose each other become one. The tree affects speed alone.
//
// Boxes come from comparisons and copies of vertices. A device that flushes denormals may move a side by 2^-126.
#pragma once

#include "simd/points.h"

// The neighbours on one side that a cluster looks at: a CPU looks at so many at once.
#define TREE_REACH 16u

// A child: the index of a node or, with this bit, of a triangle along the curve.
#define TREE_TRIANGLE 0x80000000u

// The rank of a node says how wide nodes, of `width` children each, are best cut out of the binary tree. A unit of
// level 0 is up to `width` triangles; a unit of level l + 1 is up to `width` units of lower levels. A node's rank is
// the level of the unit that it is, and how many triangles, or units below, this has.
#define TREE_RANK(level, parts) ((level) << 8 | (parts))
#define RANK_LEVEL(rank) ((rank) >> 8)
#define RANK_PARTS(rank) ((rank)&0xFFu)

GN_STRUCT_BEGIN(BinaryNode)
    float low[3];
    uint left;
    float high[3];
    uint right;
GN_STRUCT_END(BinaryNode, 32)

// The clusters of a round: rows of `stride` floats, low x, low y, low z, high x, high y, high z, with TREE_REACH floats
// before the first cluster and after the last; then two rows of words, the cluster's node or triangle and its owner.
// The owner is the first triangle of the cluster along the curve; node o joins two clusters of which o owns the second,
// so no two nodes have one index.
GN_STRUCT_BEGIN(BinaryTreeParams)
    TrianglesLayout triangles;
    uint count;  // of the round's clusters
    uint stride;
    uint is_forced;  // each cluster with an even index takes the next one
    uint width;      // of ranks
GN_STRUCT_END(BinaryTreeParams, 32)

#define TREE_BOX_ROWS 6u
#define TREE_ROWS 8u

// Of a scene: minima and maxima of its finite triangles' coordinates as keys (float_to_key), and their number.
#define TREE_BOUNDS_WORDS 7u

#ifndef __cplusplus
static uint rank_of_child(__global const uint* ranks, uint child) {
    return (child & TREE_TRIANGLE) != 0u ? TREE_RANK(0u, 1u) : ranks[child];
}
#endif
