// SPDX-License-Identifier: MIT
// Contract of the levels of colour textures: each level is the mean of the unrounded one before, in linear light times
// weight, over the area of each texel. Texels are 8-bit sRGB and a weight from 1 to 255, never 0, so that a mean of
// clear texels has a colour. Each operation rounds once: the same bits as those of the host (host/shading/texture.cpp).
#pragma once

#include "prelude.h"

// A level and the one before.
GN_STRUCT_BEGIN(MipParams)
    ulong first_texel;         // of the level, in the texels of all textures
    ulong first_texel_before;  // of the level before
    uint width, height;
    uint width_before, height_before;
    uint is_even;  // 1: both sides of the level before are even, and a texel is the mean of four; 0: taps are read
    uint padding;
GN_STRUCT_END(MipParams, 40)

// The neighbours whose mean one texel is, along one side: up to three, with their shares. Of the columns, then of the
// rows.
GN_STRUCT_BEGIN(MipTaps)
    uint first;
    float shares[3];
GN_STRUCT_END(MipTaps, 16)

// Linear light and weight of 8 bits, and sRGB of linear light in MIP_ENCODED steps from 0 to 1.
#define MIP_ENCODED 65536
GN_STRUCT_BEGIN(MipTables)
    float linear_of[256];
    float weight_of[256];
    unsigned char srgb_of[MIP_ENCODED];
GN_STRUCT_END(MipTables, 2048 + MIP_ENCODED)
