// SPDX-License-Identifier: MIT
// Contract of bundles: up to 32 lights whose bits are one mask word of each point and, if the lights are neighbours,
// cones that contain their directions, or boxes that contain their positions. All lights of a run are of one kind;
// kernels with GN_POINT_LIGHTS take point lights.
#pragma once

#include "simd/points.h"

#define MAX_BUNDLE_LIGHTS 32u
// Lights of a sector rise by more than this, of a length of 1: so rounding and underflow take little of their slopes.
#define SECTOR_LEAST_RISE 1e-6f

// All directions are scaled by powers of two, exactly, so that the largest coordinate of each is between 1/2 and 1. A
// cone contains the directions of some lights: for each direction D there are s > 0 and u, v in [-1, 1] with s D =
// middle + u across + v along; middle, across and along have coordinates of at most 1.
//
// The position S of a point light is not scaled. A box contains the positions of some point lights: for each S there
// are u, v and w in [-1, 1] with S = middle + u across + v along + w depth; planes[0] is depth.
GN_STRUCT_BEGIN(LightCone)
    // Outward normals of the beam's four sides and of its near side: n . D < 0 for each light.
    float planes[5][3];
    float middle[3], across[3], along[3];
GN_STRUCT_END(LightCone, 96)

// The axes of a directional light. w points towards the light; u and v are perpendicular to D but for rounding: |u . D|
// and |v . D| are at most 5.2e-8 |D|. No coordinate of u, v and w exceeds 1.
GN_STRUCT_BEGIN(LightAxes)
    float u[3], v[3], w[3];
    float padding;
GN_STRUCT_END(LightAxes, 40)

// Neighbouring lights, and a tree of cones: of all lights, of each half of the slots, of each quarter, and so on down
// to single lights. If all open lights lie in one part, the cone of that part is thinner.
#define LIGHT_CONES 63u
GN_STRUCT_BEGIN(LightBundle)
    LightCone cones[LIGHT_CONES];
    float directions[3][MAX_BUNDLE_LIGHTS];  // D or S, coordinate by coordinate; 0 past the last light
    LightAxes axes[MAX_BUNDLE_LIGHTS];
    uint light_count;
    float ground[3];  // for a sector (horizons/horizons.h) the unit vector of its middle along the ground; else 0
GN_STRUCT_END(LightBundle, 7728)

#ifndef __cplusplus
// The cone of the smallest part that contains all lights of a mask.
static __global const LightCone* cone_of(__global const LightBundle* bundle, uint lights) {
    uint part = 0u;
    for (uint size = MAX_BUNDLE_LIGHTS / 2u, first = 0u; part < LIGHT_CONES / 2u; size /= 2u) {
        uint low = ((1u << size) - 1u) << first, high = low << size;
        if ((lights & (low | high)) != lights || ((lights & low) != 0u && (lights & high) != 0u)) break;
        part = 2u * part + ((lights & low) != 0u ? 1u : 2u);
        if ((lights & low) == 0u) first += size;
    }
    return &bundle->cones[part];
}

// Splits `lights` at the level of the cone tree where they first differ; returns the lower half, or 0 if that level
// stores no cones.
static uint lower_lights(uint lights) {
    for (uint size = MAX_BUNDLE_LIGHTS / 2u, first = 0u; size >= 2u * MAX_BUNDLE_LIGHTS / (LIGHT_CONES + 1u);
         size /= 2u) {
        uint low = ((1u << size) - 1u) << first;
        if ((lights & low) != 0u && (lights & ~low) != 0u) return lights & low;
        if ((lights & low) == 0u) first += size;
    }
    return 0u;
}

static float3 light_box_depth(__global const LightCone* box) { return vload3(0, box->planes[0]); }

static float along_axis(const float* axis, float3 p) { return fma(axis[0], p.x, fma(axis[1], p.y, axis[2] * p.z)); }

static float3 light_direction(__global const LightBundle* bundle, uint light) {
    return (float3)(bundle->directions[0][light], bundle->directions[1][light], bundle->directions[2][light]);
}
#endif
