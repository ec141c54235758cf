// SPDX-License-Identifier: MIT
// The Morton code of a position: the bits of its three coordinates interleaved. Order along the code keeps neighbours
// in space together.
#pragma once

#include "prelude.h"

#define MORTON_BITS 10u  // the most of each coordinate

// Cells over a box: position x lies in cell (x / 2 - origin) scale. Halves, so that no difference overflows.
GN_STRUCT_BEGIN(MortonGrid)
    float origin[3];
    float scale;
GN_STRUCT_END(MortonGrid, 16)

#ifdef __cplusplus
namespace gnomon {
#endif

// Puts two zeros between each two bits.
static inline uint spread_bits(uint x) {
    x = (x | x << 16) & 0x030000FFu;
    x = (x | x << 8) & 0x0300F00Fu;
    x = (x | x << 4) & 0x030C30C3u;
    return (x | x << 2) & 0x09249249u;
}

#ifdef __cplusplus
}  // namespace gnomon
#else

// The cell of half a position, of 2^bits per axis; positions outside of the grid get the nearest cell.
static uint3 morton_cell(MortonGrid grid, float3 half_position, uint bits) {
    return convert_uint3(
        clamp((half_position - vload3(0, grid.origin)) * grid.scale, 0.0f, (float)((1u << bits) - 1u)));
}

// The code of a cell with up to MORTON_BITS bits per coordinate.
static uint morton_code(uint3 cell) {
    return spread_bits(cell.x) | spread_bits(cell.y) << 1 | spread_bits(cell.z) << 2;
}

#endif
