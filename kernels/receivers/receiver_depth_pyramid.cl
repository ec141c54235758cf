// SPDX-License-Identifier: MIT
// Farthest height: per bin of light space, the height of the point farthest from the light, and a pyramid of minima
// over it. (It may say less than that: a block of points that spans up to 2 x 2 bins counts for each as one height.) A
// triangle that lies wholly below (farther than) every point it could cover blocks none of them (Wyman et al. 2016,
// "Frustum-Traced Irregular Z-Buffers", section on early-z; the pyramid is ours).
//
// Heights are kept as order-preserving keys, so that integer minima serve; an empty bin holds 0xFFFFFFFF, above all.
// The same per bin for doubtful points alone (point_blocks.h): what the conservative map must not decide.
// Of several frames: bins frame by frame; the pyramid level by level, inside a level frame by frame.
#include "receivers/block_bounds.h"
#include "receivers/footprint.h"

// A look first: most points are not the farthest of their bin. What it sees can only be too high.
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

// The lowest place of each footprint, in every bin that it touches. Those that LISTED_SPAN leaves out are strays
// (settle.cl).
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

// Whether that was all there is to do for a block: if its points lie in 2 x 2 bins, there is no need to load them.
// (Counted on Sponza: with its least in all of these bins .7 % more references are listed.)
static bool lower_block(const BlockGrid* grid, __constant const Projection* projection, __global const BlockBounds* at,
                        uint frame, volatile __global uint* lowest) {
    BlockBounds bounds = *at;
    const BlockBounds* block = &bounds;
    if (block->frame == BLOCK_IN_NO_FRAME) return true;
    if (block->frame == BLOCK_IN_FRAMES) return false;
    if (block->frame != frame) return true;
    if (grid->indistinct || (block->flags & BLOCK_MAY_SELF_SHADOW)) return false;
    BlockBox box = block_box(grid, projection, block);
    uint log2 = projection->bin_log2, x = box.x0 >> log2, y = box.y0 >> log2;
    uint x1 = box.x1 >> log2, y1 = box.y1 >> log2;
    if (x1 > x + 1u || y1 > y + 1u) return false;
    uint key = float_to_key(box.z0);
    for (uint j = y; j <= y1; ++j)
        for (uint i = x; i <= x1; ++i) lower_to(&lowest[j * projection->bins_x + i], key);
    return true;
}

// `has_blocks`: of one frame alone.
#define FARTHEST_HEIGHT_PARAMETERS                                                                             \
    LightFrame light_frame, uint first_frame, uint frame_count, PointsLayout layout,                           \
        __constant const Projection *projections, uint has_footprints, uint has_blocks,                        \
        __global const float *positions, __global const float *footprints, __global const BlockBounds *blocks, \
        __global const float *visibility, __global uint *pyramid, __global uint *doubtful
GN_KERNEL_OF_ITEMS(receiver_depth_pyramid, block_count(layout), FARTHEST_HEIGHT_PARAMETERS,
                   (items, light_frame, first_frame, frame_count, layout, projections, has_footprints, has_blocks,
                    positions, footprints, blocks, visibility, pyramid, doubtful)) {
    uint bin_count = light_frame.bins_x * light_frame.bins_y;
    BlockGrid grid = block_grid(light_frame, projections, first_frame);
    GN_FOR_EACH_OF(block, items) {
        if (has_blocks && lower_block(&grid, projections, &blocks[block], first_frame, pyramid)) continue;
        LaneFloat state = load_lanes(visibility, layout, block);
        LaneInt left = open_lanes(state);
        if (!LANES_ANY(left)) continue;
        PointBlock points = load_block(positions, layout, block);
        LaneInt frames = frames_of(light_frame, points) - (int)first_frame;
        left &= LANE_COMPARE(frames, >=, (LaneInt)(0)) & LANE_COMPARE(frames, <, (LaneInt)((int)frame_count));
        while (LANES_ANY(left)) {
            int frame = LANE_OF_INT(frames, first_lane(left));
            LaneInt same = left & LANE_COMPARE(frames, ==, (LaneInt)(frame));
            left &= ~same;
            if (has_footprints) {
                FootprintBlock around = load_footprints(footprints, layout, block);
                lower_footprint_bins(&projections[frame], points, &around, same, pyramid + (size_t)frame * bin_count);
                continue;
            }
            PointBlock places = project_points(&projections[frame], points);
            LaneInt bins = bins_of(&projections[frame], places) + frame * (int)bin_count;
            LaneInt heights = lanes_in_order(places.z);
            lower_bins(bins, heights, same, pyramid);
            lower_bins(bins, heights, same & may_self_shadow_lanes(state), doubtful);
        }
    }
}

// The levels `from` + 1 to `from` + PYRAMID_LEVELS (or the last), from level `from`: each cell is the minimum of up to
// 2 x 2 below. A work-group takes a square of 2^PYRAMID_LEVELS cells of one frame, which is whole cells of every level
// it makes, so that it reads nothing that another group writes.
__kernel void receiver_depth_pyramid_reduce(uint frame_count, uint width, uint height, uint first,
                                            __global uint* pyramid) {
    uint squares_x = (width + (1u << PYRAMID_LEVELS) - 1u) >> PYRAMID_LEVELS;
    uint squares_y = (height + (1u << PYRAMID_LEVELS) - 1u) >> PYRAMID_LEVELS;
    uint square = (uint)get_group_id(0) % (squares_x * squares_y),
         frame = (uint)get_group_id(0) / (squares_x * squares_y);
    uint x0 = square % squares_x << PYRAMID_LEVELS, y0 = square / squares_x << PYRAMID_LEVELS;
    for (uint level = 1; level <= PYRAMID_LEVELS && (width > 1u || height > 1u); ++level) {
        uint half_width = (width + 1u) / 2u, half_height = (height + 1u) / 2u;
        __global const uint* below = pyramid + first + frame * width * height;
        first += frame_count * width * height;
        __global uint* cells = pyramid + first + frame * half_width * half_height;
        x0 /= 2u;
        y0 /= 2u;
        uint side = 1u << (PYRAMID_LEVELS - level);
        for (uint i = (uint)get_local_id(0); i < side * side; i += (uint)get_local_size(0)) {
            uint x = x0 + i % side, y = y0 + i / side;
            if (x >= half_width || y >= half_height) continue;
            uint x1 = min(2u * x + 1u, width - 1u), y1 = min(2u * y + 1u, height - 1u);
            cells[y * half_width + x] = min(min(below[2u * y * width + 2u * x], below[2u * y * width + x1]),
                                            min(below[y1 * width + 2u * x], below[y1 * width + x1]));
        }
        barrier(CLK_GLOBAL_MEM_FENCE);
        width = half_width;
        height = half_height;
    }
}

// Per bin a height below which no point needs a list of triangles: the map decides what is below its texel, so beside
// the farthest point the lowest height of the bin's texels counts; but doubtful points need a list wherever they are.
__kernel void depth_after_map(uint frame_count, __constant const Projection* projections, __global const uint* map,
                              __global const uint* pyramid, __global const uint* doubtful, __global uint* heights) {
    uint bins_x = projections->bins_x, bins_y = projections->bins_y;
    uint width = projections->width, height = projections->height, size = 1u << projections->bin_log2;
    GN_FOR_EACH(i, frame_count * bins_x * bins_y) {
        uint bin = (uint)i % (bins_x * bins_y), frame = (uint)i / (bins_x * bins_y);
        bool is_seen = !projections[frame].map_disabled;
        uint lowest_cover = is_seen ? 0xFFFFFFFFu : 0u;
        if (is_seen) {
            uint x0 = bin % bins_x * size, y0 = bin / bins_x * size;
            for (uint y = y0; y < min(y0 + size, height); ++y)
                for (uint x = x0; x < min(x0 + size, width); ++x)
                    lowest_cover = min(lowest_cover, map[((size_t)frame * height + y) * width + x]);
        }
        heights[i] = min(max(pyramid[i], lowest_cover), doubtful[i]);
    }
}
