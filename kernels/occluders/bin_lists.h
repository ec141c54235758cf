// SPDX-License-Identifier: MIT
// Contract of the bins: per bin of a projection the list of the triangles that may block a point in it. Each entry has
// bounds of 16 bits, which dismiss most triangles before a record is read.
//
// GN_LANES entries of one bin lie together, coordinate by coordinate, so that a CPU tests 16 entries with one
// comparison. ranges[bin] = (first, past the last), in units of BinEntries. Unused lanes have x0 > x1.
//
// On a GPU a list is in runs of LIST_RUN entries, each run with its highest triangle first: a point above an entry is
// above the rest of the run. On a CPU the lists of a prepared light are in runs of KEPT_RUN BinEntries, each run wholly
// in the order of heights. The rest of a list's order has no meaning. A point (X, Y, Z) of the bin, or a block of
// points by its own bounds, can only meet an entry with
//     x0 <= qx <= x1,   y0 <= qy <= y1,   qz <= z          qx = quantised_texel(X, width) and so on.
// Proof: x0..y1 are made from the rectangle that holds every computed (X, Y) of points that the triangle can block (all
// errors included), z from the record's z_high, and the same functions quantise both sides. Each function is monotone,
// being made of monotone roundings: X <= X' implies q(X) <= q(X'); so q(X) < x0 implies X < the rectangle's left side.
// A camera's heights are 1 / t; the search for the nearest triangle tests with the least 1 / t that is certain.
#pragma once

#include "prelude.h"

#define BIN_ENTRY_BYTES 16
#define LIST_RUN 64u
#define KEPT_RUN 64u

// The bounds of a triangle that survived the cull. `id` is the triangle's number in the scene; where clusters have an
// order of their own, it is the position in that order until triangle_tiles makes tiles for the lists.
GN_STRUCT_BEGIN(TriangleBounds)
    ushort x0, y0, x1, y1;
    ushort z;
    ushort flags;  // BOUNDS_FOR_MAP or BOUNDS_MASKED
    uint id;
GN_ALIGNED_STRUCT_END(TriangleBounds, BIN_ENTRY_BYTES)

#define BOUNDS_FOR_MAP 0x8000u  // may cover a whole texel
#define BOUNDS_MASKED 0x4000u   // of a masked triangle (exact/cut_outs.h)

// A triangle (its record's slot) in a bin, and the pair's index in the bin's list. An unused slot has bin GN_NO_ID. On
// a CPU each work-item counts its own pairs, in a row of counts for all bins: the bin is that of the row (bin number +
// row times the number of bins), and the index that of the bin's pairs in the row.
GN_STRUCT_BEGIN(Pair)
    uint bin, slot, index;
GN_STRUCT_END(Pair, 12)

// Bins per item that a GPU's work-group tests before it reserves slots: all items wait for a reservation.
#define PAIRS_AT_ONCE 4u

GN_STRUCT_BEGIN(BinsParams)
    uint bin_count;
    uint bounds_capacity;  // slots of bounds and records
    uint map_tile_capacity;
    uint tile_capacity;
    uint pair_capacity;
    uint entry_capacity;  // in BinEntries
    uint has_pyramid;     // 0: the depth excludes no bin
    uint count_rows;      // rows of the bins' counts; on a GPU 1
GN_STRUCT_END(BinsParams, 32)

#ifndef __cplusplus

#include "occluders/triangle_setup.h"
#include "simd/lanes.clh"

// Only programs that read cut-outs have masked triangles.
static bool is_masked(__global const TriangleBounds* bounds) {
#ifdef GN_CUT_OUTS
    return (bounds->flags & BOUNDS_MASKED) != 0u;
#else
    return false;
#endif
}

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
    LaneUint slot;  // slot of the record
} BinEntries;
typedef char BinEntries_has_size[sizeof(BinEntries) == GN_LANES * BIN_ENTRY_BYTES ? 1 : -1];

// One lane of a member, to read or write.
#define ENTRY_LANE(entries, member, lane) (((__global ushort*)&(entries)->member)[lane])
#define ENTRY_SLOT(entries, lane) (((__global const uint*)&(entries)->slot)[lane])

// Units per texel: a whole number, so that host, device and every kernel agree on it to the bit.
static float texel_units(uint texels) { return (float)(65536u / texels); }
static ushort quantised_texel(float coordinate, uint texels) {
    return (ushort)clamp(coordinate * texel_units(texels), 0.0f, 65535.0f);
}
static ushort quantised_height(float z, float z_origin, float z_scale) {
    return (ushort)clamp((z - z_origin) * z_scale, 0.0f, 65535.0f);
}
// Both for lanes, from coordinates and heights in units.
static LaneInt quantised(LaneFloat units) {
    const LaneFloat least = (LaneFloat)(0.0f), most = (LaneFloat)(65535.0f);
    units = LANES_MAX(units, least);
    return LANES_TO_INT(LANES_MIN(units, most));
}
// A camera's heights, 1 / t of any size: exponent and 8 bits behind the point, in the order of the floats; 0 below 0.
static LaneInt quantised_nearness(LaneFloat z) { return max(LANES_AS_INT(z), (LaneInt)(0)) >> 15; }

// The least and greatest coordinates of a point or of a block of points.
typedef struct QuantisedBlock {
    ushort x0, y0, x1, y1;
    ushort z;  // the least
} QuantisedBlock;

// The block around some lanes, in quantised units.
#if GN_LANES == 1
static QuantisedBlock block_of_lanes(LaneInt x0, LaneInt y0, LaneInt x1, LaneInt y1, LaneInt lowest, LaneInt lanes) {
    return lanes ? (QuantisedBlock){(ushort)x0, (ushort)y0, (ushort)x1, (ushort)y1, (ushort)lowest}
                 : (QuantisedBlock){65535, 65535, 0, 0, 65535};
}

typedef uint4 EntryWords;  // one load

static bool entry_is_below(EntryWords entry, QuantisedBlock block) { return (entry.z & 0xFFFFu) < block.z; }
static bool entry_meets(EntryWords entry, QuantisedBlock block) {
    return (entry.x & 0xFFFFu) <= block.x1 && entry.x >> 16 <= block.y1 && block.x0 <= (entry.y & 0xFFFFu) &&
           block.y0 <= entry.y >> 16 && !entry_is_below(entry, block);
}

static uint slot_of_words(EntryWords entry) { return entry.w; }

// Entries that a work-item loads at once, to wait once for all of them.
#define ENTRIES_AT_ONCE 4u

// Tests ENTRIES_AT_ONCE entries of a list from entry *next on. Bit k: entry k may meet the block, and is not the entry
// of record `own` (GN_NO_ID: no record). Moves *next to the next untested entry.
static uint next_that_meet(__global const BinEntries* entries, uint2 range, uint* next, QuantisedBlock block,
                           uint own) {
    uint first = *next, last = first + ENTRIES_AT_ONCE - 1u, meeting = 0;
    EntryWords some[ENTRIES_AT_ONCE];
    for (uint k = 0; k < ENTRIES_AT_ONCE; ++k)
        some[k] = *(__global const EntryWords*)&entries[min(first + k, range.y - 1u)];
    for (uint k = 0; k < ENTRIES_AT_ONCE; ++k)
        if (first + k < range.y && (own == GN_NO_ID || slot_of_words(some[k]) != own) && entry_meets(some[k], block))
            meeting |= 1u << k;
    bool run_is_done = entry_is_below(some[ENTRIES_AT_ONCE - 1u], block);
    *next = last + (run_is_done ? LIST_RUN - (last - range.x) % LIST_RUN : 1u);
    return meeting;
}

// Bit i: entry i of a BinEntries may meet the block.
static uint entries_that_meet(__global const BinEntries* entries, QuantisedBlock block) {
    return entry_meets(*(__global const EntryWords*)entries, block) ? 1u : 0u;
}
#else
// Least values of eights: a transposition halves the work of each step; five separate reductions would not.
static ushort8 min_eight(int16 v, ushort16 others) {
    ushort16 values = convert_ushort16(v) | others;
    return min(values.lo, values.hi);
}
static ushort8 min_in_turn(ushort8 a, ushort8 b) {
    ushort8 low = (ushort8)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3);
    ushort8 high = (ushort8)(a.s4, b.s4, a.s5, b.s5, a.s6, b.s6, a.s7, b.s7);
    return min(low, high);
}

static QuantisedBlock block_of_lanes(LaneInt x0, LaneInt y0, LaneInt x1, LaneInt y1, LaneInt lowest, LaneInt lanes) {
    const LaneInt bits = (LaneInt)(65535);
    ushort16 others = convert_ushort16(~lanes & bits);
    ushort8 x = min_in_turn(min_eight(x0, others), min_eight(bits - x1, others));
    ushort8 y = min_in_turn(min_eight(y0, others), min_eight(bits - y1, others));
    ushort8 z = min_eight(lowest, others);
    z = min_in_turn(z, z);
    ushort8 all = min_in_turn(min_in_turn(x, y), min_in_turn(z, z));  // x0 z y0 z, 65535 - x1 and so on
    return (QuantisedBlock){all.s0, all.s2, (ushort)(65535 - all.s4), (ushort)(65535 - all.s6), all.s1};
}

static uint bits_of_shorts(short16 mask) {
#if defined(GN_X86_MASKS)
    return (uint)__builtin_ia32_cvtw2mask256(mask);
#elif defined(GN_X86_SIGNS)
    return (uint)__builtin_ia32_pmovmskb128(convert_char16(mask));
#else
    long2 some = as_long2(mask.lo | mask.hi);
    if ((some.x | some.y) == 0) return 0u;
    ushort16 bits =
        as_ushort16(mask) & (ushort16)(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768);
    ushort8 a = bits.lo | bits.hi;
    ushort4 b = a.lo | a.hi;
    return (uint)(b.x | b.y) | (uint)(b.z | b.w);
#endif
}

static uint entries_that_meet(__global const BinEntries* entries, QuantisedBlock block) {
    short16 meets = (entries->x0 <= block.x1) & (entries->y0 <= block.y1) & (entries->x1 >= block.x0) &
                    (entries->y1 >= block.y0) & (entries->z >= block.z) & (entries->x0 <= entries->x1);
    return bits_of_shorts(meets);
}

// The same for entries[i], 0 from `end` on. Prefetches the records: in large scenes a walk mostly waited for them.
// `bounds`: null if they are not read.
static uint prefetch_entries_that_meet(__global const BinEntries* entries, __global const TriangleRecord* records,
                                       __global const TriangleBounds* bounds, uint i, uint end, QuantisedBlock block) {
    if (i >= end) return 0u;
    uint meeting = entries_that_meet(&entries[i], block);
    for (uint ahead = meeting; ahead != 0u;) {
        uint slot = ENTRY_SLOT(&entries[i], take_lowest_bit(&ahead));
        GN_PREFETCH(&records[slot]);
        if (bounds) GN_PREFETCH(&bounds[slot]);
    }
    return meeting;
}
#endif

#endif
