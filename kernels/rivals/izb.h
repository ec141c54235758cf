// SPDX-License-Identifier: MIT
// Contract of the technique izb: lists of points by texel of light space.
#pragma once

#include "rivals/framed_technique.h"

GN_STRUCT_BEGIN(IzbParams)
    FramedParams framed;
    uint has_map;         // 0: the map's buffer is not read
    uint slot_count;      // of the lists, a multiple of 16
    uint queue_capacity;  // pairs
    uint padding;
GN_STRUCT_END(IzbParams, 152)

// The lists as a structure of arrays: slot_count words each of the point's index and of its X, Y, Z in the grid. The
// index of an empty slot, which a removed point leaves, is GN_NO_ID.
#define IZB_WORDS 4u

// A GPU's work-group has at most this number of items.
#define IZB_GROUP 128u
