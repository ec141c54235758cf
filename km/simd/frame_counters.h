// SPDX-License-Identifier: MIT
// The ledger of a frame: the counters of all stages, from which the host sees which lists were too short and how many
// points each stage decided.
#pragma once

#include "prelude.h"

// Counters of one projection's run, zeroed at its start, written by the stages named.
GN_STRUCT_BEGIN(FrameCounters)
    uint clusters_listed;   // clusters: survivors of the cull, if clusters are kept
    uint clusters_outside;  // clusters: dropped, behind the light or outside the fitted frustum
    uint clusters_too_far;  // clusters: dropped, farther than every point that they could cover
    uint slots;             // triangle_setup: slots of the list of bounds wanted (may exceed the capacity)
    uint map_slots;         // triangle_setup: slots of the list of the map's candidates wanted
    uint survivors;         // triangle_setup: triangles with bounds
    uint map_candidates;    // triangle_setup: survivors that can cover a whole texel
    uint map_expected;    // triangle_setup, on a CPU: texels the map will cover, roughly; counted until it is worth it
    uint not_finite;      // clusters, triangle_setup: dropped for a NaN or infinite vertex
    uint edge_on;         // triangle_setup: dropped, exactly edge-on to the light or of zero area
    uint outside;         // the same: dropped, outside the fitted frustum or farther than every point there
    uint hidden;          // triangle_setup: with bounds, but farther than every open point
    uint map_hidden;      // triangle_setup: not drawn into the map for the same reason
    uint setup_exact;     // triangle_setup: orientations decided at the exact level
    uint map_tiles;       // triangle_setup: tiles for the map wanted
    uint tiles;           // triangle_setup: tiles for the lists wanted
    uint pairs;           // bins: slots for (triangle, bin) pairs wanted
    uint references;      // bins: pairs listed; GN_NO_LISTS if something did not fit: no list may be read
    uint entries;         // bins: BinEntries wanted
    uint map_texels;      // conservative_map: texels written; sub_pixel_shadow_map: texels with a triangle
    uint decided_by_map;  // izb: points in shadow by the conservative map
    uint listed;          // izb: points listed
    uint uncertain;       // trace: (point, triangle) pairs handed to the exact stage, wanted
    uint decided_by_trace;  // trace: points in shadow by the float filter
    uint exact_float;       // exact_trace: pairs decided at each level of the predicate
    uint exact_double;
    uint exact_exact;
    uint decided_by_exact;  // exact_trace, sub_pixel_shadow_map: points in shadow by the exact predicate
    uint facing_away;       // facing: points
    uint absent;            // facing: points
    uint facing_exact;      // facing: points (or receivers, each counted once) that needed the exact level
    uint fallback_points;   // fallback points of a prepared light (trace) or of classify_footprints
    uint chunks;            // camera, on a GPU: chunks of tiles' long lists
    uint open_pairs;        // camera, on a GPU: (pixel, triangle) pairs that records leave open, wanted
    uint tests_low;         // trace: (point, triangle) tests, 64 bits in two words
    uint tests_high;
GN_STRUCT_END(FrameCounters, 144)

// FrameCounters::references where something did not fit.
#define GN_NO_LISTS 0xFFFFFFFFu
