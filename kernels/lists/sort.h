// SPDX-License-Identifier: MIT
// Contract of the sort: 32-bit keys with a value each, put in the order of the keys; equal keys keep their order. The
// sort takes one byte at a time, the lowest first: each pass keeps the order of keys with the same byte.
#pragma once

#include "prelude.h"

#define SORT_DIGIT_BITS 8u
#define SORT_DIGITS 256u
// A GPU's work-group sorts a chunk by half a digit at a time.
#define SORT_HALF_BITS 4u
#define SORT_HALVES 16u

// The number of keys of a chunk, which on a CPU one work-item sorts, and on a GPU a work-group.
#ifdef __cplusplus
namespace gnomon {
constexpr uint sort_chunk(bool is_cpu) { return is_cpu ? 4096 : 1024; }
}  // namespace gnomon
#elif defined(GN_CPU)
#define SORT_CHUNK 4096u
#else
#define SORT_CHUNK 1024u
#endif

GN_STRUCT_BEGIN(SortParams)
    uint count;  // number of keys
    uint shift;  // the lowest bit of the digit
GN_STRUCT_END(SortParams, 8)
