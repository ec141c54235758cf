// SPDX-License-Identifier: MIT
// Prefilters, common to all stored quantities: filter a plane of a shadow map before the lookup.
//
//   gaussian     separable, `taps` (odd) texels with weights exp(-d^2 / (2 sigma^2)), sigma = taps / 4.5; a view's
//                border texels are repeated beyond it
//   summed area  S(x, y) = sum of the texels up to (x, y): any box is four lookups (Crow 1984; Lauritzen 2007). In
//                fixed point modulo 2^32, so that no precision is lost however large the map is: a box whose own sum
//                is below 2^32 comes out exact. For quantities in [0, 1]; those in [-1, 1] are moved there.
//   mip          a chain of halves (moments.h); the lookup chooses the level by the pixel's footprint
#include "rivals/shadow_map/moments.h"

// Index in the map of a view's texel.
static size_t map_texel(__global const MapView* view, uint x, uint y) {
    return view->first_texel + (size_t)y * view->row_stride + x;
}

static void gaussian(uint half_bits, MapSet set, uint planes, GaussianPass pass, __constant const float* weights,
                     __global const MapView* views, __global const void* input, __global void* output) {
    uint taps = pass.taps, axis = pass.axis;
    for (uint v = 0; v < set.view_count; ++v) {
        __global const MapView* view = views + v;
        uint texels = view->width * view->height;
        if (texels == 0) continue;
        int last = (int)(axis == 0u ? view->width : view->height) - 1, half_taps = (int)taps / 2;
        size_t step = axis == 0u ? 1 : view->row_stride;
        GN_FOR_EACH(i, (size_t)texels * planes) {
            uint texel = (uint)(i % texels), x = texel % view->width, y = texel / view->width;
            size_t plane = i / texels * set.texels;
            int along = (int)(axis == 0u ? x : y);
            size_t line = plane + map_texel(view, axis == 0u ? 0 : x, axis == 0u ? y : 0);
            float sum = 0.0f;
            if (along >= half_taps && along + half_taps <= last) {
                size_t first = line + (size_t)(along - half_taps) * step;
                for (uint t = 0; t < taps; ++t) sum += weights[t] * load_number(half_bits, input, first + t * step);
            } else {
                for (uint t = 0; t < taps; ++t) {
                    size_t at = line + (size_t)clamp(along - half_taps + (int)t, 0, last) * step;
                    sum += weights[t] * load_number(half_bits, input, at);
                }
            }
            store_number(half_bits, output, plane + map_texel(view, x, y), sum);
        }
    }
}

__kernel void prefilter_gaussian(StorePlan plan, MapSet set, GaussianPass pass, __constant const float* weights,
                                 __global const MapView* views, __global const void* input, __global void* output) {
    if (plan.half_bits)
        gaussian(1u, set, plan.planes, pass, weights, views, input, output);
    else
        gaussian(0u, set, plan.planes, pass, weights, views, input, output);
}

// Runs twice: along rows (axis 0) it converts the numbers to fixed point and sums them, along columns it sums in place.
__kernel void prefilter_sum(StorePlan plan, MapSet set, uint axis, __global const MapView* views,
                            __global const void* input, __global uint* sums) {
    float low = is_signed(&plan) ? -1.0f : 0.0f, scale_in = is_signed(&plan) ? 0.5f : 1.0f;
    for (uint v = 0; v < set.view_count; ++v) {
        __global const MapView* view = views + v;
        uint lines = axis == 0u ? view->height : view->width, length = axis == 0u ? view->width : view->height;
        size_t step = axis == 0u ? 1 : view->row_stride, next_line = axis == 0u ? view->row_stride : 1;
        GN_FOR_EACH(i, (size_t)lines * plan.planes) {
            size_t at = i / lines * set.texels + map_texel(view, 0, 0) + i % lines * next_line;
            uint sum = 0;
            for (uint k = 0; k < length; ++k, at += step) {
                float number = axis == 0u ? load_number(plan.half_bits, input, at) : 0.0f;
                sum += axis == 0u ? (uint)rint(clamp((number - low) * scale_in, 0.0f, 1.0f) * plan.summed_scale)
                                  : sums[at];
                sums[at] = sum;
            }
        }
    }
}

// Shares of the texels 2 i, 2 i + 1 and 2 i + 2 of a line of `fine` in texel i of its half. On an odd line 2 m + 1 each
// of the m texels has a length of (2 m + 1) / m.
static float3 shares_of_half(uint i, uint fine) {
    uint half_line = fine / 2u;
    if (fine % 2u == 0u) return (float3)(0.5f, 0.5f, 0.0f);
    return (float3)((float)(half_line - i), (float)half_line, (float)(i + 1u)) / (float)fine;
}

static float mean_below(uint half_bits, __global const void* numbers, size_t plane, MipLevel fine, uint x, uint y) {
    float3 across = shares_of_half(x, fine.width), down = shares_of_half(y, fine.height);
    float columns[3] = {across.x, across.y, across.z}, rows[3] = {down.x, down.y, down.z};
    float sum = 0.0f;
    for (uint j = 0; j < 2u + fine.height % 2u; ++j)
        for (uint i = 0; i < 2u + fine.width % 2u; ++i) {
            size_t at = plane + fine.first + (size_t)(2u * y + j) * fine.row_stride + 2u * x + i;
            sum += columns[i] * rows[j] * load_number(half_bits, numbers, at);
        }
    return sum;
}

// Computes one level from the previous level: `input` is the map for level 1, else the chain itself.
__kernel void prefilter_mip(StorePlan plan, MapSet set, uint level, __global const MapView* views,
                            __global const void* input, __global void* mips) {
    for (uint v = 0; v < set.view_count; ++v) {
        MipLevel coarse = mip_level(views + v, level), fine = mip_level(views + v, level - 1u);
        uint texels = coarse.width * coarse.height;
        if (texels == 0) continue;
        GN_FOR_EACH(i, (size_t)texels * plan.planes) {
            uint texel = (uint)(i % texels), x = texel % coarse.width, y = texel / coarse.width;
            size_t plane = i / texels * set.texels;
            store_number(plan.half_bits, mips, plane + coarse.first + (size_t)y * coarse.row_stride + x,
                         mean_below(plan.half_bits, input, plane, fine, x, y));
        }
    }
}
