// SPDX-License-Identifier: MIT
#include "receivers/footprint.h"

// One coordinate of a footprint's half axes in the grid, and the slack around them.
__kernel void probe(float3 g, float3 size, float3 U, float3 V, float spread, float scale, float stretch, float k,
                    __global float* half_u, __global float* half_v, __global float* slack) {
    FootprintBlock f = {{U.x, U.y, U.z}, {V.x, V.y, V.z}, spread};
    PointBlock along = {g.x, g.y, g.z}, sizes = {size.x, size.y, size.z};
    LaneFloat of_u, of_v, of_slack;
    grid_coordinate(along, sizes, scale, stretch, k, &f, &of_u, &of_v, &of_slack);
    *half_u = of_u, *half_v = of_v, *slack = of_slack;
}
