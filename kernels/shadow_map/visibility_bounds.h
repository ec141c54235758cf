// SPDX-License-Identifier: MIT
// From filtered quantities to visibility: for each store of moments.h an estimate of the share of the filter's texels
// that are no nearer to the light than depth t.
#ifndef GN_VISIBILITY_BOUNDS_H
#define GN_VISIBILITY_BOUNDS_H

#include "moments.h"

// Chebyshev's one-sided bound: of all distributions with this mean and variance, the largest share at or beyond t.
//   t <= mean: 1;  else variance / (variance + (t - mean)^2)
static float chebyshev_bound(float mean, float square, float t, float least_variance) {
    if (t <= mean) return 1.0f;
    float variance = fmax(square - mean * mean, least_variance), d = t - mean;
    return variance / (variance + d * d);
}

// The share of a Gaussian with this mean and variance that lies beyond t, 1 - Phi((t - mean) / sigma), doubled so that
// it meets the 1 of the lit side at t = mean. Below Chebyshev's bound everywhere beyond the mean.
static float gaussian_share(float mean, float square, float t, float least_variance) {
    if (t <= mean) return 1.0f;
    float variance = fmax(square - mean * mean, least_variance);
    return erfc((t - mean) / sqrt(2.0f * variance));
}

// Fourier series of the step [z >= t] for |z - t| < 1, damped by exp(-0.1 (k / terms)^2) against ringing:
//   1/2 + 2 sum of (cos(c_k t) E[sin(c_k z)] - sin(c_k t) E[cos(c_k z)]) / c_k
// At z = t it is 1/2, so t is moved towards the light by half a rise, 1 / (2 terms), to keep surfaces lit.
static float fourier_step(const StorePlan* plan, const float* means, float t) {
    float sum = 0.5f, moved = t - 0.5f / (float)plan->terms;
    for (uint k = 0; k < plan->terms; ++k) {
        float c = frequency(k), share = (float)(k + 1) / (float)plan->terms;
        sum +=
            2.0f / c * exp(-0.1f * share * share) * (cos(c * moved) * means[2 * k] - sin(c * moved) * means[2 * k + 1]);
    }
    return clamp(sum, 0.0f, 1.0f);
}

// E[exp(c (z - t))], at most 1: exp(c (z - t)) is about [z >= t] where no texel is far behind the point.
static float exponential_test(const StorePlan* plan, float mean, float t) {
    return fmin(1.0f, mean * exp(-plan->exponent * t));
}

// Least variance of a warped depth: `moment_bias` depths of deviation, times the warp's slope at the point.
static float warped_least_variance(float warped, float exponent, float moment_bias) {
    float deviation = 2.0f * moment_bias * exponent * warped;
    return deviation * deviation;
}

static float exponential_variance(const StorePlan* plan, const float* means, float t) {
    float x = 2.0f * t - 1.0f, w = exp(plan->exponent * x);
    float least = warped_least_variance(w, plan->exponent, plan->moment_bias);
    if (plan->store == STORE_EWGF) return gaussian_share(means[0], means[1], w, least);
    float bound = chebyshev_bound(means[0], means[1], w, least);
    if (plan->store == STORE_EVSM2) return bound;
    float n = -exp(-plan->negative_exponent * x);
    least = warped_least_variance(n, plan->negative_exponent, plan->moment_bias);
    return fmin(bound, chebyshev_bound(means[2], means[3], n, least));
}

static float layered_variance(const StorePlan* plan, const float* means, float t) {
    uint l = min((uint)(clamp(t, 0.0f, 1.0f) * (float)plan->layers), plan->layers - 1);
    float2 range = layer_range(plan, l);
    float length = range.y - range.x, deviation = plan->moment_bias / length;
    return chebyshev_bound(means[2 * l], means[2 * l + 1], clamp((t - range.x) / length, 0.0f, 1.0f),
                           deviation * deviation);
}

static float4 moments_from_optimised(float4 o) {
    o.x -= 0.035955884801f;
    return (float4)(0.2227744146f * o.x + 0.0771972861f * o.y + 0.7926986636f * o.z + 0.0319417555f * o.w,
                    0.1549679261f * o.x + 0.1394629426f * o.y + 0.7963415838f * o.z - 0.1722823173f * o.w,
                    0.1451988946f * o.x + 0.2120202157f * o.y + 0.7258694464f * o.z - 0.2758014811f * o.w,
                    0.163127443f * o.x + 0.2591432266f * o.y + 0.6539092497f * o.z - 0.3376131734f * o.w);
}

// Hamburger four-moment shadow mapping (Peters and Klein 2015, algorithm 2): of all distributions with these moments,
// the smallest share nearer than t. One with three depths, t among them, attains it: with H the Hankel matrix of
// (1, b), c = H^-1 (1, t, t^2) by Cholesky factors, the other two depths are the roots of c_3 z^2 + c_2 z + c_1 = 0,
// and their weights follow from the moments. The mix-in keeps H positive definite where rounding would not.
static float hamburger_shadow(float4 moments, float t, float moment_bias, float4 mixed_in) {
    float4 b = moments + moment_bias * (mixed_in - moments);
    float d22 = b.y - b.x * b.x;
    float l32_d22 = b.z - b.x * b.y;
    float d33_d22 = (b.w - b.y * b.y) * d22 - l32_d22 * l32_d22;
    float l32 = l32_d22 / d22;
    float c1 = 1.0f, c2 = t - b.x, c3 = t * t - b.y - l32 * c2;
    c2 /= d22;
    c3 *= d22 / d33_d22;
    c2 -= l32 * c3;
    c1 -= c2 * b.x + c3 * b.y;
    float p = c2 / c3, q = c1 / c3;
    float root = sqrt(fmax(0.25f * p * p - q, 0.0f));
    float near_depth = -0.5f * p - root, far_depth = -0.5f * p + root;
    float share = 0.0f;
    if (far_depth < t)  // both roots are nearer: all but the weight of t
        share = 1.0f +
                (near_depth * far_depth - b.x * (near_depth + far_depth) + b.y) / ((far_depth - t) * (t - near_depth));
    else if (near_depth < t)  // the weight of the nearer root
        share = (t * far_depth - b.x * (t + far_depth) + b.y) / ((far_depth - near_depth) * (t - near_depth));
    return share > 0.0f ? fmin(share, 1.0f) : 0.0f;  // not a number (no variance at all): 0
}

static float visibility_estimate(const StorePlan* plan, const float* means, float t) {
    float lit = 1.0f;
    switch (plan->store) {
        case STORE_VARIANCE:
            lit = chebyshev_bound(means[0], means[1], t, plan->moment_bias * plan->moment_bias);
            break;
        case STORE_LAYERED:
            lit = layered_variance(plan, means, t);
            break;
        case STORE_CONVOLUTION:
            lit = fourier_step(plan, means, t);
            break;
        case STORE_EXPONENTIAL:
            lit = exponential_test(plan, means[0], t);
            break;
        case STORE_EVSM2:
        case STORE_EVSM4:
        case STORE_EWGF:
            lit = exponential_variance(plan, means, t);
            break;
        case STORE_MOMENTS: {
            float4 b = (float4)(means[0], means[1], means[2], means[3]);
            // Mixed in: moments of a distribution over the whole range, as Peters and Klein choose them.
            if (plan->half_bits)
                lit = 1.0f - hamburger_shadow(moments_from_optimised(b), t, plan->moment_bias, (float4)(0.5f));
            else
                lit = 1.0f -
                      hamburger_shadow(b, 2.0f * t - 1.0f, plan->moment_bias, (float4)(0.0f, 0.375f, 0.0f, 0.375f));
            break;
        }
    }
    // Against light bleeding (Lauritzen 2007; survey 113).
    return clamp((lit - plan->bleeding) / (1.0f - plan->bleeding), 0.0f, 1.0f);
}

#endif
