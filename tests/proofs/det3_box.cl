// SPDX-License-Identifier: MIT
#include "exact/det3.clh"

__kernel void probe(float3 u1, float3 u0, float3 v1, float3 v0, float3 w1, float3 w0, __global float* value) {
    float bound;
    float3 w = w1 - w0;
    *value = det3_float(det3_cross_float(u1 - u0, v1 - v0), w, fabs(w), &bound);
}
