// SPDX-License-Identifier: MIT
// IEEE 754 double precision by integers alone, for devices without it: the same bits as hardware that rounds to nearest
// even, denormals, infinities and signed zeros included. (NaN is one NaN: hardware differs in its bits as well.)
//
// A finite number is unpacked to  sign, exponent, significand  with the significand's leading bit at bit 62, so that
// its value is significand 2^-62 2^(exponent - 1023); operations give one more bit than they need, with everything
// below it gathered into the last bit ("sticky": 1 if anything was lost), and soft_rounded() rounds once. Why once is
// right: the kept bits, the next one and "is anything below" decide rounding to nearest even, and nothing else does.
#ifndef GN_EXACT_SOFT_DOUBLE_H
#define GN_EXACT_SOFT_DOUBLE_H

#include "prelude.h"

// A struct, so that no operator of C works on the bits by mistake.
typedef struct SoftDouble {
    ulong bits;
} SoftDouble;

typedef struct SoftParts {
    ulong sign;         // 0, or bit 63
    int exponent;       // biased; below 1 for denormals, which are normalised
    ulong significand;  // bit 62 leads; 0 for zero
} SoftParts;

#define SOFT_SIGN 0x8000000000000000ul
#define SOFT_INFINITY 0x7FF0000000000000ul
#define SOFT_NAN 0x7FF8000000000000ul

static SoftDouble soft_of_bits(ulong bits) {
    SoftDouble x;
    x.bits = bits;
    return x;
}

static ulong soft_magnitude_bits(SoftDouble x) { return x.bits & ~SOFT_SIGN; }
static bool soft_is_nan(SoftDouble x) { return soft_magnitude_bits(x) > SOFT_INFINITY; }
static bool soft_is_infinite(SoftDouble x) { return soft_magnitude_bits(x) == SOFT_INFINITY; }
static bool soft_is_zero(SoftDouble x) { return soft_magnitude_bits(x) == 0; }

// Shifts right; what falls out is gathered into the last bit.
static ulong shifted_and_gathered(ulong x, uint by) {
    if (by == 0) return x;
    if (by > 63) return x != 0 ? 1 : 0;
    return (x >> by) | ((x << (64 - by)) != 0 ? 1 : 0);
}

// Moves the leading bit to bit 62; the value stays.
static SoftParts soft_normalised(SoftParts x) {
    if (x.significand == 0) return x;
    int up = (int)clz(x.significand) - 1;
    x.significand = up < 0 ? shifted_and_gathered(x.significand, 1) : x.significand << up;
    x.exponent -= up;
    return x;
}

static SoftParts soft_parts(SoftDouble x) {
    SoftParts parts;
    uint field = (uint)(x.bits >> 52) & 0x7FFu;
    parts.sign = x.bits & SOFT_SIGN;
    parts.exponent = (int)max(field, 1u);
    parts.significand = ((x.bits & 0xFFFFFFFFFFFFFul) | (field != 0 ? 0x10000000000000ul : 0)) << 10;
    return field != 0 ? parts : soft_normalised(parts);
}

// Exponent and fraction fields of a normalised number rounded to a format with `fraction_bits` and exponents below
// `infinite`. A carry out of the fraction moves the exponent up by itself, from denormal to normal and to infinity too.
static ulong soft_rounded(SoftParts x, int fraction_bits, int infinite) {
    if (x.exponent >= infinite) return (ulong)infinite << fraction_bits;
    uint drop = 62u - (uint)fraction_bits;
    ulong significand = x.significand;
    ulong exponent_field = 0;
    if (x.exponent >= 1)
        exponent_field = (ulong)(x.exponent - 1) << fraction_bits;  // the leading bit adds the 1
    else
        significand = shifted_and_gathered(significand, (uint)(1 - x.exponent));
    ulong kept = significand >> drop, lost = significand & ((1ul << drop) - 1), half_ulp = 1ul << (drop - 1);
    if (lost > half_ulp || (lost == half_ulp && (kept & 1ul) != 0)) ++kept;
    return exponent_field + kept;
}

static SoftDouble soft_packed(SoftParts x) {
    if (x.significand == 0) return soft_of_bits(x.sign);
    return soft_of_bits(x.sign | soft_rounded(soft_normalised(x), 52, 2047));
}

static SoftDouble soft_negated(SoftDouble x) { return soft_of_bits(x.bits ^ SOFT_SIGN); }
static SoftDouble soft_absolute(SoftDouble x) { return soft_of_bits(soft_magnitude_bits(x)); }

static SoftDouble soft_add(SoftDouble x, SoftDouble y) {
    if (soft_is_nan(x) || soft_is_nan(y)) return soft_of_bits(SOFT_NAN);
    if (soft_is_infinite(x) || soft_is_infinite(y)) {
        if (soft_is_infinite(x) && soft_is_infinite(y) && x.bits != y.bits) return soft_of_bits(SOFT_NAN);
        return soft_is_infinite(x) ? x : y;
    }
    if (soft_is_zero(x) && soft_is_zero(y)) return soft_of_bits(x.bits & y.bits);
    if (soft_is_zero(x)) return y;
    if (soft_is_zero(y)) return x;
    bool swapped = soft_magnitude_bits(y) > soft_magnitude_bits(x);
    SoftParts larger = soft_parts(swapped ? y : x), smaller = soft_parts(swapped ? x : y);
    // Ten zeros lie below either significand: room for the alignment's gathered bit, and for one bit of cancellation,
    // after which (exponents that differ by more than one) at most one leading bit can cancel.
    ulong aligned = shifted_and_gathered(smaller.significand, (uint)(larger.exponent - smaller.exponent));
    if (larger.sign == smaller.sign)
        larger.significand += aligned;
    else
        larger.significand -= aligned;
    if (larger.significand == 0) larger.sign = 0;  // x - x is +0
    return soft_packed(larger);
}

static SoftDouble soft_sub(SoftDouble x, SoftDouble y) { return soft_add(x, soft_negated(y)); }

static SoftDouble soft_mul(SoftDouble x, SoftDouble y) {
    ulong sign = (x.bits ^ y.bits) & SOFT_SIGN;
    if (soft_is_nan(x) || soft_is_nan(y)) return soft_of_bits(SOFT_NAN);
    if (soft_is_infinite(x) || soft_is_infinite(y))
        return soft_of_bits(soft_is_zero(x) || soft_is_zero(y) ? SOFT_NAN : sign | SOFT_INFINITY);
    SoftParts a = soft_parts(x), b = soft_parts(y);
    ulong high = mul_hi(a.significand, b.significand), low = a.significand * b.significand;
    a.sign = sign;
    a.exponent += b.exponent - 1021;  // 2^62 2^62 2^-64 is 2^60: two below bit 62
    a.significand = high | (low != 0 ? 1 : 0);
    return soft_packed(a);
}

static SoftDouble soft_div(SoftDouble x, SoftDouble y) {
    ulong sign = (x.bits ^ y.bits) & SOFT_SIGN;
    if (soft_is_nan(x) || soft_is_nan(y) || (soft_is_infinite(x) && soft_is_infinite(y)) ||
        (soft_is_zero(x) && soft_is_zero(y)))
        return soft_of_bits(SOFT_NAN);
    if (soft_is_infinite(x) || soft_is_zero(y)) return soft_of_bits(sign | SOFT_INFINITY);
    if (soft_is_zero(x) || soft_is_infinite(y)) return soft_of_bits(sign);
    SoftParts a = soft_parts(x), b = soft_parts(y);
    // Long division, eleven bits at a time: the remainder stays below the divisor's 53 bits.
    ulong divisor = b.significand >> 10, rest = a.significand >> 10;
    ulong quotient = rest / divisor;
    rest -= quotient * divisor;
    for (int i = 0; i < 5; ++i) {
        rest <<= 11;
        ulong digit = rest / divisor;
        rest -= digit * divisor;
        quotient = (quotient << 11) | digit;
    }
    a.sign = sign;
    a.exponent += 1023 - b.exponent;
    a.significand = (quotient << 7) | (rest != 0 ? 1 : 0);  // a quotient of 1 is 2^55
    return soft_packed(a);
}

static SoftDouble soft_sqrt(SoftDouble x) {
    if (soft_is_zero(x)) return x;
    if (soft_is_nan(x) || (x.bits & SOFT_SIGN) != 0) return soft_of_bits(SOFT_NAN);
    if (soft_is_infinite(x)) return x;
    SoftParts a = soft_parts(x);
    // value = radicand 2^-52 2^(exponent - 1023) with an even exponent - 1023; then bit by bit, two of the radicand for
    // one of the root, as on paper. 55 bits of root: 53, one more, and the gathered rest.
    ulong radicand = a.significand >> 10;
    int exponent = a.exponent - 1023;
    if (exponent & 1) {
        radicand <<= 1;
        exponent -= 1;
    }
    ulong root = 0, rest = 0;
    for (int i = 0; i < 55; ++i) {
        int at = 52 - 2 * i;
        rest = (rest << 2) | (at >= 0 ? (radicand >> at) & 3ul : 0);
        ulong trial = (root << 2) | 1ul;
        bool fits = rest >= trial;
        if (fits) rest -= trial;
        root = (root << 1) | (fits ? 1 : 0);
    }
    a.exponent = exponent / 2 + 1023;
    a.significand = (root << 8) | (rest != 0 ? 1 : 0);  // a root of 1 is 2^54
    return soft_packed(a);
}

// False if either is NaN.
static bool soft_less(SoftDouble x, SoftDouble y) {
    if (soft_is_nan(x) || soft_is_nan(y)) return false;
    if (soft_is_zero(x) && soft_is_zero(y)) return false;
    bool x_negative = (x.bits & SOFT_SIGN) != 0, y_negative = (y.bits & SOFT_SIGN) != 0;
    if (x_negative != y_negative) return x_negative;
    return x_negative ? x.bits > y.bits : x.bits < y.bits;
}

static SoftDouble soft_of_uint(uint x) {
    SoftParts parts;
    parts.sign = 0;
    parts.exponent = 1023 + 31;
    parts.significand = (ulong)x << 31;
    return soft_packed(parts);
}

static SoftDouble soft_of_float(float x) {
    uint bits = as_uint(x), field = (bits >> 23) & 0xFFu;
    ulong sign = (ulong)(bits & 0x80000000u) << 32;
    if (field == 0xFFu) return soft_of_bits((bits & 0x7FFFFFu) != 0 ? SOFT_NAN : sign | SOFT_INFINITY);
    SoftParts parts;
    parts.sign = sign;
    parts.exponent = (int)max(field, 1u) + (1023 - 127);
    parts.significand = (ulong)((bits & 0x7FFFFFu) | (field != 0 ? 0x800000u : 0u)) << 39;
    return soft_packed(parts);
}

// Rounded to nearest even.
static float float_of_soft(SoftDouble x) {
    if (soft_is_nan(x)) return as_float(0x7FC00000u);
    uint sign = (uint)(x.bits >> 32) & 0x80000000u;
    if (soft_is_infinite(x)) return as_float(sign | 0x7F800000u);
    SoftParts parts = soft_parts(x);
    if (parts.significand == 0) return as_float(sign);
    parts.exponent -= 1023 - 127;
    return as_float(sign | (uint)soft_rounded(parts, 23, 255));
}

#endif
