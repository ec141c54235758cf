// SPDX-License-Identifier: MIT
// Contract of the triangle setup: which triangles matter to a projection, and a float filter for each.
//
// A record answers, for a point (X, Y, Z) in one of the triangle's bins:
//     e_i = edge_x[i] X + edge_y[i] Y + edge_0[i]       inside the triangle's projection iff all three are >= 0
//     z   = plane_x X + plane_y Y + plane_0             the triangle's height along the point's ray
// Some e_i < -margin_edge: certainly outside. All e_i > margin_edge: certainly inside. Z > z + margin_plane: certainly
// nearer to the light. Z < z - margin_plane: certainly behind. Z < z_low, Z > z_high: behind and nearer, whatever the
// plane says. Anything else is for the exact predicate. The margins are proven in triangle_setup.cl.
#ifndef GN_TRIANGLE_SETUP_H
#define GN_TRIANGLE_SETUP_H

#include "simd/frame_counters.h"

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

// Triangles that a GPU's work-item bounds before its group claims places for those that may matter.
#define BOUNDS_AT_ONCE 4

#ifndef __cplusplus
// Fewer texels covered than these, and the conservative map is not worth its while.
static uint texels_worth_a_map(uint width, uint height) { return width * height / 16u; }
#endif

#endif
