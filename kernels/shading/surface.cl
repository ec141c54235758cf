// SPDX-License-Identifier: MIT
// Albedo and shading normal of each pixel. Contract: surface.h.
#include "shading/surface.h"
#include "shading/texture.clh"

// Barycentric coordinates of the pixel's centre, and their derivatives.
typedef struct Barycentric {
    float3 at, across, down;
} Barycentric;

GN_INLINE_ON_CPU float3 surface_vector(const float* v) { return (float3)(v[0], v[1], v[2]); }

GN_INLINE_ON_CPU float3 surface_cross(float3 v, float3 w) {
    return (float3)(v.y * w.z - v.z * w.y, v.z * w.x - v.x * w.z, v.x * w.y - v.y * w.x);
}
GN_INLINE_ON_CPU float surface_dot(float3 v, float3 w) { return v.x * w.x + v.y * w.y + v.z * w.z; }

static Barycentric barycentric_of(Triangle t, SurfaceParams params, float x, float y) {
    float3 eye = surface_vector(params.eye);
    float3 across = surface_vector(params.across), down = surface_vector(params.down);
    float3 d = surface_vector(params.corner) + across * x + down * y;
    float3 a = t.a - eye, b = t.b - eye, c = t.c - eye;
    // An edge as second row: the rounding grows with distance x edge, not with distance squared.
    float3 of_a = surface_cross(b, t.c - t.b), of_b = surface_cross(c, t.a - t.c), of_c = surface_cross(a, t.b - t.a);
    float3 w = (float3)(surface_dot(of_a, d), surface_dot(of_b, d), surface_dot(of_c, d));
    float sum = w.x + w.y + w.z, inverse = 1.0f / sum;
    Barycentric found;
    found.at = w * inverse;
    if (!GN_FINITE(inverse) || !GN_FINITE(found.at.x + found.at.y + found.at.z)) {
        found.at = (float3)(1.0f / 3.0f);
        found.across = found.down = (float3)(0.0f);
        return found;
    }
    // Textures are filtered over the square that the sample stands for.
    across *= params.pixel_share, down *= params.pixel_share;
    float3 w_across = (float3)(surface_dot(of_a, across), surface_dot(of_b, across), surface_dot(of_c, across));
    float3 w_down = (float3)(surface_dot(of_a, down), surface_dot(of_b, down), surface_dot(of_c, down));
    found.across = (w_across - found.at * (w_across.x + w_across.y + w_across.z)) * inverse;
    found.down = (w_down - found.at * (w_down.x + w_down.y + w_down.z)) * inverse;
    // The ray meets the triangle: what is outside is rounding.
    found.at = clamp(found.at, 0.0f, 1.0f);
    found.at /= found.at.x + found.at.y + found.at.z;
    return found;
}

// What triangles have, by slot (surface.h).
typedef struct SurfaceArrays {
    __global const uint* materials;
    __global const float* coordinates;
    __global const float* colors;
    __global const uint* normals;
} SurfaceArrays;

GN_INLINE_ON_CPU float2 blended_coordinates(__global const float* uv, float3 of) {
    return (float2)(uv[0] * of.x + uv[2] * of.y + uv[4] * of.z, uv[1] * of.x + uv[3] * of.y + uv[5] * of.z);
}

// A corner's normal from the octahedral map; 0 if there is none.
GN_INLINE_ON_CPU float3 unpacked_normal(uint bits) {
    if (bits == 0u) return (float3)(0.0f);
    float x = (float)(bits & 0xFFFFu) * (2.0f / 65534.0f) - (65536.0f / 65534.0f);
    float y = (float)(bits >> 16) * (2.0f / 65534.0f) - (65536.0f / 65534.0f);
    float z = 1.0f - fabs(x) - fabs(y);
    float fold = fmax(-z, 0.0f);
    x += x >= 0.0f ? -fold : fold;
    y += y >= 0.0f ? -fold : fold;
    return (float3)(x, y, z) / sqrt(x * x + y * y + z * z);
}

// The interpolated normal, on the eye's side of the triangle; the geometric normal if corners have none.
static float3 shading_normal(__global const uint* normals, float3 at, float3 geometric) {
    if (normals[0] == 0u || normals[1] == 0u || normals[2] == 0u) return geometric;
    float3 n =
        unpacked_normal(normals[0]) * at.x + unpacked_normal(normals[1]) * at.y + unpacked_normal(normals[2]) * at.z;
    float size = sqrt(surface_dot(n, n));
    if (!(size > 1e-3f)) return geometric;
    n /= size;
    float side = surface_dot(n, geometric);
    return fabs(side) > 1e-3f ? (side < 0.0f ? -n : n) : geometric;
}

// The sine of the largest angle between the triangle's normal and a corner's; 0 if corners have none.
static float spread_of_normals(__global const uint* normals, float3 geometric) {
    float least = 1.0f;
    for (int i = 0; i < 3; ++i) {
        if (normals[i] == 0u) return 0.0f;
        least = fmin(least, fabs(surface_dot(unpacked_normal(normals[i]), geometric)));
    }
    return sqrt(fmax(1.0f - least * least, 0.0f));
}

static float3 albedo_of(const SurfaceArrays* of, size_t slot, const Barycentric* at, bool has_colors,
                        __global const SurfaceMaterial* materials, __global const uchar4* texels,
                        __global const float* decoded) {
    SurfaceMaterial material = materials[of->materials[slot]];
    float3 albedo = surface_vector(material.base_color);
    if (has_colors) {
        __global const float* c = of->colors + 9 * slot;
        albedo *= clamp(vload3(0, c) * at->at.x + vload3(1, c) * at->at.y + vload3(2, c) * at->at.z, 0.0f, 1.0f);
    }
    if (material.width == 0u) return albedo;
    Texels texture = {
        texels + material.first_texel, decoded, material.width, material.height, material.wrap_u, material.wrap_v};
    __global const float* uv = of->coordinates + 6 * slot;
    TextureArea area = {blended_coordinates(uv, at->at), blended_coordinates(uv, at->across),
                        blended_coordinates(uv, at->down)};
    return albedo * filtered(&texture, &area, material.is_nearest != 0u, material.minification);
}

// `slots`: of each pixel, or GN_NO_ID. `normals`: the geometric ones, in whose place the shading normals are written.
// Sky: 0.
__kernel void surfaces(SurfaceParams params, __global const float* vertices, __global const uint* visible,
                       __global const uint* slots, __global const uint* triangle_material,
                       __global const float* coordinates, __global const float* corner_colors,
                       __global const uint* corner_normals, __global const SurfaceMaterial* materials,
                       __global const uchar4* texels, __global const float* decoded, __global float* albedos,
                       __global float* normals, __global float* spreads GN_SHARES) {
    SurfaceArrays of = {triangle_material, coordinates, corner_colors, corner_normals};
    GN_FOR_EACH_OF(pixel, GN_SHARED_RANGE(params.width * params.height)) {
        float3 albedo = (float3)(0.0f);
        float spread = 0.0f;
        size_t slot = slots[pixel];
        if (slot != GN_NO_ID) {
            Triangle t = load_triangle(vertices + params.triangles.first_float, visible[pixel]);
            Barycentric at = barycentric_of(t, params, (float)(pixel % params.width), (float)(pixel / params.width));
            albedo = albedo_of(&of, slot, &at, params.has_colors != 0u, materials, texels, decoded);
            if (params.has_normals != 0u) {
                float3 geometric = vload3(pixel, normals);
                vstore3(shading_normal(corner_normals + 3 * slot, at.at, geometric), pixel, normals);
                spread = spread_of_normals(corner_normals + 3 * slot, geometric);
            }
        }
        vstore3(albedo, pixel, albedos);
        if (params.has_normals != 0u) spreads[pixel] = spread;
    }
    GN_END_SHARES;
}
