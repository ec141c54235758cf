// SPDX-License-Identifier: MIT
// The shares of a CPU's launch: items take runs of neighbours from a counter, and the last one to end leaves the counters
// as the next launch needs them (take_run() and end_shares() of the prelude). Two launches, of up to MOST elements, then of
// up to 2, by ITEMS items.
//= kernels/prelude.h
#ifndef ITEMS
#define ITEMS 3
#endif
#ifndef MOST
#define MOST 14
#endif
#define LENGTH_OF_RUNS(left) ((left) / (4 * ITEMS) + 1) //= return left / (4 * (size_t)items) + 1; }

byte shares_taken, shares_ended;
byte done[MOST];
byte count, left_running, lasts;

inline check_all_done() {
    for (i : 0 .. MOST - 1) {
        assert(done[i] == (i < count))
    }
}

proctype run_shares() {
    byte run_number, runs_before, left_first, length, first, end, i;
    length = LENGTH_OF_RUNS(count);
    do
    :: true ->
        //= uint run = atomic_inc(of->taken);
        atomic { run_number = shares_taken; shares_taken++ };
        do
        //= while (run - of->runs_before >= of->items) {
        :: run_number - runs_before >= ITEMS ->
            atomic {
                //= of->runs_before += of->items;
                runs_before = runs_before + ITEMS;
                //= of->left_first = min(of->left_first + of->items * of->length, of->count);
                left_first = left_first + ITEMS * length;
                left_first = (left_first < count -> left_first : count);
                //= of->length = length_of_runs(of->count - of->left_first, of->items);
                length = LENGTH_OF_RUNS(count - left_first)
            }
        :: else -> break
        od;
        //= of->first = of->left_first + (run - of->runs_before) * of->length;
        first = left_first + (run_number - runs_before) * length;
        //= of->end = min(of->first + of->length, of->count);
        end = (first + length < count -> first + length : count);
        if
        //= return of->first < of->count;
        :: first >= count -> break
        :: else
        fi;
        do
        :: first < end -> done[first]++; first++
        :: else -> break
        od
    od;
    //= if (atomic_inc(&shares[SHARES_ENDED]) != (uint)get_global_size(0) - 1u) return false;
    atomic { i = shares_ended; shares_ended++ };
    if
    :: i == ITEMS - 1 ->
        //= atomic_xchg(&shares[SHARES_TAKEN], 0u);
        shares_taken = 0;
        //= atomic_xchg(&shares[SHARES_ENDED], 0u);
        shares_ended = 0;
        atomic { check_all_done() };
        lasts++
    :: else
    fi;
    left_running--
}

inline launch(elements) {
    count = elements;
    lasts = 0;
    left_running = ITEMS;
    atomic {
        for (i : 0 .. MOST - 1) {
            done[i] = 0
        };
        for (i : 1 .. ITEMS) {
            run run_shares()
        }
    };
    left_running == 0;
    assert(lasts == 1 && shares_taken == 0 && shares_ended == 0);
    atomic { check_all_done() }
}

init {
    byte i, elements;
    select(elements : 0 .. MOST);
    launch(elements);
    select(elements : 0 .. 2);
    launch(elements)
}
