// SPDX-License-Identifier: MIT
// Decides facing for many lights at once (light_sides.h), exactly. The sign of a light against a receiver's plane is
// that of n . D, which lanes_side() decides; against a normal, lanes_normal_faces().
#include "exact/normal_side.clh"
#include "lights/light_sides.h"
#include "receivers/facing.clh"

typedef struct SidedPoints {
    PointBlock points;
    TriangleBlock receivers;
    LaneCross receiver_normals;
    PointBlock normals;
    LaneInt sided;  // the lanes with a side
    LaneInt eye_side;
} SidedPoints;

static TriangleBlock gather_triangles(Triangles triangles, LaneInt ids, LaneInt lanes) {
    __global const float* rows[GN_LANES];
    for (uint lane = 0; lane < GN_LANES; ++lane)
        rows[lane] = triangles.vertices + 9 * (size_t)(LANE_OF_INT(lanes, lane) ? (uint)LANE_OF_INT(ids, lane) : 0u);
    return load_triangle_rows(rows);
}

static SidedPoints load_sided(const LightSidesParams params, size_t block, __global const float* vertices,
                              __global const float* positions, __global const uint* receivers,
                              __global const float* normals, uint* exact) {
    SidedPoints s;
    s.points = load_block(positions, params.points, block);
    s.sided = valid_lanes(params.points, block) & present_lanes(s.points);
    if (params.side == SIDE_NORMALS) {
        s.normals = load_block(normals, params.points, block);
        s.sided &= present_lanes(s.normals);
        return s;
    }
    Triangles triangles = triangles_of(vertices, params.triangles);
    LaneInt ids = load_lane_ids(receivers + params.points.first / 3u, params.points, block);
    s.sided &= lanes_below(ids, triangles.count);
    s.receivers = gather_triangles(triangles, ids, s.sided);
    s.sided &= finite_triangles(&s.receivers);
    s.receiver_normals = triangle_normals(&s.receivers);
    s.eye_side = (LaneInt)(1);
    if (params.side == SIDE_EYE) {
        float3 at = eye_of(params.points);
        PointBlock eye = same_point(at.x, at.y, at.z);
        s.eye_side = lanes_side(&s.receivers, &s.receiver_normals, &eye, &s.receivers.a, s.sided, exact);
    }
    return s;
}

// The lanes that face a light.
static LaneInt lanes_face(const SidedPoints* s, uint side, float3 direction, uint* exact) {
    if (side == SIDE_NORMALS) return lanes_normal_faces(&s->normals, direction, s->sided);
    PointBlock towards = same_point(direction.x, direction.y, direction.z), from = same_point(0.0f, 0.0f, 0.0f);
    LaneInt light_side = lanes_side(&s->receivers, &s->receiver_normals, &towards, &from, s->sided, exact);
    return s->sided & LANE_COMPARE(light_side, ==, s->eye_side) & LANE_COMPARE(light_side, !=, (LaneInt)(0));
}

GN_NOINLINE_ON_CPU void decide_light_sides(ItemRange items, const LightSidesParams params,
                                           __global const LightBundle* bundles, __global const float* vertices,
                                           __global const float* positions, __global const uint* receivers,
                                           __global const float* normals, __global uint* masks) {
    uint exact = 0;
    GN_FOR_EACH_OF(block, items) {
        SidedPoints s;
        if (params.side != SIDE_NONE) s = load_sided(params, block, vertices, positions, receivers, normals, &exact);
        for (uint b = 0; b < params.bundle_count; ++b) {
            uint count = bundles[b].light_count;
            LaneInt mask = (LaneInt)((int)(count < 32u ? (1u << count) - 1u : GN_NO_ID));
            for (uint l = 0; params.side != SIDE_NONE && l < count; ++l)
                mask &= ~(s.sided & ~lanes_face(&s, params.side, light_direction(&bundles[b], l), &exact) &
                          (LaneInt)((int)(1u << l)));
            store_lanes(LANES_AS_FLOAT(mask), (__global float*)(masks + b * (size_t)params.mask_stride), params.points,
                        block);
        }
    }
}

__kernel void light_sides(const LightSidesParams params, __global const LightBundle* bundles,
                          __global const float* vertices, __global const float* positions,
                          __global const uint* receivers, __global const float* normals, __global uint* masks) {
    decide_light_sides(item_range(block_count(params.points)), params, bundles, vertices, positions, receivers, normals,
                       masks);
}
