// SPDX-License-Identifier: MIT
// Contract of the light that reaches each pixel from a shining parallelogram, or from the sky: sums over a table of
// lights, in doubles (exact/wide.clh: of the device's own, or of integers) and rounded once.
#pragma once

#include "simd/points.h"

GN_STRUCT_BEGIN(ReceivedParams)
    PointsLayout layout;  // of the pixels' points
    ulong area[3];        // bits of doubles: edge_a x edge_b, as long as its area
    uint samples;
    uint words;  // of a row of bits
GN_STRUCT_END(ReceivedParams, 80)
