// SPDX-License-Identifier: MIT
// The first look under a prepared light, at all points: facing is decided on the way (prepared_facing.h).
#define TRACE_KERNEL prepared_trace
#define TRACE_IN_PLACE 0
#define TRACE_FACES 1
#define TRACE_BY_PLANES 0
#define TRACE_BLOCKS 0
#define TRACE_BY_ANSWERS 0
#include "trace_points.h"
