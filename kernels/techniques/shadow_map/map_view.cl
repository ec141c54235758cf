// SPDX-License-Identifier: MIT
// Fills the tables of texel centres of all views: where each column and row of texels lies before the warp.
#include "techniques/shadow_map/map_view.h"

__kernel void map_view_centres(MapSet set, __global const MapView* views, __global float* tables) {
    for (uint v = 0; v < set.view_count; ++v) {
        __global const MapView* view = views + v;
        GN_FOR_EACH(i, view->width + view->height) {
            uint axis = i < view->width ? 0u : 1u;
            float at = axis == 0u ? ((float)i + 0.5f) / (float)view->width
                                  : ((float)(i - view->width) + 0.5f) / (float)view->height;
            tables[view->centres_first + i] = map_unwarp(view, tables, axis, at);
        }
    }
}
