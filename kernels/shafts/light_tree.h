// SPDX-License-Identifier: MIT
// Contract of light trees, and of the trace of single shadow rays through one. All rays to a directional light are
// parallel. So the shafts' tree (shaft.h) is turned: its nodes and leaves stay, with boxes and corners along the
// light's own axes, and a ray is a point in two of them. A tree is turned to one light after the other.
#pragma once

#include "shafts/shaft.h"

// A node of a light tree has rows of SHAFT_WIDTH floats: the least and the greatest coordinate of each child along u, v
// and w, and the child's code. An absent child's box is empty.
#define LIGHT_LOW_U 0u
#define LIGHT_LOW_V 2u
#define LIGHT_LOW_W 4u
#define LIGHT_HIGH_W 5u
#define LIGHT_CODES 6u
#define LIGHT_NODE_ROWS 7u

// A leaf has a row of its own: its origin, the least corner of its box in the scene; the sum of that box's sides; its
// least and greatest coordinate along each axis; and which of its triangles are present. Then come rows for the corners
// from the origin on, u, v, w of each.
#define LIGHT_LEAF_ROWS 10u
#define LIGHT_LEAF_SIZE 3u
#define LIGHT_LEAF_BOX 4u
#define LIGHT_LEAF_PRESENT 10u

GN_STRUCT_BEGIN(LightTreeParams)
    LightAxes axes;
    uint first, count;  // of the nodes of one level, or of all leaves
GN_STRUCT_END(LightTreeParams, 48)

// Points that one work-item of the trace, or one group, takes in a row.
#define RAYS_OF_TASK 64u

GN_STRUCT_BEGIN(RayParams)
    PointsLayout points;  // of a part of the sorted points
    LightAxes axes;
    uint bundle, light;  // the light's bundle, and its place there
    uint mask_stride;
    uint queue_capacity;
    float rounding;  // a bound of the errors of coordinates along the axes
    uint padding;
GN_STRUCT_END(RayParams, 112)
