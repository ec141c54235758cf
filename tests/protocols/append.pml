// SPDX-License-Identifier: MIT
// A list that items append to, which is grown and filled again if it was too short: kernels/lists/append.h, the host's
// GrowingList (host/occluders/triangle_setup.cpp) and the loop of FrustumTracer::run_frame().
//
// ITEMS items append 0 to MOST entries each, in all orders of their steps; the list begins with room for 2. A counter has
// 4 bits instead of 32, and APPEND_OVERFLOW is 8. BLOCK is 1 (GPU) or 2 (CPU). Lines `//=` are the kernel's own.
//= kernels/lists/append.h
//= host/occluders/triangle_setup.cpp
#ifndef BLOCK
#define BLOCK 2
#endif
#define ITEMS 3
#ifndef MOST
#define MOST 5
#endif
#define APPEND_OVERFLOW 8
#define LARGEST APPEND_OVERFLOW /* the longest list that the host makes */

#define NOTHING 0
#define UNUSED 255
#define ENTRY(item, i) ((item) * MOST + (i) + 1)

unsigned counter : 4;
byte wanted[ITEMS]; // entries that an item appends
byte list[LARGEST], capacity = 2;
byte ended, runs;

inline write(slot, what) {
    if
    :: slot < capacity -> assert(list[slot] == NOTHING); list[slot] = what // no slot is written twice
    :: else
    fi
}

inline reserve_slots() {
    //= uint first = atomic_add(counter, count);
    d_step { first = counter; counter = counter + BLOCK };
    //= if (first >= APPEND_OVERFLOW) atomic_sub(counter, count);
    if
    :: first >= APPEND_OVERFLOW -> counter = counter - BLOCK
    :: else
    fi
}

proctype append_entries(byte me) {
    byte next = 0, end = 0, first = 0, i = 0;
    do
    :: i < wanted[me] ->
        //= if (mine->next == mine->end) {
        if
        :: next == end ->
            //= mine->next = reserve_slots(APPEND_BLOCK, counter);
            reserve_slots();
            next = first;
            //= mine->end = mine->next + APPEND_BLOCK;
            end = next + BLOCK
        :: else
        fi;
        //= return mine->next++;
        write(next, ENTRY(me, i));
        next++;
        i++
    :: else -> break
    od;
    do // the rest of the item's block is marked
    :: next < end -> write(next, UNUSED); next++
    :: else -> break
    od;
    atomic { next = 0; end = 0; first = 0; i = 0; ended++ }
}

inline run_items() {
    counter = 0;
    ended = 0;
    run append_entries(0);
    run append_entries(1);
    run append_entries(2);
    ended == ITEMS
}

inline clear_list() {
    i = 0;
    do
    :: i < LARGEST -> list[i] = NOTHING; i++
    :: else -> break
    od
}

// Each entry is in one slot; the counter's other slots are marked as unused.
inline check_list() {
    byte found;
    i = 0;
    do
    :: i < LARGEST ->
        assert((i < counter) == (list[i] != NOTHING));
        if
        :: list[i] != NOTHING && list[i] != UNUSED -> found++
        :: else
        fi;
        i++
    :: else -> break
    od;
    assert(found == wanted[0] + wanted[1] + wanted[2]) // with write()'s assertion: each once
}

inline add_blocks_of(who) {
    slots = slots + (wanted[who] + BLOCK - 1) / BLOCK * BLOCK
}

init {
    byte i, slots;
    // Any numbers of entries; the items are alike, so falling ones are enough.
    select(i : 0 .. MOST);
    wanted[0] = i;
    select(i : 0 .. wanted[0]);
    wanted[1] = i;
    select(i : 0 .. wanted[1]);
    wanted[2] = i;
    add_blocks_of(0);
    add_blocks_of(1);
    add_blocks_of(2);
    do
    :: true ->
        atomic { clear_list() };
        run_items();
        runs++;
        if
        :: counter <= capacity -> break //= if (wanted <= capacity_) return true;
        :: counter > capacity && counter >= APPEND_OVERFLOW -> //= if (wanted >= APPEND_OVERFLOW)
            assert(slots >= APPEND_OVERFLOW); // the host refuses what is too long, and nothing else
            goto refused
        :: counter > capacity && counter < APPEND_OVERFLOW -> capacity = counter
        fi
    od;
    atomic { check_list() };
    assert(slots < APPEND_OVERFLOW || slots <= capacity);
    assert(runs <= 2); // the second run has room for all
refused:
    skip
}
