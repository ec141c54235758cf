// SPDX-License-Identifier: MIT
// met before: quotient 5
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define GN_FP64
#define GN_CUT_OUTS
#include "exact/cut_outs.clh"

// A texture coordinate of a hit in texels, less 1/2, and its error, from the barycentric coordinates and their bounds.
__kernel void probe(double e_a, double e_b, double e_c, double bounds, float3 u, uint side, __global double* sum,
                    __global double* texel, __global double* error) {
    CutWeights weights = weights_of(e_a, e_b, e_c, bounds);
    const float of_corners[3] = {u.x, u.y, u.z};
    CutCoordinate x = cut_out_coordinate(&weights, of_corners, side, 1u);
    *sum = weights.sum, *texel = x.at, *error = x.error;
}
