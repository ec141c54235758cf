// SPDX-License-Identifier: MIT
// The first look under a prepared direction on a CPU, after facing: what is not within the domain is lit, or a stray.
#define TRACE_KERNEL prepared_trace_of_blocks
#define TRACE_IN_PLACE 0
#define TRACE_FACES 0
#define TRACE_BLOCKS 1
#define TRACE_DOMAINS 1
#include "trace_points.h"
