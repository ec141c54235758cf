// SPDX-License-Identifier: MIT
// The kernels of small_cases_test.cpp: for each triangle and light, the points that the triangle blocks, one bit each.
#include "exact/decide_pair.clh"

// Triangle i has the corners i % n, i / n % n and i / n^2 of the grid's n points. levels[k]: the pairs that level k
// decided.
__kernel void blocked_points(uint light_count, uint grid_points, uint count, __global const float* grid,
                             __global const float* vertices, __global const float4* lights, __global ulong* blocked,
                             __global uint* levels) {
    Triangles triangles = {vertices, grid_points * grid_points * grid_points};
    uint by_level[3] = {0u, 0u, 0u};
    GN_FOR_EACH(i, count) {
        uint ids[GN_LANES], id = (uint)i / light_count;
        ulong mask = 0ul;
        for (uint lane = 0u; lane < GN_LANES; ++lane) ids[lane] = id;
        for (uint p = 0u; p < grid_points; p += GN_LANES) {
            PointBlock points;
            LaneInt lanes;
            for (uint lane = 0u; lane < GN_LANES; ++lane) {
                __global const float* at = grid + 3u * min(p + lane, grid_points - 1u);
                LANE_OF_FLOAT(points.x, lane) = at[0];
                LANE_OF_FLOAT(points.y, lane) = at[1];
                LANE_OF_FLOAT(points.z, lane) = at[2];
                LANE_OF_INT(lanes, lane) = p + lane < grid_points ? -1 : 0;
            }
            float4 light = lights[(uint)i % light_count];
            mask |= (ulong)lane_bits(decide_pairs(triangles, ids, &points, light, lanes, by_level)) << p;
        }
        blocked[i] = mask;
    }
    for (uint k = 0u; k < 3u; ++k) atomic_add(&levels[k], by_level[k]);
}
