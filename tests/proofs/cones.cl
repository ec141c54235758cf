// SPDX-License-Identifier: MIT
#define BVH_WIDTH 16
#include "beams/beam_intersect.clh"

// The least value of a beam's edge for the lights of a cone, A - P, the edge from A to B, and the bound that it is
// compared with.
__kernel void probe(float3 A, float3 B, float3 P, __global const LightCone* cone, __global float* value,
                    __global float* size, __global float* bound) {
    PointBlock at_a = {A.x, A.y, A.z}, at_b = {B.x, B.y, B.z}, at = {P.x, P.y, P.z};
    PointBlock a = difference(at_a, at), edge = difference(at_b, at_a);
    BeamEdges e;
    e.ab = e.bc = e.ca = cross_edge(a, edge);
    *value = edge_value(&e, 0, lanes_to_light(vload3(0, cone->middle), at)) - edge_radius(&e, 0, cone);
    *size = lanes_size(a) * lanes_size(edge);
    *bound = CONE_BOUNDS * (BEAM_BOUND * (lanes_size(a) * lanes_size(edge)));
}
