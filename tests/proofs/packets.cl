// SPDX-License-Identifier: MIT
// 16 lanes
#define BVH_WIDTH 16
#include "packets/ray_packets.clh"

// A corner's or a point's coordinate along an axis of the light; e of an edge and twice an area from such coordinates
// as they are computed; m for S (leaf), R (distance) and q + S (off).
__kernel void probe(float3 X, float3 O, float3 u, float3 v, float2 a, float2 b, float2 c, float2 p, float leaf,
                    float distance, float off, __global float* coordinate_u, __global float* coordinate_v,
                    __global float* e, __global float* area, __global float* bound) {
    PointBlock from = difference(same_in_lanes(X), same_in_lanes(O));
    LaneFloat at_u = lanes_along(u, from), at_v = lanes_along(v, from);
    *coordinate_u = at_u.s0, *coordinate_v = at_v.s0;
    PointBlock at_a = same_in_lanes((float3)(a, 0.0f)), at_b = same_in_lanes((float3)(b, 0.0f)),
               at_c = same_in_lanes((float3)(c, 0.0f));
    PacketEdge bc = packet_edge(at_b, at_c), ca = packet_edge(at_c, at_a), ab = packet_edge(at_a, at_b);
    LaneFloat e_a = along_packet_edge(bc.x, bc.y, bc.z, p.x, p.y), twice = packet_area(&ca, &ab);
    LaneFloat m = packet_bound(off, leaf, distance);
    *e = e_a.s0, *area = twice.s0, *bound = m.s0;
}
