// SPDX-License-Identifier: MIT
// Contract of shafts: the shadow rays from a block of neighbouring points to a bundle of neighbouring directional
// lights, decided together. A shaft contains all of these rays. A tree over the triangles finds the occluders that the
// shaft may meet, near ones first; each is tested against the bundle's cone for all points of the block at once, and
// against single lights only where the cone is not certain. Pairs that the float filter leaves undecided are queued for
// the exact predicate.
//
// A block has SHAFT_WIDTH points, and so many children has a node of the tree: 16 on a CPU, where a work-item's lanes
// are the points or the children, and 32 on a GPU, where the items of a work-group are.
#pragma once

#include "simd/points.h"

#define SHAFT_WIDTH_ON_CPU 16u
#define SHAFT_WIDTH_ON_GPU 32u
#define MOST_SHAFT_LEVELS 8u
// The boxes that wait on the way through the tree: each level adds less than a node's children.
#define MOST_SHAFT_ENTRIES 256u
// Words of local memory on a GPU: shaft_lanes.clh.
#define SHAFT_LOCAL_WORDS (1u + 7u * SHAFT_WIDTH_ON_GPU + MOST_SHAFT_ENTRIES)
#define MOST_BUNDLE_LIGHTS 32u
// In the id of a leaf's masked triangle (exact/cut_outs.h): it blocks nothing for certain. Scenes with cut-outs have
// fewer triangles than this.
#define SHAFT_MASKED 0x80000000u

// Lights whose directions lie in one cone. All directions are scaled by powers of two, exactly, so that the largest
// coordinate of each is between 1/2 and 1. For each light's direction D there are s > 0 and u, v in [-1, 1] with
// s D = middle + u across + v along; middle, across and along have coordinates of at most 1.
GN_STRUCT_BEGIN(LightBundle)
    // Outward normals of the shaft's four sides and of its near side: n . D < 0 for each light.
    float planes[5][3];
    float middle[4], across[4], along[4];
    float directions[3][MOST_BUNDLE_LIGHTS];  // coordinate by coordinate; of lights past the last: 0
    uint light_count;
GN_STRUCT_END(LightBundle, 496)

// Level 0 of the tree has one box per leaf; a leaf is SHAFT_WIDTH triangles. Node k of level l holds the boxes of
// children k SHAFT_WIDTH .. of the level below, coordinate by coordinate: low x, low y, low z, high x, high y, high z.
GN_STRUCT_BEGIN(ShaftTree)
    uint first_node[MOST_SHAFT_LEVELS];  // of each level; the root, the only node of the last level, is node 0
    uint level_count;
    uint leaf_count;
    uint triangle_count;
    uint padding;
GN_STRUCT_END(ShaftTree, 48)

GN_STRUCT_BEGIN(ShaftParams)
    ShaftTree tree;
    TrianglesLayout triangles;
    PointsLayout points;  // of a part of the sorted points
    uint bundle_count;
    uint mask_stride;  // masks[bundle mask_stride + point]: bit l is light l of the bundle
    uint queue_capacity;
    float rounding;  // a bound of the rounding errors of n . X, for coordinates of n up to 1
GN_STRUCT_END(ShaftParams, 128)

// Pairs that the filter left undecided: a point, a triangle, and the lights of a bundle.
GN_STRUCT_BEGIN(ShaftPairs)
    uint point;
    uint bundle;
    uint triangle;
    uint lights;  // 0: an unused slot
GN_STRUCT_END(ShaftPairs, 16)

GN_STRUCT_BEGIN(ShaftCounters)
    uint queued;
    uint by_level[3];
GN_STRUCT_END(ShaftCounters, 16)

#ifndef __cplusplus
static float3 light_direction(__global const LightBundle* bundle, uint light) {
    return (float3)(bundle->directions[0][light], bundle->directions[1][light], bundle->directions[2][light]);
}
#endif

// A node's six rows and a leaf's nine, of SHAFT_WIDTH floats each.
#define SHAFT_NODE_ROWS 6u
#define SHAFT_LEAF_ROWS 9u
