// SPDX-License-Identifier: MIT
// Contract of the sort: 32-bit keys with a value each, put in the order of the keys; equal keys keep their order. The
// sort takes one digit at a time, the lowest first: each pass keeps the order of keys with the same digit.
#pragma once

#include "prelude.h"

// A GPU's work-group sorts a chunk by half a digit at a time.
#define SORT_HALF_BITS 4u
#define SORT_HALVES 16u

// The number of keys of a chunk, which on a CPU one work-item sorts, on a GPU a work-group; and the bits of a digit.
#ifdef __cplusplus
namespace gnomon {
constexpr uint sort_chunk(bool is_cpu) { return is_cpu ? 4096 : 1024; }
constexpr uint sort_digit_bits(bool is_cpu) { return is_cpu ? 9 : 2 * SORT_HALF_BITS; }
}  // namespace gnomon
#elif defined(GN_CPU)
#define SORT_CHUNK 4096u
#define SORT_DIGITS 512u
#else
#define SORT_CHUNK 1024u
#define SORT_DIGITS 256u
#endif

GN_STRUCT_BEGIN(SortParams)
    uint count;  // number of keys
    uint shift;  // the lowest bit of the digit
GN_STRUCT_END(SortParams, 8)
