// SPDX-License-Identifier: MIT
// What the filter of beams says of pairs, for beam_intersect_test.cpp. Case i has a block of W points, a leaf of W
// triangles and a bundle of lights, W = BVH_WIDTH. One entry for each point and triangle: of point p and triangle k,
// number (i W + p) W + k.
#include "beams/point_beam.clh"

typedef struct Decisions {
    uint all;              // of the lights of a cone: bit 0, all are blocked; bit 1, none is
    uint blocked, missed;  // light by light, for lanes of triangles or points
    uint dark, undecided;  // for lanes of lights
} Decisions;

// Entry `first` + lane * `step` of each lane. The points are of one lane each, or the same.
GN_INLINE_ON_CPU void decide_lanes(const BeamEdges* e, PointBlock p, __global const LightBundle* bundle, uint cone,
                                   __global Decisions* decisions, size_t first, size_t step SHARED_PARAMETER) {
    uint count = bundle->light_count;
    BeamDecision all = decide_cone(e, p, &bundle->cones[cone]);
    LaneInt blocked = (LaneInt)(0), missed = (LaneInt)(0);
    for (uint l = 0; l < count; ++l) {
        BeamDecision one = decide_light(e, lanes_to_light(light_direction(bundle, l), p));
        blocked |= one.blocked & (int)(1u << l);
        missed |= one.missed & (int)(1u << l);
    }
    EDGE_ROWS_OF_LEAF(rows);
    STORE_EDGES(rows, *e);
    EDGES_BARRIER;
    uint lights = count < 32u ? (1u << count) - 1u : GN_NO_ID;
    for (int lane = 0; lane < GN_LANES; ++lane) {
        PointEdges edges = LOAD_EDGES(rows, BEAM_LANE(lane));
        LightDecision decision = decide_lights(&edges, lane_point(p, lane), bundle, lights);
        decisions[first + BEAM_LANE(lane) * step] = (Decisions){
            (LANE_OF_INT(all.blocked, lane) & 1) | (LANE_OF_INT(all.missed, lane) & 2),
            (uint)LANE_OF_INT(blocked, lane), (uint)LANE_OF_INT(missed, lane), decision.dark, decision.undecided};
    }
#if GN_LANES == 1
    barrier(CLK_LOCAL_MEM_FENCE);  // all items have read their rows
#endif
}

// Lanes are the leaf's triangles, for each point.
__kernel void filter_by_points(uint count, PointsLayout layout, __global const float* roundings,
                               __global const LightBundle* bundles, __global const uint* cones,
                               __global const float* positions, __global const float* leaves,
                               __global Decisions* decisions, __local uint* shared GN_SHARES) {
    BEAM_FOR_EACH(i, count * BVH_WIDTH) {
        size_t of = i / BVH_WIDTH;
        float3 p = load_point(positions, layout, i);
        PointPlane plane = {(float3)(0.0f), false, 0.0f};
        Beam beam = beam_of_point(p, plane, roundings[of], &bundles[of].cones[0]);
        LaneTriangles t = triangles_of_leaf(leaves + of * (BVH_LEAF_ROWS * BVH_WIDTH));
        BeamEdges e = edges_of(&t, same_in_lanes(p), REACH_OF(&beam));
        decide_lanes(&e, same_in_lanes(p), &bundles[of], cones[of], decisions, i * BVH_WIDTH, 1u SHARED);
    }
    GN_END_SHARES;
}

// Lanes are the block's points, for each triangle.
__kernel void filter_by_triangles(uint count, PointsLayout layout, __global const float* roundings,
                                  __global const LightBundle* bundles, __global const uint* cones,
                                  __global const float* positions, __global const float* leaves,
                                  __global Decisions* decisions, __local uint* shared GN_SHARES) {
    BEAM_FOR_EACH(i, count) {
#if GN_LANES > 1
        PointBlock p = load_block(positions, layout, i);
#else
        PointBlock p = load_block(positions, layout, i * BVH_WIDTH + get_local_id(0));
#endif
        BlockBeam beam =
            beam_of_points(&p, present_lanes(p), (float3)(0.0f), roundings[i], &bundles[i].cones[0] SHARED);
        __global const float* leaf = leaves + i * (BVH_LEAF_ROWS * BVH_WIDTH);
        STORE_TRIANGLES(rows, leaf);
        for (uint k = 0; k < BVH_WIDTH; ++k) {
            LaneTriangles t = TRIANGLE_AT(rows, leaf, k);
            BeamEdges e = edges_of(&t, p, REACH_OF(&beam.all));
            decide_lanes(&e, p, &bundles[i], cones[i], decisions, i * BVH_WIDTH * BVH_WIDTH + k, BVH_WIDTH SHARED);
        }
    }
    GN_END_SHARES;
}
