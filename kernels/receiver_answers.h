// SPDX-License-Identifier: MIT
// Which way receivers face, looked up: the same answer for all points on a triangle, none of them doubtful. facing.cl
// says who asks whom. `vertices` are those of the first triangle on.
#ifndef GN_RECEIVER_ANSWERS_H
#define GN_RECEIVER_ANSWERS_H

#include "receivers.h"

#if GN_LANES == 1
// Of each triangle 1 if points on it face away, else 0.
typedef __global const uchar* TriangleAnswers;
#else
// A word for each GN_LANES triangles: 0 as long as nobody has asked, then TRIANGLES_ANSWERED and a bit for each
// triangle that faces away.
typedef volatile __global uint* TriangleAnswers;
#define TRIANGLES_ANSWERED 0x10000u
// The words of these triangles, and those of them that face away by these words.
#define ANSWERS_OF(triangles) ((triangles) >> 4 & 0x0FFFFFFF)
static LaneInt lanes_answered_away(LaneInt words, LaneInt triangles) { return -(words >> (triangles & 15) & 1); }

static uint ask_triangles(TriangleAnswers answers, uint block, __global const float* vertices, uint triangle_count,
                          PointsLayout layout, float4 light, uint* exact) {
    uint first = block * GN_LANES, by_integers = 0;
    TriangleBlock t = load_triangles(vertices, first, triangle_count);
    LaneInt asked = LANE_COMPARE((LaneInt)((int)min(triangle_count - first, (uint)GN_LANES)), >, LANE_INDEX);
    ReceiverAnswer answer = answer_of_triangles(&t, asked, 0, layout, light, &by_integers);
    uint word = TRIANGLES_ANSWERED | lane_bits(answer.faces_away);
    // Several work-items may ask at once: what it took is counted once.
    if (atomic_xchg(&answers[block], word) == 0u) *exact += by_integers;
    return word;
}

// Whether these lanes, of which there is one at least, lie in so few blocks that all of their triangles are asked.
#define FEW_BLOCKS 2
static bool in_few_blocks(LaneInt blocks, LaneInt lanes) {
    for (uint i = 0; i < FEW_BLOCKS; ++i) {
        lanes &= LANE_COMPARE(blocks, !=, (LaneInt)(LANE_OF_INT(blocks, first_lane(lanes))));
        if (!LANES_ANY(lanes)) return true;
    }
    return false;
}

// As look_up_away(), where some have not been asked.
GN_APART LaneInt ask_and_look_up_away(TriangleAnswers answers, __global const float* vertices, LaneInt ids,
                                      LaneInt asked, uint triangle_count, PointsLayout layout, float4 light,
                                      uint* exact) {
    LaneInt at = LANES_SELECT((LaneInt)(0), ids, asked);
    LaneInt blocks = ANSWERS_OF(at), words = LANES_LOOK(answers, blocks);
    LaneInt unknown = asked & LANE_COMPARE(words, ==, (LaneInt)(0));
    LaneInt away = (LaneInt)(0);
    if (LANES_ANY(unknown) && !in_few_blocks(blocks, unknown)) {
        away = ask_receivers(ids, unknown, 0, layout, light, false, vertices, exact).faces_away;
        unknown = (LaneInt)(0);
    }
    while (LANES_ANY(unknown)) {
        int block = LANE_OF_INT(blocks, first_lane(unknown));
        uint word = ask_triangles(answers, (uint)block, vertices, triangle_count, layout, light, exact);
        LaneInt same = LANE_COMPARE(blocks, ==, (LaneInt)(block));
        words = LANES_SELECT(words, (LaneInt)((int)word), same);
        unknown &= ~same;
    }
    return away | (asked & lanes_answered_away(words, at));
}
#endif

// Which of the lanes `asked`, whose ids name triangles, face away, none of them doubtful.
static LaneInt look_up_away(TriangleAnswers answers, __global const float* vertices, LaneInt ids, LaneInt asked,
                            uint triangle_count, PointsLayout layout, float4 light, uint* exact) {
    LaneInt at = LANES_SELECT((LaneInt)(0), ids, asked);
#if GN_LANES == 1
    return asked & -LANES_GATHER(answers, at);
#else
    LaneInt first = (LaneInt)(at.s0), blocks = ANSWERS_OF(at), words;
    // Most blocks lie on one triangle.
    if (LANES_ANY(LANE_COMPARE(at, !=, first)))
        words = LANES_LOOK(answers, blocks);
    else
        words = (LaneInt)((int)GN_LOOK(&answers[blocks.s0]));
    if (LANES_ANY(asked & LANE_COMPARE(words, ==, (LaneInt)(0))))
        return ask_and_look_up_away(answers, vertices, ids, asked, triangle_count, layout, light, exact);
    return asked & lanes_answered_away(words, at);
#endif
}

static LaneFloat state_of_lanes(LaneInt away, LaneInt open) {
    LaneFloat state = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), away);
    return LANES_SELECT(state, (LaneFloat)(VISIBILITY_OPEN), open);
}

#endif
