// SPDX-License-Identifier: MIT
// 16 lanes
#define BVH_WIDTH 16
#include "packets/ray_packets.clh"

// The greatest coordinate of a leaf's triangle along an axis of the light, and the least of a box of points, as they
// are compared.
__kernel void probe(float3 A, float3 B, float3 C, float3 O, __global const LightAxes* axes, float3 low, float3 high,
                    float rounding, __global float* corner, __global float* triangle_high, __global float* box_low,
                    __global float* factor, __global float* of_nothing) {
    TurnedLeaf t;
    LightAxes same = *axes;
    turn_corners(&t, same_in_lanes(A), same_in_lanes(B), same_in_lanes(C), O, &same);
    *corner = t.a.x.s0, *triangle_high = t.high_u.s0;
    PacketBlock block;
    block.points = same_in_lanes(low);
    block.box = (PointBox){low, high};
    PacketFrame frame;
    frame.axes = same;
    set_rays(&block, &frame, rounding);
    *box_low = block.low_u;
    *factor = BEAM_ROUNDING, *of_nothing = BEAM_ROUNDING_LEAST;
}
