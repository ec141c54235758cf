// SPDX-License-Identifier: MIT
// Contract of footprints: the size of a pixel in a shadow map, ds and dt, the steps in texels from a pixel to the next
// along x and y.
//
// A step is taken on the plane of the point's receiver: at pixel (x, y) the ray r meets the plane at e + z r; one pixel
// to the side, at r + a, the meeting point moves by z (a - r (n . a) / (n . r)).
#pragma once

#include "rivals/shadow_map/map_projection.h"

// One pixel's step of the camera's rays; the rays' component along forward is 1.
GN_STRUCT_BEGIN(PixelSteps)
    float4 eye, forward, step_x, step_y;
GN_STRUCT_END(PixelSteps, 64)

#ifndef __cplusplus

#include "rivals/shadow_map/homography.clh"
#include "simd/points.h"

// The meeting point of the ray one pixel to the side, minus the meeting point of this pixel's ray.
static float3 pixel_step(float3 ray, float depth, float3 normal, float3 step) {
    return (step - ray * (dot3(normal, step) / dot3(normal, ray))) * depth;
}

// Texels from p to p + step, by the middle of the step.
static float2 texel_step(__global const MapView* view, __global const float* tables, float3 p, float3 step) {
    float3 from = map_uv(view, p - 0.5f * step), to = map_uv(view, p + 0.5f * step);
    return map_texels(view, tables, to.xy) - map_texels(view, tables, from.xy);
}

static void pixel_footprint(const PixelSteps* steps, __global const MapView* view, __global const float* tables,
                            Triangle t, float3 p, float2* ds, float2* dt) {
    float3 normal = cross3(t.b - t.a, t.c - t.a), from_eye = p - steps->eye.xyz;
    float depth = dot3(from_eye, steps->forward.xyz);
    float3 ray = from_eye / depth;
    *ds = texel_step(view, tables, p, pixel_step(ray, depth, normal, steps->step_x.xyz));
    *dt = texel_step(view, tables, p, pixel_step(ray, depth, normal, steps->step_y.xyz));
}

#endif
