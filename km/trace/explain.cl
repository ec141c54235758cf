// SPDX-License-Identifier: MIT
// Explains one point: the signs of the determinants of its receiver, and of each triangle that its shadow ray meets or
// for which the float level of the exact predicate was not certain. The predicates are those that decide a frame
// (decide_pair(), is_backfacing()). Two launches: explain_point, then explain_triangles over the whole scene.
#include "exact/decide_pair.clh"
#include "receivers/facing.clh"
#include "trace/explain.h"

// EXPLAINED_...: decide_pair(), and for a pair that does not block, whether the texture alone lets the ray pass.
static uint meeting_of(Triangles triangles, uint id, float3 p, float4 light, int* level) {
    if (decide_pair(triangles, id, p, light, level)) return EXPLAINED_BLOCKS;
#ifdef GN_CUT_OUTS
    int level_of_triangle = DET3_BY_FLOAT;
    if (blocks(load_triangle(triangles.vertices, id), p, light, &level_of_triangle)) return EXPLAINED_CLEAR;
#endif
    return EXPLAINED_MISSED;
}

static ExplainedTriangle signs_of_triangle(Triangles triangles, uint id, float3 p, float4 light) {
    ExplainedTriangle signs;
    Triangle t = load_triangle(triangles.vertices, id);
    int level = DET3_BY_FLOAT, any_level = DET3_BY_FLOAT;
    float3 start = light.w != 0.0f ? p : (float3)(0.0f);  // D = light - start
    bool is_finite = is_finite_triangle(t) && is_present(p);
    signs.triangle = id;
    signs.meets = is_finite ? meeting_of(triangles, id, p, light, &level) : EXPLAINED_MISSED;
    signs.level = level;
    signs.point_side = is_finite ? det3_sign(t.b, t.a, t.c, t.a, p, t.a, &any_level) : 0;
    signs.light_side = is_finite ? side_of_light(t, light, &any_level) : 0;
    const float3 vertices[4] = {t.a, t.b, t.c, t.a};
    for (int i = 0; i < 3; ++i) {
        vstore3(vertices[i], i, signs.vertices);
        signs.edges[i] = is_finite ? det3_sign(vertices[i], p, vertices[i + 1], p, light.xyz, start, &any_level) : 0;
    }
    return signs;
}

__kernel void explain_point(const ExplainParams params, __global const float* positions, __global const uint* receivers,
                            __global const float* vertices, __global ExplainedPoint* out) {
    if (get_global_id(0) != 0) return;
    float3 p = load_point(positions, params.points, params.index);
    float4 light = vload4(0, params.light);
    Triangles triangles = triangles_of(vertices, params.triangles);
    ExplainedPoint point;
    int level = DET3_BY_FLOAT;
    vstore3(p, 0, point.position);
    point.receiver = params.points.has_receivers ? receivers[params.index] : GN_NO_ID;
    if (point.receiver >= triangles.count) point.receiver = GN_NO_ID;
    point.is_backfacing = 0;
    point.eye_side = 0;
    point.count = 0;
    if (point.receiver != GN_NO_ID) {
        Triangle receiver = load_triangle(triangles.vertices, point.receiver);
        point.on_receiver = signs_of_triangle(triangles, point.receiver, p, light);
        if (params.points.has_eye && is_present(p) && is_finite_triangle(receiver)) {
            float3 eye = eye_of(params.points);
            point.is_backfacing = is_backfacing(receiver, light, eye, &level);
            point.eye_side = det3_sign(receiver.b, receiver.a, receiver.c, receiver.a, eye, receiver.a, &level);
        }
    }
    point.facing_level = level;
    *out = point;
}

// Appends the triangles that the shadow ray meets, and the other triangles for which the float level of the exact
// predicate was not certain.
__kernel void explain_triangles(const ExplainParams params, __global const float* vertices,
                                __global ExplainedPoint* point, __global ExplainedTriangle* list) {
    float3 p = vload3(0, point->position);
    float4 light = vload4(0, params.light);
    Triangles triangles = triangles_of(vertices, params.triangles);
    uint receiver = point->receiver;
    if (!is_present(p)) return;
    GN_FOR_EACH(i, triangles.count) {
        int level;
        if (i == receiver || !is_finite_triangle(load_triangle(triangles.vertices, i))) continue;
        uint meets = meeting_of(triangles, (uint)i, p, light, &level);
        if (meets == EXPLAINED_MISSED && level == DET3_BY_FLOAT) continue;
        uint slot = atomic_inc(&point->count);
        if (slot < params.capacity) list[slot] = signs_of_triangle(triangles, (uint)i, p, light);
    }
}
