// SPDX-License-Identifier: MIT
// The Morton code of a position: the bits of its three coordinates interleaved. Order along the code keeps neighbours
// in space together.
#pragma once

#include "prelude.h"

#define MORTON_BITS 10u  // of each coordinate

#ifndef __cplusplus

// Puts two zeros between each two bits.
static uint spread_bits(uint x) {
    x = (x | x << 16) & 0x030000FFu;
    x = (x | x << 8) & 0x0300F00Fu;
    x = (x | x << 4) & 0x030C30C3u;
    return (x | x << 2) & 0x09249249u;
}

// The code of a cell, of up to MORTON_BITS each.
static uint morton_of_cell(uint3 cell) {
    return spread_bits(cell.x) | spread_bits(cell.y) << 1 | spread_bits(cell.z) << 2;
}

// The code of a position whose coordinates are from 0 to 2^MORTON_BITS; others are moved to the nearest of these.
static uint morton_code(float3 position) {
    return morton_of_cell(convert_uint3(clamp(position, 0.0f, (float)((1u << MORTON_BITS) - 1u))));
}

#endif
