// SPDX-License-Identifier: MIT
// Contract of the lookups: from a shading point and a shadow map to visibility in [0, 1].
//
// If a point has visibility 1 and a view serves it (map_view.h), the lookup decides it. Every other point keeps its
// value: a backfacing point is in shadow; a point that is absent or outside all maps is lit.
#pragma once

#include "rivals/shadow_map/moments.h"

// Lookups of depths.
#define LOOKUP_HARD 0u       // the texel under the point (Williams 1978)
#define LOOKUP_PCF 1u        // mean of taps x taps texels (Reeves, Salesin, Cook 1987)
#define LOOKUP_BILINEAR 2u   // the same, moving smoothly: (taps + 1)^2 texels, the outer texels by their share
#define LOOKUP_GAUSSIAN 3u   // as bilinear, weighted by a Gaussian of sigma taps / 4.5 (Gruen 2010)
#define LOOKUP_TWELVE 4u     // 12 taps distributed like a Gaussian of sigma `softness` texels
#define LOOKUP_PCSS 5u       // kernel as wide as the penumbra estimated from the blockers (Fernando 2005)
#define LOOKUP_PCSS_GRID 6u  // the same, the taps on one grid for all points

#define MAX_TAPS 33

GN_STRUCT_BEGIN(LookupPlan)
    ulong first_float;  // where the triangles begin in their buffer
    uint triangle_count;
    uint lookup, taps;
    uint adaptive;     // 1: each texel is compared with the receiver's plane at that texel's centre
    float softness;    // texels
    float light_size;  // point light: world units across; directional light: tangent of the angle across
    StorePlan store;   // of depths only receiver_bias
    PixelSteps steps;  // of the points' camera; read where store.mips is not 0
GN_STRUCT_END(LookupPlan, 160)

#ifndef __cplusplus

#include "simd/points.h"

// A point in the view that serves it.
typedef struct MapPoint {
    __global const MapView* view;
    __global const float* tables;
    float2 uv;         // before the warp
    float2 at_texels;  // after it
    float depth;
    float4 homogeneous;
    bool has_plane;
    float4 tangent_a, tangent_b;  // of the receiver's plane, as map_homogeneous changes along them
} MapPoint;

// The change of map_homogeneous along a world direction.
static float4 homogeneous_direction(__global const MapView* view, float3 d) {
    return (float4)(dot3(view->row_u.xyz, d), dot3(view->row_v.xyz, d), dot3(view->row_w.xyz, d),
                    dot3(view->row_depth.xyz, d));
}

// Writes through a pointer: oclgrind cannot run clang's code for returning a structure this large.
static void make_map_point(__global const MapView* view, __global const float* tables, float3 p, MapPoint* point) {
    point->view = view;
    point->tables = tables;
    point->homogeneous = map_homogeneous(view, p);
    point->uv = point->homogeneous.xy / point->homogeneous.z;
    point->depth = point->homogeneous.w;
    point->at_texels = map_texels(view, tables, point->uv);
    point->has_plane = false;
}

// Gives the point the plane of its receiver, if the triangle has one: two unit tangents span it.
static void set_receiver_plane(MapPoint* point, Triangle t) {
    float3 ab = t.b - t.a, normal = cross(ab, t.c - t.a);
    float size = length(normal), along = length(ab);
    if (!(size > 0.0f) || !(along > 0.0f) || !GN_FINITE(size)) return;
    float3 tangent = ab / along;
    point->has_plane = true;
    point->tangent_a = homogeneous_direction(point->view, tangent);
    point->tangent_b = homogeneous_direction(point->view, cross(normal / size, tangent));
}

// True if the map serves the point; writes its position and the view.
static bool is_looked_up(MapSet set, PointsLayout layout, __global const float* positions,
                         __global const float* visibility, __global const MapView* views, size_t i, float3* p,
                         uint* index) {
    if (visibility[i] != 1.0f) return false;
    *p = load_point(positions, layout, i);
    if (!is_present(*p)) return false;
    *index = select_view(set, views, *p);
    return *index != NO_VIEW;
}

// Depth of the receiver's plane on the ray of light through (u, v): p + a tangent_a + b tangent_b lies on that ray if
//   (X - u W) = 0 and (Y - v W) = 0,
// two linear equations in a and b. Without a plane, or with a plane edge-on to the light: the point's own depth.
static float plane_depth(const MapPoint* point, float2 uv) {
    float2 column_a = point->tangent_a.xy - uv * point->tangent_a.z,
           column_b = point->tangent_b.xy - uv * point->tangent_b.z;
    float2 right = uv * point->homogeneous.z - point->homogeneous.xy;
    float det = column_a.x * column_b.y - column_b.x * column_a.y;
    float a = (right.x * column_b.y - column_b.x * right.y) / det;
    float b = (column_a.x * right.y - right.x * column_a.y) / det;
    float depth = point->homogeneous.w + a * point->tangent_a.w + b * point->tangent_b.w;
    return GN_FINITE(depth) ? depth : point->depth;
}

// Number of texels under a world length across the light at the point, along u and v.
static float2 texels_per_length(const MapPoint* point) {
    __global const MapView* view = point->view;
    float3 row_w = view->row_w.xyz;
    float u = length(view->row_u.xyz - point->uv.x * row_w);
    float v = length(view->row_v.xyz - point->uv.y * row_w);
    // For a warped map: the density of its texels at the point.
    float step = 0.5f / (float)max(view->width, view->height);
    float2 low = map_texels(view, point->tables, clamp(point->uv - step, 0.0f, 1.0f));
    float2 high = map_texels(view, point->tables, clamp(point->uv + step, 0.0f, 1.0f));
    float2 span = clamp(point->uv + step, 0.0f, 1.0f) - clamp(point->uv - step, 0.0f, 1.0f);
    return (float2)(u, v) / fabs(point->homogeneous.z) * (high - low) / span;
}

static size_t texel_at(const MapPoint* point, int x, int y) {
    uint column = (uint)clamp(x, 0, (int)point->view->width - 1), row = (uint)clamp(y, 0, (int)point->view->height - 1);
    return point->view->first_texel + (size_t)row * point->view->row_stride + column;
}

#endif
