// SPDX-License-Identifier: MIT
// The first look at open points: undecided pairs are handed over to the exact stage.
#define TRACE_KERNEL trace
#define TRACE_IN_PLACE 0
#define TRACE_FACES 0
#define TRACE_BLOCKS 1
#define TRACE_BY_ANSWERS 0
#include "trace_points.h"
