// SPDX-License-Identifier: MIT
// Slots in a list that many work-items append to: one counter hands out all slots. A work-item of a CPU reserves
// APPEND_BLOCK slots at a time, since a shared counter is slow there; at its end it must mark its unused slots, [next,
// end).
#pragma once

#include "prelude.h"

#define APPEND_BLOCK_ON_CPU 64u
#ifdef GN_CPU
#define APPEND_BLOCK APPEND_BLOCK_ON_CPU
#else
#define APPEND_BLOCK 1u
#endif

// A counter that reaches this means "more than 2^32", and stays there.
#define APPEND_OVERFLOW 0xC0000000u

#ifndef __cplusplus

typedef struct Reservation {
    uint next, end;
} Reservation;

static Reservation no_reservation(void) { return (Reservation){0u, 0u}; }

// The first of `count` neighbouring slots. The host sees from the counter whether all fitted, so it must never wrap
// around: the sum of all additions before the items see an overflow must be less than 2^30.
static uint reserve_slots(uint count, __global uint* counter) {
    uint first = atomic_add(counter, count);
    if (first >= APPEND_OVERFLOW) atomic_sub(counter, count);
    return first;
}

static uint reservation(Reservation* mine, __global uint* counter) {
    if (mine->next == mine->end) {
        mine->next = reserve_slots(APPEND_BLOCK, counter);
        mine->end = mine->next + APPEND_BLOCK;
    }
    return mine->next++;
}

#ifndef GN_CPU
// A GPU's work-group reserves by one atomic for all of its items; all items must call this. On one address a GPU does
// some 1.3 atomics a nanosecond. The first of the local words must be 0, and is 0 again afterwards.
#define GROUP_APPEND_WORDS 2
#define LARGEST_GROUP_APPEND 256u  // for each item of the group

// The first of `wanted` neighbouring slots, up to LARGEST_GROUP_APPEND for each item.
static uint append_in_group(uint wanted, __local uint* words, __global uint* counter) {
    uint before = wanted != 0u ? atomic_add(&words[0], wanted) : 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) {
        words[1] = words[0] == 0u ? 0u : reserve_slots(words[0], counter);
        words[0] = 0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    return words[1] + before;
}

// The first of `count` neighbouring slots, the same value for all items; up to LARGEST_GROUP_APPEND per item.
static uint reserve_for_group(uint count, __local uint* words, __global uint* counter) {
    barrier(CLK_LOCAL_MEM_FENCE);  // all items have read the last reservation
    if (get_local_id(0) == 0) words[1] = reserve_slots(count, counter);
    barrier(CLK_LOCAL_MEM_FENCE);
    return words[1];
}
#endif

#endif
