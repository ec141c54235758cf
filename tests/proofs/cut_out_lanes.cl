// SPDX-License-Identifier: MIT
// met before: quotient 5
#define GN_CUT_OUTS
#include "exact/cut_outs.clh"

// A texture coordinate of one of many hits in texels, and its error, from the float level's e and their bounds; and,
// less 1/2, of a single hit where there is no double precision.
__kernel void probe(float e_a, float e_b, float e_c, float bound_a, float bound_b, float bound_c, float3 u, float3 v,
                    uint width, uint height, __global float* sum, __global float* lost, __global float* texel,
                    __global float* error, __global float* of_one, __global float* error_of_one) {
    CutOut of;
    of.u[0] = u.x, of.u[1] = u.y, of.u[2] = u.z, of.v[0] = v.x, of.v[1] = v.y, of.v[2] = v.z;
    of.material.width = width, of.material.height = height;
    const float e[3] = {e_a, e_b, e_c}, bounds[3] = {bound_a, bound_b, bound_c};
    LaneTexels at = lanes_texels(&of, e, bounds);
    *sum = at.sum, *lost = at.lost, *texel = at.x, *error = at.error;
    CutWeights weights = weights_of(e_a, e_b, e_c, bound_a + bound_b + bound_c);
    CutCoordinate x = cut_out_coordinate(&weights, of.u, width, 1u);
    *of_one = x.at, *error_of_one = x.error;
}
