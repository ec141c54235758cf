// SPDX-License-Identifier: MIT
// 16 lanes
#define BVH_WIDTH 16
#include "packets/ray_packets.clh"

// h of a triangle and a point, from their coordinates along a light's axes as they are computed.
__kernel void probe(float3 a, float3 b, float3 c, float3 p, __global float* area, __global float* height,
                    __global float* factor, __global float* of_corner) {
    TurnedLeaf t;
    t.a = same_in_lanes(a), t.b = same_in_lanes(b), t.c = same_in_lanes(c);
    PacketEdge bc = packet_edge(t.b, t.c), ca = packet_edge(t.c, t.a), ab = packet_edge(t.a, t.b);
    LaneFloat twice = packet_area(&ca, &ab);
    LaneFloat h = packet_height(height_factor(bc.x, ca.x, ab.x, &t), height_factor(bc.y, ca.y, ab.y, &t), -fabs(twice),
                                height_factor(bc.z, ca.z, ab.z, &t), p.x, p.y, p.z);
    *area = twice.s0, *height = h.s0;
    *factor = PACKET_BOUND_OF_HEIGHT, *of_corner = PACKET_BOUND_OF_CORNER;
}
