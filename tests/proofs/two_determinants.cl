// SPDX-License-Identifier: MIT
#define GN_FP64
#include "receivers/backfacing.cl"

static float size_of(Det3FloatCross cross, float3 w) {
    return fabs(w.x) * cross.size.x + fabs(w.y) * cross.size.y + fabs(w.z) * cross.size.z;
}
static double size_of_rows(Det3Row cross, Det3Row w) {
    return wide_dot(w.size_x, w.size_y, w.size_z, cross.size_x, cross.size_y, cross.size_z);
}

// det(u, v, a), det(u, v, b), their sum and what it must exceed; in float, then in double.
__kernel void probe(float3 u1, float3 u0, float3 v1, float3 v0, float3 a1, float3 a0, float3 b1, float3 b0,
                    __global float* one, __global float* other, __global float* size_one, __global float* size_other,
                    __global float* value, __global float* bound, __global double* wide_one,
                    __global double* wide_other, __global double* wide, __global double* wide_bound) {
    float of_one, of_two;
    Det3FloatCross cross = det3_cross_float(u1 - u0, v1 - v0);
    *one = det3_float(cross, a1 - a0, fabs(a1 - a0), &of_one);
    *other = det3_float(cross, b1 - b0, fabs(b1 - b0), &of_one);
    *size_one = size_of(cross, a1 - a0), *size_other = size_of(cross, b1 - b0);
    *value = det3_float_of_two(cross, a1 - a0, b1 - b0, &of_two);
    *bound = of_two;
    Det3Row rows = det3_cross(det3_row(u1, u0), det3_row(v1, v0)), a = det3_row(a1, a0), b = det3_row(b1, b0);
    double of_wide;
    *wide_one = size_of_rows(rows, a), *wide_other = size_of_rows(rows, b);
    *wide = det3_wide_of_two(rows, a, b, &of_wide);
    *wide_bound = of_wide;
}
