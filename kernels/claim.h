// SPDX-License-Identifier: MIT
// Places in a list that many work-items append to, given out by one counter. A work-item of a CPU claims CLAIM_BLOCK of
// them at a time, since there a shared counter is slow; what it does not use in the end, [next, end), it has to mark.
#ifndef GN_CLAIM_H
#define GN_CLAIM_H

#include "prelude.h"

#define CLAIM_BLOCK_OF_CPU 64u
#ifdef GN_CPU
#define CLAIM_BLOCK CLAIM_BLOCK_OF_CPU
#else
#define CLAIM_BLOCK 1u
#endif

// From here on a counter stands for "more than 2^32", and stays there.
#define CLAIM_OVERFLOW 0xC0000000u

#ifndef __cplusplus

typedef struct Claim {
    uint next, end;
} Claim;

static Claim no_claim(void) {
    Claim claim;
    claim.next = claim.end = 0;
    return claim;
}

// The first of `count` places; the host sees from the counter whether all of them fitted, so it must never wrap around.
static uint claim_places(uint count, __global uint* counter) {
    uint first = atomic_add(counter, count);
    if (first >= CLAIM_OVERFLOW) atomic_sub(counter, count);
    return first;
}

static uint claim(Claim* mine, __global uint* counter) {
    if (mine->next == mine->end) {
        mine->next = claim_places(CLAIM_BLOCK, counter);
        mine->end = mine->next + CLAIM_BLOCK;
    }
    return mine->next++;
}

#endif
#endif
