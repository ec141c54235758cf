// SPDX-License-Identifier: MIT
// Contract of mip chains (Williams 1983, "Pyramidal Parametrics"): of a view's stored numbers, levels of half the
// texels per side each, down to a side of one texel.
//
// Level l has (width >> l) x (height >> l) texels. A texel is the mean of the texels of the level before that it lies
// over: 2 x 2 of them, or 3 along an odd side, the outer two by their share. Level 0 is the map itself. The others lie
// side by side in a second buffer, in the same view's rectangle as level 0 in the map: level 1 from column 0 on, then
// level 2 and so on; width / 2 + width / 4 + ... is less than width.
#ifndef GN_MIP_CHAIN_H
#define GN_MIP_CHAIN_H

#include "map_view.h"

// What a lookup or a filter sees of a level.
typedef struct MipLevel {
    size_t first;  // of its texel (0, 0), in a plane of its buffer
    uint row_stride, width, height;
} MipLevel;

// Width 0: the view has no such level.
static MipLevel mip_level(__global const MapView* view, uint level) {
    MipLevel found = {view->first_texel, view->row_stride, view->width >> level, view->height >> level};
    if (found.height == 0) found.width = 0;
    for (uint l = 1; l < level; ++l) found.first += view->width >> l;
    return found;
}

#endif
