// SPDX-License-Identifier: MIT
// met before: D 1
#define BVH_WIDTH 16
#include "beams/beam_intersect.clh"

// The sign of a beam's edge for a light: A - P, the edge from A to B, D.
__kernel void probe(float3 A, float3 B, float3 P, float3 D, __global float* value, __global float* size,
                    __global float* bound) {
    PointBlock at_a = {A.x, A.y, A.z}, at_b = {B.x, B.y, B.z}, at = {P.x, P.y, P.z}, d = {D.x, D.y, D.z};
    PointBlock a = difference(at_a, at), edge = difference(at_b, at_a);
    *value = lanes_dot(d, cross_edge(a, edge));
    *size = lanes_size(a) * lanes_size(edge);
    *bound = BEAM_BOUND * (lanes_size(a) * lanes_size(edge));
}
