// SPDX-License-Identifier: MIT
// Contract of the scan: how many counts one work-item adds up.
#ifndef GN_SCAN_H
#define GN_SCAN_H

#include "prelude.h"

// A CPU likes long pieces; a GPU many.
#ifdef __cplusplus
namespace gnomon {
constexpr uint scan_piece(bool is_cpu) { return is_cpu ? 256 : 32; }
}  // namespace gnomon
#elif defined(GN_CPU)
#define SCAN_CHUNK 256
#else
#define SCAN_CHUNK 32
#endif

#endif
