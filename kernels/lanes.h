// SPDX-License-Identifier: MIT
// One source for scalar and vector work-items: GN_LANES points or pixels at a time, 1 on a GPU (whose hardware does the
// rest), 16 on a CPU (one AVX-512 register, two of AVX). Comparisons give 0 or -1 per lane in both.
#ifndef GN_LANES_H
#define GN_LANES_H

#include "prelude.h"

#if GN_LANES == 1
typedef float LaneFloat;
typedef int LaneInt;
#define LANE_COMPARE(a, op, b) (-((a)op(b)))
#define LANES_ANY(mask) ((mask) != 0)
#define LANES_SELECT(no, yes, mask) ((mask) ? (yes) : (no))
#define LANE_INDEX 0
#elif GN_LANES == 16
typedef float16 LaneFloat;
typedef int16 LaneInt;
#define LANE_COMPARE(a, op, b) ((a)op(b))
#define LANES_ANY(mask) any(mask)
#define LANES_SELECT(no, yes, mask) select(no, yes, mask)
#define LANE_INDEX (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#else
#error "GN_LANES must be 1 or 16"
#endif

// Minimum without fmin's rules for NaN, which cost instructions: no NaN gets here.
#define LANES_MIN(a, b) LANES_SELECT(b, a, LANE_COMPARE(a, <, b))

// slope_x x + slope_y y + constant_term, rounded as the records' margins assume.
static LaneFloat lanes_linear(float slope_x, float slope_y, float constant_term, LaneFloat x, LaneFloat y) {
    return fma((LaneFloat)(slope_x), x, fma((LaneFloat)(slope_y), y, (LaneFloat)(constant_term)));
}

#endif
