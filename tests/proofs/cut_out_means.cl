// SPDX-License-Identifier: MIT
// met before: quotient 5
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define GN_FP64
#define GN_CUT_OUTS
#include "exact/cut_outs.clh"

// The bilinear mean of four texels from coordinates in texels and their errors, and its error; and the corners' alpha.
__kernel void probe(double at_x, int first_x, double error_x, double at_y, int first_y, double error_y, double off,
                    uint4 texels, double e_a, double e_b, double e_c, double bounds, float3 alphas,
                    __global double* mean, __global double* error, __global double* of_hit,
                    __global double* alpha_error, __global double* low, __global double* high) {
    CutCoordinate x = {at_x, error_x, first_x, first_x + 1}, y = {at_y, error_y, first_y, first_y + 1};
    const uint four[4] = {texels.x, texels.y, texels.z, texels.w};
    *mean = mean_of_texels(&x, &y, four), *error = error_of_mean(&x, &y, off);
    CutWeights weights = weights_of(e_a, e_b, e_c, bounds);
    const float of_corners[3] = {alphas.x, alphas.y, alphas.z};
    CutAlpha a = alpha_of_corners(&weights, of_corners);
    *of_hit = a.at, *alpha_error = a.error, *low = a.low, *high = a.high;
}
