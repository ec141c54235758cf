// SPDX-License-Identifier: MIT
// Shade: albedo times (ambient + the lights' visibility * Lambert), times the exposure, through the tone curve, to
// 8-bit sRGB through a table that the host computes, so that no device's pow() can change a pixel. The ambient light
// comes mostly from above and a little from one side, so that shapes stay visible in shadow.
#include "camera/shade.h"

#define AMBIENT 0.25f

// Normals that are farther apart than this sine (30 degrees) are meant to show edges.
#define MOST_SHIFT 0.5f

// The light of the whole sky, beside the 1 - AMBIENT of a light that shines from above; and the part of the ambient
// light that stays beside it.
#define SKY_LIGHT 0.45f
#define REFLECTED_AMBIENT 0.5f

static uchar to_srgb(float linear, __global const uchar* table) {
    return table[(int)(clamp(linear, 0.0f, 1.0f) * (float)(SRGB_TABLE_SIZE - 1) + 0.5f)];
}

// Unit vector towards the light, up to the last bits (pictures only, never a decision).
static float3 towards_light(float3 p, float4 light) {
    float3 d = light.w != 0.0f ? light.xyz - p : light.xyz;
    float largest = fmax(fmax(fabs(d.x), fabs(d.y)), fabs(d.z));
    if (!(largest > 0.0f)) return (float3)(0.0f);
    d /= largest;
    return d / sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
}

// Adds one light's part to `lambert`, which is 0 before the first.
__kernel void shade_light(ShadeParams params, __global const float* positions, __global const uint* visible,
                          __global const float* normals, __global const float* visibility, __global float* lambert) {
    PointsLayout layout = params.layout;
    float4 light = (float4)(params.light[0], params.light[1], params.light[2], params.light[3]);
    GN_FOR_EACH(pixel, layout.count) {
        if (visible[pixel] == GN_NO_ID) continue;
        float3 n = vload3(pixel, normals);
        float3 l = towards_light(load_point(positions, layout, pixel), light);
        lambert[pixel] += visibility[pixel] * fmax(n.x * l.x + n.y * l.y + n.z * l.z, 0.0f);
    }
}

// The same with shading normals. Visibility is that of the triangle: it ends where the light lies in the triangle's
// plane, and there the shading normal would still get light, up to the sine of its angle to the triangle's (`spreads`),
// so that the edges of triangles would show. So the cosine is shifted: it is 0 from that sine on, and 1 where it is 1,
// as appleseed (F. Beaune 2019) and Blender's Cycles ("Shading Offset") shift it; here the triangle tells by how much.
__kernel void shade_light_smooth(ShadeParams params, __global const float* positions, __global const uint* visible,
                                 __global const float* normals, __global const float* spreads,
                                 __global const float* visibility, __global float* lambert) {
    PointsLayout layout = params.layout;
    float4 light = (float4)(params.light[0], params.light[1], params.light[2], params.light[3]);
    GN_FOR_EACH(pixel, layout.count) {
        if (visible[pixel] == GN_NO_ID) continue;
        float3 n = vload3(pixel, normals);
        float3 l = towards_light(load_point(positions, layout, pixel), light);
        float shift = fmin(spreads[pixel], MOST_SHIFT);
        float cosine = (n.x * l.x + n.y * l.y + n.z * l.z - shift) / (1.0f - shift);
        lambert[pixel] += visibility[pixel] * fmax(cosine, 0.0f);
    }
}

// The light that a pixel shows, linear. With shares of the sky, the light of the sky takes the place of most of the
// ambient light; a little stays for what surfaces reflect.
static float3 light_of_pixel(PictureParams params, uint id, size_t pixel, __global const float* normals,
                             __global const float* lambert, __global const uint* triangle_material,
                             __global const float* base_colors, __global const float* albedos,
                             __global const float* sky_shares) {
    if (id == GN_NO_ID) return (float3)(0.46f, 0.62f, 0.86f) * params.exposure;  // sky
    float3 base = params.has_albedos != 0u ? vload3(pixel, albedos) : vload3(triangle_material[id], base_colors);
    float3 n = vload3(pixel, normals);
    float ambient = AMBIENT * (1.0f + 0.35f * n.y + 0.15f * n.x), sun = (1.0f - AMBIENT) * lambert[pixel];
    if (params.has_sky_shares == 0u) return base * (ambient + sun) * params.exposure;
    float3 sky = (float3)(0.80f, 0.97f, 1.26f) * (SKY_LIGHT * sky_shares[pixel]);
    return base * (sky + (REFLECTED_AMBIENT * ambient + sun)) * params.exposure;
}

// Light above 1 in the range of the picture: the curve of Khronos' PBR Neutral tone mapper (2024) without its first
// step, which is for materials that reflect 4 % at their surface. Colours up to .8 stay as they are; brighter ones keep
// their hue and slowly lose their saturation.
static float3 tone_mapped(float3 color) {
    const float start = 0.8f, rest = 1.0f - start;
    float peak = fmax(fmax(color.x, color.y), color.z);
    if (!(peak > start)) return color;
    float mapped = 1.0f - rest * rest / (peak + rest - start);
    float saturated = 1.0f / (0.15f * (peak - mapped) + 1.0f);
    return color * (mapped / peak) * saturated + (float3)(mapped) * (1.0f - saturated);
}

__kernel void shade(PictureParams params, __global const uint* visible, __global const float* normals,
                    __global const float* lambert, __global const uint* triangle_material,
                    __global const float* base_colors, __global const float* albedos, __global const float* sky_shares,
                    __global const uchar* srgb_table, __global uchar4* picture) {
    GN_FOR_EACH(pixel, params.count) {
        float3 linear = tone_mapped(light_of_pixel(params, visible[pixel], pixel, normals, lambert, triangle_material,
                                                   base_colors, albedos, sky_shares));
        picture[pixel] = (uchar4)(to_srgb(linear.x, srgb_table), to_srgb(linear.y, srgb_table),
                                  to_srgb(linear.z, srgb_table), (uchar)255);
    }
}

// The brightest channel of each pixel, for a metered exposure. Sky: -1.
__kernel void brightest_channels(PictureParams params, __global const uint* visible, __global const float* normals,
                                 __global const float* lambert, __global const uint* triangle_material,
                                 __global const float* base_colors, __global const float* albedos,
                                 __global const float* sky_shares, __global float* brightest) {
    GN_FOR_EACH(pixel, params.count) {
        float3 linear = light_of_pixel(params, visible[pixel], pixel, normals, lambert, triangle_material, base_colors,
                                       albedos, sky_shares);
        brightest[pixel] = visible[pixel] == GN_NO_ID ? -1.0f : fmax(fmax(linear.x, linear.y), linear.z);
    }
}
