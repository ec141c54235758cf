// SPDX-License-Identifier: MIT
#include "occluders/triangle_records.clh"
#include "trace/filter.clh"

// The edge function of two projected vertices at a point of the grid, the Q of docs/numerics.md, 4, and what the margin
// has beside it.
__kernel void probe(float3 a, float3 b, float X, float Y, float reach, __global float* value, __global float* size,
                    __global float* bound, __global float* of_nothing) {
    Projected from = {a.x, a.y, a.z, 0.0f, 0.0f, 0.0f, 0.0f};
    Edge edge = make_edge(&from, b.x - a.x, b.y - a.y, b.z - a.z);
    *value = lanes_linear(edge.x, edge.y, edge.c, X, Y);
    *size = reach * (edge.size_x + edge.size_y) + edge.size_c;
    *bound = (reach * (edge.size_x + edge.size_y) + edge.size_c) * EDGE_ROUNDING;
    *of_nothing = EDGE_NEAR;
}
