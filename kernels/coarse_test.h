// SPDX-License-Identifier: MIT
// The coarse test by the conservative map (Mizoguchi and Tokuyoshi, section 3.1): a point below its texel's height is
// in shadow for certain, unless it is doubtful (its own receiver might be what covers the texel; see facing.cl).
#ifndef GN_COARSE_TEST_H
#define GN_COARSE_TEST_H

#include "block_bounds.h"

// The heights of the points' texels, in order (lanes_in_order). `map` is that of the frame.
static LaneInt covers_of(__constant const Projection* projection, PointBlock places, __global const uint* map) {
    LaneInt texels = texel_indices(places.y, projection->height) * (int)projection->width +
                     texel_indices(places.x, projection->width);
    // Other lanes' places may be anything; texel_indices keeps them inside.
    return LANES_GATHER((__global const int*)map, texels) ^ (LaneInt)((int)0x80000000);  // key_to_order()
}

static bool map_is_seen(__constant const Projection* projection) {
    return !projection->indistinct && !projection->map_unseen;
}

// Which of these lanes does the map decide?
static LaneInt lanes_below_map(__constant const Projection* projection, PointBlock places, LaneFloat state,
                               LaneInt lanes, __global const uint* map) {
    lanes &= ~doubtful_lanes(state);
    if (!map_is_seen(projection)) return (LaneInt)(0);
    return lanes & LANE_COMPARE(lanes_in_order(places.z), <, covers_of(projection, places, map));
}

// What the map says of a block's points by its bounds alone. Each point's texel is one of the box's, and its height
// between the box's: where the greatest is below all these covers every point is below its own, and where the least is
// below none, no point is.
#define MAP_MAY_HIDE 0u  // nothing
#define MAP_HIDES_ALL 1u
#define MAP_HIDES_NONE 2u
#define BLOCK_TEXELS 16u  // a block that spans more is left to its points

static uint map_hides(const BlockGrid* grid, __constant const Projection* projection, const BlockBounds* block,
                      __global const uint* map) {
    if (grid->indistinct || block->frame == BLOCK_IN_FRAMES) return MAP_MAY_HIDE;
    BlockBox box = block_box(grid, projection, block);
    if ((box.x1 - box.x0 + 1u) * (box.y1 - box.y0 + 1u) > BLOCK_TEXELS) return MAP_MAY_HIDE;
    // The corners first, without a loop: most boxes have no other texels.
    uint right = box.x1 - box.x0, rows = box.y1 - box.y0, width = projection->width;
    __global const uint* covers = map + box.y0 * width + box.x0;
    uint corners[4] = {covers[0], covers[right], covers[rows * width], covers[rows * width + right]};
    uint least = min(min(corners[0], corners[1]), min(corners[2], corners[3]));
    uint greatest = max(max(corners[0], corners[1]), max(corners[2], corners[3]));
    if (max(right, rows) > 1u)
        for (uint y = 0; y <= rows; ++y)
            for (uint x = 0; x <= right; ++x) {
                uint cover = covers[y * width + x];
                least = min(least, cover);
                greatest = max(greatest, cover);
            }
    // As floats, since a box may say -0 of points at 0. A texel that nothing covers has 0: NaN, above nothing.
    if (greatest == 0u || box.z0 >= key_to_float(greatest)) return MAP_HIDES_NONE;
    return !(block->flags & BLOCK_DOUBTFUL) && box.z1 < key_to_float(least) ? MAP_HIDES_ALL : MAP_MAY_HIDE;
}

#endif
