// SPDX-License-Identifier: MIT
// Contract of the decisions: which stage of an exact run decided each point, and how hard that was. Watched from
// outside, between the stages (decisions.cl): the kernels of a run are the same whether anyone watches or not.
//
// The values rise so that an atomic maximum keeps what counts: of several pairs of a point that the filter left open
// the hardest, and a shadow that the map or the filter is certain of before any of them.
#ifndef GN_DECISIONS_H
#define GN_DECISIONS_H

#include "receivers/light_frame.h"

#define PROVENANCE_OPEN 0u      // still to be decided; in the end: none
#define PROVENANCE_DOUBTFUL 1u  // open, and its own receiver might cover it (VISIBILITY_MAY_SELF_SHADOW)
#define PROVENANCE_LIT_BY_FILTER 2u
#define PROVENANCE_BY_FLOAT 3u     // the exact predicate, at its level float,
#define PROVENANCE_BY_DOUBLE 4u    // double,
#define PROVENANCE_BY_INTEGERS 5u  // or integers
#define PROVENANCE_SHADOWED_BY_FILTER 6u
#define PROVENANCE_BY_MAP 7u
#define PROVENANCE_SECOND_LOOK 8u  // its pairs found no room in the queue
#define PROVENANCE_FACES_AWAY 9u
#define PROVENANCE_NOT_ASKED 10u  // lit: no triangles, or at the lamp itself
#define PROVENANCE_ABSENT 11u     // the sky
#define PROVENANCE_COUNT 12u

#endif
