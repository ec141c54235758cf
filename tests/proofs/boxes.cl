// SPDX-License-Identifier: MIT
// 16 lanes
// met before: inverse 5
// met before: rounded_inverse 6
#define BVH_WIDTH 16
#include "beams/beam_intersect.clh"

// Where a ray enters and leaves a box. Parallel: P and the sides are the scene's. Else a side is relative to the rays'
// origin, and D has met a rounding.
__kernel void probe(float low, float high, float P, float rounding, float inverse, float rounded_inverse, float origin,
                    float side, __global float* enter, __global float* leave, __global float* moved_low,
                    __global float* moved_high, __global float* reached, __global float* less, __global float* factor,
                    __global float* of_nothing) {
    LaneFloat at = reached_at(P, inverse);
    LaneFloat first = reached_at((LaneFloat)(low)-rounding, inverse) - at;
    LaneFloat last = reached_at((LaneFloat)(high) + rounding, inverse) - at;
    *enter = first.s0, *leave = last.s0;
    LaneFloat from_low = moved_side(low, origin, -rounding), from_high = moved_side(high, origin, rounding);
    *moved_low = from_low.s0, *moved_high = from_high.s0;
    LaneFloat t = reached_at(side, rounded_inverse);
    *reached = t.s0, *less = LESS_THAN_ONE, *factor = BEAM_ROUNDING;
    *of_nothing = BEAM_ROUNDING_LEAST;
}
