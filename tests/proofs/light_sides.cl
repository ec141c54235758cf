// SPDX-License-Identifier: MIT
#include "lights/light_sides.cl"

// The least value of n . D over the directional lights of a cone, n a receiver's normal, and its bound.
__kernel void probe(float3 a, float3 b, float3 c, __global const LightCone* cone, __global float* value,
                    __global float* size, __global float* bound) {
    PointBlock at_a = {a.x, a.y, a.z}, at_b = {b.x, b.y, b.z}, at_c = {c.x, c.y, c.z};
    LaneCross normals = lanes_cross(difference(at_b, at_a), difference(at_c, at_a));
    SidedPoints s;
    s.normals = normals.value;
    s.cone_bound = cone_bound(normals.size);
    ConeAlongNormals n = cone_along_normals(&s, cone);
    *value = n.middle - n.radius;
    *size = fabs(normals.size.x) + fabs(normals.size.y) + fabs(normals.size.z);
    *bound = n.bound;
}
