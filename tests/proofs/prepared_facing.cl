// SPDX-License-Identifier: MIT
#include "prepared/prepared_facing.clh"

// How far the eye is above a triangle's plane, whose normal is scaled by a power of two, and the bound for coordinates
// of the eye up to E and of triangles up to A.
__kernel void probe(float3 a, float3 b, float3 c, float3 eye, float scale, float E, float A, __global float* value,
                    __global float* size, __global float* bound, __global float* plane_least) {
    PointBlock at_a = {a.x, a.y, a.z}, at_b = {b.x, b.y, b.z}, at_c = {c.x, c.y, c.z};
    LaneCross normals = lanes_cross(difference(at_b, at_a), difference(at_c, at_a));
    PlaneBlock plane;
    plane.n = scaled(normals.value, scale);
    plane.minus_offset = minus_plane_offset(plane.n, at_a);
    *value = height_above_plane(&plane, eye);
    *plane_least = PLANE_LEAST;
    *size = A + fabs(E);
    *bound = plane_bound(A, (float3)(E, E, E));
}
