// SPDX-License-Identifier: MIT
// Contract of the sort: keys of 32 bits and a value each, put in the order of the keys, of equal keys in the order that
// they came in. By one byte at a time, the lowest first: each pass keeps the order of what it cannot tell apart.
#ifndef GN_SORT_H
#define GN_SORT_H

#include "prelude.h"

#define SORT_DIGIT_BITS 8u
#define SORT_DIGITS 256u

// Keys that one work-item takes, one after the other: a CPU likes long pieces; a GPU many.
#ifdef __cplusplus
namespace gnomon {
constexpr uint sort_piece(bool is_cpu) { return is_cpu ? 4096 : 512; }
}  // namespace gnomon
#elif defined(GN_CPU)
#define SORT_CHUNK 4096u
#else
#define SORT_CHUNK 512u
#endif

#endif
