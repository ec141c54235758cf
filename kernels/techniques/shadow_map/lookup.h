// SPDX-License-Identifier: MIT
// Contract of the lookups: from a shading point and a shadow map to visibility in [0, 1].
//
// A point with visibility 1 that a view serves (map_view.h) is looked up there; every other keeps its value: in shadow
// because it faces away, or lit because it is absent or outside all maps.
#ifndef GN_LOOKUP_H
#define GN_LOOKUP_H

#include "techniques/shadow_map/map_view.h"

// Lookups of depths.
#define LOOKUP_HARD 0u      // the texel under the point (Williams 1978)
#define LOOKUP_PCF 1u       // mean of taps x taps texels (Reeves, Salesin, Cook 1987; survey 101)
#define LOOKUP_BILINEAR 2u  // the same, moving smoothly: (taps + 1)^2 texels, the outer ones by their share
#define LOOKUP_GAUSSIAN 3u  // as bilinear, weighted by a Gaussian of sigma taps / 4.5 (Gruen 2010; survey 102-103)
#define LOOKUP_TWELVE 4u    // 12 taps distributed like a Gaussian of sigma `softness` texels (document 004)
#define LOOKUP_PCSS 5u      // kernel as wide as the penumbra estimated from the blockers (Fernando 2005; survey 133)

#define MOST_TAPS 33

GN_STRUCT_BEGIN(LookupPlan)
    uint lookup;
    uint taps;
    uint adaptive;        // 1: each texel is compared with the receiver's plane at that texel's centre
    float receiver_bias;  // depth; subtracted from the receiver's
    float softness;       // texels
    float light_size;     // a position: world units across; a direction: tangent of the angle across
    uint triangle_count;
    uint padding;
GN_STRUCT_END(LookupPlan, 32)

#ifndef __cplusplus

#include "simd/points.h"

// What is known of a point in its view.
typedef struct Receiver {
    __global const MapView* view;
    __global const float* tables;
    float2 uv;         // before the warp
    float2 at_texels;  // after it
    float depth;
    float4 homogeneous;
    bool has_plane;
    float4 tangent_a, tangent_b;  // of the receiver's plane, as map_homogeneous moves
} Receiver;

// How map_homogeneous changes along a world direction.
static float4 homogeneous_direction(__global const MapView* view, float3 d) {
    float4 q;
    q.x = view->row_u[0] * d.x + view->row_u[1] * d.y + view->row_u[2] * d.z;
    q.y = view->row_v[0] * d.x + view->row_v[1] * d.y + view->row_v[2] * d.z;
    q.z = view->row_w[0] * d.x + view->row_w[1] * d.y + view->row_w[2] * d.z;
    q.w = view->row_depth[0] * d.x + view->row_depth[1] * d.y + view->row_depth[2] * d.z;
    return q;
}

// Unit tangents of the triangle's plane; false if it has none.
static bool plane_tangents(Triangle t, float3* tangent_a, float3* tangent_b) {
    float3 ab = t.b - t.a, ac = t.c - t.a;
    float3 normal = cross(ab, ac);
    float size = length(normal), along = length(ab);
    if (!(size > 0.0f) || !(along > 0.0f) || !GN_FINITE(size)) return false;
    *tangent_a = ab / along;
    *tangent_b = cross(normal / size, *tangent_a);
    return true;
}

// By pointer: oclgrind cannot run what clang makes of a structure this large when it is returned.
static void make_receiver(__global const MapView* view, __global const float* tables, float3 p, Receiver* r) {
    r->view = view;
    r->tables = tables;
    r->homogeneous = map_homogeneous(view, p);
    r->uv = r->homogeneous.xy / r->homogeneous.z;
    r->depth = r->homogeneous.w;
    r->at_texels = map_texels(view, tables, r->uv);
    r->has_plane = false;
}

// Is the point to be looked up, and in which view?
static bool is_looked_up(MapSet set, PointsLayout layout, __global const float* positions,
                         __global const float* visibility, __global const MapView* views, size_t i, float3* p,
                         uint* index) {
    if (visibility[i] != 1.0f) return false;
    *p = load_point(positions, layout, i);
    if (!is_present(*p)) return false;
    *index = select_view(set, views, *p);
    return *index != NO_VIEW;
}

// Depth of the receiver's plane on the ray of light through (u, v): p + a tangent_a + b tangent_b lies on it if
//   (X - u W) = 0 and (Y - v W) = 0,
// two linear equations in a and b. No plane, or one edge-on to the light: the point's own depth.
static float plane_depth(const Receiver* r, float2 uv) {
    float2 column_a = r->tangent_a.xy - uv * r->tangent_a.z, column_b = r->tangent_b.xy - uv * r->tangent_b.z;
    float2 right = uv * r->homogeneous.z - r->homogeneous.xy;
    float det = column_a.x * column_b.y - column_b.x * column_a.y;
    float a = (right.x * column_b.y - column_b.x * right.y) / det;
    float b = (column_a.x * right.y - right.x * column_a.y) / det;
    float depth = r->homogeneous.w + a * r->tangent_a.w + b * r->tangent_b.w;
    return GN_FINITE(depth) ? depth : r->depth;
}

// Texels that a world length across the light covers at the point, along u and v.
static float2 texels_per_length(const Receiver* r) {
    __global const MapView* view = r->view;
    float u = length((float3)(view->row_u[0] - r->uv.x * view->row_w[0], view->row_u[1] - r->uv.x * view->row_w[1],
                              view->row_u[2] - r->uv.x * view->row_w[2]));
    float v = length((float3)(view->row_v[0] - r->uv.y * view->row_w[0], view->row_v[1] - r->uv.y * view->row_w[1],
                              view->row_v[2] - r->uv.y * view->row_w[2]));
    // Of a warped map: how dense its texels are where the point lies.
    float step = 0.5f / (float)max(view->width, view->height);
    float2 low = map_texels(view, r->tables, clamp(r->uv - step, 0.0f, 1.0f));
    float2 high = map_texels(view, r->tables, clamp(r->uv + step, 0.0f, 1.0f));
    float2 span = clamp(r->uv + step, 0.0f, 1.0f) - clamp(r->uv - step, 0.0f, 1.0f);
    return (float2)(u, v) / fabs(r->homogeneous.z) * (high - low) / span;
}

static size_t texel_at(const Receiver* r, int x, int y) {
    uint column = (uint)clamp(x, 0, (int)r->view->width - 1), row = (uint)clamp(y, 0, (int)r->view->height - 1);
    return r->view->first_texel + (size_t)row * r->view->row_stride + column;
}

#endif
#endif
