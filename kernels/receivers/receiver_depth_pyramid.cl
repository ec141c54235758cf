// SPDX-License-Identifier: MIT
// Receiver depth pyramid (receiver_depth_pyramid.h). A second set of bins, self_shadow_depths, has only the depths of
// points that may shadow themselves, because the conservative map must not decide those points.
#include "receivers/block_bounds.h"
#include "receivers/footprint.h"
#include "receivers/receiver_depth_pyramid.h"

// Most points are not the farthest of their bin: a relaxed load saves the atomic. A stale key can only be too high.
static void lower_to(volatile __global uint* lowest, uint key) {
    if (key < GN_RELAXED_LOAD(lowest)) atomic_min(lowest, key);
}

// One atomic for all lanes of a bin.
static void lower_bins(LaneInt bins, LaneInt heights, LaneInt lanes, volatile __global uint* lowest) {
    while (LANES_ANY(lanes)) {
        int bin = LANE_OF_INT(bins, first_lane(lanes));
        LaneInt same = lanes & LANE_COMPARE(bins, ==, (LaneInt)(bin));
        lanes &= ~same;
        int least = LANES_MINIMUM(LANES_SELECT((LaneInt)(INT_MAX), heights, same));
        lower_to(&lowest[bin], order_to_key(least));
    }
}

// The least height of each footprint, in every bin that the footprint touches. Footprints that span more than
// LISTED_SPAN bins per side are fallback points (classify_footprints).
static void lower_footprint_bins(__constant const Projection* projection, PointBlock centres,
                                 const FootprintBlock* footprints, LaneInt lanes, volatile __global uint* lowest) {
    GridFootprint grid = project_footprint(projection, centres, footprints);
    CellSpan span = footprint_cells(projection, &grid, projection->bin_log2);
    lanes &= grid.usable & spans_below(&span, LISTED_SPAN);
    LaneInt heights = lanes_in_order(grid.centre.z - grid.reach.z);
    for (LaneInt bin_y = span.y0; LANES_ANY(lanes); bin_y += 1) {
        lanes &= LANE_COMPARE(bin_y, <=, span.y1);
        LaneInt touching = lanes;
        for (LaneInt bin_x = span.x0; LANES_ANY(touching); bin_x += 1) {
            lower_bins(bin_y * (int)projection->bins_x + bin_x, heights, touching, lowest);
            touching &= LANE_COMPARE(bin_x, <, span.x1);
        }
    }
}

// Lowers the bins of a block by its bounds, without its points. False if the points must be loaded. If they lie in 2 x
// 2 bins, each of these bins gets the block's least height. (Counted on Sponza: this lists .7 % more references.)
static bool lower_block(const BlockGrid* grid, __constant const Projection* projection, BlockBounds block, uint frame,
                        volatile __global uint* lowest) {
    if (block.frame == BLOCK_IN_FRAMES) return false;
    if (block.frame != frame) return true;  // also if no point is open
    if (grid->indistinct || (block.flags & BLOCK_MAY_SELF_SHADOW)) return false;
    BlockBox box = block_box(grid, projection, &block);
    uint log2 = projection->bin_log2, x = box.x0 >> log2, y = box.y0 >> log2;
    uint x1 = box.x1 >> log2, y1 = box.y1 >> log2;
    if (x1 > x + 1u || y1 > y + 1u) return false;
    uint key = float_to_key(box.z0);
    for (uint j = y; j <= y1; ++j)
        for (uint i = x; i <= x1; ++i) lower_to(&lowest[j * projection->bins_x + i], key);
    return true;
}

GN_NOINLINE_ON_CPU void lower_points(ReceiverDepthParams params, __constant const Projection* projections,
                                     __global const float* positions, __global const float* footprints,
                                     __global const BlockBounds* blocks, __global const float* visibility,
                                     __global uint* pyramid, __global uint* self_shadow_depths, ItemRange items) {
    uint bin_count = params.light_frame.bins_x * params.light_frame.bins_y;
    BlockGrid grid = block_grid(params.light_frame, projections, params.first_frame);
    GN_FOR_EACH_OF(block, items) {
        if (params.has_blocks && lower_block(&grid, projections, blocks[block], params.first_frame, pyramid)) continue;
        LaneFloat state = load_lanes(visibility, params.layout, block);
        LaneInt left = open_lanes(state);
        if (!LANES_ANY(left)) continue;
        PointBlock points = load_block(positions, params.layout, block);
        LaneInt frames = frames_of(params.light_frame, points) - (int)params.first_frame;
        left &= LANE_COMPARE(frames, >=, (LaneInt)(0)) & LANE_COMPARE(frames, <, (LaneInt)((int)params.frame_count));
        while (LANES_ANY(left)) {
            int frame = LANE_OF_INT(frames, first_lane(left));
            LaneInt same = left & LANE_COMPARE(frames, ==, (LaneInt)(frame));
            left &= ~same;
            __constant const Projection* projection = &projections[frame];
            if (params.has_footprints) {
                FootprintBlock around = load_footprints(footprints, params.layout, block);
                lower_footprint_bins(projection, points, &around, same, pyramid + (size_t)frame * bin_count);
                continue;
            }
            PointBlock in_grid = project_points(projection, points);
            LaneInt bins = bins_of(projection, in_grid) + frame * (int)bin_count;
            LaneInt heights = lanes_in_order(in_grid.z);
            lower_bins(bins, heights, same, pyramid);
            lower_bins(bins, heights, same & may_self_shadow_lanes(state), self_shadow_depths);
        }
    }
}

// A cell of the level above: the minimum of up to 2 x 2 cells of this one.
static uint least_of_square(__global const uint* below, uint width, uint height, uint x, uint y) {
    uint x1 = min(2u * x + 1u, width - 1u), y1 = min(2u * y + 1u, height - 1u);
    return min(min(below[2u * y * width + 2u * x], below[2u * y * width + x1]),
               min(below[y1 * width + 2u * x], below[y1 * width + x1]));
}

#ifdef GN_CPU
// All levels above the bins. One item makes them: a launch takes a CPU longer than these few cells do.
GN_NOINLINE_ON_CPU void reduce_bins(uint frame_count, uint width, uint height, __global uint* pyramid) {
    for (__global uint* below = pyramid; width > 1u || height > 1u;) {
        uint half_width = (width + 1u) / 2u, half_height = (height + 1u) / 2u;
        __global uint* above = below + (size_t)frame_count * width * height;
        for (uint frame = 0; frame < frame_count; ++frame)
            for (uint y = 0; y < half_height; ++y)
                for (uint x = 0; x < half_width; ++x)
                    above[(frame * half_height + y) * half_width + x] =
                        least_of_square(below + (size_t)frame * width * height, width, height, x, y);
        below = above;
        width = half_width;
        height = half_height;
    }
}
#endif

__kernel void receiver_depth_pyramid(ReceiverDepthParams params, __constant const Projection* projections,
                                     __global const float* positions, __global const float* footprints,
                                     __global const BlockBounds* blocks, __global const float* visibility,
                                     __global uint* pyramid, __global uint* self_shadow_depths GN_SHARES) {
    lower_points(params, projections, positions, footprints, blocks, visibility, pyramid, self_shadow_depths,
                 GN_SHARED_RANGE(block_count(params.layout)));
#ifdef GN_CPU
    if (GN_END_SHARES) reduce_bins(params.frame_count, params.light_frame.bins_x, params.light_frame.bins_y, pyramid);
#endif
}

#if GN_LANES == 1
// On a GPU: makes PYRAMID_LEVELS levels (or up to the last) above `level`: each cell is the minimum of up to 2 x 2
// cells below. A work-group takes a square of 2^PYRAMID_LEVELS cells of one frame. It is whole cells of every level
// that the group makes, so a group reads no cell that another group writes.
__kernel void receiver_depth_pyramid_reduce(PyramidLevel level, __global uint* pyramid) {
    uint width = level.width, height = level.height, first = level.first;
    uint squares_x = (width + (1u << PYRAMID_LEVELS) - 1u) >> PYRAMID_LEVELS;
    uint squares_y = (height + (1u << PYRAMID_LEVELS) - 1u) >> PYRAMID_LEVELS;
    uint square = (uint)get_group_id(0) % (squares_x * squares_y),
         frame = (uint)get_group_id(0) / (squares_x * squares_y);
    uint x0 = square % squares_x << PYRAMID_LEVELS, y0 = square / squares_x << PYRAMID_LEVELS;
    for (uint up = 1; up <= PYRAMID_LEVELS && (width > 1u || height > 1u); ++up) {
        uint half_width = (width + 1u) / 2u, half_height = (height + 1u) / 2u;
        __global const uint* below = pyramid + first + frame * width * height;
        first += level.frame_count * width * height;
        __global uint* cells = pyramid + first + frame * half_width * half_height;
        x0 /= 2u;
        y0 /= 2u;
        uint side = 1u << (PYRAMID_LEVELS - up);
        GN_FOR_EACH_IN_GROUP(i, side * side) {
            uint x = x0 + i % side, y = y0 + i / side;
            if (x >= half_width || y >= half_height) continue;
            cells[y * half_width + x] = least_of_square(below, width, height, x, y);
        }
        barrier(CLK_GLOBAL_MEM_FENCE);
        width = half_width;
        height = half_height;
    }
}
#endif

// Per bin a height such that no point below it needs an occluder list. The map decides every point below its texel, so
// the least height of the bin's texels counts beside the farthest point's height; but points that may shadow themselves
// need a list at every height.
__kernel void depth_after_map(uint frame_count, __constant const Projection* projections, __global const uint* map,
                              __global const uint* pyramid, __global const uint* self_shadow_depths,
                              __global uint* depths GN_SHARES) {
    uint bins_x = projections->bins_x, bins_y = projections->bins_y;
    uint width = projections->width, height = projections->height, size = 1u << projections->bin_log2;
    GN_FOR_EACH_OF(i, GN_SHARED_RANGE(frame_count * bins_x * bins_y)) {
        uint bin = (uint)i % (bins_x * bins_y), frame = (uint)i / (bins_x * bins_y);
        bool has_map = !projections[frame].map_disabled;
        uint lowest_cover = has_map ? 0xFFFFFFFFu : 0u;
        if (has_map) {
            uint x0 = bin % bins_x * size, y0 = bin / bins_x * size;
            for (uint y = y0; y < min(y0 + size, height); ++y)
                for (uint x = x0; x < min(x0 + size, width); ++x)
                    lowest_cover = min(lowest_cover, map[((size_t)frame * height + y) * width + x]);
        }
        depths[i] = min(max(pyramid[i], lowest_cover), self_shadow_depths[i]);
    }
#ifdef GN_CPU
    if (GN_END_SHARES) reduce_bins(frame_count, bins_x, bins_y, depths);
#endif
}
