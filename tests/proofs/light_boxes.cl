// SPDX-License-Identifier: MIT
#define GN_POINT_LIGHTS
#define BVH_WIDTH 16
#include "beams/beam_intersect.clh"

// A triangle's edge and plane under a point light at S, their least values under the lights of a box, and the bound
// that both are compared with.
__kernel void probe(float3 A, float3 B, float3 C, float3 P, float3 S, __global const LightCone* box, float reach,
                    __global float* bound, __global float* edge, __global float* edge_of_box, __global float* plane,
                    __global float* plane_of_box, __global float* bound_of_box) {
    PointBlock a = {A.x, A.y, A.z}, b = {B.x, B.y, B.z}, c = {C.x, C.y, C.z}, p = {P.x, P.y, P.z};
    LaneTriangles t = triangles_of_corners(a, b, c);
    BeamEdges e = edges_of(&t, p, reach);
    PointBlock one = lanes_to_light(S, p), middle = lanes_to_light(vload3(0, box->middle), p);
    *bound = e.bound;
    *edge = edge_value(&e, 0, one), *edge_of_box = edge_value(&e, 0, middle) - edge_radius(&e, 0, box);
    *plane = edge_value(&e, 3, one), *plane_of_box = edge_value(&e, 3, middle) - edge_radius(&e, 3, box);
    *bound_of_box = CONE_BOUNDS * e.bound;
}
