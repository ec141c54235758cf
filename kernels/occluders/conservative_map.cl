// SPDX-License-Identifier: MIT
// Conservative map: for each texel that ONE triangle covers completely, a height below which every point of the texel
// is certainly in shadow; the highest such height over all triangles.
//
// Method: Mizokuchi and Tokuyoshi, "Accelerating Frustum Traced Shadows Using Conservative Shadow Maps", section 2.
// Complete cover, tight (their eq. 1): every edge function is positive at its worst corner, i.e. its value at the
// centre minus half the sum of the magnitudes of its slopes. Hertel et al. 2009, kept for comparison (their table 2):
// every edge is at least half a texel's DIAGONAL from the centre. Height, tight: the plane at its lowest corner,
// z(centre) - (|dz/dx| + |dz/dy|) / 2  (= their max(|a + b|, |a - b|) / 2). Z = 1 / W is as linear in the grid as a
// directional light's Z, so the same formula is the perspective form for a point light.
// All comparisons leave the record's margins, so rounding cannot shadow a lit point. The points on a receiver that the
// receiver might cover itself are excluded: see trace/map_query.clh.
#include "occluders/conservative_map.h"
#include "occluders/tile_bins.clh"

#define HALF_DIAGONAL 0.70710685f  // above sqrt(1/2)

// Smallest values of a linear function over GN_LANES neighbouring squares of side 1 at (x, y); evaluated as for points,
// so that the record's margin covers the rounding.
static LaneFloat lowest_at_corners(float slope_x, float slope_y, float constant_term, LaneFloat x, float y) {
    LaneFloat corner_x = x + (slope_x > 0.0f ? 0.0f : 1.0f);
    float corner_y = slope_y > 0.0f ? y : y + 1.0f;
    return lanes_linear(slope_x, slope_y, constant_term, corner_x, (LaneFloat)(corner_y));
}

static LaneInt covers_tight(const TriangleRecord* record, LaneFloat x, float y) {
    LaneInt covers = (LaneInt)(-1);
    for (int i = 0; i < 3; ++i)
        covers &= LANE_COMPARE(lowest_at_corners(record->edge_x[i], record->edge_y[i], record->edge_0[i], x, y), >,
                               (LaneFloat)(record->margin_edge));
    return covers;
}

static LaneInt covers_circle(const TriangleRecord* record, LaneFloat x, float y) {
    LaneInt covers = (LaneInt)(-1);
    for (int i = 0; i < 3; ++i) {
        LaneFloat centre =
            lanes_linear(record->edge_x[i], record->edge_y[i], record->edge_0[i], x + 0.5f, (LaneFloat)(y + 0.5f));
        // Scaled, since the squares of slopes near a point light underflow. 2.5 ulp for the quotient, 3 for sqrt.
        float larger = fmax(fabs(record->edge_x[i]), fabs(record->edge_y[i]));
        float ratio = fmin(fabs(record->edge_x[i]), fabs(record->edge_y[i])) / larger;
        float gradient = larger > 0.0f ? larger * sqrt(1.0f + ratio * ratio) : 0.0f;
        float least = HALF_DIAGONAL * gradient * (1.0f + 16.0f * GN_U) + record->margin_edge;
        covers &= LANE_COMPARE(centre, >, (LaneFloat)(least));
    }
    return covers;
}

// Draws one triangle into GN_LANES texels from (x, y) on, up to last_x; returns the number of covered texels.
static uint draw_texels(const TriangleRecord* record, uint x, uint last_x, uint y, uint cover_test,
                        volatile __global uint* row) {
    LaneFloat left = LANES_TO_FLOAT((LaneInt)((int)x) + LANE_INDEX);
    LaneInt covers =
        LANE_COMPARE((LaneInt)((int)(last_x - x)), >, LANE_INDEX) &
        (cover_test == COVER_CIRCLE ? covers_circle(record, left, (float)y) : covers_tight(record, left, (float)y));
    if (!LANES_ANY(covers)) return 0u;
    LaneFloat lowest = lowest_at_corners(record->plane_x, record->plane_y, record->plane_0, left, (float)y) -
                       record->margin_plane * (1.0f + 4.0f * GN_U);
    // z(centre) - max(|dz/dx|, |dz/dy|) is lower than the corner by half of the slopes' difference.
    if (cover_test == COVER_SLOPE) lowest -= 0.5f * fabs(fabs(record->plane_x) - fabs(record->plane_y));
    lowest = fmax(lowest - 2.0f * GN_U * fabs(lowest), cover_test == COVER_SLOPE ? -INFINITY : record->z_low);
    LaneInt heights = lanes_in_order(lowest);
    for (uint bits = lane_bits(covers); bits != 0u;) {
        int lane = take_lane(&bits);
        uint key = order_to_key(LANE_OF_INT(heights, lane));
        if (key > GN_RELAXED_LOAD(&row[x + (uint)lane])) atomic_max(&row[x + (uint)lane], key);
    }
    return count_lanes(covers);
}

// Draws one triangle into the texels of a rectangle of bins; returns the number of covered texels.
static uint draw_bins(const TriangleRecord* record, __constant const Projection* projection, uint4 bins,
                      uint cover_test, volatile __global uint* map) {
    uint size = 1u << projection->bin_log2, written = 0;
    uint last_x = min((bins.z + 1u) * size, projection->width), last_y = min((bins.w + 1u) * size, projection->height);
    for (uint y = bins.y * size; y < last_y; ++y)
        for (uint x = bins.x * size; x < last_x; x += GN_LANES)
            written += draw_texels(record, x, last_x, y, cover_test, map + y * projection->width);
    return written;
}

#ifdef GN_CPU
GN_NOINLINE_ON_CPU uint draw_tiles(ItemRange items, __constant const Projection* projection, uint cover_test,
                                   __global const TriangleRecord* records, __global const uint2* tiles,
                                   volatile __global uint* map) {
    uint written = 0;
    GN_FOR_EACH_OF(i, items) {
        uint2 tile = tiles[i];
        if (tile.x == GN_NO_ID) continue;
        TriangleRecord record = records[tile.x];
        written += draw_bins(&record, projection, bins_of_tile(tile.y), cover_test, map);
    }
    return written;
}
#endif

// The bins of a tile are drawn without a test: to draw a bin takes no longer than to cull the triangle there.
__kernel void conservative_map_draw(ConservativeMapParams params, __constant const Projection* projection,
                                    __global const TriangleRecord* records, __global const uint2* tiles,
                                    __global const uint* pyramid, volatile __global uint* map,
                                    __global FrameCounters* counters, __local uint* ends,
                                    __local uint2* group_tiles GN_SHARES) {
    __local uint sum;
    uint count = min(counters->map_tiles, params.tile_capacity), written = 0;
#ifdef GN_CPU
    written = draw_tiles(GN_SHARED_RANGE(count), projection, params.cover_test, records, tiles, map);
#else
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    TileGroup group = {group_tiles, ends};
    GN_ROUNDS(round, count) {
        uint total = take_tile(group, tiles, count, round, projection, 1u, pyramid, records);
        for (uint i = item; i < total; i += items) {
            uint slot;
            bool alone;
            uint4 bin = bin_to_walk(group, i, &slot, &alone);
            TriangleRecord record = records[slot];
            written += draw_bins(&record, projection, bin, params.cover_test, map);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
#endif
    add_in_group(written, &sum, &counters->map_texels);
    GN_END_SHARES;
}

// One work-item decides before the drawing whether a map is worth its cost: a map decides neighbouring points at once,
// but every point loads its texel. Measured on a CPU, 1920x1080 (docs/performance.md): where a tenth of the texels or
// more are written, a frame with the map is 3 to 28 % faster; where a twenty-fifth or fewer, 2 to 7 % slower.
__kernel void conservative_map_judge(__global Projection* projection, __global const FrameCounters* counters) {
    if (get_global_id(0) == 0)
        projection->map_disabled = counters->map_expected < texels_worth_a_map(projection->width, projection->height);
}
