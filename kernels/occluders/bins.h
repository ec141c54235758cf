// SPDX-License-Identifier: MIT
// Contract of the bins' list of pairs, which the lists are made from and the traversal by triangles walks.
#ifndef GN_BINS_H
#define GN_BINS_H

#include "prelude.h"

// A (triangle, bin) pair, and its place in the bin's list. bin: GN_NO_ID where the list of pairs has a gap.
GN_STRUCT_BEGIN(Pair)
    uint bin, slot, place;
GN_STRUCT_END(Pair, 12)

// Bins that a GPU's work-group asks about before it claims places for the pairs that it found, for each of its items:
// all items wait for a claim.
#define PAIRS_AT_ONCE 4u

#endif
