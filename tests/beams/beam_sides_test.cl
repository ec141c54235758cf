// SPDX-License-Identifier: MIT
// The boxes and triangles that beams do not cull, for beam_sides_test.cpp. Case i has the points [W i, W i + W), a
// cone, a normal, a node and a leaf of W lanes each, W = BVH_WIDTH. Outputs have a bit for each lane.
#include "beams/beam_intersect.clh"

static float3 case_point(__global const float* positions, PointsLayout layout, size_t i) {
    return load_point(positions, layout, i * BVH_WIDTH);
}

// boxes, triangles: those of the node and of the leaf that the block's beam may meet. points[W i + k]: the points
// whose rays may meet triangle k.
__kernel void meet_block(uint count, PointsLayout layout, __global const float* roundings,
                         __global const LightCone* cones, __global const float* positions,
                         __global const float* normals, __global const float* nodes, __global const float* leaves,
                         __global uint* boxes, __global uint* triangles, __global uint* points,
                         __local uint* shared GN_SHARES) {
    BEAM_FOR_EACH(i, count) {
#if GN_LANES > 1
        PointBlock p = load_block(positions, layout, i);
#else
        PointBlock p = load_block(positions, layout, i * BVH_WIDTH + get_local_id(0));
#endif
        BlockBeam beam = beam_of_points(&p, present_lanes(p), vload3(i, normals), roundings[i], &cones[i] SHARED);
        LaneFloat nearness;
        uint met = BEAM_BITS(boxes_in_beam(nodes + i * (BVH_NODE_ROWS * BVH_WIDTH), &beam.all, &nearness));
        BeamHits hits = triangles_in_beam(leaves + i * (BVH_LEAF_ROWS * BVH_WIDTH), &beam.all);
        SHARE_MINIMA(hits);
        uint some = BEAM_BITS(hits.some);
        for (uint k = 0; k < BVH_WIDTH; ++k) {
            LaneInt lanes = (LaneInt)(-1);
            for (uint plane = 0; plane < 6u; ++plane)
                lanes &= LANE_COMPARE((LaneFloat)(MIN_OF(hits, plane, k)), <=, beam.point_limits[plane]);
            uint of_triangle = BEAM_BITS(lanes);
            if (get_local_id(0) == 0 || GN_LANES > 1) points[i * BVH_WIDTH + k] = of_triangle;
        }
        if (get_local_id(0) == 0 || GN_LANES > 1) {
            boxes[i] = met;
            triangles[i] = some;
        }
    }
    GN_END_SHARES;
}

// boxes: those of the node that the beam of the first point may meet. normals[i] is the surface's if begins[i] < 0,
// else a direction along the ground, in which the rays meet nothing before begins[i].
__kernel void meet_point(uint count, PointsLayout layout, __global const float* roundings,
                         __global const LightCone* cones, __global const float* positions,
                         __global const float* normals, __global const float* begins, __global const float* nodes,
                         __global uint* boxes, __local uint* shared GN_SHARES) {
    BEAM_FOR_EACH(i, count) {
        PointPlane plane = {vload3(i, normals), begins[i] >= 0.0f, begins[i]};
        Beam beam = beam_of_point(case_point(positions, layout, i), plane, roundings[i], &cones[i]);
        LaneFloat nearness;
        uint met = BEAM_BITS(boxes_in_beam(nodes + i * (BVH_NODE_ROWS * BVH_WIDTH), &beam, &nearness));
        if (get_local_id(0) == 0 || GN_LANES > 1) boxes[i] = met;
    }
    GN_END_SHARES;
}
