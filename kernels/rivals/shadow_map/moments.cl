// SPDX-License-Identifier: MIT
// Turns the depths of a shadow map into the stored quantities (contract: moments.h).
#include "rivals/shadow_map/moments.h"

// The affine map of four moments that uses 16 bits per number best, and its inverse (Peters and Klein 2015, section
// 3.4; the constants are theirs, for z in [0, 1]).
static float4 optimised_moments(float z) {
    float4 m = (float4)(z, z * z, z * z * z, z * z * z * z);
    return (float4)(-2.07224649f * m.x + 32.23703778f * m.y - 68.571074599f * m.z + 39.3703274134f * m.w +
                        0.035955884801f,
                    13.7948857237f * m.x - 59.4683975703f * m.y + 82.0359750338f * m.z - 35.364903257f * m.w,
                    0.105877704f * m.x - 1.9077466311f * m.y + 9.3496555107f * m.z - 6.6543490743f * m.w,
                    9.7924062118f * m.x - 33.7652110555f * m.y + 47.9456096605f * m.z - 23.9728048165f * m.w);
}

// The second moment of a quantity in [0, 1] within a texel; the moment bias is its variance there.
static float second_moment(float mean, float bias) { return mean * mean + fmin(bias, mean * (1.0f - mean)); }

__kernel void moments_fill(StorePlan plan, MapSet set, __global const float* depths, __global const float* slopes,
                           __global float* planes) {
    size_t texels = set.texels;
    GN_FOR_EACH(i, texels) {
        __global float* at = planes + i;
        float z = depths[i], x = 2.0f * z - 1.0f;
        switch (plan.store) {
            case STORE_VARIANCE:
                at[0] = z;
                at[texels] = second_moment(z, 0.25f * slopes[i]);
                break;
            case STORE_LAYERED:
                for (uint l = 0; l < plan.layers; ++l) {
                    float2 range = layer_range(&plan, l);
                    float length = range.y - range.x, warped = clamp((z - range.x) / length, 0.0f, 1.0f);
                    at[2 * l * texels] = warped;
                    at[(2 * l + 1) * texels] = second_moment(warped, 0.25f * slopes[i] / (length * length));
                }
                break;
            case STORE_CONVOLUTION:
                for (uint k = 0; k < plan.terms; ++k) {
                    at[2 * k * texels] = sin(frequency(k) * z);
                    at[(2 * k + 1) * texels] = cos(frequency(k) * z);
                }
                break;
            case STORE_EXPONENTIAL:
                at[0] = exp(plan.exponent * z);
                break;
            case STORE_EVSM2:
            case STORE_EWGF:
            case STORE_EVSM4: {
                float w = exp(plan.exponent * x);
                at[0] = w;
                at[texels] = w * w;
                if (plan.store != STORE_EVSM4) break;
                float n = -exp(-plan.negative_exponent * x);
                at[2 * texels] = n;
                at[3 * texels] = n * n;
                break;
            }
            case STORE_MOMENTS: {
                float4 m = plan.half_bits ? optimised_moments(z) : (float4)(x, x * x, x * x * x, x * x * x * x);
                store_number(plan.half_bits, planes, i, m.x);
                store_number(plan.half_bits, planes, i + texels, m.y);
                store_number(plan.half_bits, planes, i + 2 * texels, m.z);
                store_number(plan.half_bits, planes, i + 3 * texels, m.w);
                break;
            }
        }
    }
}
