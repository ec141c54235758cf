// SPDX-License-Identifier: MIT
// Places in a list that many work-items append to, given out by one counter. A work-item of a CPU claims APPEND_BLOCK
// of them at a time, since there a shared counter is slow; what it does not use in the end, [next, end), it has to
// mark.
#ifndef GN_CLAIM_H
#define GN_CLAIM_H

#include "prelude.h"

#define APPEND_BLOCK_ON_CPU 64u
#ifdef GN_CPU
#define APPEND_BLOCK APPEND_BLOCK_ON_CPU
#else
#define APPEND_BLOCK 1u
#endif

// From here on a counter stands for "more than 2^32", and stays there.
#define APPEND_OVERFLOW 0xC0000000u

#ifndef __cplusplus

typedef struct Reservation {
    uint next, end;
} Reservation;

static Reservation no_reservation(void) {
    Reservation reservation;
    reservation.next = reservation.end = 0;
    return reservation;
}

// The first of `count` places in a row; the host sees from the counter whether all fitted, so it must never wrap
// around: what everybody adds before they see an overflow must be less than 2^30.
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
// A GPU's work-group claims by one atomic for all of its items, which must all come here: on one address a GPU does
// some 1.3 a nanosecond. Of the local words the first is 0 before, and again afterwards.
#define GROUP_APPEND_WORDS 2
#define LARGEST_GROUP_APPEND 256u  // for each item of the group

// The first of as many places in a row as an item wants, up to LARGEST_GROUP_APPEND.
static uint claim_in_group(uint wanted, __local uint* words, __global uint* counter) {
    uint before = wanted != 0u ? atomic_add(&words[0], wanted) : 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) {
        words[1] = words[0] == 0u ? 0u : reserve_slots(words[0], counter);
        words[0] = 0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    return words[1] + before;
}

// `count` places in a row, the same to all items; up to LARGEST_GROUP_APPEND for each of them.
static uint reserve_for_group(uint count, __local uint* words, __global uint* counter) {
    barrier(CLK_LOCAL_MEM_FENCE);  // everybody has read the last claim
    if (get_local_id(0) == 0) words[1] = reserve_slots(count, counter);
    barrier(CLK_LOCAL_MEM_FENCE);
    return words[1];
}
#endif

#endif
#endif
