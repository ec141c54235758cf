// SPDX-License-Identifier: MIT
// Contract of clusters: CLUSTER_TRIANGLES neighbouring triangles, in the scene's order or in an order of the clusters'
// own, with a box around the finite ones. A box is exact: its sides are coordinates of vertices, compared as integers,
// so that neither rounding nor flushed denormals can move them. While the vertices do not change, boxes are kept; a
// projection then lists the clusters that survive its cull, and the vertices of all others are never read.
#pragma once

#include "lists/morton.h"
#include "simd/points.h"

#define CLUSTER_TRIANGLES 64u
#define CLUSTER_BOX_BYTES 28

// The minima and maxima of the coordinates of a scene's finite triangles as keys (float_to_key), and their number.
#define TRIANGLE_BOX_WORDS 7u

// The order of the triangles is that of the Morton codes of the middles of their boxes, MORTON_BITS of each coordinate.
// It affects speed alone. Triangles that are not finite come last.
GN_STRUCT_BEGIN(ClusterParams)
    TrianglesLayout triangles;
    uint cluster_count;
    uint has_pyramid;  // for cull_clusters; 0: the depth drops no cluster
GN_STRUCT_END(ClusterParams, 24)

#ifndef __cplusplus

#include "simd/lanes.clh"

// GN_LANES clusters lie together, coordinate by coordinate.
typedef struct ClusterBoxes {
    LaneFloat low[3], high[3];  // low > high: no finite triangle, or past the last cluster
    LaneInt not_finite;         // triangles with a NaN or infinite vertex
} ClusterBoxes;
typedef char ClusterBoxes_has_size[sizeof(ClusterBoxes) == GN_LANES * CLUSTER_BOX_BYTES ? 1 : -1];

#endif
