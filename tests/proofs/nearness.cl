// SPDX-License-Identifier: MIT
// met before: quotient 5
#define GN_FP64
#include "camera/camera_rays.clh"

// 1 / t of a hit from two determinants as they are computed: in float, its error and the ends of its interval; and in
// double what the error of a determinant must not exceed.
__kernel void probe(float along, float depth, float along_bound, float depth_bound, double wide,
                    __global double* wide_error, __global float* value, __global float* of_along,
                    __global float* of_depth, __global float* error, __global float* low, __global float* high) {
    *wide_error = wide_mul(GOOD_RELATIVE_ERROR, wide_absolute(wide));
    float z = along / depth, a = along_bound / fabs(along), b = depth_bound / fabs(depth), e = nearness_error(z, a + b);
    *value = z, *of_along = a, *of_depth = b, *error = e;
    *low = z - e, *high = z + e;
}
