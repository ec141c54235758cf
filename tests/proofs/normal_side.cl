// SPDX-License-Identifier: MIT
#include "exact/normal_side.clh"

__kernel void probe(float3 normal, float3 light, float3 start, __global float* value, __global float* size,
                    __global float* sizes, __global float* bound) {
    PointBlock n = {normal.x, normal.y, normal.z};
    PointBlock d = {light.x - start.x, light.y - start.y, light.z - start.z};
    LaneFloat bound_of_value;
    *value = lanes_normal_along(&n, d, &bound_of_value);
    *size = fabs(n.x * d.x) + fabs(n.y * d.y) + fabs(n.z * d.z);
    *sizes = fabs(n.x) + fabs(n.y) + fabs(n.z) + (1.0f + fabs(d.x) + fabs(d.y) + fabs(d.z));
    *bound = bound_of_value;
}
