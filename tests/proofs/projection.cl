// SPDX-License-Identifier: MIT
// met before: row 4
#define GN_DIRECTIONAL_ONLY
#include "simd/triangle_blocks.clh"

// One coordinate of a projected vertex, g of docs/numerics.md, 3, and the bound.
__kernel void probe(float3 vertex, float3 center, __constant const float* row, __global float* value,
                    __global float* size, __global float* bound) {
    PointBlock d = difference((PointBlock){vertex.x, vertex.y, vertex.z}, (PointBlock){center.x, center.y, center.z});
    *value = lanes_row_dot(row, d);
    *size = lanes_row_size(row, magnitudes(d));
    *bound = lanes_row_size(row, magnitudes(d)) * PROJECTION_ERROR + PROJECTION_UNDERFLOW;
}
