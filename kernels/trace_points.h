// SPDX-License-Identifier: MIT
// Frustum trace: every open point against the map, then against the triangles of its bin's list, by the float filter of
// the records. Points are not sorted: a work-item takes a block of GN_LANES neighbours, which mostly share a bin; where
// they do not, each of the bins is walked for its lanes.
//
// The filter only says what is certain. A pair it cannot decide (the point near an edge's ray or near the plane, by the
// proven margins) goes to the queue of the exact stage, unless the triangle is the point's own receiver. Where the
// queue is full the point stays open, and a second look decides such pairs in place: so the memory of open pairs is
// bounded. One writer per point: no atomics on visibility here.
//
// On a GPU a work-group takes its points in rounds: first all of a round are looked at by the map, neighbours by
// neighbours, and those that it leaves open are queued; then the items walk the lists of the queued points, and who is
// done takes the next. So a warp's items all walk, though most of its points are settled at once, and none waits for
// the longest list of its neighbours (counted: a point looks at 1.2 entries, the longest list of a warp's points at 4).
//
// Under a prepared light (TRACE_FACES) all points are looked at, and facing is decided on the way: reading points and
// writing visibility once is most of what such a run costs. On a CPU the map may settle blocks of points at once, and
// receivers' answers be looked up for the others (TRACE_BY_ANSWERS).
//
// After facing on a CPU (TRACE_BLOCKS), blocks that the map hides are settled by their bounds, without their points.
//
// Of a prepared light's lists, triangles below the map are missing that only a doubtful point below the map could need.
// Such a point is a stray, unless a listed triangle blocks it.
#ifndef GN_TRACE_POINTS_H
#define GN_TRACE_POINTS_H

#include "bin_lists.h"
#include "coarse_test.h"
#include "trace.h"
#define TRACE_BY_BLOCKS (TRACE_BLOCKS && GN_LANES > 1)
// A GPU asks for the next point's state while it looks at one: most are not open.
#define TRACE_LOOKS_AHEAD (GN_LANES == 1 && !TRACE_FACES)
#if TRACE_FACES || TRACE_BY_ANSWERS
#include "prepared_light.h"
#include "receivers.h"
#endif
#if TRACE_FACES
#include "prepared_facing.h"
#endif
#if TRACE_BY_ANSWERS
#include "receiver_answers.h"
#endif

typedef struct TraceLists {
    __global const uint2* ranges;
    __global const BinEntries* entries;
    __global const TriangleRecord* records;
    __global const TriangleBounds* bounds;  // of the records, for their ids
} TraceLists;

// What a work-group counts. The tests in two words: their low 16 bits and the rest, so that neither sum overflows.
enum {
    COUNT_MAP,
    COUNT_TRACE,
    COUNT_EXACT,
    COUNT_LISTED,
    COUNT_STRAYS,
    COUNT_TESTS_LOW,
    COUNT_TESTS_HIGH,
    COUNT_ABSENT,
    COUNT_AWAY,
    TRACE_COUNTS
};

static void add_counts(const uint* found, __global FrameCounters* counters) {
    __global uint* totals[] = {&counters->decided_by_map, &counters->decided_by_trace, &counters->decided_by_exact,
                               &counters->listed,         &counters->strays,           &counters->absent,
                               &counters->facing_away};
    const uint counts[] = {COUNT_MAP, COUNT_TRACE, COUNT_EXACT, COUNT_LISTED, COUNT_STRAYS, COUNT_ABSENT, COUNT_AWAY};
    for (uint i = 0; i < sizeof(counts) / sizeof(counts[0]); ++i)
        if (found[counts[i]] != 0u) atomic_add(totals[i], found[counts[i]]);
    count_tests((found[COUNT_TESTS_LOW] + ((ulong)found[COUNT_TESTS_HIGH] << 16)) * GN_LANES, counters);
}

#if TRACE_FACES
#define TRACE_MORE_ARGUMENTS                                                                      \
    , uint triangle_count, __global const PreparedDomain *domains, __global const float4 *planes, \
        __global const uint *largest_coordinate, __global const uint *lit, __global const uint *slots

static LaneFloat state_of_points(const PreparedFacing* facing) {
    LaneFloat state = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), facing->away);
    state = LANES_SELECT(state, (LaneFloat)(VISIBILITY_OPEN), facing->open);
    return LANES_SELECT(state, (LaneFloat)(VISIBILITY_DOUBTFUL), facing->open & facing->doubtful);
}
#elif TRACE_BY_ANSWERS
#define TRACE_MORE_ARGUMENTS , uint triangle_count, __global const PreparedDomain *domains, TriangleAnswers answers
#elif TRACE_BLOCKS
#define TRACE_MORE_ARGUMENTS , uint has_blocks, __global const BlockBounds *block_bounds
#else
#define TRACE_MORE_ARGUMENTS
#endif

// The square and the least height that some lanes of a block span.
static QuantisedBlock quantised_block(__constant const Projection* projection, PointBlock places, LaneInt lanes) {
    const float most = 65535.0f;
    LaneInt x = LANES_TO_INT(clamp(places.x * texel_units(projection->width), 0.0f, most));
    LaneInt y = LANES_TO_INT(clamp(places.y * texel_units(projection->height), 0.0f, most));
    LaneInt z = LANES_TO_INT(clamp((places.z - projection->z_origin) * projection->z_scale, 0.0f, most));
    return block_of_lanes(x, y, x, y, z, lanes);
}

// What becomes of a block: points in shadow, and points that must be looked at again.
typedef struct BlockAnswer {
    LaneInt shadowed, postponed;
    LaneInt by_map, by_exact;  // of the shadowed ones
    LaneInt listed;            // the map did not decide them
    LaneInt below;             // of these, those below the map
    LaneInt waiting;           // a triangle that the filter left open, GN_NO_ID: none
} BlockAnswer;

static BlockAnswer no_answer(void) {
    BlockAnswer answer;
    answer.shadowed = answer.postponed = answer.by_map = answer.by_exact = answer.listed = answer.below = (LaneInt)(0);
    answer.waiting = (LaneInt)((int)GN_NO_ID);
    return answer;
}

// The points of the block that is looked at.
typedef struct BlockPoints {
    PointBlock at;
    PointsLayout layout;
    size_t block;
#if GN_LANES > 1
    LaneInt receivers;
#endif
} BlockPoints;

static BlockPoints load_points(__global const float* positions, __global const uint* receivers, PointsLayout layout,
                               size_t block) {
    BlockPoints points;
    points.at = load_block(positions, layout, block);
    points.layout = layout;
    points.block = block;
#if GN_LANES > 1
    if (layout.has_receivers) points.receivers = load_lane_ids(receivers, layout, block);
#endif
    return points;
}

// On a GPU only where they are asked for: most points never ask.
static LaneInt receivers_of(const ExactPairs* pairs, const BlockPoints* points) {
#if GN_LANES > 1
    return points->receivers;
#else
    return load_lane_ids(pairs->receivers, points->layout, points->block);
#endif
}

// What the filter left open, of points that the triangle may block. Returns those that need no more triangles.
static LaneInt settle_open(const ExactPairs* pairs, LaneInt open, const BlockPoints* points, uint id,
                           BlockAnswer* answer) {
    LaneInt settled = (LaneInt)(0);
    for (uint bits = lane_bits(open); bits != 0u;) {
        int lane = take_lane(&bits);
        if (TRACE_IN_PLACE) {
            if (!blocks_exactly(pairs, lane_point(points->at, lane), id)) continue;
            LANE_OF_INT(answer->shadowed, lane) = LANE_OF_INT(answer->by_exact, lane) = LANE_OF_INT(settled, lane) = -1;
        } else if (LANE_OF_INT(answer->waiting, lane) == (int)GN_NO_ID) {
            LANE_OF_INT(answer->waiting, lane) = (int)id;
        } else if (!hand_over(pairs, (uint)point_of_lane(points->layout, points->block, lane), id)) {
            LANE_OF_INT(answer->postponed, lane) = LANE_OF_INT(settled, lane) = -1;
        }
    }
    return settled;
}

// Looks at the lanes that the filter did not dismiss; returns those that need no more triangles.
static LaneInt settle(const ExactPairs* pairs, FilterAnswer found, const BlockPoints* points, uint id,
                      BlockAnswer* answer) {
    LaneInt others = (LaneInt)(-1);
    if (pairs->has_receivers) others = LANE_COMPARE(receivers_of(pairs, points), !=, (LaneInt)((int)id));
    LaneInt settled = found.certain & others, open = found.possible & others & ~settled;
    answer->shadowed |= settled;
    if (LANES_ANY(open)) settled |= settle_open(pairs, open, points, id, answer);
    return settled;
}

// Most points with an open pair have but one. It waits until the block's lists are walked: then most such points turn
// out to be in shadow anyway, and the walk's loop does not have to fork.
static void hand_over_waiting(const ExactPairs* pairs, const BlockPoints* points, BlockAnswer* answer) {
    LaneInt lanes =
        ~answer->shadowed & ~answer->postponed & LANE_COMPARE(answer->waiting, !=, (LaneInt)((int)GN_NO_ID));
    for (uint bits = lane_bits(lanes); bits != 0u;) {
        int lane = take_lane(&bits);
        if (!hand_over(pairs, (uint)point_of_lane(points->layout, points->block, lane),
                       (uint)LANE_OF_INT(answer->waiting, lane)))
            LANE_OF_INT(answer->postponed, lane) = -1;
    }
}

#if GN_LANES != 1
// The receiver that these points share, which blocks none of them; GN_NO_ID if they have several.
static uint one_receiver(const ExactPairs* pairs, const BlockPoints* points, LaneInt lanes) {
    if (!pairs->has_receivers) return GN_NO_ID;
    int first = LANE_OF_INT(points->receivers, first_lane(lanes));
    bool others = LANES_ANY(lanes & LANE_COMPARE(points->receivers, !=, (LaneInt)(first)));
    return others ? GN_NO_ID : (uint)first;
}

// A bin's list for some lanes of a block; returns the number of records looked at.
static uint walk(const ExactPairs* pairs, TraceLists lists, __constant const Projection* projection, uint2 range,
                 LaneInt lit, const BlockPoints* points, PointBlock places, BlockAnswer* answer) {
    QuantisedBlock block = quantised_block(projection, places, lit);
    uint looks = 0;
    uint next = entries_to_look_at(lists.entries, lists.records, lists.bounds, range.x, range.y, block);
    uint own = one_receiver(pairs, points, lit);
    for (uint i = range.x; i < range.y; ++i) {
        uint meeting = next;
        next = entries_to_look_at(lists.entries, lists.records, lists.bounds, i + 1u, range.y, block);
        while (meeting != 0u) {
            uint slot = ENTRY_SLOT(&lists.entries[i], take_lowest_bit(&meeting));
            uint id = lists.bounds[slot].id;
            if (id == own) continue;
            ++looks;
            FilterAnswer found = filter(&lists.records[slot], places, lit);
            if (!LANES_ANY(found.possible)) continue;
            lit &= ~settle(pairs, found, points, id, answer);
            if (!LANES_ANY(lit)) return looks;
        }
    }
    return looks;
}
#endif

// The frames that points are looked at in, and the maps.
typedef struct TraceFrames {
    __constant const Projection* projections;
    __global const uint* map;
    uint first, count;
    uint has_map;
    uint bin_count, texel_count;
} TraceFrames;

#if GN_LANES == 1
// What is known of a point's place in its frame. Asked for as early as can be, also where it is not needed in the end:
// so that a GPU waits once for all that it reads of the point.
typedef struct PointLookUp {
    PointBlock place;
    uint2 range;  // of its bin's list
    int cover;    // of its texel, in order; none is below INT_MIN
} PointLookUp;

static PointLookUp look_up(const TraceFrames* frames, TraceLists lists, int frame, PointBlock point) {
    PointLookUp found;
    uint nearest_frame = (uint)clamp(frame, 0, (int)frames->count - 1);
    __constant const Projection* projection = &frames->projections[nearest_frame];
    found.place = project_points(projection, point);
    found.range = lists.ranges[nearest_frame * frames->bin_count + (uint)bins_of(projection, found.place)];
    found.cover = INT_MIN;
    if (frames->has_map && map_is_seen(projection))
        found.cover = covers_of(projection, found.place, frames->map + (size_t)nearest_frame * frames->texel_count);
    return found;
}

// What the map says of a point that is `left`; true if it has a list to be walked.
static bool ask_map(const PointLookUp* found, LaneInt left, LaneFloat state, BlockAnswer* answer) {
    LaneInt below = left & LANE_COMPARE(lanes_in_order(found->place.z), <, found->cover);
    answer->shadowed = answer->by_map = below & ~doubtful_lanes(state);
    answer->below = below & doubtful_lanes(state);
    answer->listed = left & ~answer->by_map;
    return answer->listed && found->range.x != found->range.y;
}
#else
// `asks_map`: false if there is none, or it hides none of these points.
static uint trace_block(const ExactPairs* pairs, const TraceFrames* frames, TraceLists lists, bool asks_map,
                        LaneInt lane_frames, LaneInt left, LaneFloat state, const BlockPoints* points,
                        BlockAnswer* answer) {
    uint tests = 0;
    while (LANES_ANY(left)) {
        int frame = LANE_OF_INT(lane_frames, first_lane(left));
        LaneInt same_frame = left & LANE_COMPARE(lane_frames, ==, (LaneInt)(frame));
        left &= ~same_frame;
        __constant const Projection* projection = &frames->projections[frame];
        PointBlock places = project_points(projection, points->at);
        if (asks_map) {
            __global const uint* map = frames->map + (size_t)frame * frames->texel_count;
            LaneInt below = lanes_below_map(projection, places, state, same_frame, map);
            answer->shadowed |= below;
            answer->by_map |= below;
            same_frame &= ~below;
            LaneInt doubtful = same_frame & doubtful_lanes(state);
            if (LANES_ANY(doubtful))
                answer->below |= lanes_below_map(projection, places, (LaneFloat)(VISIBILITY_OPEN), doubtful, map);
        }
        answer->listed |= same_frame;
        LaneInt bins = bins_of(projection, places);
        while (LANES_ANY(same_frame)) {
            int bin = LANE_OF_INT(bins, first_lane(same_frame));
            LaneInt same_bin = same_frame & LANE_COMPARE(bins, ==, (LaneInt)(bin));
            same_frame &= ~same_bin;
            tests += walk(pairs, lists, projection, lists.ranges[(uint)frame * frames->bin_count + (uint)bin], same_bin,
                          points, places, answer);
        }
    }
    return tests;
}
#endif

// What a work-item counts.
typedef struct TraceCounts {
    LaneInt minus_by_map, minus_by_trace, minus_by_exact, minus_listed, minus_strays;
#if TRACE_FACES || TRACE_BY_ANSWERS
    LaneInt minus_absent, minus_away;
    uint facing_exact;
#endif
    ulong tests;
} TraceCounts;

static TraceCounts no_counts(void) {
    TraceCounts counts;
    counts.minus_by_map = counts.minus_by_trace = counts.minus_by_exact = (LaneInt)(0);
    counts.minus_listed = counts.minus_strays = (LaneInt)(0);
#if TRACE_FACES || TRACE_BY_ANSWERS
    counts.minus_absent = counts.minus_away = (LaneInt)(0);
    counts.facing_exact = 0;
#endif
    counts.tests = 0;
    return counts;
}

// Sets found[], of TRACE_COUNTS.
static void read_counts(const TraceCounts* counts, uint* found) {
    found[COUNT_MAP] = count_lanes(counts->minus_by_map);
    found[COUNT_TRACE] = count_lanes(counts->minus_by_trace);
    found[COUNT_EXACT] = count_lanes(counts->minus_by_exact);
    found[COUNT_LISTED] = TRACE_IN_PLACE ? 0u : count_lanes(counts->minus_listed);
    found[COUNT_STRAYS] = count_lanes(counts->minus_strays);
    found[COUNT_TESTS_LOW] = (uint)counts->tests & 0xFFFFu;
    found[COUNT_TESTS_HIGH] = (uint)(counts->tests >> 16);
#if TRACE_FACES || TRACE_BY_ANSWERS
    found[COUNT_ABSENT] = count_lanes(counts->minus_absent);
    found[COUNT_AWAY] = count_lanes(counts->minus_away);
#else
    found[COUNT_ABSENT] = found[COUNT_AWAY] = 0u;
#endif
}

// All is known of the points `left` of a block.
static void finish_block(const ExactPairs* pairs, const BlockPoints* points, LaneInt left, LaneFloat state,
                         BlockAnswer* answer, __global float* visibility, TraceCounts* counts) {
    counts->minus_by_map += answer->by_map;
    counts->minus_listed += answer->listed;
    counts->minus_by_trace += answer->shadowed & ~answer->by_map & ~answer->by_exact;
    hand_over_waiting(pairs, points, answer);
    counts->minus_by_exact += answer->by_exact;
    counts->minus_strays += answer->below & ~answer->shadowed;
    LaneFloat result = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), answer->shadowed);
    result = LANES_SELECT(result, state, answer->postponed & ~answer->shadowed);
    store_lanes(LANES_SELECT(state, result, left), visibility, points->layout, points->block);
}

// What a work-item reads and writes of the points.
typedef struct TracePoints {
    PointsLayout layout;
    __global const float* positions;
    __global const uint* receivers;
    __global float* visibility;
#if TRACE_BLOCKS
    __global const BlockBounds* blocks;  // null: there are none
#endif
#if TRACE_BY_ANSWERS
    __global const PreparedDomain* domain;
    TriangleAnswers answers;
    uint triangle_count;
#endif
#if TRACE_FACES
    PreparedReceivers prepared;
#endif
} TracePoints;

#if GN_LANES == 1
// The slot of the record of a point's own receiver, which cannot block it; GN_NO_ID where that is not known. Most lit
// points meet no other entry, so that to pass it over saves them a look at a record.
static uint own_slot(const TracePoints* to, size_t point) {
#if TRACE_FACES
    if (to->layout.has_receivers)
        return slot_of_receiver(&to->prepared, load_lane_ids(to->receivers, to->layout, point));
#endif
    return GN_NO_ID;
}

// The points of a round whose lists are to be walked, from the round's first point on, and what is known of them.
typedef struct WalkQueue {
    __local uint* entries;
    __local uint *count, *taken;
    size_t first_point;
} WalkQueue;
#define QUEUED_DOUBTFUL 0x80000000u
#define QUEUED_BELOW 0x40000000u  // the map

// Every item of the group must come here.
static void start_round(const WalkQueue* queue) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0) *queue->count = *queue->taken = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
}

static void queue_point(const WalkQueue* queue, size_t point, LaneFloat state, const BlockAnswer* answer) {
    uint flags = (doubtful_lanes(state) ? QUEUED_DOUBTFUL : 0u) | (answer->below ? QUEUED_BELOW : 0u);
    queue->entries[atomic_inc(queue->count)] = (uint)(point - queue->first_point) | flags;
}

// A queued point, and how far its list has been walked.
typedef struct Walk {
    BlockPoints points;
    LaneFloat state;
    PointBlock place;
    QuantisedBlock quantised;
    uint2 range;
    uint own;                   // slot
    uint next, first, meeting;  // entries from `next` on, and of those from `first` on these
    BlockAnswer answer;
} Walk;

static Walk start_walk(const TraceFrames* frames, TraceLists lists, uint frame, BlockPoints points, uint own,
                       uint flags) {
    Walk walk;
    walk.points = points;
    walk.state = flags & QUEUED_DOUBTFUL ? VISIBILITY_DOUBTFUL : VISIBILITY_OPEN;
    __constant const Projection* projection = &frames->projections[frame];
    walk.place = project_points(projection, points.at);
    walk.quantised = quantised_block(projection, walk.place, -1);
    walk.range = lists.ranges[frame * frames->bin_count + (uint)bins_of(projection, walk.place)];
    walk.own = own;
    walk.next = walk.first = walk.range.x;
    walk.meeting = 0u;
    walk.answer = no_answer();
    walk.answer.listed = -1;
    walk.answer.below = flags & QUEUED_BELOW ? -1 : 0;
    return walk;
}

// Some entries, and one record if any of them meets the point: all items of a warp look at one together. True if that
// was the last.
static bool walk_on(const ExactPairs* pairs, TraceLists lists, Walk* walk, ulong* tests) {
    if (walk->meeting == 0u && walk->next < walk->range.y) {
        walk->first = walk->next;
        walk->meeting = next_that_meet(lists.entries, walk->range, &walk->next, walk->quantised,
                                       TRACE_FACES ? walk->own : GN_NO_ID);
    }
    if (walk->meeting != 0u) {
        uint slot = ENTRY_SLOT(&lists.entries[walk->first + take_lowest_bit(&walk->meeting)], 0);
        ++*tests;
        FilterAnswer found = filter(&lists.records[slot], walk->place, -1);
        if (found.possible && settle(pairs, found, &walk->points, lists.bounds[slot].id, &walk->answer)) return true;
    }
    return walk->meeting == 0u && walk->next >= walk->range.y;
}

// Is a point's own receiver all that its list names? Then it need not be queued.
static bool names_own_alone(const TracePoints* to, TraceLists lists, uint2 range, size_t point) {
    return TRACE_FACES && range.y - range.x == 1u && ENTRY_SLOT(&lists.entries[range.x], 0) == own_slot(to, point);
}

// Each item takes queued points, one after the other, as long as there are any. Every item of the group must come here,
// after all have queued theirs.
static void walk_queue(const WalkQueue* queue, LightFrame light_frame, const TraceFrames* frames, TraceLists lists,
                       const ExactPairs* pairs, const TracePoints* to, TraceCounts* counts) {
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);  // of the visibility, too: another item has read the point's
    uint queued = *queue->count;
    bool walks = false;
    Walk walk;
    while (true) {
        if (!walks) {
            uint at = atomic_inc(queue->taken);
            if (at >= queued) break;
            uint entry = queue->entries[at];
            BlockPoints points = load_points(to->positions, to->receivers, to->layout,
                                             queue->first_point + (entry & ~(QUEUED_DOUBTFUL | QUEUED_BELOW)));
            uint frame = (uint)(frames_of(light_frame, points.at) - (int)frames->first);
            walk = start_walk(frames, lists, frame, points, own_slot(to, points.block), entry);
            walks = true;
        }
        if (!walk_on(pairs, lists, &walk, &counts->tests)) continue;
        finish_block(pairs, &walk.points, -1, walk.state, &walk.answer, to->visibility, counts);
        walks = false;
    }
}
#define TRACE_MORE_OF_BLOCKS , const WalkQueue* walks
#else
#define TRACE_MORE_OF_BLOCKS
#endif

#if TRACE_BY_ANSWERS
// As below, of points that nobody has looked at, each coordinate in a row of its own. First whole blocks by the map:
// what it hides is dark whichever way it faces, so that its receivers need not be loaded. Up to there coordinates are
// in the order of the frame's axes: to choose them block by block takes longer than to load some of them once more.
GN_APART void trace_blocks(Share share, LightFrame light_frame, TraceFrames frames, TraceLists lists, ExactPairs pairs,
                           TracePoints to, TraceCounts* total) {
    PointsLayout layout = to.layout;
    BlockGrid grid = block_grid(light_frame, frames.projections, 0u);
    bool sees_map = frames.has_map && map_is_seen(frames.projections);
    PreparedDomain domain = domain_in_order(to.domain, light_frame);
    float4 light = light_of(light_frame);
    __global const float* coordinates = to.positions + layout.first;
    __global const float* along_x = coordinates + (size_t)layout.coordinate_stride * light_frame.axis_x;
    __global const float* along_y = coordinates + (size_t)layout.coordinate_stride * light_frame.axis_y;
    __global const float* along_z = coordinates + (size_t)layout.coordinate_stride * light_frame.axis_z;
    TraceCounts counts = *total;
    GN_FOR_EACH_OF(block, share) {
        BlockPlace place = place_of_block(layout, block);
        PointBlock at = {load_strided(along_x, 1u, place), load_strided(along_y, 1u, place),
                         load_strided(along_z, 1u, place)};
        LaneInt valid = valid_lanes(layout, block), left = valid & present_lanes(at);
        counts.minus_absent += valid & ~left;
        if (!LANES_ANY(left)) {
            store_at((LaneFloat)(1.0f), to.visibility, place);
            continue;
        }
        PointBlock values = {at.x - light_frame.shear_x * at.z, at.y - light_frame.shear_y * at.z, at.z};
        BlockBounds bounds = bounds_of_block(light_frame, values, left);
        bool is_inside =
            block_stays_open(&domain, light_frame, &bounds) || !LANES_ANY(left & ~lanes_stay_open(&domain, at, values));
        uint map_says = MAP_MAY_HIDE;
        if (sees_map && is_inside) map_says = map_hides(&grid, frames.projections, &bounds, frames.map);
        if (map_says == MAP_HIDES_ALL) {
            counts.minus_by_map += left;
            store_at(LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), left), to.visibility, place);
            continue;
        }
        LaneInt ids = LANES_AS_INT(load_strided((__global const float*)to.receivers, 1u, place));
        LaneInt away = look_up_away(to.answers, pairs.vertices, ids, left & lanes_below(ids, to.triangle_count),
                                    to.triangle_count, layout, light, &counts.facing_exact);
        counts.minus_away += away;
        left &= ~away;
        LaneFloat state = state_of_lanes(away, left);
        if (!LANES_ANY(left)) {
            store_at(state, to.visibility, place);
            continue;
        }
        BlockPoints points = load_points(to.positions, to.receivers, layout, block);
        if (!is_inside) {
            LaneInt strays, open = prepared_lanes(light_frame, to.domain, points.at, left, &strays);
            counts.minus_strays += strays;
            state = LANES_SELECT(state, (LaneFloat)(1.0f), left & ~open & ~strays);
            left = open;
        }
        BlockAnswer answer = no_answer();
        counts.tests += trace_block(&pairs, &frames, lists, sees_map && map_says != MAP_HIDES_NONE, (LaneInt)(0), left,
                                    state, &points, &answer);
        finish_block(&pairs, &points, left, state, &answer, to.visibility, &counts);
    }
    *total = counts;
}
#else
#if TRACE_FACES && GN_LANES == 1
// What is asked for of the next point while one is looked at.
typedef struct AskedPoint {
    PointBlock at;
    LaneInt receiver;
} AskedPoint;

static AskedPoint ask_point(const TracePoints* of, size_t point) {
    AskedPoint asked = {load_block(of->positions, of->layout, point), (LaneInt)((int)GN_NO_ID)};
    if (of->layout.has_receivers) asked.receiver = load_lane_ids(of->receivers, of->layout, point);
    return asked;
}
#endif

// Adds to `total`. All else by value: in memory of its own, which no store to the points can change. A GPU
// queues points whose lists are to be walked.
GN_APART void trace_blocks(Share share, LightFrame light_frame, TraceFrames frames, TraceLists lists, ExactPairs pairs,
                           TracePoints to, TraceCounts* total TRACE_MORE_OF_BLOCKS) {
    PointsLayout layout = to.layout;
#if TRACE_BY_BLOCKS
    BlockGrid grid = block_grid(light_frame, frames.projections, frames.first);
    bool sees_map = frames.has_map && map_is_seen(frames.projections);
#endif
    TraceCounts counts = *total;
#if TRACE_FACES && GN_LANES == 1
    AskedPoint asked_ahead = ask_point(&to, min(share.first, share.end - 1));
#endif
#if TRACE_LOOKS_AHEAD
    LaneFloat state_ahead = share.first < share.end ? to.visibility[share.first] : 0.0f;
#endif
    GN_FOR_EACH_OF(block, share) {
#if TRACE_FACES
#if GN_LANES == 1
        AskedPoint asked = asked_ahead;
        asked_ahead = ask_point(&to, min(block + share.step, share.end - 1));
        BlockPoints points = {asked.at, layout, block};
        LaneInt receivers = asked.receiver;
#else
        BlockPoints points = load_points(to.positions, to.receivers, layout, block);
        LaneInt receivers = points.receivers;
#endif
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
        PreparedFacing facing =
            face_points(&to.prepared, light_frame, layout, block, &points.at, receivers, &counts.facing_exact);
        counts.minus_absent += facing.absent;
        counts.minus_away += facing.away;
        counts.minus_strays += facing.strays;
        LaneFloat state = state_of_points(&facing);
        LaneInt left = facing.open;
        if (!LANES_ANY(left)) {
            store_lanes(state, to.visibility, layout, block);
            continue;
        }
#if GN_LANES == 1
        PointLookUp place = look_up(&frames, lists, lane_frames, points.at);
#endif
#else
#if TRACE_BY_BLOCKS
        uint map_says = MAP_MAY_HIDE;
        bool all_open = false;  // all lanes are, and in this frame: nothing has decided one before
        if (to.blocks != 0) {
            BlockBounds bounds = to.blocks[block];
            if (bounds.frame != frames.first && bounds.frame != BLOCK_IN_FRAMES) continue;
            if (sees_map) map_says = map_hides(&grid, frames.projections, &bounds, frames.map);
            all_open = bounds.frame == frames.first && bounds.flags == BLOCK_ALL_OPEN;
        }
        LaneFloat state = all_open ? (LaneFloat)(VISIBILITY_OPEN) : load_lanes(to.visibility, layout, block);
#elif TRACE_LOOKS_AHEAD
        LaneFloat state = state_ahead;
        size_t ahead = block + share.step;
        state_ahead = ahead < share.end ? to.visibility[ahead] : 0.0f;
#else
        LaneFloat state = load_lanes(to.visibility, layout, block);
#endif
        LaneInt left = open_lanes(state);
        if (!LANES_ANY(left)) continue;
#if TRACE_BY_BLOCKS
        if (map_says == MAP_HIDES_ALL) {
            counts.minus_by_map += left;
            store_lanes(LANES_SELECT(state, (LaneFloat)(0.0f), left), to.visibility, layout, block);
            continue;
        }
#endif
        BlockPoints points = load_points(to.positions, to.receivers, layout, block);
        LaneInt lane_frames = frames_of(light_frame, points.at) - (int)frames.first;
#if GN_LANES == 1
        PointLookUp place = look_up(&frames, lists, lane_frames, points.at);
#endif
#endif
        left &=
            LANE_COMPARE(lane_frames, >=, (LaneInt)(0)) & LANE_COMPARE(lane_frames, <, (LaneInt)((int)frames.count));
        BlockAnswer answer = no_answer();
#if GN_LANES == 1
        if (ask_map(&place, left, state, &answer) && !names_own_alone(&to, lists, place.range, block)) {
            queue_point(walks, block, state, &answer);
            continue;
        }
#else
#if TRACE_BY_BLOCKS
        bool asks_map = sees_map && map_says != MAP_HIDES_NONE;
#else
        bool asks_map = frames.has_map != 0u;
#endif
        counts.tests += trace_block(&pairs, &frames, lists, asks_map, lane_frames, left, state, &points, &answer);
#endif
        finish_block(&pairs, &points, left, state, &answer, to.visibility, &counts);
    }
    *total = counts;
}
#endif

// `points_at_once`, of a GPU alone: how many a work-group takes in a round, for which `queued` has room.
__kernel void TRACE_KERNEL(LightFrame light_frame, uint first_frame, uint frame_count, PointsLayout layout,
                           __constant const Projection* projections, uint has_map, uint queue_capacity,
                           ulong first_float, __global const float* positions, __global const uint* receivers,
                           __global const float* vertices, __global const uint* map, __global const uint2* ranges,
                           __global const BinEntries* entries, __global const TriangleRecord* records,
                           __global const TriangleBounds* bounds, __global float* visibility, __global uint2* queue,
                           __global FrameCounters* counters, uint points_at_once,
                           __local uint* queued TRACE_MORE_ARGUMENTS) {
    // After an overflow upstream there is nothing to do: the host will grow the lists and run again. No return: every
    // item must come to the barriers, also as far as a compiler can tell (PoCL 3.1 makes code that crashes).
    uint blocks = counters->references == GN_NO_LISTS ? 0u : block_count(layout);
#ifndef GN_CPU
    // One atomic per work-group and counter: hundreds of thousands on one address would take longer than the trace.
    __local uint group_counts[TRACE_COUNTS];
    for (uint i = (uint)get_local_id(0); i < TRACE_COUNTS; i += (uint)get_local_size(0)) group_counts[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
#endif
    TraceLists lists = {ranges, entries, records, bounds};
    ExactPairs pairs =
        exact_pairs(light_frame, layout, receivers, vertices + first_float, queue, queue_capacity, counters);
    TraceFrames frames = {projections,
                          map,
                          first_frame,
                          frame_count,
                          has_map,
                          light_frame.bins_x * light_frame.bins_y,
                          light_frame.width * light_frame.height};
    TracePoints to;
    to.layout = layout;
    to.positions = positions;
    to.receivers = receivers;
    to.visibility = visibility;
#if TRACE_BLOCKS
    to.blocks = has_blocks ? block_bounds : 0;
#endif
#if TRACE_BY_ANSWERS
    to.domain = domains;
    to.answers = answers;
    to.triangle_count = triangle_count;
#endif
#if TRACE_FACES
    to.prepared = prepared_receivers(light_frame, layout, triangle_count, domains, planes, largest_coordinate, lit,
                                     slots, vertices + first_float);
#endif
    TraceCounts counts = no_counts();
#if GN_LANES == 1
    __local uint queue_count, queue_taken;
    for (size_t first = get_group_id(0) * (size_t)points_at_once; first < blocks;
         first += get_num_groups(0) * (size_t)points_at_once) {
        WalkQueue walks = {queued, &queue_count, &queue_taken, first};
        start_round(&walks);
        Share share = {first + get_local_id(0), min(first + points_at_once, (size_t)blocks), get_local_size(0)};
        trace_blocks(share, light_frame, frames, lists, pairs, to, &counts, &walks);
        walk_queue(&walks, light_frame, &frames, lists, &pairs, &to, &counts);
    }
#else
    trace_blocks(share_of(blocks), light_frame, frames, lists, pairs, to, &counts);
#endif
    uint found[TRACE_COUNTS];
    read_counts(&counts, found);
#if TRACE_FACES || TRACE_BY_ANSWERS
    if (counts.facing_exact != 0) atomic_add(&counters->facing_exact, counts.facing_exact);
#endif
#ifdef GN_CPU
    // Few work-items; and PoCL 3.1 keeps vectors misaligned across a barrier of work-groups of 3, 7 and so on.
    add_counts(found, counters);
#else
    for (uint i = 0; i < TRACE_COUNTS; ++i)
        if (found[i] != 0u) atomic_add(&group_counts[i], found[i]);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) != 0) return;
    for (uint i = 0; i < TRACE_COUNTS; ++i) found[i] = group_counts[i];
    add_counts(found, counters);
#endif
}

#endif
