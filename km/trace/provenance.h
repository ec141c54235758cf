// SPDX-License-Identifier: MIT
// Contract of provenance: which stage of an exact run decided each point, and at which level. Provenance is recorded
// between the stages (provenance.cl), so that a run launches the same kernels with and without the record.
//
// The values rise, so that an atomic maximum keeps the hardest of several undecided pairs of a point, and a shadow that
// the map or the filter decides takes precedence over all pairs.
#pragma once

#include "receivers/light_frame.h"

#define PROVENANCE_OPEN 0u             // still to be decided; after a run no point is
#define PROVENANCE_MAY_SELF_SHADOW 1u  // open, and its own receiver may cover it (VISIBILITY_MAY_SELF_SHADOW)
#define PROVENANCE_LIT_BY_FILTER 2u
#define PROVENANCE_BY_FLOAT 3u     // the exact predicate, at its level float,
#define PROVENANCE_BY_DOUBLE 4u    // double,
#define PROVENANCE_BY_INTEGERS 5u  // or integers
#define PROVENANCE_SHADOWED_BY_FILTER 6u
#define PROVENANCE_BY_MAP 7u
#define PROVENANCE_QUEUE_OVERFLOW 8u  // its pairs found no room in the queue
#define PROVENANCE_FACES_AWAY 9u
#define PROVENANCE_NOT_TRACED 10u  // lit: there are no triangles, or the point is at the point light itself
#define PROVENANCE_ABSENT 11u      // the sky
#define PROVENANCE_COUNT 12u
