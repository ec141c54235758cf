// SPDX-License-Identifier: MIT
// Bins: for each bin of a projection, the list of triangles that may matter to a point in it (count, scan, fill: no
// fixed capacity, contiguous lists). Serves the light's frames and, with a bin per 16 x 16 pixels, the camera.
//
// A triangle enters a bin's list unless it certainly cannot matter there (bin_test.h). Three size
// classes share out the work: see triangle_setup.h.
#include "bin_test.h"

// Counts (fill = 0) or writes (fill = 1) one triangle's reference in one bin.
static void refer(uint fill, uint capacity, uint bin, uint slot, __global const uint* offsets, __global uint* cursors,
                  __global uint* references) {
    uint place = atomic_inc(&cursors[bin]);
    if (!fill) return;
    uint at = offsets[bin] + place;
    if (at < capacity) references[at] = slot;
}

static void refer_if_matters(const TriangleRecord* record, __constant const Projection* projection, uint2 bin,
                             uint has_heights, uint fill, uint capacity, uint slot, __global const uint* farthest,
                             __global const uint* offsets, __global uint* cursors, __global uint* references) {
    if (may_matter(record, projection, bin.x, bin.y, has_heights, farthest))
        refer(fill, capacity, bin.y * projection->bins_x + bin.x, slot, offsets, cursors, references);
}

__kernel void bins_small(__constant const Projection* projection, uint record_capacity, uint has_heights, uint fill,
                         uint reference_capacity, __global const TriangleRecord* records,
                         __global const uint4* record_bins, __global const uint* farthest, __global const uint* offsets,
                         __global uint* cursors, __global uint* references, __global const FrameCounters* counters) {
    uint count = min(counters->survivors, record_capacity);
    GN_FOR_EACH(slot, count) {
        uint4 bins = record_bins[slot];
        uint bin_count = bins_of_rectangle(bins);
        if (bin_count > SMALL_BINS) continue;
        TriangleRecord record = records[slot];
        for (uint b = 0; b < bin_count; ++b)
            refer_if_matters(&record, projection, bin_of_rectangle(bins, b), has_heights, fill, reference_capacity,
                             (uint)slot, farthest, offsets, cursors, references);
    }
}

__kernel void bins_large(__constant const Projection* projection, uint record_capacity, uint has_heights, uint fill,
                         uint reference_capacity, __global const TriangleRecord* records,
                         __global const uint4* record_bins, __global const uint* large, __global const uint* farthest,
                         __global const uint* offsets, __global uint* cursors, __global uint* references,
                         __global const FrameCounters* counters) {
    uint count = min(counters->large, record_capacity);
    for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
        uint slot = LARGE_ENTRY_SLOT(large[i]);
        uint4 bins = record_bins[slot];
        TriangleRecord record = records[slot];
        uint bin_count = bins_of_rectangle(bins);
        for (uint b = (uint)get_local_id(0); b < bin_count; b += (uint)get_local_size(0))
            refer_if_matters(&record, projection, bin_of_rectangle(bins, b), has_heights, fill, reference_capacity,
                             slot, farthest, offsets, cursors, references);
    }
}

__kernel void bins_huge(__constant const Projection* projection, uint record_capacity, uint has_heights, uint fill,
                        uint reference_capacity, __global const TriangleRecord* records,
                        __global const uint4* record_bins, __global const uint* large, __global const uint* farthest,
                        __global const uint* offsets, __global uint* cursors, __global uint* references,
                        __global const FrameCounters* counters) {
    uint count = min(counters->huge, record_capacity);
    uint chunks_before = 0;
    for (uint i = 0; i < count; ++i) {
        uint slot = LARGE_ENTRY_SLOT(large[record_capacity - 1 - i]);
        uint4 bins = record_bins[slot];
        uint bin_count = bins_of_rectangle(bins), chunks = (bin_count + HUGE_CHUNK_BINS - 1) / HUGE_CHUNK_BINS;
        for (uint chunk = first_chunk_of_group(chunks_before); chunk < chunks; chunk += (uint)get_num_groups(0)) {
            TriangleRecord record = records[slot];
            uint last = min((chunk + 1) * HUGE_CHUNK_BINS, bin_count);
            for (uint b = chunk * HUGE_CHUNK_BINS + (uint)get_local_id(0); b < last; b += (uint)get_local_size(0))
                refer_if_matters(&record, projection, bin_of_rectangle(bins, b), has_heights, fill, reference_capacity,
                                 slot, farthest, offsets, cursors, references);
        }
        chunks_before += chunks;
    }
}

// After the scan: tells the host how many references there are in all.
__kernel void bins_total(uint bin_count, __global const uint* offsets, __global FrameCounters* counters) {
    if (get_global_id(0) == 0) counters->references = offsets[bin_count];
}
