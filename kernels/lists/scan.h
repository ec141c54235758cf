// SPDX-License-Identifier: MIT
// Contract of the scan: the number of counts that a work-group sums.
#pragma once

#include "prelude.h"

// On a CPU a work-group is one item.
#ifdef __cplusplus
namespace gnomon {
constexpr uint scan_chunk(bool is_cpu) { return is_cpu ? 256 : 2048; }
}  // namespace gnomon
#elif defined(GN_CPU)
#define SCAN_CHUNK 256u
#else
#define SCAN_CHUNK 2048u
#endif
