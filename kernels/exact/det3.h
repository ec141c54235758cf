// SPDX-License-Identifier: MIT
// Exact signs of 3x3 determinants whose rows are differences of float vectors: the one predicate of gnomon.
//
//     det(u1 - u0, v1 - v0, w1 - w0)  =  (w1 - w0) . ((u1 - u0) x (v1 - v0))
//
// Side of a plane, side of an edge seen along a ray, orientation seen from a light: all are this. Three levels:
//
//   float   Evaluated in float. Each of the six products of three differences meets at most 8 roundings (3 differences,
//           2 products, 3 sums), so the error is at most gamma_8 = 8u / (1 - 8u) times the permanent (the same sum with
//           every sign positive), u = 2^-24. The permanent computed in float is off by at most the same factor. Hence
//           |error| <= 8.00001 u * permanent_computed * 1.00001 < 5.0e-7 * permanent_computed (8u = 4.77e-7).
//           Underflow adds at most 2^-126 a step (flushed denormals included). With every difference at most 2^20 it
//           grows to at most 20 * 2^-126 * 2^40 < 2^-81, while the bound is at least 5.0e-7 * 2^-40 > 2^-61 where the
//           level is used (permanent >= 2^-40): the gap between 4.77e-7 and 5.0e-7 covers it.
//   double  The same in double (where the device has it): u = 2^-53, 8u = 8.9e-16, bound 1.0e-15. Differences of
//           floats, their products and sums stay between 2^-447 and 2^390: neither underflow nor overflow exists.
//   exact   48 products in the accumulator.
//
// Source of the method: Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates"
// (1997), section 4, for the filters; the exact level is an accumulator instead of expansions.
#ifndef GN_EXACT_DET3_H
#define GN_EXACT_DET3_H

#include "exact/accumulator.h"

#define DET3_FLOAT_BOUND 5.0e-7f
#define DET3_DOUBLE_BOUND 1.0e-15

// What decided a sign, counted by callers that print the share of each level.
#define DET3_BY_FLOAT 0
#define DET3_BY_DOUBLE 1
#define DET3_BY_EXACT 2

static int sign_of_float(float x) { return (x > 0.0f) - (x < 0.0f); }

// Returns true and the sign if the float level is certain.
static bool det3_sign_float(float3 u, float3 v, float3 w, int* sign) {
    float minor_x_plus = u.y * v.z, minor_x_minus = u.z * v.y;
    float minor_y_plus = u.z * v.x, minor_y_minus = u.x * v.z;
    float minor_z_plus = u.x * v.y, minor_z_minus = u.y * v.x;
    float value = w.x * (minor_x_plus - minor_x_minus) + w.y * (minor_y_plus - minor_y_minus) +
                  w.z * (minor_z_plus - minor_z_minus);
    float permanent = fabs(w.x) * (fabs(minor_x_plus) + fabs(minor_x_minus)) +
                      fabs(w.y) * (fabs(minor_y_plus) + fabs(minor_y_minus)) +
                      fabs(w.z) * (fabs(minor_z_plus) + fabs(minor_z_minus));
    float3 largest = fmax(fmax(fabs(u), fabs(v)), fabs(w));
    bool in_range = largest.x <= 0x1p20f && largest.y <= 0x1p20f && largest.z <= 0x1p20f && permanent >= 0x1p-40f;
    *sign = sign_of_float(value);
    return in_range && fabs(value) > DET3_FLOAT_BOUND * permanent;
}

#ifdef GN_FP64

// A vector of doubles with, per coordinate, a magnitude that bounds everything that was added up to make it.
typedef struct Det3Row {
    double x, y, z;
    double size_x, size_y, size_z;
} Det3Row;

static Det3Row det3_row(float3 end, float3 start) {
    Det3Row row;
    row.x = (double)end.x - (double)start.x;
    row.y = (double)end.y - (double)start.y;
    row.z = (double)end.z - (double)start.z;
    row.size_x = fabs(row.x);
    row.size_y = fabs(row.y);
    row.size_z = fabs(row.z);
    return row;
}

// The determinant in double; *bound is at least its error.
static double det3_double(Det3Row u, Det3Row v, Det3Row w, double* bound) {
    double value = w.x * (u.y * v.z - u.z * v.y) + w.y * (u.z * v.x - u.x * v.z) + w.z * (u.x * v.y - u.y * v.x);
    double permanent = w.size_x * (u.size_y * v.size_z + u.size_z * v.size_y) +
                       w.size_y * (u.size_z * v.size_x + u.size_x * v.size_z) +
                       w.size_z * (u.size_x * v.size_y + u.size_y * v.size_x);
    *bound = DET3_DOUBLE_BOUND * permanent;
    return value;
}

#endif

static float coordinate_of(float3 v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; }

// sum += det(u1 - u0, v1 - v0, w1 - w0), exactly: six permutations of three binary choices.
__attribute__((noinline)) static void accumulator_add_det3(Accumulator* sum, float3 u1, float3 u0, float3 v1, float3 v0,
                                                    float3 w1, float3 w0) {
    for (int term = 0; term < 48; ++term) {
        int permutation = term >> 3;
        int i = permutation % 3;
        bool odd = permutation >= 3;
        int j = (i + (odd ? 2 : 1)) % 3;
        int k = (i + (odd ? 1 : 2)) % 3;
        bool from_u0 = (term & 1) != 0, from_v0 = (term & 2) != 0, from_w0 = (term & 4) != 0;
        accumulator_add_product(sum, coordinate_of(from_u0 ? u0 : u1, i), coordinate_of(from_v0 ? v0 : v1, j),
                                coordinate_of(from_w0 ? w0 : w1, k), odd != (from_u0 != (from_v0 != from_w0)));
    }
}

__attribute__((noinline)) static int det3_sign_exact(float3 u1, float3 u0, float3 v1, float3 v0, float3 w1, float3 w0) {
    Accumulator sum;
    accumulator_clear(&sum);
    accumulator_add_det3(&sum, u1, u0, v1, v0, w1, w0);
    return accumulator_sign(&sum);
}

// The sign, for certain. *level is raised to the level that was needed.
static int det3_sign(float3 u1, float3 u0, float3 v1, float3 v0, float3 w1, float3 w0, int* level) {
    int sign;
    if (det3_sign_float(u1 - u0, v1 - v0, w1 - w0, &sign)) return sign;
#ifdef GN_FP64
    double bound;
    double value = det3_double(det3_row(u1, u0), det3_row(v1, v0), det3_row(w1, w0), &bound);
    *level = max(*level, DET3_BY_DOUBLE);
    if (fabs(value) > bound) return value > 0.0 ? 1 : -1;
    // Every product is exactly zero (nothing underflows in double): axis-aligned geometry under axis-aligned lights.
    if (bound == 0.0) return 0;
#endif
    *level = max(*level, DET3_BY_EXACT);
    return det3_sign_exact(u1, u0, v1, v0, w1, w0);
}

#endif
