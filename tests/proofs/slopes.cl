// SPDX-License-Identifier: MIT
// met before: sector 2
// met before: quotient 5
#include "horizons/strip_triangle.clh"

// A corner's numbers; then, from the numbers of two corners as they are computed, the slope between them and a corner's
// slope, with their bounds; the least slope of a sector's lights, times `halves`; what is too near to decide; and the
// height over a point.
__kernel void probe(float3 a, float3 at, __global const HorizonSector* sector, float halves, float units, float q_i,
                    float q_j, float height_i, float height_j, float height_k, float size_i, float size_j,
                    float farthest, float highest, float3 areas, __global float* q, __global float* across,
                    __global float* height, __global float* distance, __global float* q_between, __global float* slope,
                    __global float* slope_bound, __global float* corner, __global float* corner_bound,
                    __global float* least, __global float* least_of_crossing, __global float* least_of_corner,
                    __global float* highest_of, __global float* over, __global float* over_bound) {
    HeightField field;
    field.axis = 2u;
    field.halves = halves;
    field.units = units;
    FieldBlock block;
    block.at = (PointBlock){at.x, at.y, at.z};
    StripTriangle t;
    PointBlock at_a = {a.x, a.y, a.z};
    TriangleBlock point = {at_a, at_a, at_a};
    set_triangle(&t, &point, &block, sector, &field);
    *highest_of = t.highest;
    *q = t.q[0], *across = t.across[0], *height = t.height[0], *distance = t.distance[0];
    StripTriangle of;
    of.q[0] = q_i, of.q[1] = q_j;
    of.height[0] = height_i, of.height[1] = height_j, of.height[2] = height_k;
    of.farthest = farthest, of.highest = highest;
    LaneFloat error, q_of;
    *slope = slope_between(&of, 0u, 1u, size_i, size_j, &q_of, &error);
    *q_between = q_of, *slope_bound = error;
    *corner = slope_at(&of, of.height[0], of.q[0], SLOPE_ERROR, &error);
    *corner_bound = error;
    *least = SECTOR_LEAST_RISE * units;
    *least_of_crossing = CROSSING_NEAR, *least_of_corner = CORNER_NEAR;
    LaneFloat of_areas[3] = {areas.x, areas.y, areas.z};
    *over = height_over_point(&of, of_areas, &error);
    *over_bound = error;
}
