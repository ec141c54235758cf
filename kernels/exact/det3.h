// SPDX-License-Identifier: MIT
// Exact signs of 3x3 determinants whose rows are differences of float vectors: the one predicate of gnomon.
//
//     det(u1 - u0, v1 - v0, w1 - w0)  =  (w1 - w0) . ((u1 - u0) x (v1 - v0))
//
// Side of a plane, side of an edge seen along a ray, orientation seen from a light: all are this. Three levels:
//
// Coordinates must be finite.
//
//   float   Let u = 2^-24, P the permanent (the determinant with every sign positive) and Q the permanent as computed.
//           Rounding. Each of the six terms meets at most 8 roundings: 3 differences, the product of two, the minor's
//           sum, the product with w, 2 sums. So |value - det| <= ((1 + u)^8 - 1) P and Q >= (1 - u)^8 P, which makes
//           the error at most 8u (1 + 12u) Q < 4.769e-7 Q. (Fused products round less often; they keep the bound.)
//           Underflow, with denormals kept or flushed: every operation may err by another h = 2^-126 in its result, and
//           take each operand for another that is h away. The level is used only if the computed differences are at
//           most M = 2^20. A difference is off by 3h; as an operand by 4h. A product of two: 4hM + 4hM + h. A minor:
//           twice that and 3h more, below 17hM. A product with w, the minor being at most 2M^2: 17hM M + 4h 2M^2 and
//           less than hM^2 more: 26hM^2. Three of them, added: 79hM^2, with room for later roundings below 128hM^2 =
//           2^-79. The same holds for Q. So |value - det| < 4.769e-7 (Q + 2^-79) + 2^-79 < 4.769e-7 Q + 2^-78. Bound.
//           The level is used only if Q >= 2^-40. Then 5.0e-7 Q, rounded, exceeds 4.769e-7 Q by more than 2^-26 Q >=
//           2^-66 > 2^-78: the bound holds, and it is itself a normal number. Overflow. Finite coordinates make no NaN
//           difference; an infinite one is above M, and the level is not used. Below M nothing exceeds 2^63.
//   double  Let u = 2^-53. The same 8 roundings: the error is at most 8u (1 + 12u) Q < 8.89e-16 Q, and 1.0e-15 Q,
//           rounded, is more. Nothing underflows: coordinates are multiples of 2^-149 (a device that flushes denormals
//           when it widens them has its double precision hidden, see self_check.cl), so differences, products of two
//           and of three are multiples of 2^-149, 2^-298 and 2^-447, rounded or not; the bound is 0 or above 2^-497.
//           Nothing overflows: all is below 2^390. A bound of 0 means that every product is exactly 0.
//   exact   48 products in the accumulator.
//
// Source of the method: Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates"
// (1997), section 4, for the filters; the exact level is an accumulator instead of expansions.
#ifndef GN_EXACT_DET3_H
#define GN_EXACT_DET3_H

#include "exact/accumulator.h"

#define DET3_FLOAT_BOUND 5.0e-7f
#define DET3_DOUBLE_BOUND wide_of_bits(0x3CD203AF9EE75616ul)  // 1.0e-15

// What decided a sign, counted by callers that print the share of each level.
#define DET3_BY_FLOAT 0
#define DET3_BY_DOUBLE 1
#define DET3_BY_EXACT 2

// u x v in float: `size` adds up what `value` subtracts, `largest` is the larger magnitude of each coordinate.
typedef struct Det3FloatCross {
    float3 value, size, largest;
} Det3FloatCross;

static Det3FloatCross det3_cross_float(float3 u, float3 v) {
    float3 plus = u.yzx * v.zxy, minus = u.zxy * v.yzx;
    Det3FloatCross cross;
    cross.value = plus - minus;
    cross.size = fabs(plus) + fabs(minus);
    cross.largest = fmax(fabs(u), fabs(v));
    return cross;
}

// The determinant det(u, v, w) in float, cross = u x v; *bound is at least its error, infinite where the level must not
// be used. size_w is at least the magnitude of each coordinate of w, and u size_w (up to a factor of 1 + 2^-20) at
// least its error.
static float det3_float(Det3FloatCross cross, float3 w, float3 size_w, float* bound) {
    float value = w.x * cross.value.x + w.y * cross.value.y + w.z * cross.value.z;
    float permanent = size_w.x * cross.size.x + size_w.y * cross.size.y + size_w.z * cross.size.z;
    float3 largest = fmax(cross.largest, size_w);
    bool in_range = largest.x <= 0x1p20f && largest.y <= 0x1p20f && largest.z <= 0x1p20f && permanent >= 0x1p-40f;
    *bound = in_range ? DET3_FLOAT_BOUND * permanent : INFINITY;
    return value;
}

// True, and the sign, if the float level is certain. (A value that is infinite or NaN exceeds no bound.)
static bool det3_sign_float(float3 u1, float3 u0, float3 v1, float3 v0, float3 w1, float3 w0, int* sign) {
    float bound;
    float3 w = w1 - w0;
    float value = det3_float(det3_cross_float(u1 - u0, v1 - v0), w, fabs(w), &bound);
    *sign = value > 0.0f ? 1 : -1;
    return fabs(value) > bound;
}

// A vector in double precision; size_* is at least the magnitude of each coordinate, and 2^-53 size_* (up to a factor
// of 1 + 2^-51) at least its error.
typedef struct Det3Row {
    Wide x, y, z;
    Wide size_x, size_y, size_z;
} Det3Row;

static Det3Row det3_row(float3 end, float3 start) {
    Det3Row row;
    row.x = wide_sub(wide_of_float(end.x), wide_of_float(start.x));
    row.y = wide_sub(wide_of_float(end.y), wide_of_float(start.y));
    row.z = wide_sub(wide_of_float(end.z), wide_of_float(start.z));
    row.size_x = wide_absolute(row.x);
    row.size_y = wide_absolute(row.y);
    row.size_z = wide_absolute(row.z);
    return row;
}

// u x v, in which size_* adds up what the coordinates subtract: its dot product with a row is a determinant.
static Det3Row det3_cross(Det3Row u, Det3Row v) {
    Det3Row cross;
    cross.x = wide_sub(wide_mul(u.y, v.z), wide_mul(u.z, v.y));
    cross.y = wide_sub(wide_mul(u.z, v.x), wide_mul(u.x, v.z));
    cross.z = wide_sub(wide_mul(u.x, v.y), wide_mul(u.y, v.x));
    cross.size_x = wide_add(wide_mul(u.size_y, v.size_z), wide_mul(u.size_z, v.size_y));
    cross.size_y = wide_add(wide_mul(u.size_z, v.size_x), wide_mul(u.size_x, v.size_z));
    cross.size_z = wide_add(wide_mul(u.size_x, v.size_y), wide_mul(u.size_y, v.size_x));
    return cross;
}

// The determinant det(u, v, w) in double precision, cross = u x v; *bound is at least its error.
static Wide det3_wide(Det3Row cross, Det3Row w, Wide* bound) {
    Wide permanent = wide_dot(w.size_x, w.size_y, w.size_z, cross.size_x, cross.size_y, cross.size_z);
    *bound = wide_mul(DET3_DOUBLE_BOUND, permanent);
    return wide_dot(w.x, w.y, w.z, cross.x, cross.y, cross.z);
}

// True, and the sign, if the double level is certain: also where every product is exactly zero, as in axis-aligned
// geometry under axis-aligned lights.
static bool det3_sign_double(float3 u1, float3 u0, float3 v1, float3 v0, float3 w1, float3 w0, int* sign) {
    Wide bound;
    Wide value = det3_wide(det3_cross(det3_row(u1, u0), det3_row(v1, v0)), det3_row(w1, w0), &bound);
    *sign = wide_sign(value);
    return wide_less(bound, wide_absolute(value)) || wide_is_zero(bound);
}

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
    if (det3_sign_float(u1, u0, v1, v0, w1, w0, &sign)) return sign;
#ifdef GN_FP64
    *level = max(*level, DET3_BY_DOUBLE);
    if (det3_sign_double(u1, u0, v1, v0, w1, w0, &sign)) return sign;
#endif
    *level = max(*level, DET3_BY_EXACT);
    return det3_sign_exact(u1, u0, v1, v0, w1, w0);
}

#endif
