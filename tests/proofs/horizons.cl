// SPDX-License-Identifier: MIT
// met before: sector 2
#include "horizons/strip_triangle.clh"

// Twice the area of two corners and the point, in a strip's coordinates, and the product of their distances.
__kernel void probe(float3 a, float3 b, float3 at, __global const HorizonSector* sector, float halves,
                    __global float* value, __global float* size, __global float* bound) {
    HeightField field;
    field.axis = 2u;
    field.halves = halves;
    field.units = 1.0f;
    FieldBlock block;
    block.at = (PointBlock){at.x, at.y, at.z};
    StripTriangle t;
    set_corner(&t, 0u, (PointBlock){a.x, a.y, a.z}, &block, sector, &field);
    set_corner(&t, 1u, (PointBlock){b.x, b.y, b.z}, &block, sector, &field);
    LaneFloat bound_of_value;
    *value = area_with_point(&t, 0u, 1u, &bound_of_value);
    *size = t.distance[0] * t.distance[1];
    *bound = bound_of_value;
}
