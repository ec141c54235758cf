// SPDX-License-Identifier: MIT
// Fills several buffers at once: on a GPU each launch takes several microseconds, however little it does.
#include "prelude.h"

// buffer_i[0, count_i) = word_i. If count_i is 0, buffer_i is ignored.
__kernel void fill_buffers(ulong count_0, uint word_0, __global uint* buffer_0, ulong count_1, uint word_1,
                           __global uint* buffer_1, ulong count_2, uint word_2, __global uint* buffer_2, ulong count_3,
                           uint word_3, __global uint* buffer_3) {
    GN_FOR_EACH(i, count_0) buffer_0[i] = word_0;
    GN_FOR_EACH(i, count_1) buffer_1[i] = word_1;
    GN_FOR_EACH(i, count_2) buffer_2[i] = word_2;
    GN_FOR_EACH(i, count_3) buffer_3[i] = word_3;
}
