// SPDX-License-Identifier: MIT
#define BVH_WIDTH 16
#include "beams/beam_intersect.clh"

// How far a corner or a side X lies along a plane's normal, the limit of the plane through P, and the largest
// coordinate's factor in `rounding`.
__kernel void probe(float3 n, float3 X, float3 P, float rounding, __global float* along, __global float* limit,
                    __global float* factor, __global float* factor_of_positions, __global float* of_nothing) {
    *along = lanes_along(n, (PointBlock){X.x, X.y, X.z});
    *limit = limit_along(n, (PointBlock){P.x, P.y, P.z}, rounding);
    *factor = BEAM_ROUNDING, *factor_of_positions = BEAM_ROUNDING_OF_POSITIONS;
    *of_nothing = BEAM_ROUNDING_LEAST;
}
