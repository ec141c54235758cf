// SPDX-License-Identifier: MIT
// As prepared_trace.cl, for points on a CPU under a direction, none of them doubtful: which way their receivers face is
// looked up (receiver_answers.h).
#define TRACE_KERNEL prepared_trace_by_answers
#define TRACE_IN_PLACE 0
#define TRACE_FACES 0
#define TRACE_BLOCKS 0
#define TRACE_BY_ANSWERS 1
#include "trace_points.h"
