// SPDX-License-Identifier: MIT
// Contract of the triangle lists: per bin of a projection the triangles that may matter to a point in it, each with
// bounds of 16 bits that dismiss most of them before a record is read.
//
// GN_LANES entries of one bin lie together, coordinate by coordinate, so that a CPU looks at 16 entries with one
// comparison. ranges[bin] = (first, past the last), in units of BinEntries. Unused lanes have x0 > x1.
//
// A point (X, Y, Z) of the bin, or a block of points by its own bounds, can only meet an entry with
//     x0 <= qx <= x1,   y0 <= qy <= y1,   qz <= z          qx = quantised_texel(X, width) and so on.
// Why: x0..y1 are made from the rectangle that holds every computed (X, Y) of points whose ray the triangle can meet
// (all errors in it), z from the record's z_high, and the same functions quantise both sides. Each is monotone, being
// made of monotone roundings: X <= X' implies q(X) <= q(X'); so q(X) < x0 implies X < the rectangle's left side.
#ifndef GN_BIN_LISTS_H
#define GN_BIN_LISTS_H

#include "prelude.h"

#define BIN_ENTRY_BYTES 16

// A triangle that matters to a frame: its bounds, and which one it is. `id` is the triangle's number in the scene.
GN_STRUCT_BEGIN(TriangleBounds)
    ushort x0, y0, x1, y1;
    ushort z;
    ushort frame;  // and BOUNDS_FOR_MAP
    uint id;
GN_STRUCT_END(TriangleBounds, BIN_ENTRY_BYTES)

#define BOUNDS_FOR_MAP 0x8000u  // may cover a whole texel
#define BOUNDS_FRAME(frame) ((frame)&0xFFu)

#ifndef __cplusplus

#if GN_LANES == 1
typedef ushort LaneUshort;
typedef uint LaneUint;
#else
typedef ushort16 LaneUshort;
typedef uint16 LaneUint;
#endif

typedef struct BinEntries {
    LaneUshort x0, y0, x1, y1;
    LaneUshort z;
    LaneUshort unused;
    LaneUint slot;  // of the record
} BinEntries;
typedef char BinEntries_has_size[sizeof(BinEntries) == GN_LANES * BIN_ENTRY_BYTES ? 1 : -1];

// Units per texel: a whole number, so that host, device and every kernel agree on it to the bit.
static float texel_units(uint texels) { return (float)(65536u / texels); }
static ushort quantised_texel(float coordinate, uint texels) {
    return (ushort)clamp(coordinate * texel_units(texels), 0.0f, 65535.0f);
}
static ushort quantised_height(float z, float z_origin, float z_scale) {
    return (ushort)clamp((z - z_origin) * z_scale, 0.0f, 65535.0f);
}

#endif
#endif
