// SPDX-License-Identifier: MIT
// Contract of the scan: how many counts one work-item adds up.
#ifndef GN_SCAN_H
#define GN_SCAN_H

#include "prelude.h"

#define SCAN_PIECE 256

#endif
