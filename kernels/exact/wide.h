// SPDX-License-Identifier: MIT
// Double precision under one name, so that a kernel has one text: the device's own where it has it and computes right
// (GN_FP64), else by integers (soft_double.h). Every operation is rounded to nearest even: the same bits either way.
#ifndef GN_EXACT_WIDE_H
#define GN_EXACT_WIDE_H

#include "prelude.h"

#ifdef GN_FP64

typedef double Wide;
static Wide wide_of_bits(ulong bits) { return as_double(bits); }
static ulong bits_of_wide(Wide x) { return as_ulong(x); }
static Wide wide_of_float(float x) { return (double)x; }
static Wide wide_of_uint(uint x) { return (double)x; }
static float float_of_wide(Wide x) { return convert_float_rte(x); }
static Wide wide_add(Wide x, Wide y) { return x + y; }
static Wide wide_sub(Wide x, Wide y) { return x - y; }
static Wide wide_mul(Wide x, Wide y) { return x * y; }
static Wide wide_div(Wide x, Wide y) { return x / y; }
static Wide wide_sqrt(Wide x) { return sqrt(x); }
static Wide wide_negated(Wide x) { return -x; }
static Wide wide_absolute(Wide x) { return fabs(x); }
static bool wide_less(Wide x, Wide y) { return x < y; }

#else

#include "exact/soft_double.h"

typedef SoftDouble Wide;
static Wide wide_of_bits(ulong bits) { return soft_of_bits(bits); }
static ulong bits_of_wide(Wide x) { return x.bits; }
static Wide wide_of_float(float x) { return soft_of_float(x); }
static Wide wide_of_uint(uint x) { return soft_of_uint(x); }
static float float_of_wide(Wide x) { return float_of_soft(x); }
static Wide wide_add(Wide x, Wide y) { return soft_add(x, y); }
static Wide wide_sub(Wide x, Wide y) { return soft_sub(x, y); }
static Wide wide_mul(Wide x, Wide y) { return soft_mul(x, y); }
static Wide wide_div(Wide x, Wide y) { return soft_div(x, y); }
static Wide wide_sqrt(Wide x) { return soft_sqrt(x); }
static Wide wide_negated(Wide x) { return soft_negated(x); }
static Wide wide_absolute(Wide x) { return soft_absolute(x); }
static bool wide_less(Wide x, Wide y) { return soft_less(x, y); }

#endif

#define WIDE_ZERO wide_of_bits(0ul)
#define WIDE_ONE wide_of_bits(0x3FF0000000000000ul)

// Of numbers, not NaN.
static Wide wide_max(Wide x, Wide y) { return wide_less(x, y) ? y : x; }
static bool wide_is_zero(Wide x) { return (bits_of_wide(x) << 1) == 0; }
// -1, 0 or 1.
static int wide_sign(Wide x) { return wide_is_zero(x) ? 0 : (bits_of_wide(x) >> 63) != 0 ? -1 : 1; }
// 2^e, -1022 <= e <= 1023. Multiplying by it is exact while the product is a normal number.
static Wide wide_power_of_two(int e) { return wide_of_bits((ulong)(e + 1023) << 52); }
// e of 2^e <= |x| < 2^(e + 1); -1023 for zero and denormals.
static int wide_exponent(Wide x) { return (int)((bits_of_wide(x) >> 52) & 0x7FFul) - 1023; }
// x a + y b + z c, every product and sum rounded, from left to right.
static Wide wide_dot(Wide x, Wide y, Wide z, Wide a, Wide b, Wide c) {
    return wide_add(wide_add(wide_mul(x, a), wide_mul(y, b)), wide_mul(z, c));
}

#endif
