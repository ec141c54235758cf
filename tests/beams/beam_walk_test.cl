// SPDX-License-Identifier: MIT
// Walks of blocks' beams, for beam_walk_test.cpp.
#include "beams/beam_walk.clh"

// leaves[i most + n]: the leaf that the walk of block i comes to as its n-th; counts[i]: how many leaves it comes to;
// highest[i]: the most entries of its stack.
__kernel void walk_blocks(uint count, PointsLayout layout, float rounding, __global const LightCone* cone,
                          __global const float* positions, __global const float* nodes, uint most,
                          __global uint* leaves, __global uint* counts, __global uint* highest,
                          __local uint* shared GN_SHARES) {
    BeamScene scene = {nodes, 0, 0, 0, 0u, rounding, 0};
    BEAM_FOR_EACH(i, count) {
#if GN_LANES > 1
        PointBlock p = load_block(positions, layout, i);
#else
        PointBlock p = load_block(positions, layout, i * BVH_WIDTH + get_local_id(0));
#endif
        BlockBeam beam = beam_of_points(&p, present_lanes(p), (float3)(0.0f), rounding, cone SHARED);
        BEAM_BEGIN_STACK(stack);
        uint top = 1u, max_entries = 1u, found = 0u;
        while (top != 0u) {
            uint code = stack[--top];
            if ((code & BVH_LEAF) == 0u) {
                top = push_children_in_beam(stack, top, code, &beam.all, &scene SHARED);
                max_entries = max(max_entries, top);
                continue;
            }
            if (found < most) leaves[i * most + found] = code & ~BVH_LEAF;
            ++found;
        }
        counts[i] = found;
        highest[i] = max_entries;
    }
    GN_END_SHARES;
}

// The leaves that are remembered after each of some codes: those of code n from remembered[n BLOCKING_LEAVES] on.
__kernel void note_codes(uint count, __global const uint* codes, __global uint* remembered, __global uint* room) {
    uint blocking[BLOCKING_LEAVES];
    if (get_global_id(0) != 0) return;
    room[0] = BLOCKING_LEAVES;
    for (uint k = 0; k < BLOCKING_LEAVES; ++k) blocking[k] = 0u;
    for (uint n = 0; n < count; ++n) {
        note_blocking(blocking, codes[n]);
        for (uint k = 0; k < BLOCKING_LEAVES; ++k) remembered[n * BLOCKING_LEAVES + k] = blocking[k];
    }
}
