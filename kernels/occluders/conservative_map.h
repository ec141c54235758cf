// SPDX-License-Identifier: MIT
// Contract of the conservative map: the parameters of a launch, and when a map is worth drawing.
#pragma once

#include "prelude.h"

// When a texel counts as covered, and the height it gets.
#define COVER_TIGHT 0u   // the triangle covers its four corners; the plane's height at the lowest of them
#define COVER_CIRCLE 1u  // Hertel's test; the same height
#define COVER_SLOPE 2u   // as tight; the height that graphics hardware gives the paper: slope-scaled bias, d = 1

GN_STRUCT_BEGIN(ConservativeMapParams)
    uint tile_capacity;  // of the map's tiles
    uint cover_test;     // COVER_TIGHT, COVER_CIRCLE or COVER_SLOPE
GN_STRUCT_END(ConservativeMapParams, 8)

#ifndef __cplusplus
// A map that covers fewer texels than this costs more than it saves.
static uint texels_worth_a_map(uint width, uint height) { return width * height / 16u; }
#endif
