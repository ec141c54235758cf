// SPDX-License-Identifier: MIT
// Contract of the shadow-map family: the result of a fit (projection x partition) for the depth pass and the lookups.
// It stays on the device from beginning to end, so a fit can follow the shading points without a read-back.
//
// A shadow map is one or more views. With q = (p - origin, 1), p in world space, a view defines:
//   u = (row_u . q) / (row_w . q),  v = (row_v . q) / (row_w . q)   position in the map, [0, 1] inside it
//   depth = row_depth . q                                           affine along the light, 0 near, 1 far
// All points of one ray of light share u and v, whatever the sign of row_w . q: a perspective warp that turns the
// scene inside out (PSM with the light behind the eye) needs no case of its own, because depth decides the order. Only
// the half of a line with depth > front_depth is in front of a point light; a directional light has front_depth
// -INFINITY. Casters nearer than depth 0 are kept and clamped to 0.
//
// The texel grid may be warped along each axis by a strictly rising function of [0, 1] onto itself:
//   WARP_NONE         x
//   WARP_LOGARITHMIC  v only: log(1 + log_strength v) / log(1 + log_strength), u unchanged (LogPSM)
//   WARP_RECTILINEAR  a table per axis with warp_size segments of equal length, linear between entries (RTW):
//                     tables[forward_first + i], i in [0, warp_size], for u; the next warp_size + 1 for v
// The depth pass is exact under any of the warps: it evaluates triangles at the texels' unwarped centres,
//   tables[centres_first + x], x in [0, width), for u; tables[centres_first + width + y] for v
// Kernel map_projection_centres (map_projection.cl) fills these tables from the warp.
//
// A view with a face serves only the points that a point light sees through that face of the cube around it: face / 2
// is the axis, odd faces lie on its negative side. The view's map may reach farther.
//
// Storage: view's texel (x, y) is texel first_texel + y * row_stride + x of the map. Views one after the other are an
// array; views with a common row_stride are an atlas. A view of width 0 is off.
#pragma once

#include "prelude.h"

#define WARP_NONE 0u
#define WARP_LOGARITHMIC 1u
#define WARP_RECTILINEAR 2u

#define NO_FACE 0xFFFFFFFFu
// Views selected by face alone overlap by this share: rays through an edge must not fall between two views.
#define FACE_RIM 5.0e-4f

GN_STRUCT_BEGIN(MapView)
    float4 row_u, row_v, row_w, row_depth;
    float4 origin;  // [3] unused
    float front_depth;
    float select_near, select_far;  // serves points with camera depth in [select_near, select_far)
    float blend_from;               // from this camera depth on the next view takes over, fully at select_far
    uint warp;
    float log_strength;  // > 0
    uint warp_size;      // segments of a rectilinear table
    uint forward_first;  // index in tables
    uint centres_first;  // index in tables
    uint width, height;  // texels
    uint first_texel, row_stride;
    uint face;          // NO_FACE: the view serves every point in its map
    float scene_depth;  // the length of the scene's diagonal, in depths
    uint padding;
GN_STRUCT_END(MapView, 144)

// All views together, as far as the host knows them.
GN_STRUCT_BEGIN(MapSet)
    uint view_count;
    uint texels;                 // of all views together: the size of the map
    uint texels_per_view;        // at most, width * height
    uint has_camera;             // 0: camera depth is 0, and selection is by containment alone
    float4 eye, camera_forward;  // [3] unused
    float4 light;                // the point light, in world space
GN_STRUCT_END(MapSet, 64)

#ifndef __cplusplus

#define NO_VIEW 0xFFFFFFFFu

static float dot3(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static float dot4(float4 row, float4 p) { return row.x * p.x + row.y * p.y + row.z * p.z + row.w * p.w; }

static float3 cross3(float3 a, float3 b) {
    return (float3)(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static float3 unit3(float3 v) { return v / sqrt(dot3(v, v)); }

// Homogeneous position: (u w, v w, w, depth).
static float4 map_homogeneous(__global const MapView* view, float3 p) {
    float4 q = (float4)(p - view->origin.xyz, 1.0f);
    return (float4)(dot4(view->row_u, q), dot4(view->row_v, q), dot4(view->row_w, q), dot4(view->row_depth, q));
}

// Position of a world point before the warp: (u, v, depth).
static float3 map_uv(__global const MapView* view, float3 p) {
    float4 h = map_homogeneous(view, p);
    return (float3)(h.x / h.z, h.y / h.z, h.w);
}

static float warp_by_table(__global const float* table, uint segments, float x) {
    float at = clamp(x, 0.0f, 1.0f) * (float)segments;
    uint segment = min((uint)at, segments - 1);
    return table[segment] + (at - (float)segment) * (table[segment + 1] - table[segment]);
}

static float unwarp_by_table(__global const float* table, uint segments, float warped) {
    uint low = 0, high = segments;  // table[low] <= warped < table[high]
    while (high - low > 1) {
        uint middle = (low + high) / 2;
        if (table[middle] <= warped)
            low = middle;
        else
            high = middle;
    }
    float span = table[low + 1] - table[low];
    float inside = span > 0.0f ? clamp((warped - table[low]) / span, 0.0f, 1.0f) : 0.5f;
    return ((float)low + inside) / (float)segments;
}

// The warp, axis 0 (u) or 1 (v); for values outside [0, 1] the caller clamps the result if needed.
static float map_warp(__global const MapView* view, __global const float* tables, uint axis, float x) {
    if (view->warp == WARP_LOGARITHMIC && axis == 1u)
        return log1p(view->log_strength * fmax(x, 0.0f)) / log1p(view->log_strength);
    if (view->warp == WARP_RECTILINEAR)
        return warp_by_table(tables + view->forward_first + axis * (view->warp_size + 1), view->warp_size, x);
    return x;
}

static float map_unwarp(__global const MapView* view, __global const float* tables, uint axis, float warped) {
    if (view->warp == WARP_LOGARITHMIC && axis == 1u)
        return expm1(warped * log1p(view->log_strength)) / view->log_strength;
    if (view->warp == WARP_RECTILINEAR)
        return unwarp_by_table(tables + view->forward_first + axis * (view->warp_size + 1), view->warp_size, warped);
    return warped;
}

// Position in the map in texels, after the warp: texel (x, y) has its centre at (x + 0.5, y + 0.5).
static float2 map_texels(__global const MapView* view, __global const float* tables, float2 uv) {
    return (float2)(map_warp(view, tables, 0u, uv.x) * (float)view->width,
                    map_warp(view, tables, 1u, uv.y) * (float)view->height);
}

static float camera_depth_of(MapSet set, float3 p) {
    return set.has_camera ? dot3(p - set.eye.xyz, set.camera_forward.xyz) : 0.0f;
}

// True if the light sees this direction through the face of its cube, widened by `rim` times the face's half width.
static bool is_on_face(float3 from_light, uint face, float rim) {
    float d[3] = {from_light.x, from_light.y, from_light.z};
    uint axis = face / 2;
    float reach = ((face & 1u) ? -d[axis] : d[axis]) * (1.0f + rim);
    return fabs(d[(axis + 1) % 3]) <= reach && fabs(d[(axis + 2) % 3]) <= reach;
}

// True if the view serves the point: inside the map, in front of the light, and seen through the view's face, if any.
static bool is_in_map(MapSet set, __global const MapView* view, float3 p) {
    if (view->width == 0) return false;
    if (view->face != NO_FACE && !is_on_face(p - set.light.xyz, view->face, FACE_RIM)) return false;
    float3 at = map_uv(view, p);
    return at.x >= 0.0f && at.x <= 1.0f && at.y >= 0.0f && at.y <= 1.0f && at.z > view->front_depth;
}

// The first view that serves the point and has the point's camera depth in its interval. NO_VIEW: the point is outside
// all maps, and lit.
static uint select_view(MapSet set, __global const MapView* views, float3 p) {
    float camera_depth = camera_depth_of(set, p);
    for (uint i = 0; i < set.view_count; ++i) {
        __global const MapView* view = views + i;
        if (camera_depth >= view->select_near && camera_depth < view->select_far && is_in_map(set, view, p)) return i;
    }
    return NO_VIEW;
}

// The next view's share of the visibility, if the view after `index` serves the point: 0 unless slices blend.
static float share_of_next(MapSet set, __global const MapView* views, uint index, float3 p) {
    __global const MapView* view = views + index;
    if (!(view->blend_from < view->select_far) || index + 1 >= set.view_count) return 0.0f;
    float camera_depth = camera_depth_of(set, p);
    if (!(camera_depth > view->blend_from) || !is_in_map(set, view + 1, p)) return 0.0f;
    return (camera_depth - view->blend_from) / (view->select_far - view->blend_from);
}

#endif
