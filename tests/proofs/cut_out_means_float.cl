// SPDX-License-Identifier: MIT
// met before: quotient 5
#define GN_CUT_OUTS
#include "exact/cut_outs.clh"

// The bilinear mean of four texels from coordinates in texels and their errors, and its error; and the corners' alpha:
// in float.
__kernel void probe(float at_x, int first_x, float error_x, float at_y, int first_y, float error_y, float off,
                    uint4 texels, float e_a, float e_b, float e_c, float bounds, float3 alphas, __global float* mean,
                    __global float* error, __global float* of_hit, __global float* alpha_error, __global float* low,
                    __global float* high) {
    CutCoordinate x = {at_x, error_x, first_x, first_x + 1}, y = {at_y, error_y, first_y, first_y + 1};
    const uint four[4] = {texels.x, texels.y, texels.z, texels.w};
    *mean = mean_of_texels(&x, &y, four), *error = error_of_mean(&x, &y, off);
    CutWeights weights = weights_of(e_a, e_b, e_c, bounds);
    const float of_corners[3] = {alphas.x, alphas.y, alphas.z};
    CutAlpha a = alpha_of_corners(&weights, of_corners);
    *of_hit = a.at, *alpha_error = a.error, *low = a.low, *high = a.high;
}
