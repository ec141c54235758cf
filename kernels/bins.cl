// SPDX-License-Identifier: MIT
// Bins: for each bin of a projection, the list of triangles that may matter to a point in it (count, scan, fill: no
// fixed capacity, contiguous lists). Serves the light's frames and, with a bin per 16 x 16 pixels, the camera.
//
// A triangle enters a bin's list unless it certainly misses the bin's square (an edge function below -margin at its
// best corner: conservative rasterization), or is certainly below the farthest point listed there (its highest vertex
// or its plane's highest corner). Two size classes: up to SMALL_BINS bins one work-item, else one work-group, and the
// very large ones split over groups.
#include "projection.h"
#include "triangle_setup.h"

static float highest_at_corners(float slope_x, float slope_y, float constant_term, float4 square) {
    float corner_x = slope_x > 0.0f ? square.z : square.x;
    float corner_y = slope_y > 0.0f ? square.w : square.y;
    return fma(slope_x, corner_x, fma(slope_y, corner_y, constant_term));
}

static bool may_matter(const TriangleRecord* record, __constant const Projection* projection, uint x, uint y,
                       uint has_heights, __global const uint* farthest) {
    float size = (float)(1u << projection->bin_log2);
    float4 square = (float4)((float)x, (float)y, (float)(x + 1u), (float)(y + 1u)) * size;
    for (int i = 0; i < 3; ++i)
        if (highest_at_corners(record->edge_x[i], record->edge_y[i], record->edge_0[i], square) < -record->margin_edge)
            return false;
    if (!has_heights) return true;
    uint key = farthest[y * projection->bins_x + x];
    if (key == 0xFFFFFFFFu) return false;  // no point is listed here
    float lowest = key_to_float(key);
    float highest = highest_at_corners(record->plane_x, record->plane_y, record->plane_0, square) + record->margin_plane;
    return record->z_high >= lowest && !(highest < lowest);
}

// Counts (fill = 0) or writes (fill = 1) one triangle's reference in one bin.
static void refer(uint fill, uint capacity, uint bin, uint slot, __global const uint* offsets, __global uint* cursors,
                  __global uint* references) {
    uint place = atomic_inc(&cursors[bin]);
    if (!fill) return;
    uint at = offsets[bin] + place;
    if (at < capacity) references[at] = slot;
}

__kernel void bins_small(__constant const Projection* projection, uint record_capacity, uint has_heights, uint fill,
                         uint reference_capacity, __global const TriangleRecord* records,
                         __global const uint4* record_bins, __global const uint* farthest, __global const uint* offsets,
                         __global uint* cursors, __global uint* references, __global const FrameCounters* counters) {
    uint count = min(counters->survivors, record_capacity);
    GN_FOR_EACH(slot, count) {
        uint4 bins = record_bins[slot];
        if ((bins.z - bins.x + 1u) * (bins.w - bins.y + 1u) > SMALL_BINS) continue;
        TriangleRecord record = records[slot];
        for (uint y = bins.y; y <= bins.w; ++y)
            for (uint x = bins.x; x <= bins.z; ++x)
                if (may_matter(&record, projection, x, y, has_heights, farthest))
                    refer(fill, reference_capacity, y * projection->bins_x + x, (uint)slot, offsets, cursors, references);
    }
}

// Group g takes rows g % splits, ... of large triangles g / splits, ...
__kernel void bins_large(__constant const Projection* projection, uint record_capacity, uint splits, uint has_heights,
                         uint fill, uint reference_capacity, __global const TriangleRecord* records,
                         __global const uint4* record_bins, __global const uint* large, __global const uint* farthest,
                         __global const uint* offsets, __global uint* cursors, __global uint* references,
                         __global const FrameCounters* counters) {
    uint count = min(counters->large, record_capacity);
    uint split = (uint)get_group_id(0) % splits;
    for (uint i = (uint)get_group_id(0) / splits; i < count; i += (uint)get_num_groups(0) / splits) {
        uint slot = large[i];
        uint4 bins = record_bins[slot];
        TriangleRecord record = records[slot];
        for (uint y = bins.y + split; y <= bins.w; y += splits)
            for (uint x = bins.x + (uint)get_local_id(0); x <= bins.z; x += (uint)get_local_size(0))
                if (may_matter(&record, projection, x, y, has_heights, farthest))
                    refer(fill, reference_capacity, y * projection->bins_x + x, slot, offsets, cursors, references);
    }
}

// After the scan: tells the host how many references there are in all.
__kernel void bins_total(uint bin_count, __global const uint* offsets, __global FrameCounters* counters) {
    if (get_global_id(0) == 0) counters->references = offsets[bin_count];
}
