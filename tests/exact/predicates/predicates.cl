// SPDX-License-Identifier: MIT
// The predicates laid open for their test: every level alone, the cascade, and the accumulator.
#include "exact/blocks.clh"

#define UNDECIDED 2
#define LEVEL_ABSENT 3

static float3 vector_of(__global const float* cases, size_t i, int vector) { return vload3(6 * i + vector, cases); }

// Per case: the signs of the levels float, double, exact and of the cascade, and the level that the cascade needed.
__kernel void signs_of_det3(uint count, __global const float* cases, __global char* signs) {
    GN_FOR_EACH(i, count) {
        float3 u1 = vector_of(cases, i, 0), u0 = vector_of(cases, i, 1);
        float3 v1 = vector_of(cases, i, 2), v0 = vector_of(cases, i, 3);
        float3 w1 = vector_of(cases, i, 4), w0 = vector_of(cases, i, 5);
        __global char* out = signs + 5 * i;
        int sign, level = DET3_BY_FLOAT;
        out[0] = det3_sign_float(u1, u0, v1, v0, w1, w0, &sign) ? sign : UNDECIDED;
#ifdef GN_FP64
        out[1] = det3_sign_double(u1, u0, v1, v0, w1, w0, &sign) ? sign : UNDECIDED;
#else
        out[1] = LEVEL_ABSENT;
#endif
        out[2] = det3_sign_exact(u1, u0, v1, v0, w1, w0);
        out[3] = det3_sign(u1, u0, v1, v0, w1, w0, &level);
        out[4] = level;
    }
}

#ifdef GN_FP64
// Per case: what the two filters compute, and the error they allow for.
__kernel void values_of_det3(uint count, __global const float* cases, __global float2* in_float,
                             __global double2* in_double) {
    GN_FOR_EACH(i, count) {
        float3 u1 = vector_of(cases, i, 0), u0 = vector_of(cases, i, 1);
        float3 v1 = vector_of(cases, i, 2), v0 = vector_of(cases, i, 3);
        float3 w1 = vector_of(cases, i, 4), w0 = vector_of(cases, i, 5);
        float bound;
        float value = det3_float(det3_cross_float(u1 - u0, v1 - v0), w1 - w0, fabs(w1 - w0), &bound);
        in_float[i] = (float2)(value, bound);
        double wide_bound;
        double wide_value = det3_wide(det3_cross(det3_row(u1, u0), det3_row(v1, v0)), det3_row(w1, w0), &wide_bound);
        in_double[i] = (double2)(wide_value, wide_bound);
    }
}
#endif

// Per case (nine floats of triangle, three of the point, four of the light): blocked, and the level that it took.
__kernel void answers_of_blocks(uint count, __global const float* cases, __global char* answers) {
    GN_FOR_EACH(i, count) {
        __global const float* rest = cases + 16 * i + 9;
        Triangle triangle;
        triangle.a = vload3(0, cases + 16 * i);
        triangle.b = vload3(1, cases + 16 * i);
        triangle.c = vload3(2, cases + 16 * i);
        int level = DET3_BY_FLOAT;
        answers[2 * i] = blocks(triangle, vload3(0, rest), (float4)(vload3(1, rest), rest[6]), &level);
        answers[2 * i + 1] = level;
    }
}

#ifdef GN_FP64
// Per case: the sum of its products (x y z, minus that where w is 1), its sign, and the sum as a double.
__kernel void sums_of_products(uint count, __global const uint* first, __global const float4* products,
                               __global uint* words, __global int* signs, __global double* rounded) {
    GN_FOR_EACH(i, count) {
        Accumulator sum;
        accumulator_clear(&sum);
        for (uint k = first[i]; k < first[i + 1]; ++k)
            accumulator_add_product(&sum, products[k].x, products[k].y, products[k].z, products[k].w != 0.0f);
        for (int k = 0; k < ACCUMULATOR_WORDS; ++k) words[ACCUMULATOR_WORDS * i + k] = sum.word[k];
        signs[i] = accumulator_sign(&sum);
        rounded[i] = accumulator_to_wide(&sum);
    }
}
#endif
