// SPDX-License-Identifier: MIT
// Contract of the triangle setup: the triangles that survive the cull of a projection, and a float filter for each.
//
// A record gives, for a point (X, Y, Z) in one of the triangle's bins:
//     e_i = edge_x[i] X + edge_y[i] Y + edge_0[i]       inside the triangle's projection iff all three are >= 0
//     z   = plane_x X + plane_y Y + plane_0             the triangle's height along the point's ray
// Some e_i < -margin_edge: certainly outside. All e_i > margin_edge: certainly inside. Z > z + margin_plane: certainly
// nearer to the light. Z < z - margin_plane: certainly behind. Z < z_low, Z > z_high: behind and nearer, at any value
// of the plane. Every other pair is left to the exact predicate. The margins are proven in triangle_records.clh.
#pragma once

#include "simd/frame_counters.h"
#include "simd/points.h"
#include "simd/projection.h"

GN_STRUCT_BEGIN(TriangleRecord)
    float edge_x[3];
    float margin_edge;
    float edge_y[3];
    float margin_plane;
    float edge_0[3];
    float z_low;
    float plane_x, plane_y, plane_0;
    float z_high;
GN_ALIGNED_STRUCT_END(TriangleRecord, 64)

// Parameters of both kernels; members that a kernel does not use are 0.
GN_STRUCT_BEGIN(TriangleSetupParams)
    TrianglesLayout triangles;
    uint capacity;  // capacity of the bounds, the records and the map's candidates
    uint tile_capacity;
    uint pair_capacity;
    uint has_clusters;  // 1: only the triangles of the listed clusters
    uint has_numbers;   // 1: clusters have an order of their own, and `numbers` has the triangle at each position
    uint has_pyramid;   // 0: the depth drops no triangle
    uint for_map;       // 1: tiles of the map's candidates; 0: tiles of all triangles, for the lists
    uint count_rows;    // not 0: a CPU appends pairs in place of tiles, and counts them in so many rows (Pair)
    // A camera's samples, in both coordinates of every pixel at first_sample + k / samples_per_pixel (a power of two):
    // a triangle with bounds that contain no sample is dropped. 0: the points may lie anywhere.
    uint samples_per_pixel;
    float first_sample;
    PictureRays picture;  // a camera's
GN_STRUCT_END(TriangleSetupParams, 104)

// Triangles that a GPU's work-item bounds before its group reserves slots for the survivors.
#define BOUNDS_AT_ONCE 4
