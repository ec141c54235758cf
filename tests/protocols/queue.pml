// SPDX-License-Identifier: MIT
// The queue of undecided pairs and its overflow: queue_pair(), resolve_undecided(), queue_waiting_pairs() and
// finish_block() of the trace, decide_queue() of the exact trace, and the host's FrustumTracer::run_last_stages().
//
// ITEMS items trace one point each, in all orders of their steps. A point has two pairs; each of them is certain to block
// or undecided, and an undecided one blocks or not by the exact predicate. The queue has room for 2 pairs.
//= kernels/trace/filter.clh
//= kernels/trace/trace_points.clh
//= kernels/trace/exact_trace.cl
//= host/trace/trace.cpp
#define ITEMS 3
#define PAIRS 2
#define CAPACITY 2

#define DISMISSED 0 /* by the filter */
#define UNDECIDED_PASSES 1
#define UNDECIDED_BLOCKS 2
#define CERTAIN 3
#define NO_PAIR 255
#define KIND(of_point, i) ((of_point) >> 2 * (i) & 3)

#define SHADOW 0
#define LIT 1
#define OPEN 2

byte pairs[ITEMS]; // the two pairs of a point, 2 bits each
byte visibility[ITEMS];
byte queue[CAPACITY];
byte uncertain, decided_by_exact;
byte ended, taken;

// False if the queue is full.
inline queue_pair(which, has_room) {
    //= uint slot = atomic_inc(&pairs->counters->uncertain);
    d_step { slot = uncertain; uncertain++ };
    //= if (slot >= pairs->queue_capacity) return false;
    if
    :: slot >= CAPACITY -> has_room = false
    :: else ->
        //= pairs->queue[slot] = (uint2)(point, id);
        assert(queue[slot] == NO_PAIR);
        queue[slot] = which;
        has_room = true
    fi
}

proctype trace_point(byte point, of_point) {
    byte slot, waiting = NO_PAIR, i = 0;
    bool has_room, shadowed = false, postponed = false;
    do
    :: i < PAIRS && !shadowed && !postponed ->
        if
        :: KIND(of_point, i) == CERTAIN -> shadowed = true
        :: KIND(of_point, i) == UNDECIDED_PASSES || KIND(of_point, i) == UNDECIDED_BLOCKS ->
            if
            //= LANE_OF_INT(result->waiting, lane) = (int)id;
            :: waiting == NO_PAIR -> waiting = point * PAIRS + i
            :: else ->
                queue_pair(point * PAIRS + i, has_room);
                //= LANE_OF_INT(result->postponed, lane) = LANE_OF_INT(done, lane) = -1;
                postponed = !has_room
            fi
        :: else
        fi;
        i++
    :: else -> break
    od;
    if
    //= ~result->shadowed & ~result->postponed & LANE_COMPARE(result->waiting, !=, (LaneInt)((int)GN_NO_ID));
    :: !shadowed && !postponed && waiting != NO_PAIR ->
        queue_pair(waiting, has_room);
        //= LANE_OF_INT(result->postponed, lane) = -1;
        postponed = !has_room
    :: else
    fi;
    //= LaneFloat decided = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), result->shadowed);
    if
    :: shadowed -> visibility[point] = SHADOW
    //= decided = LANES_SELECT(decided, state, result->postponed & ~result->shadowed);
    :: !shadowed && postponed -> visibility[point] = OPEN
    :: !shadowed && !postponed -> visibility[point] = LIT
    fi;
    ended++
}

// An item of the exact trace takes any pair that nobody has taken.
//= kernels/trace/exact_trace.cl
proctype decide_pairs() {
    byte at, seen;
    do
    :: true ->
        d_step { at = taken; taken++ };
        if
        //= uint count = min(counters->uncertain, params.queue_capacity);
        :: at >= uncertain || at >= CAPACITY -> break
        :: else
        fi;
        assert(queue[at] != NO_PAIR);
        //= LANE_OF_INT(lanes, lane) = first + lane < count && GN_RELAXED_LOAD(&visibility_bits[pair.x]) != 0u ? -1 : 0;
        seen = visibility[queue[at] / PAIRS];
        if
        :: seen != SHADOW && KIND(pairs[queue[at] / PAIRS], queue[at] % PAIRS) == UNDECIDED_BLOCKS ->
            //= if (atomic_xchg(&visibility_bits[points[take_lane(&bits)]], 0u) != 0u) ++decided;
            d_step {
                decided_by_exact = decided_by_exact + (visibility[queue[at] / PAIRS] != SHADOW);
                visibility[queue[at] / PAIRS] = SHADOW
            }
        :: else
        fi
    od;
    ended++
}

#define BLOCKS(kind) ((kind) >= UNDECIDED_BLOCKS)
#define IN_SHADOW(of_point) (BLOCKS(KIND(of_point, 0)) || BLOCKS(KIND(of_point, 1)))

inline count_shadows(shadows) {
    shadows = (visibility[0] == SHADOW) + (visibility[1] == SHADOW) + (visibility[2] == SHADOW)
}

init {
    byte i, by_trace, by_both;
    // The points are alike, so falling kinds of pairs are enough.
    select(i : 0 .. 15);
    pairs[0] = i;
    select(i : 0 .. pairs[0]);
    pairs[1] = i;
    select(i : 0 .. pairs[1]);
    pairs[2] = i;
    atomic {
        for (i : 0 .. CAPACITY - 1) {
            queue[i] = NO_PAIR
        };
        for (i : 0 .. ITEMS - 1) {
            visibility[i] = OPEN;
            run trace_point(i, pairs[i])
        }
    };
    ended == ITEMS;
    count_shadows(by_trace);
    ended = 0;
    atomic { // two items for a queue of two
        run decide_pairs();
        run decide_pairs()
    };
    ended == 2;
    count_shadows(by_both);
    assert(decided_by_exact == by_both - by_trace); // a point is counted once
    //= if (counted.uncertain <= capacity()) return true;
    if
    :: uncertain > CAPACITY -> // run_queue_overflow() decides the points that are open
        for (i : 0 .. ITEMS - 1) {
            if
            :: visibility[i] == OPEN -> visibility[i] = (IN_SHADOW(pairs[i]) -> SHADOW : LIT)
            :: else
            fi
        }
    :: else
    fi;
    for (i : 0 .. ITEMS - 1) {
        assert(visibility[i] == (IN_SHADOW(pairs[i]) -> SHADOW : LIT))
    }
}
