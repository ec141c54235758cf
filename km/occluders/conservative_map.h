// SPDX-License-Identifier: MIT
// Contract of the conservative map: the parameters of a launch, and when a map is worth drawing.
#pragma once

#include "prelude.h"

GN_STRUCT_BEGIN(ConservativeMapParams)
    uint tile_capacity;  // of the map's tiles
    uint circle_cover;   // 1: a texel counts as covered by Hertel's test; 0: by the tight one
GN_STRUCT_END(ConservativeMapParams, 8)

#ifndef __cplusplus
// A map that covers fewer texels than this costs more than it saves.
static uint texels_worth_a_map(uint width, uint height) { return width * height / 16u; }
#endif
