// SPDX-License-Identifier: MIT
// Contract of shafts: the shadow rays from a block of neighbouring points to a bundle of neighbouring lights, decided
// together. A shaft contains all of these rays. A tree over the triangles finds the occluders that the
// shaft may meet, near ones first; each is tested against the bundle's cone for all points of the block at once, and
// against single lights only where the cone is not certain. Pairs that the float filter leaves undecided are queued for
// the exact predicate.
//
// A block has SHAFT_WIDTH points, and so many children has a node of the tree: 16 on a CPU, where a work-item's lanes
// are the points or the children, and 32 on a GPU, where the items of a work-group are.
#pragma once

#include "lights/light_bundle.h"

#define SHAFT_WIDTH_ON_CPU 16u
#define SHAFT_WIDTH_ON_GPU 32u
// On a GPU so many groups share the points of a task (point_shaft_trace): some points take much longer than others.
#define POINT_GROUPS_ON_GPU 4u
// Of triangles and points: differences stay within the filter's range (shaft_test.clh).
#define SHAFT_LARGEST_COORDINATE 0x1p19f
// The children that wait on the way through the tree.
#define MOST_SHAFT_ENTRIES 768u
// Words of local memory on a GPU: shaft_lanes.clh.
#define SHAFT_LOCAL_WORDS (1u + (7u + POINT_EDGE_ROWS) * SHAFT_WIDTH_ON_GPU + MOST_SHAFT_ENTRIES)
// What a point shaft knows of a triangle, for its tests of single lights.
#define POINT_EDGE_ROWS 15u
// In the id of a leaf's masked triangle (exact/cut_outs.h): it blocks nothing for certain. Scenes with cut-outs have
// fewer triangles than this.
#define SHAFT_MASKED 0x80000000u

// A node of the tree has rows of SHAFT_WIDTH floats: for its children, low x, low y, low z, high x, high y, high z of
// the box, and its code: the index of a node, or SHAFT_LEAF and the index of a leaf. An absent child's box is empty. A
// leaf has up to SHAFT_WIDTH triangles, in rows for the coordinates of the corners; absent ones are NaN.
#define SHAFT_NODE_ROWS 7u
#define SHAFT_LEAF_ROWS 9u
#define SHAFT_CODES (6u * SHAFT_WIDTH)
#define SHAFT_LEAF 0x80000000u

// How the nodes [first, first + count) of one level are made of a binary tree.
GN_STRUCT_BEGIN(ShaftTreeParams)
    TrianglesLayout triangles;
    uint first, count;
    uint node_capacity, leaf_capacity;
GN_STRUCT_END(ShaftTreeParams, 32)

GN_STRUCT_BEGIN(ShaftTreeCounters)
    uint nodes, leaves;
GN_STRUCT_END(ShaftTreeCounters, 8)

GN_STRUCT_BEGIN(ShaftParams)
    TrianglesLayout triangles;
    PointsLayout points;  // of a part of the sorted points
    uint bundle_count;
    uint mask_stride;  // masks[bundle mask_stride + point]: bit l is light l of the bundle
    uint queue_capacity;
    uint listed_tasks;  // so many tasks alone, those that shaft_trace left to point shafts; 0: all
    // A bound of the rounding errors of n . X, for coordinates of n up to 1. At least 1e-30, since rays_in_box() takes
    // coordinates of D below 2^-100 for that much.
    float rounding;
    uint are_sectors;  // 1: of the bundles, those with a direction along the ground (light_bundle.h)
    uint are_packets;  // 1: on a CPU blocks go light by light alone
    uint padding;
GN_STRUCT_END(ShaftParams, 96)

// A task is a block and a bundle, number bundle x blocks + block; of shaft_trace on a CPU PACKET_BLOCKS blocks.

// Pairs that the filter left undecided: a point, a triangle, and the lights of a bundle.
GN_STRUCT_BEGIN(ShaftPairs)
    uint point;
    uint bundle;
    uint triangle;
    uint lights;  // 0: an unused slot
GN_STRUCT_END(ShaftPairs, 16)

// The tasks that were left to point shafts follow the counters.
GN_STRUCT_BEGIN(ShaftCounters)
    uint queued;
    uint left_to_points;  // on a GPU
    uint tried, gave_up;  // among one task in so many
    uint by_level[3];
GN_STRUCT_END(ShaftCounters, 28)
#define TASKS_LEFT(counters) ((__global uint*)((counters) + 1))
