// SPDX-License-Identifier: MIT
// The second look, at points whose undecided pairs found no room in the queue: they are decided in place.
#define TRACE_KERNEL trace_again
#define TRACE_IN_PLACE 1
#define TRACE_FACES 0
#define TRACE_BLOCKS 0
#define TRACE_BY_ANSWERS 0
#include "trace_points.h"
