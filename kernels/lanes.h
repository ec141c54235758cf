// SPDX-License-Identifier: MIT
// One source for scalar and vector work-items: GN_LANES points or pixels at a time, 1 on a GPU (whose hardware does the
// rest), 16 on a CPU (one AVX-512 register, two of AVX). Comparisons give 0 or -1 per lane in both.
#ifndef GN_LANES_H
#define GN_LANES_H

#include "prelude.h"

// Where a CPU has an instruction that collects the signs of lanes.
#if defined(__AVX__) && defined(__has_builtin)
#if __has_builtin(__builtin_ia32_movmskps256) && __has_builtin(__builtin_ia32_pmovmskb128)
#define GN_X86_SIGNS
#endif
#endif

#if GN_LANES == 1
typedef float LaneFloat;
typedef int LaneInt;
#define LANE_COMPARE(a, op, b) (-((a)op(b)))
#define LANES_ANY(mask) ((mask) != 0)
#define LANES_SELECT(no, yes, mask) ((mask) ? (yes) : (no))
#define LANE_INDEX 0
#define LANES_AS_INT(x) as_int(x)
#define LANES_AS_FLOAT(x) as_float(x)
#define LANES_TO_INT(x) ((int)(x))
#define LANES_TO_FLOAT(x) ((float)(x))
#define LANES_MINIMUM(v) (v)
#define LANES_MAXIMUM(v) (v)
#define LANES_SUM(v) (v)
#define LANES_LEAST(v) (v)
#define LANES_STRIDED(values, stride) (*(values))
#define LANES_OF_ROWS(rows, k) ((rows)[0][k])
#define LANES_GATHER(values, at) ((values)[at])
#elif GN_LANES == 16
typedef float16 LaneFloat;
typedef int16 LaneInt;
#define LANE_COMPARE(a, op, b) ((a)op(b))
#define LANES_ANY(mask) any_of_16(mask)
#define LANES_SELECT(no, yes, mask) select(no, yes, mask)
#define LANE_INDEX (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#define LANES_AS_INT(x) as_int16(x)
#define LANES_AS_FLOAT(x) as_float16(x)
#define LANES_TO_INT(x) convert_int16(x)
#define LANES_TO_FLOAT(x) convert_float16(x)
#define LANES_MINIMUM(v) least_of_16(v)
#define LANES_MAXIMUM(v) ~least_of_16(~(v))
#define LANES_SUM(v) sum_of_16(v)
#define LANES_LEAST(v) least_float_of_16(v)

// values[0], values[stride], values[2 stride] ...; rows[0][k], rows[1][k] ...; values[at.s0], values[at.s1] ... Written
// out: lane by lane through an array, each vector would wait for its stores.
#define LANES_STRIDED(values, stride)                                                                                \
    (float16)((values)[0], (values)[stride], (values)[2 * (stride)], (values)[3 * (stride)], (values)[4 * (stride)], \
              (values)[5 * (stride)], (values)[6 * (stride)], (values)[7 * (stride)], (values)[8 * (stride)],        \
              (values)[9 * (stride)], (values)[10 * (stride)], (values)[11 * (stride)], (values)[12 * (stride)],     \
              (values)[13 * (stride)], (values)[14 * (stride)], (values)[15 * (stride)])
#define LANES_OF_ROWS(rows, k)                                                                                      \
    (float16)((rows)[0][k], (rows)[1][k], (rows)[2][k], (rows)[3][k], (rows)[4][k], (rows)[5][k], (rows)[6][k],     \
              (rows)[7][k], (rows)[8][k], (rows)[9][k], (rows)[10][k], (rows)[11][k], (rows)[12][k], (rows)[13][k], \
              (rows)[14][k], (rows)[15][k])
#define LANES_GATHER(values, at)                                                                                  \
    (int16)((values)[at.s0], (values)[at.s1], (values)[at.s2], (values)[at.s3], (values)[at.s4], (values)[at.s5], \
            (values)[at.s6], (values)[at.s7], (values)[at.s8], (values)[at.s9], (values)[at.sa], (values)[at.sb], \
            (values)[at.sc], (values)[at.sd], (values)[at.se], (values)[at.sf])

// The same by looks (prelude.h).
#define LANES_LOOK(values, at)                                                                                      \
    (int16)(                                                                                                        \
        GN_LOOK(&(values)[at.s0]), GN_LOOK(&(values)[at.s1]), GN_LOOK(&(values)[at.s2]), GN_LOOK(&(values)[at.s3]), \
        GN_LOOK(&(values)[at.s4]), GN_LOOK(&(values)[at.s5]), GN_LOOK(&(values)[at.s6]), GN_LOOK(&(values)[at.s7]), \
        GN_LOOK(&(values)[at.s8]), GN_LOOK(&(values)[at.s9]), GN_LOOK(&(values)[at.sa]), GN_LOOK(&(values)[at.sb]), \
        GN_LOOK(&(values)[at.sc]), GN_LOOK(&(values)[at.sd]), GN_LOOK(&(values)[at.se]), GN_LOOK(&(values)[at.sf]))

// PoCL's any() asks lane by lane, with a branch each.
static bool any_of_16(int16 mask) {
    int8 a = mask.lo | mask.hi;
    long2 b = as_long2(a.lo | a.hi);
    return (b.x | b.y) != 0;
}
static int least_of_16(int16 v) {
    int8 a = min(v.lo, v.hi);
    int4 b = min(a.lo, a.hi);
    int2 c = min(b.lo, b.hi);
    return min(c.x, c.y);
}
static float least_float_of_16(float16 v) {
    float8 a = fmin(v.lo, v.hi);
    float4 b = fmin(a.lo, a.hi);
    float2 c = fmin(b.lo, b.hi);
    return fmin(c.x, c.y);
}
static int sum_of_16(int16 v) {
    int8 a = v.lo + v.hi;
    int4 b = a.lo + a.hi;
    return b.x + b.y + b.z + b.w;
}
#else
#error "GN_LANES must be 1 or 16"
#endif

// Minimum and maximum without fmin's rules for NaN, which cost instructions. A NaN as `a` gives b.
#define LANES_MIN(a, b) LANES_SELECT(b, a, LANE_COMPARE(a, <, b))
#define LANES_MAX(a, b) LANES_SELECT(b, a, LANE_COMPARE(a, >, b))

// The bits of |x|: in the order of the magnitudes, infinities and NaNs above all of them. Integer maxima over them and
// one comparison say whether all of several values are finite.
#define LANES_SIZE_BITS(x) (LANES_AS_INT(x) & 0x7FFFFFFF)
#define BITS_OF_INFINITY 0x7F800000

// One lane of a vector (of a variable).
#define LANE_OF_INT(v, lane) (((int*)&(v))[lane])
#define LANE_OF_FLOAT(v, lane) (((float*)&(v))[lane])

// Bit i: lane i of a mask is set.
#if GN_LANES == 1
static uint lane_bits(LaneInt mask) { return (uint)mask & 1u; }
#elif defined(GN_X86_SIGNS)
static uint lane_bits(LaneInt mask) {
    float16 signs = as_float16(mask);
    return (uint)__builtin_ia32_movmskps256(signs.lo) | (uint)__builtin_ia32_movmskps256(signs.hi) << 8;
}
#else
static uint lane_bits(LaneInt mask) { return (uint)LANES_SUM(mask & ((LaneInt)(1) << LANE_INDEX)); }
#endif

// The lowest of the bits, of which there is one at least; and clears it.
static uint lowest_bit(uint bits) { return 31u - clz(bits & (0u - bits)); }
static uint take_lowest_bit(uint* bits) {
    uint lowest = lowest_bit(*bits);
    *bits &= *bits - 1u;
    return lowest;
}

// The first of the lanes whose bits are set; clears its bit. On a GPU, where it is the only one, it is a constant: by
// an index that is not, a GPU would keep what is indexed in memory.
static int take_lane(uint* bits) {
#if GN_LANES == 1
    *bits = 0u;
    return 0;
#else
    return (int)take_lowest_bit(bits);
#endif
}

// The first lane that is set, of a mask that has one; and how many are.
static int first_lane(LaneInt mask) { return GN_LANES == 1 ? 0 : (int)lowest_bit(lane_bits(mask)); }
static uint count_lanes(LaneInt mask) { return (uint)-LANES_SUM(mask); }

// Signed integers in the order of the floats (no NaN): float_to_key() with the top bit turned.
static LaneInt lanes_in_order(LaneFloat x) {
    LaneInt bits = LANES_AS_INT(x);
    return bits ^ ((bits >> 31) & 0x7FFFFFFF);
}
static LaneFloat lanes_of_order(LaneInt order) { return LANES_AS_FLOAT(order ^ ((order >> 31) & 0x7FFFFFFF)); }
static uint order_to_key(int order) { return (uint)order ^ 0x80000000u; }
static int key_to_order(uint key) { return (int)(key ^ 0x80000000u); }

// slope_x x + slope_y y + constant_term, rounded as the records' margins assume.
static LaneFloat lanes_linear(float slope_x, float slope_y, float constant_term, LaneFloat x, LaneFloat y) {
    return fma((LaneFloat)(slope_x), x, fma((LaneFloat)(slope_y), y, (LaneFloat)(constant_term)));
}

#endif
