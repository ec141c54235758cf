// SPDX-License-Identifier: MIT
// Contract of the bins' list of pairs, which the lists are made from and the traversal by triangles walks.
#ifndef GN_BINS_H
#define GN_BINS_H

#include "prelude.h"

// A (triangle, bin) pair, and its place in the bin's list. bin: GN_NO_ID where the list of pairs has a gap.
GN_STRUCT_BEGIN(Pair)
    uint bin, slot, place;
GN_STRUCT_END(Pair, 12)

#endif
