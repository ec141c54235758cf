// SPDX-License-Identifier: MIT
// The levels of a colour texture. Contract: mip_levels.h.
#include "shading/mip_levels.h"

// The level before: texels, or linear light times weight, and weight.
typedef struct MipSource {
    __global const uchar4* texels;  // null: the lights
    __global const float4* lights;
    __global const MipTables* tables;
    uint width;
} MipSource;

static float4 mip_light(const MipSource* from, size_t x, size_t y) {
    size_t at = y * from->width + x;
    if (from->texels == 0) return from->lights[at];
    uchar4 texel = from->texels[at];
    __global const float* linear_of = from->tables->linear_of;
    float weight = from->tables->weight_of[texel.w];
    return (float4)(linear_of[texel.x] * weight, linear_of[texel.y] * weight, linear_of[texel.z] * weight, weight);
}

// The mean of four, which are added as the host adds them.
static float4 mip_mean_of_four(const MipSource* from, size_t x, size_t y) {
    float4 a = mip_light(from, x, y), b = mip_light(from, x + 1, y);
    float4 c = mip_light(from, x, y + 1), d = mip_light(from, x + 1, y + 1);
    return 0.25f * (from->texels != 0 ? ((a + b) + c) + d : (a + b) + (c + d));
}

static float4 mip_mean_of_taps(const MipSource* from, MipTaps column, MipTaps row) {
    float4 sum = (float4)(0.0f);
    for (uint dy = 0; dy < 3; ++dy)
        for (uint dx = 0; dx < 3; ++dx) {
            float share = row.shares[dy] * column.shares[dx];
            if (share != 0.0f) sum += share * mip_light(from, column.first + dx, row.first + dy);
        }
    return sum;
}

static uchar mip_srgb(__global const MipTables* tables, float linear) {
    return tables->srgb_of[(uint)(clamp(linear, 0.0f, 1.0f) * (float)(MIP_ENCODED - 1) + 0.5f)];
}

static uchar4 mip_texel(__global const MipTables* tables, float4 light) {
    return (uchar4)(mip_srgb(tables, light.x / light.w), mip_srgb(tables, light.y / light.w),
                    mip_srgb(tables, light.z / light.w), (uchar)fmax(1.0f, round(light.w * 255.0f)));
}

// A texture's weights in the place of its alpha: at least 1, or 255 where alpha weighs nothing.
__kernel void mip_weights(ulong first_texel, ulong count, uint weighs_alpha, __global uchar4* texels) {
    GN_FOR_EACH(i, count) {
        uchar alpha = texels[first_texel + i].w;
        texels[first_texel + i].w = weighs_alpha != 0u ? max(alpha, (uchar)1) : (uchar)255;
    }
}

// `lights_before`: of the level before, unless `is_first`: that one is the texture itself, in `texels`.
__kernel void mip_level(MipParams params, uint is_first, __global const MipTables* tables, __global const MipTaps* taps,
                        __global const float4* lights_before, __global uchar4* texels, __global float4* lights) {
    MipSource from = {is_first != 0u ? texels + params.first_texel_before : 0, lights_before, tables,
                      params.width_before};
    GN_FOR_EACH(i, (size_t)params.width * params.height) {
        size_t x = i % params.width, y = i / params.width;
        float4 light = params.is_even != 0u ? mip_mean_of_four(&from, 2 * x, 2 * y)
                                            : mip_mean_of_taps(&from, taps[x], taps[params.width + y]);
        lights[i] = light;
        texels[params.first_texel + i] = mip_texel(tables, light);
    }
}
