// SPDX-License-Identifier: MIT
// Start-up check: does this device compute as the proofs of the other kernels assume? Cheap, run once per device
// opened.
//
// Every operation gets numbers for which an incorrect compiler or chip gives other bits. Inputs are constants
// exclusive-or a zero from memory, so that nothing is computed at compile time; results are compared as integers.
//
// Float arithmetic may flush denormals: the float filter of det3.clh allows for it, and the exact level computes with
// bit patterns. A copy must not change a denormal or its sign: the exact level would then get other coordinates than
// the caller gave. A denormal must also not vanish when it is widened to double: the double filter would take the
// result for exact. A double narrowed to a denormal must give the nearest one: the camera rounds its points near the
// origin in this way.
#include "exact/det3.clh"
#include "exact/self_check.h"

// The registers of a target for x86, known when the kernel is compiled.
#if defined(__x86_64__) && !defined(__AVX512F__)
#define HAS_WIDE_REGISTERS 0
#else
#define HAS_WIDE_REGISTERS 1
#endif

static void demand(uint* faults, int fault, bool holds) {
    if (!holds) *faults |= 1u << fault;
}

static void check_floats(uint* faults, uint zero) {
    float one = as_float(0x3F800000u ^ zero);
    float half_ulp = as_float(0x33800000u ^ zero);  // 2^-24
    float ulp = as_float(0x34000000u ^ zero);       // 2^-23

    // (1 + 2^-12)^2 = 1 + 2^-11 + 2^-24, a tie that goes to 1 + 2^-11. Fused, 2^-24 is left.
    float a = as_float(0x3F800800u ^ zero), minus_square = as_float(0xBF801000u ^ zero);
    float square = a * a;
    float rest = square + minus_square;
    int4 rests = as_int4((float4)(a) * (float4)(a) + (float4)(minus_square));
    demand(faults, FAULT_FUSED, as_uint(a * a + minus_square) == 0u && as_uint(rest) == 0u && !any(rests != (int4)(0)));

    // 1 + 5/4 ulp rounds to 1 + ulp and leaves ulp / 4.
    float b = as_float(0x34200000u ^ zero);
    float sum = one + b;
    demand(faults, FAULT_REORDERED, as_uint((one - (sum - (sum - one))) + (b - (sum - one))) == 0x33000000u);

    demand(faults, FAULT_ROUNDING,
           as_uint(one + half_ulp) == 0x3F800000u && as_uint((one + ulp) + half_ulp) == 0x3F800002u &&
               as_uint((-one) + (-half_ulp)) == 0xBF800000u && as_uint(square) == 0x3F801000u);

    // The same tie: 2^-80 more breaks it, unless a sum that is rounded before loses the 2^-80.
    float little = as_float(0x17800000u ^ zero);
    demand(faults, FAULT_FMA,
           as_uint(fma(a, a, minus_square)) == 0x33800000u && as_uint(fma(a, a, little)) == 0x3F801001u);
}

// `kept` are floats in memory: two denormals and the largest. They are loaded, selected and stored, as the exact level
// does it. No denormal is negated, and fabs() of one enters only the float filter, whose bounds allow for flushing:
// Mesa's compiler flushes what it negates itself (tests/drivers/denormal_folded.c).
static void check_copies(uint* faults, __global float* kept, uint zero) {
    float3 v = (float3)(kept[0], kept[1], kept[2]);
    float3 w = vload3(0, kept);
    float chosen = coordinate_of(zero != 0u ? v : w, (int)zero + 1);
    kept[3] = v.x;
    demand(faults, FAULT_DENORMAL_COPIED,
           as_uint(v.x) == 0x00000001u && as_uint(w.x) == 0x00000001u && as_uint(chosen) == 0x807FFFFFu &&
               ((__global uint*)kept)[3] == 0x00000001u);
}

static void check_integers(uint* faults, uint zero) {
    ulong ones = ~(ulong)zero;
    uint word = 0xFFFFFFFFu ^ zero;
    ulong carried = (ulong)word + word + 1u;
    demand(faults, FAULT_INTEGERS,
           mul_hi(ones, ones) == 0xFFFFFFFFFFFFFFFEul && mul_hi(ones >> 16, (ulong)0xFFFFFFu) == 0xFFul &&
               (ulong)word * word == 0xFFFFFFFE00000001ul && (ones << (zero + 31u)) == 0xFFFFFFFF80000000ul &&
               (ones >> (zero + 33u)) == 0x7FFFFFFFul && (ones >> zero) == ones && carried == 0x1FFFFFFFFul);
}

static void check_keys(uint* faults, __global SelfCheckResult* result, uint zero) {
    const uint rising[8] = {0xFF7FFFFFu, 0xBF800000u, 0x80000001u, 0x80000000u,
                            0x00000000u, 0x00000001u, 0x3F800000u, 0x7F7FFFFFu};
    uint before = 0u;
    for (int i = 0; i < 8; ++i) {
        float x = as_float(rising[i] ^ zero);
        uint key = float_to_key(x);
        demand(faults, FAULT_KEYS, key > before && as_uint(key_to_float(key)) == rising[i]);
        before = key;
        atomic_min(&result->min_key, key);
        atomic_max(&result->greatest_key, key);
    }
}

// Rows (x, y, 0), (p, q, 0), (0, 0, 1): x q - y p, over the whole range of floats.
static int sign_of_minor(float x, float y, float p, float q, float3 origin) {
    return det3_sign_exact((float3)(x, y, 0.0f), origin, (float3)(p, q, 0.0f), origin, (float3)(0.0f, 0.0f, 1.0f),
                           origin);
}

static void check_exact(uint* faults, __global const float* kept, uint zero) {
    float3 origin = (float3)(as_float(zero));
    float tiny = kept[0], large = kept[2];
    demand(faults, FAULT_EXACT,
           sign_of_minor(tiny, 0.0f, large, tiny, origin) == 1 &&
               sign_of_minor(0.0f, tiny, tiny, large, origin) == -1 &&
               sign_of_minor(large, tiny, large, tiny, origin) == 0 &&
               sign_of_minor(large, large, -large, -large, (float3)(tiny, -tiny, large)) == 1 &&
               sign_of_minor(large, -tiny, tiny, -tiny, origin) == -1);
}

// A whole number of `bits` bits, less half its range (Numerical Recipes' quick generator).
static long next_whole(uint* state, uint bits) {
    *state = *state * 1664525u + 1013904223u;
    return (long)(*state >> (32u - bits)) - (1l << (bits - 1u));
}

static float3 float_point(const long* origin, const long* offset) {
    return (float3)((float)(origin[0] + offset[0]), (float)(origin[1] + offset[1]), (float)(origin[2] + offset[2]));
}

// Each work-item decides eight signs, some by floats, some by doubles, some exactly, so that neighbouring work-items
// take different ways. A compiler that joins work-items to vectors can mix them up: Intel's did (docs/drivers.md). The
// rows are u, v and a u + b v + (c, 0, 0), so the determinant is c (u_y v_z - u_z v_y). All coordinates are whole
// numbers below 2^24, which floats hold, and the determinant is computed in integers.
static void check_mixed_items(uint* faults, uint zero) {
    const long nothing[3] = {0l, 0l, 0l};
    uint state = (uint)get_global_id(0) ^ zero;
    for (int round = 0; round < 8; ++round) {
        uint bits = 4u + ((uint)round * 5u + (uint)get_global_id(0)) % 17u;
        long u[3], v[3], w[3], origin[3];
        for (int i = 0; i < 3; ++i) {
            u[i] = next_whole(&state, bits);
            v[i] = next_whole(&state, bits);
            origin[i] = next_whole(&state, 22u);
        }
        long a = next_whole(&state, 3u), b = next_whole(&state, 3u), c = next_whole(&state, 2u);
        for (int i = 0; i < 3; ++i) w[i] = a * u[i] + b * v[i];
        w[0] += c;
        long determinant = c * (u[1] * v[2] - u[2] * v[1]);
        float3 start = float_point(origin, nothing);
        int level = DET3_BY_FLOAT;
        int sign = det3_sign(float_point(origin, u), start, float_point(origin, v), start, float_point(origin, w),
                             start, &level);
        demand(faults, FAULT_ITEMS_MIXED, sign == (determinant > 0l) - (determinant < 0l));
    }
}

#ifdef GN_FP64
static void check_doubles(uint* faults, __global const float* kept, uint zero) {
    ulong none = zero;
    double one = as_double(0x3FF0000000000000ul ^ none);
    // As for floats: (1 + 2^-27)^2 = 1 + 2^-26 + 2^-54, which rounds to 1 + 2^-26.
    double a = as_double(0x3FF0000002000000ul ^ none), minus_square = as_double(0xBFF0000004000000ul ^ none);
    double square = a * a;
    double rest = square + minus_square;
    demand(faults, FAULT_DOUBLE_FUSED, as_ulong(a * a + minus_square) == 0ul && as_ulong(rest) == 0ul);
    double b = as_double(0x3CB4000000000000ul ^ none);  // 5/4 ulp
    double sum = one + b;
    demand(faults, FAULT_DOUBLE_REORDERED,
           as_ulong((one - (sum - (sum - one))) + (b - (sum - one))) == 0x3C90000000000000ul);
    double three = as_double(0x4008000000000000ul ^ none);
    double above_tie = as_double(0x3FF0000010000001ul ^ none);  // of floats: 1 + 2^-24 + 2^-52
    demand(faults, FAULT_DOUBLE_ROUNDING,
           as_ulong(one / three) == 0x3FD5555555555555ul && as_ulong(sqrt(three)) == 0x3FFBB67AE8584CAAul &&
               as_ulong(one + as_double(0x3CA0000000000000ul ^ none)) == 0x3FF0000000000000ul &&
               as_uint(convert_float_rte(above_tie)) == 0x3F800001u);
    demand(faults, FAULT_DENORMAL_WIDENED, as_ulong((double)kept[0]) == 0x36A0000000000000ul);
    // In units of the smallest denormal: 5/2, a tie that goes to 2, and minus a little more than 1/2, which goes to -1.
    double tie = as_double(0x36B4000000000000ul ^ none), above_half = as_double(0xB690000000000001ul ^ none);
    demand(faults, FAULT_DENORMAL_NARROWED,
           as_uint(convert_float_rte(tie)) == 0x00000002u && as_uint(convert_float_rte(above_half)) == 0x80000001u);
}
#endif

__kernel void self_check(__global SelfCheckResult* result, __global float* kept) {
    uint zero = result->zero;
    uint faults = 0u;
    check_keys(&faults, result, zero);
    check_mixed_items(&faults, zero);
    if (get_global_id(0) == 0) {
        check_floats(&faults, zero);
        check_copies(&faults, kept, zero);
        check_integers(&faults, zero);
        check_exact(&faults, kept, zero);
        if (GN_LANES > 1) demand(&faults, FAULT_WIDE_VECTORS, HAS_WIDE_REGISTERS);
#ifdef GN_FP64
        check_doubles(&faults, kept, zero);
#endif
    }
    if (faults != 0u) atomic_or(&result->faults, faults);
}
