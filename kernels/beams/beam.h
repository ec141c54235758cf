// SPDX-License-Identifier: MIT
// Contract of beams: the shadow rays from a block of neighbouring points to a bundle of neighbouring lights, decided
// together. A beam contains all of these rays. A BVH over the triangles finds the occluders that the beam may meet,
// near boxes first. Each occluder is tested against the bundle's cone for all points of the block at once, and against
// single lights only if the test with the cone is not certain. Pairs that the float filter leaves undecided are queued
// for the exact predicate.
//
// BVH_WIDTH is both the number of points in a block and the number of children of a BVH node: 16 on a CPU, where the
// lanes of a work-item are the points or the children, and 32 on a GPU, where the items of a work-group are.
#pragma once

#include "bvh/wide_bvh.h"
#include "lights/light_bundle.h"

// Words of local memory of a GPU's work-group (beam_lanes.clh).
#define BEAM_LOCAL_WORDS (1u + (7u + POINT_EDGE_ROWS) * BVH_WIDTH_ON_GPU + MAX_STACK_ENTRIES)
// Floats of a triangle's PointEdges, which a point beam keeps for its tests of single lights.
#define POINT_EDGE_ROWS 15u

// Of planes, boxes and packets of directional lights, and of point lights, the farthest of which has three products
// more (tests/proofs/tree.v, boxes.v).
#define BEAM_ROUNDING 4e-6f
#define BEAM_ROUNDING_OF_POSITIONS 8e-6f
// At the least: rays_in_box() replaces coordinates of D below 2^-100 by 2^-100, which moves a ray by less.
#define BEAM_ROUNDING_LEAST 1e-30f

GN_STRUCT_BEGIN(BeamParams)
    TrianglesLayout triangles;
    PointsLayout points;  // of a part of the sorted points
    uint bundle_count;
    uint mask_stride;  // masks[bundle mask_stride + point]: bit l is light l of the bundle
    uint queue_capacity;
    uint listed_tasks;  // number of tasks in TASKS_LEFT to process; 0: all tasks
    // Of n . X, for coordinates of n up to 1: BEAM_ROUNDING times the largest coordinate, and BEAM_ROUNDING_LEAST.
    float rounding;
    uint are_sectors;    // 1: a bundle with a direction along the ground (light_bundle.h) is a sector
    uint are_packets;    // 1: a CPU decides all pairs by packets
    uint parts_of_task;  // of point_beam_trace: as many work-groups of a GPU share a task's points
GN_STRUCT_END(BeamParams, 96)

// Task bundle x blocks + block is a block and a bundle. On a CPU a task of beam_trace has PACKET_BLOCKS blocks.

// Pairs that the filter left undecided: a point, a triangle, and the lights of a bundle.
GN_STRUCT_BEGIN(BeamPairs)
    uint point;
    uint bundle;
    uint triangle;
    uint lights;  // 0: an unused slot
GN_STRUCT_END(BeamPairs, 16)

// The list of tasks that beam_trace leaves to point_beam_trace follows the counters (TASKS_LEFT).
GN_STRUCT_BEGIN(BeamCounters)
    uint queued;
    uint left_to_points;  // tasks in TASKS_LEFT, on a GPU
    uint tried, gave_up;  // tasks that are always tried (TASKS_A_TRY); those of them that gave up
    uint by_level[3];
GN_STRUCT_END(BeamCounters, 28)
#define TASKS_LEFT(counters) ((__global uint*)((counters) + 1))
