// SPDX-License-Identifier: MIT
// The last level of every decision: sums of products of three floats, exactly, in integers alone.
//
// Method: Kulisch's long accumulator (1971), cut to what three float32 factors need. A finite float is m * 2^(e - 150)
// with 0 <= m < 2^24 and 1 <= e <= 254, so a product of three is an integer of at most 72 bits times 2^(s - 447) with
// 0 <= s <= 759. Products are added, shifted into place, to a two's-complement integer of 28 words whose unit is
// 2^-447; up to 2^50 of them cannot overflow its 896 bits. No float operation takes part: rounding modes, contraction,
// flushed denormals and missing double precision cannot touch it.
#ifndef GN_EXACT_ACCUMULATOR_H
#define GN_EXACT_ACCUMULATOR_H

#include "exact/wide.h"
#include "prelude.h"

#define ACCUMULATOR_WORDS 28

typedef struct Accumulator {
    uint word[ACCUMULATOR_WORDS];
} Accumulator;

static void accumulator_clear(Accumulator* sum) {
    for (int i = 0; i < ACCUMULATOR_WORDS; ++i) sum->word[i] = 0;
}

// Significand of a finite float; *exponent becomes e (1 for denormals and zero).
static uint significand_of(float x, uint* exponent) {
    uint bits = as_uint(x);
    uint field = (bits >> 23) & 0xFFu;
    *exponent = max(field, 1u);
    return (bits & 0x7FFFFFu) | (field != 0u ? 0x800000u : 0u);
}

// sum += x * y * z; minus that if `negate`.
static void accumulator_add_product(Accumulator* sum, float x, float y, float z, bool negate) {
    uint exponent_x, exponent_y, exponent_z;
    uint significand_x = significand_of(x, &exponent_x);
    uint significand_y = significand_of(y, &exponent_y);
    uint significand_z = significand_of(z, &exponent_z);
    if (significand_x == 0 || significand_y == 0 || significand_z == 0) return;

    ulong product_xy = (ulong)significand_x * significand_y;  // below 2^48
    ulong low = product_xy * significand_z;
    uint high = (uint)mul_hi(product_xy, (ulong)significand_z);  // the product is high * 2^64 + low, below 2^72

    uint shift = exponent_x + exponent_y + exponent_z - 3;  // 0 .. 759
    uint first = shift >> 5;                                // at most 23, so first + 3 < ACCUMULATOR_WORDS
    uint by = shift & 31u;
    // The 72 bits moved up by 0..31 span four words. 64-bit shifts, so that by = 0 needs no case of its own.
    ulong piece[3];
    piece[0] = (low & 0xFFFFFFFFul) << by;
    piece[1] = (low >> 32) << by;
    piece[2] = (ulong)high << by;
    uint part[4];
    part[0] = (uint)piece[0];
    part[1] = (uint)(piece[0] >> 32) | (uint)piece[1];
    part[2] = (uint)(piece[1] >> 32) | (uint)piece[2];
    part[3] = (uint)(piece[2] >> 32);

    bool negative = (((as_uint(x) ^ as_uint(y) ^ as_uint(z)) >> 31) != 0u) != negate;
    // Subtraction adds the complement, with the carry into bit 0 standing for the +1 of all lower words.
    ulong carry = negative ? 1 : 0;
    uint flip = negative ? 0xFFFFFFFFu : 0u;
    for (uint i = first; i < ACCUMULATOR_WORDS; ++i) {
        uint addend = (i - first < 4u ? part[i - first] : 0u) ^ flip;
        ulong total = (ulong)sum->word[i] + addend + carry;
        sum->word[i] = (uint)total;
        carry = total >> 32;
        // Once past the product, a carry that equals the sign's own (1 with all-ones words, 0 with zeros) changes
        // nothing further up.
        if (i - first >= 3u && carry == (negative ? 1u : 0u)) break;
    }
}

// -1, 0 or 1.
static int accumulator_sign(const Accumulator* sum) {
    if (sum->word[ACCUMULATOR_WORDS - 1] & 0x80000000u) return -1;
    uint any = 0;
    for (int i = 0; i < ACCUMULATOR_WORDS; ++i) any |= sum->word[i];
    return any != 0u ? 1 : 0;
}

// The sum in double precision, with a relative error below 2^-52. Its range, 2^-447 .. 2^449, is inside double's.
static Wide accumulator_to_wide(const Accumulator* sum) {
    bool negative = (sum->word[ACCUMULATOR_WORDS - 1] & 0x80000000u) != 0u;
    Accumulator magnitude;
    uint carry = negative ? 1 : 0;
    int top = -1;
    for (int i = 0; i < ACCUMULATOR_WORDS; ++i) {
        uint word = negative ? ~sum->word[i] + carry : sum->word[i];
        carry = (negative && carry != 0u && word == 0u) ? 1 : 0;
        magnitude.word[i] = word;
        if (word != 0u) top = i;
    }
    if (top < 0) return WIDE_ZERO;
    // Three words: at least 65 bits, so what lies below them is under 2^-64 of the value. If the first two fit 53 bits,
    // only the last sum rounds. Else they may round by half an ulp; all that is below them is less than another half
    // and is lost: together less than one ulp of a number that is at least 2^52 ulps.
    Wide word_base = wide_power_of_two(32);
    Wide value = wide_of_uint(magnitude.word[top]);
    value = wide_add(wide_mul(value, word_base), wide_of_uint(top >= 1 ? magnitude.word[top - 1] : 0u));
    value = wide_add(wide_mul(value, word_base), wide_of_uint(top >= 2 ? magnitude.word[top - 2] : 0u));
    value = wide_mul(value, wide_power_of_two(32 * (top - 2) - 447));
    return negative ? wide_negated(value) : value;
}

#endif
