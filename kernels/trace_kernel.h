// SPDX-License-Identifier: MIT
// The kernel of a trace, for the file that includes this after its trace_blocks() (a CPU) or look_at_points() (a GPU).
// Before trace_points.h it defines
//     TRACE_KERNEL            the kernel's name
//     TRACE_IN_PLACE          1: pairs that the filter leaves open are decided at once, 0: they are queued
//     TRACE_MORE_PARAMETERS   of the kernel, beyond those that all have, after a comma
//     TRACE_MORE_OF_POINTS    members of TracePoints beyond those that all have
//     TRACE_MORE_VALUES       theirs, after a comma
#ifndef GN_TRACE_KERNEL_H
#define GN_TRACE_KERNEL_H

#include "trace_blocks.h"
#include "trace_rounds.h"

// `points_at_once`, of a GPU alone: how many a work-group takes in a round, for which `queued` has room.
__kernel void TRACE_KERNEL(LightFrame light_frame, uint first_frame, uint frame_count, PointsLayout layout,
                           __constant const Projection* projections, uint has_map, uint queue_capacity,
                           ulong first_float, __global const float* positions, __global const uint* receivers,
                           __global const float* vertices, __global const uint* map, __global const uint2* ranges,
                           __global const BinEntries* entries, __global const TriangleRecord* records,
                           __global const TriangleBounds* bounds, __global float* visibility, __global uint2* queue,
                           __global FrameCounters* counters, uint points_at_once,
                           __local uint* queued TRACE_MORE_PARAMETERS) {
    // After an overflow upstream there is nothing to do: the host will grow the lists and run again. No return: every
    // item must come to the barriers, also as far as a compiler can tell (PoCL 3.1 makes code that crashes).
    uint blocks = counters->references == GN_NO_LISTS ? 0u : block_count(layout);
#if GN_LANES == 1
    __local uint group_counts[TRACE_COUNTS];
    clear_counts(group_counts);
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
    TracePoints to = {layout, positions, receivers, visibility TRACE_MORE_VALUES};
    TraceCounts counts = no_counts();
#if GN_LANES == 1
    __local uint queue_count, queue_taken;
    WalkQueue walks = {queued, &queue_count, &queue_taken, 0};
    trace_rounds(walks, points_at_once, blocks, light_frame, frames, lists, pairs, to, &counts);
    add_counts_of_group(&counts, group_counts, counters);
#else
    trace_blocks(share_of(blocks), light_frame, frames, lists, pairs, to, &counts);
    add_counts_of_item(&counts, counters);
#endif
}

#endif
