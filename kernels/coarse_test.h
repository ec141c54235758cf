// SPDX-License-Identifier: MIT
// The coarse test by the conservative map (Mizoguchi and Tokuyoshi, section 3.1): a point below its texel's height is
// in shadow for certain, unless it is doubtful (its own receiver might be what covers the texel; see facing.cl).
#ifndef GN_COARSE_TEST_H
#define GN_COARSE_TEST_H

#include "light_frame.h"

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

#endif
