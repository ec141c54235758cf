// SPDX-License-Identifier: MIT
// Conservative map: for each texel that ONE triangle covers completely, a height below which every point of the texel
// is in shadow for certain; the highest such height over all triangles.
//
// Method: Mizoguchi and Tokuyoshi, "Accelerating Frustum Traced Shadows Using Conservative Shadow Maps", section 2.
// Complete cover, tight (their eq. 1): every edge function is positive at its worst corner, i.e. its value at the
// centre minus half the sum of the magnitudes of its slopes. Hertel et al. 2009, kept for comparison (their table 2):
// every edge is at least half a texel's DIAGONAL from the centre. Height, tight: the plane at its lowest corner,
// z(centre) - (|dz/dx| + |dz/dy|) / 2  (= their max(|a + b|, |a - b|) / 2). Z = 1 / W is as linear in the grid as a
// parallel light's Z, so the same formula is the perspective form for a positional light.
// All comparisons leave the record's margins, so rounding cannot shadow a lit point. A receiver never shadows its own
// points: see izb.cl.
#include "bin_test.h"

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
        // Scaled, since the squares of slopes near a positional light underflow. 2.5 ulp for the quotient, 3 for sqrt.
        float larger = fmax(fabs(record->edge_x[i]), fabs(record->edge_y[i]));
        float ratio = fmin(fabs(record->edge_x[i]), fabs(record->edge_y[i])) / larger;
        float gradient = larger > 0.0f ? larger * sqrt(1.0f + ratio * ratio) : 0.0f;
        if (!(centre > HALF_DIAGONAL * gradient * (1.0f + 16.0f * GN_U) + record->margin_edge)) return false;
    }
    return true;
}

// Draws one triangle into the texels of one bin; returns how many it covers.
static uint draw_bin(const TriangleRecord* record, __constant const Projection* projection, uint bin_x, uint bin_y,
                     uint circle_cover, __global uint* map) {
    uint size = 1u << projection->bin_log2, written = 0;
    uint last_x = min((bin_x + 1) * size, projection->width), last_y = min((bin_y + 1) * size, projection->height);
    for (uint y = bin_y * size; y < last_y; ++y)
        for (uint x = bin_x * size; x < last_x; ++x) {
            bool covers =
                circle_cover ? covers_circle(record, (float)x, (float)y) : covers_tight(record, (float)x, (float)y);
            if (!covers) continue;
            float lowest = lowest_at_corners(record->plane_x, record->plane_y, record->plane_0, (float)x, (float)y) -
                           record->margin_plane * (1.0f + 4.0f * GN_U);
            lowest = fmax(lowest - 2.0f * GN_U * fabs(lowest), record->z_low);
            atomic_max(&map[y * projection->width + x], float_to_key(lowest));
            ++written;
        }
    return written;
}

__kernel void conservative_map_draw(__constant const Projection* projection, uint tile_capacity, uint circle_cover,
                                    __global const TriangleRecord* records, __global const uint2* tiles,
                                    __global const uint* heights, __global uint* map,
                                    __global FrameCounters* counters) {
    uint count = min(counters->map_tiles, tile_capacity), written = 0;
    GN_FOR_EACH(i, count * TILE_LANES) {
        uint2 tile = tiles[i / TILE_LANES];
        if (tile.x == GN_NO_ID) continue;
        TriangleRecord record = records[tile.x];
        uint4 bins = bins_of_tile(tile.y);
        uint bin_count = bins_of_rectangle(bins);
        for (uint b = (uint)i % TILE_LANES; b < bin_count; b += TILE_LANES) {
            uint4 bin = bin_of_rectangle(bins, b);
            if (may_matter(&record, projection, bin, 1u, heights))
                written += draw_bin(&record, projection, bin.x, bin.y, circle_cover, map);
        }
    }
    if (written != 0) atomic_add(&counters->map_texels, written);
}

// One work-item, before anything is drawn: is a map worth its while? It answers whole neighbourhoods of points at once,
// but every point pays for the look. Counted on a CPU, 1920x1080 (docs/performance.md): where a tenth of the texels or
// more are written, drawing and looking is 3 to 28 % faster in all; where a twenty-fifth or fewer, 2 to 7 % slower.
__kernel void conservative_map_judge(__global Projection* projection, __global const FrameCounters* counters) {
    if (get_global_id(0) == 0)
        projection->map_unseen = counters->map_expected < texels_worth_a_map(projection->width, projection->height);
}
