// SPDX-License-Identifier: MIT
// Contract of shafts (beams): the shadow rays from a block of neighbouring points to a bundle of neighbouring lights,
// decided together. A shaft contains all of these rays. A BVH over the triangles finds the occluders that the shaft may
// meet, near boxes first. Each occluder is tested against the bundle's cone for all points of the block at once, and
// against single lights only if the test with the cone is not certain. Pairs that the float filter leaves undecided are
// queued for the exact predicate.
//
// SHAFT_WIDTH is both the number of points in a block and the number of children of a BVH node: 16 on a CPU, where the
// lanes of a work-item are the points or the children, and 32 on a GPU, where the items of a work-group are.
#pragma once

#include "lights/light_bundle.h"

#define SHAFT_WIDTH_ON_CPU 16u
#define SHAFT_WIDTH_ON_GPU 32u
// On a GPU this number of work-groups shares a task's points (point_shaft_trace): some take much longer than others.
#define POINT_GROUPS_ON_GPU 4u
// The largest coordinate of triangles and points: their differences stay within the filter's range (shaft_test.clh).
#define SHAFT_LARGEST_COORDINATE 0x1p19f
// The capacity of a walk's stack: the children that wait to be visited.
#define MOST_SHAFT_ENTRIES 768u
// Words of local memory of a GPU's work-group (shaft_lanes.clh).
#define SHAFT_LOCAL_WORDS (1u + (7u + POINT_EDGE_ROWS) * SHAFT_WIDTH_ON_GPU + MOST_SHAFT_ENTRIES)
// Floats of a triangle's PointEdges, which a point shaft keeps for its tests of single lights.
#define POINT_EDGE_ROWS 15u
// The bit of a masked triangle (exact/cut_outs.h) in the ids of a leaf: the filter is never certain that it blocks.
// Scenes with cut-outs have fewer triangles than this.
#define SHAFT_MASKED 0x80000000u

// A BVH node has rows of SHAFT_WIDTH floats, one per child: low x, low y, low z, high x, high y, high z of the child's
// box, and the child's code: the index of a node, or SHAFT_LEAF and the index of a leaf. An absent child's box is
// empty. A leaf has up to SHAFT_WIDTH triangles, in rows for the coordinates of the corners; absent triangles are NaN.
#define SHAFT_NODE_ROWS 7u
#define SHAFT_LEAF_ROWS 9u
#define SHAFT_CODES (6u * SHAFT_WIDTH)
#define SHAFT_LEAF 0x80000000u

// shaft_nodes makes the nodes [first, first + count) of one level, shaft_leaves makes `count` leaves.
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
    uint listed_tasks;  // number of tasks in TASKS_LEFT to process; 0: all tasks
    // A bound of the rounding errors of n . X, for coordinates of n up to 1. At least 1e-30, since rays_in_box()
    // replaces coordinates of D below 2^-100 by 2^-100, which moves a ray by less than this bound.
    float rounding;
    uint are_sectors;  // 1: a bundle with a direction along the ground (light_bundle.h) is a sector
    uint are_packets;  // 1: a CPU decides all pairs by packets
    uint padding;
GN_STRUCT_END(ShaftParams, 96)

// Task bundle x blocks + block is a block and a bundle. On a CPU a task of shaft_trace has PACKET_BLOCKS blocks.

// Pairs that the filter left undecided: a point, a triangle, and the lights of a bundle.
GN_STRUCT_BEGIN(ShaftPairs)
    uint point;
    uint bundle;
    uint triangle;
    uint lights;  // 0: an unused slot
GN_STRUCT_END(ShaftPairs, 16)

// The list of tasks that shaft_trace leaves to point_shaft_trace follows the counters (TASKS_LEFT).
GN_STRUCT_BEGIN(ShaftCounters)
    uint queued;
    uint left_to_points;  // tasks in TASKS_LEFT, on a GPU
    uint tried, gave_up;  // tasks that are always tried (TASKS_A_TRY); those of them that gave up
    uint by_level[3];
GN_STRUCT_END(ShaftCounters, 28)
#define TASKS_LEFT(counters) ((__global uint*)((counters) + 1))
