// SPDX-License-Identifier: MIT
#define GN_FP64
#include "exact/det3.clh"

__kernel void probe(float3 u1, float3 u0, float3 v1, float3 v0, float3 w1, float3 w0, __global double* value,
                    __global double* size, __global double* bound) {
    Det3Row cross = det3_cross(det3_row(u1, u0), det3_row(v1, v0)), w = det3_row(w1, w0);
    double bound_of_value;
    *value = det3_wide(cross, w, &bound_of_value);
    *size = wide_dot(w.size_x, w.size_y, w.size_z, cross.size_x, cross.size_y, cross.size_z);
    *bound = bound_of_value;
}
