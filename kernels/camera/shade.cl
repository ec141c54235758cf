// SPDX-License-Identifier: MIT
// Shade: base colour times (ambient + the lights' visibility * Lambert), to 8-bit sRGB through a table that the host
// computes, so that no device's pow() can change a pixel. The ambient light comes mostly from above and a little from
// one side, so that shapes stay visible in shadow.
#include "camera/shade.h"

#define AMBIENT 0.25f

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

__kernel void shade(PointsLayout layout, __global const uint* visible, __global const float* normals,
                    __global const float* lambert, __global const uint* triangle_material,
                    __global const float* base_colors, __global const uchar* srgb_table, __global uchar4* picture) {
    GN_FOR_EACH(pixel, layout.count) {
        float3 linear = (float3)(0.46f, 0.62f, 0.86f);  // sky
        uint id = visible[pixel];
        if (id != GN_NO_ID) {
            float3 base = vload3(triangle_material[id], base_colors);
            float3 n = vload3(pixel, normals);
            float ambient = AMBIENT * (1.0f + 0.35f * n.y + 0.15f * n.x);
            linear = base * (ambient + (1.0f - AMBIENT) * lambert[pixel]);
        }
        picture[pixel] = (uchar4)(to_srgb(linear.x, srgb_table), to_srgb(linear.y, srgb_table),
                                  to_srgb(linear.z, srgb_table), (uchar)255);
    }
}
