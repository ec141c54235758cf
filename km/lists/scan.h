// SPDX-License-Identifier: MIT
// Contract of the scan: the number of counts that one work-item sums, and the multiple to which they are rounded up.
#pragma once

#include "prelude.h"

// A CPU is faster with long chunks, a GPU with many.
#ifdef __cplusplus
namespace gnomon {
constexpr uint scan_chunk(bool is_cpu) { return is_cpu ? 256 : 32; }
}  // namespace gnomon
#elif defined(GN_CPU)
#define SCAN_CHUNK 256
#else
#define SCAN_CHUNK 32
#endif

GN_STRUCT_BEGIN(ScanParams)
    uint count;
    uint alignment;  // a power of two: each count is rounded up to a multiple of it
GN_STRUCT_END(ScanParams, 8)
