// SPDX-License-Identifier: MIT
// The coarse test by the conservative map (Mizoguchi and Tokuyoshi, section 3.1): a point below its texel's height is
// in shadow for certain, unless it is doubtful (its own receiver might be what covers the texel; see facing.cl).
#ifndef GN_COARSE_TEST_H
#define GN_COARSE_TEST_H

#include "light_frame.h"

// Which of these lanes does the map decide? `map` is that of the frame.
static LaneInt lanes_below_map(__constant const Projection* projection, PointBlock places, LaneFloat state,
                               LaneInt lanes, __global const uint* map) {
    lanes &= ~doubtful_lanes(state);
    if (projection->indistinct || projection->map_unseen) return (LaneInt)(0);
    LaneInt texels = texel_indices(places.y, projection->height) * (int)projection->width +
                     texel_indices(places.x, projection->width);
    // Other lanes' places may be anything; texel_indices keeps them inside.
    LaneInt covered = LANES_GATHER((__global const int*)map, texels) ^ (LaneInt)((int)0x80000000);  // key_to_order()
    return lanes & LANE_COMPARE(lanes_in_order(places.z), <, covered);
}

#endif
