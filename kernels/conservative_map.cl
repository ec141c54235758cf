// SPDX-License-Identifier: MIT
// Conservative map: for each texel that ONE triangle covers completely, a height below which every point of the texel
// is in shadow for certain; the highest such height over all triangles.
//
// Method: Mizoguchi and Tokuyoshi, "Accelerating Frustum Traced Shadows Using Conservative Shadow Maps", section 2.
// Complete cover, tight (their eq. 1): every edge function is positive at its worst corner, i.e. its value at the centre
// minus half the sum of the magnitudes of its slopes. Hertel et al. 2009, kept for comparison (their table 2): every
// edge is at least half a texel's DIAGONAL from the centre. Height, tight: the plane at its lowest corner,
// z(centre) - (|dz/dx| + |dz/dy|) / 2  (= their max(|a + b|, |a - b|) / 2). Z = 1 / W is as linear in the grid as a
// parallel light's Z, so the same formula is the perspective form for a positional light.
// All comparisons leave the record's margins, so rounding cannot shadow a lit point. A receiver never shadows its own
// points: see izb.cl.
#include "projection.h"
#include "triangle_setup.h"

#define HALF_DIAGONAL 0.70710685f  // above sqrt(1/2)

// Smallest value of an edge function over the square of side 1 at (x, y); evaluated as for points, so that the
// record's margin covers its rounding.
static float lowest_at_corners(float slope_x, float slope_y, float constant_term, float x, float y) {
    float corner_x = slope_x > 0.0f ? x : x + 1.0f;
    float corner_y = slope_y > 0.0f ? y : y + 1.0f;
    return fma(slope_x, corner_x, fma(slope_y, corner_y, constant_term));
}

static bool covers_tight(const TriangleRecord* record, float x, float y) {
    for (int i = 0; i < 3; ++i)
        if (!(lowest_at_corners(record->edge_x[i], record->edge_y[i], record->edge_0[i], x, y) > record->margin_edge))
            return false;
    return true;
}

static bool covers_circle(const TriangleRecord* record, float x, float y) {
    for (int i = 0; i < 3; ++i) {
        float centre = fma(record->edge_x[i], x + 0.5f, fma(record->edge_y[i], y + 0.5f, record->edge_0[i]));
        float gradient = sqrt(record->edge_x[i] * record->edge_x[i] + record->edge_y[i] * record->edge_y[i]);
        // sqrt may be off by 3 ulp, the squares by one each.
        if (!(centre > HALF_DIAGONAL * gradient * (1.0f + 16.0f * GN_U) + record->margin_edge)) return false;
    }
    return true;
}

// The range of texels of row y whose centre the triangle could cover; saves looking at most of a bounding box.
static uint2 span_of_row(const TriangleRecord* record, float y, uint first, uint last) {
    float low = (float)first, high = (float)last;
    for (int i = 0; i < 3; ++i) {
        // edge_x X > -(edge_y y + edge_0): a bound on X, widened by a texel for its rounding.
        float rest = fmax(fma(record->edge_y[i], y, record->edge_0[i]), fma(record->edge_y[i], y + 1.0f, record->edge_0[i]));
        float bound = -rest / record->edge_x[i];
        if (record->edge_x[i] > 0.0f && bound > low + 2.0f) low = fmin(bound - 2.0f, high);
        if (record->edge_x[i] < 0.0f && bound < high - 2.0f) high = fmax(bound + 2.0f, low);
    }
    return (uint2)((uint)low, (uint)high);
}

// Work-group g draws rows g % splits, g % splits + splits, ... of candidates g / splits, ...: large triangles are shared
// out over groups, small ones cost a group a handful of texels.
__kernel void conservative_map(__constant const Projection* projection, uint capacity, uint splits, uint circle_cover,
                               __global const TriangleRecord* records, __global const uint4* record_bins,
                               __global const uint* candidates, __global uint* map, __global FrameCounters* counters) {
    uint candidate_count = min(counters->map_candidates, capacity);
    uint written = 0;
    uint split = (uint)get_group_id(0) % splits;
    for (uint c = (uint)get_group_id(0) / splits; c < candidate_count; c += (uint)get_num_groups(0) / splits) {
        uint slot = candidates[c];
        TriangleRecord record = records[slot];
        uint4 bins = record_bins[slot] << projection->bin_log2;
        uint last_x = min(bins.z + (1u << projection->bin_log2), projection->width) - 1;
        uint last_y = min(bins.w + (1u << projection->bin_log2), projection->height) - 1;
        for (uint y = bins.y + split; y <= last_y; y += splits) {
            uint2 span = span_of_row(&record, (float)y, bins.x, last_x);
            for (uint x = span.x + (uint)get_local_id(0); x <= span.y; x += (uint)get_local_size(0)) {
                bool covers = circle_cover ? covers_circle(&record, (float)x, (float)y)
                                           : covers_tight(&record, (float)x, (float)y);
                if (!covers) continue;
                float lowest = lowest_at_corners(record.plane_x, record.plane_y, record.plane_0, (float)x, (float)y) -
                               record.margin_plane * (1.0f + 4.0f * GN_U);
                lowest = fmax(lowest - 2.0f * GN_U * fabs(lowest), record.z_low);
                atomic_max(&map[y * projection->width + x], float_to_key(lowest));
                ++written;
            }
        }
    }
    if (written != 0) atomic_add(&counters->map_texels, written);
}
