// SPDX-License-Identifier: MIT
// Contract of the trace: open points against the map and against the triangles of their bins' lists. All its kernels
// take the same parameters and the same buffers.
#pragma once

#include "receivers/light_frame.h"
#include "simd/points.h"

// A prepared light keeps its tables in one buffer; the ranges of its bins come first (prepared/prepared_light.h). The
// members are the start of each table, in units of 16 bytes; all are 0 for lists that one run makes.
GN_STRUCT_BEGIN(PreparedTables)
    uint largest;     // the largest coordinate of all finite triangles, as the bits of a float
    uint unshadowed;  // GPU: a bit per triangle (unshadowed_triangles.h)
    uint domains;     // a PreparedDomain per frame
    uint planes;      // a float4 per triangle
    uint slots;       // GPU: the slot of each triangle's record, GN_NO_ID if it has no record
GN_STRUCT_END(PreparedTables, 20)

GN_STRUCT_BEGIN(TraceParams)
    TrianglesLayout triangles;
    LightFrame light_frame;  // the light's first frame
    PointsLayout layout;
    PreparedTables tables;
    uint first_frame, frame_count;  // the frames of this launch: their projections, ranges and maps lie in this order
    uint has_map;                   // 0: the map's buffer is not read
    uint has_block_bounds;          // CPU, 0: the buffer of block bounds is not read
    uint queue_capacity;            // pairs
    uint round_points;  // GPU: points that a work-group takes in a round; the local memory has a word for each
    uint padding;
GN_STRUCT_END(TraceParams, 176)
