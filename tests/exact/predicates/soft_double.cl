// SPDX-License-Identifier: MIT
// Every operation of software double precision, laid open for its test.
#include "exact/soft_double.clh"

#define RESULTS 9

// Per pair x, y of bits: the results of all operations; a float is read from the lower half of y's bits.
__kernel void soft_double_results(uint count, __global const ulong* pairs, __global ulong* results) {
    GN_FOR_EACH(i, count) {
        SoftDouble x = soft_of_bits(pairs[2 * i]), y = soft_of_bits(pairs[2 * i + 1]);
        __global ulong* out = results + RESULTS * i;
        out[0] = soft_add(x, y).bits;
        out[1] = soft_sub(x, y).bits;
        out[2] = soft_mul(x, y).bits;
        out[3] = soft_div(x, y).bits;
        out[4] = soft_sqrt(x).bits;
        out[5] = soft_less(x, y) ? 1 : 0;
        out[6] = as_uint(float_of_soft(x));
        out[7] = soft_of_float(as_float((uint)y.bits)).bits;
        out[8] = soft_of_uint((uint)y.bits).bits;
    }
}
