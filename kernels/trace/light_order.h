// SPDX-License-Identifier: MIT
// Contract of the light order: points sorted along a curve through the light's plane, so that the points of a block lie
// in few bins. Absent points come last. The order affects speed alone.
#pragma once

#include "receivers/light_frame.h"
#include "simd/points.h"

// The points of a sampled run of neighbours, as many as a block has on a CPU.
#define LIGHT_ORDER_RUN 16u
// The plane has 2^LIGHT_ORDER_BITS cells per axis; a code has twice as many bits.
#define LIGHT_ORDER_BITS 8u

GN_STRUCT_BEGIN(LightOrderParams)
    PointsLayout points;
    LightFrame light_frame;
    float origin[2], scale[2];  // of the cells in the light's plane
    uint run_count;             // of sampled runs,
    uint run_stride;            // the distance of two runs, in points
    uint padding[2];
GN_STRUCT_END(LightOrderParams, 144)
