// SPDX-License-Identifier: MIT
// Contract of the triangle setup: which triangles matter to a projection, and a float filter for each.
//
// A record answers, for a point (X, Y, Z) in one of the triangle's bins:
//     e_i = edge_x[i] X + edge_y[i] Y + edge_0[i]       inside the triangle's projection iff all three are >= 0
//     z   = plane_x X + plane_y Y + plane_0             the triangle's height along the point's ray
// Some e_i < -margin_edge: certainly outside. All e_i > margin_edge: certainly inside. Z > z + margin_plane: certainly
// nearer to the light. Z < z - margin_plane: certainly behind. Z < z_low, Z > z_high: behind and nearer, whatever the
// plane says. Anything else is for the exact predicate. The margins are proven in triangle_setup.cl.
#ifndef GN_TRIANGLE_SETUP_H
#define GN_TRIANGLE_SETUP_H

#include "prelude.h"

GN_STRUCT_BEGIN(TriangleRecord)
    float edge_x[3];
    float margin_edge;
    float edge_y[3];
    float margin_plane;
    float edge_0[3];
    float z_low;
    float plane_x, plane_y, plane_0;
    float z_high;
GN_STRUCT_END(TriangleRecord, 64)

// Counters of one projection's run, zeroed at its start, written by the stages named.
GN_STRUCT_BEGIN(FrameCounters)
    uint survivors;         // triangle_setup: records wanted (may exceed the capacity: grow and re-run)
    uint large;             // triangle_setup: of those, in more than SMALL_BINS and at most LARGE_BINS bins
    uint huge;              // triangle_setup: of those, in more than LARGE_BINS bins
    uint map_small;         // triangle_setup: of those, able to cover a whole texel, in at most SMALL_BINS bins
    uint map_candidates;    // triangle_setup: of those, able to cover a whole texel, of any size
    uint not_finite;        // triangle_setup: left out for a NaN or infinite vertex
    uint edge_on;           // triangle_setup: left out, exactly edge-on to the light or of zero area
    uint outside;           // triangle_setup: left out, outside the fitted frustum or farther than every point there
    uint setup_exact;       // triangle_setup: orientations decided at the exact level
    uint references;        // bins: (triangle, bin) pairs wanted
    uint map_texels;        // conservative_map: texels written
    uint decided_by_map;    // izb: points in shadow by the conservative map
    uint listed;            // izb: points listed
    uint uncertain;         // trace: (point, triangle) pairs handed to the exact stage, wanted
    uint decided_by_trace;  // trace: points in shadow by the float filter
    uint exact_float;       // exact_trace: pairs decided at each level of the predicate
    uint exact_double;
    uint exact_exact;
    uint decided_by_exact;  // exact_trace: points in shadow by the exact predicate
    uint facing_away;       // facing: points
    uint absent;            // facing: points
    uint facing_exact;      // facing: points whose facing needed the exact level
    uint tests_low;         // trace: (point, triangle) tests, 64 bits in two words
    uint tests_high;
GN_STRUCT_END(FrameCounters, 96)

// Size classes: how a triangle's bins are walked. At most SMALL_BINS: by one work-item. At most LARGE_BINS: by one
// work-group. More: cut into chunks of HUGE_CHUNK_BINS, which a few work-groups share out; each of them walks the whole
// list of huge triangles for that, so both stay few. (H200, Sponza 2K, median of four views: 1.43, 1.16, 1.08, 1.10,
// 1.26 ms for LARGE_BINS of 1024, 2048, 4096, 8192, 16384.)
#define SMALL_BINS 16
#define LARGE_BINS 4096
#define HUGE_CHUNK_BINS 1024

// Entries of the list of large triangles (from its front) and huge ones (from its back).
#define LARGE_ENTRY(slot, for_map) ((slot)*2u + ((for_map) ? 1u : 0u))
#define LARGE_ENTRY_SLOT(entry) ((entry) >> 1)
#define LARGE_ENTRY_FOR_MAP(entry) (((entry)&1u) != 0u)

#endif
