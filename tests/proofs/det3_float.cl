// SPDX-License-Identifier: MIT
#include "exact/det3_lanes.clh"

__kernel void probe(float3 u1, float3 u0, float3 v1, float3 v0, float3 w1, float3 w0, __global float* value,
                    __global float* size, __global float* bound, __global float* lanes_value,
                    __global float* lanes_bound) {
    float3 u = u1 - u0, v = v1 - v0, w = w1 - w0;
    Det3FloatCross cross = det3_cross_float(u, v);
    float bound_of_value;
    *value = det3_float(cross, w, fabs(w), &bound_of_value);
    *size = fabs(w.x) * cross.size.x + fabs(w.y) * cross.size.y + fabs(w.z) * cross.size.z;
    *bound = bound_of_value;
    LaneCross of_lanes = lanes_cross((PointBlock){u.x, u.y, u.z}, (PointBlock){v.x, v.y, v.z});
    PointBlock lanes = {w.x, w.y, w.z};
    LaneFloat bound_of_lanes;
    *lanes_value = lanes_det3(&of_lanes, lanes, magnitudes(lanes), &bound_of_lanes);
    *lanes_bound = bound_of_lanes;
}
