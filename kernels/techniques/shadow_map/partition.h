// SPDX-License-Identifier: MIT
// Partitions: how the view volume is shared out to several maps.
//
// Slices of depth follow Zhang et al. (2006; survey 69): with m slices of [n, f], slice i ends at
//   lambda n (f/n)^(i/m) + (1 - lambda) (n + (f - n) i/m).
// n and f are the camera's planes (parallel-split), or the least and greatest depth of the points, found on the device
// without a trip through the host (sample distribution: Lauritzen, Salvi, Lefohn 2011; survey 85-88).
// A point belongs to the slice its own depth lies in, whatever its neighbours: no seam can come of it (the survey's
// remedy, 82-83, repairs hardware derivatives, which a kernel does not have). Filters reach over a slice's end;
// `overlap` widens what each map holds. What can be seen is that texels change their size at once; with `blend` the
// next slice takes over evenly within its overlap, where its map holds the points already.
#ifndef GN_SHADOW_PARTITION_H
#define GN_SHADOW_PARTITION_H

#include "techniques/shadow_map/projection.h"

#ifndef __cplusplus

// End of slice i of m; i = 0 is where the first begins.
static float split_depth(float near_depth, float far_depth, float lambda, uint i, uint m) {
    float items = (float)i / (float)m;
    if (i == 0) return near_depth;
    if (i == m) return far_depth;
    float logarithmic = near_depth * exp2(items * log2(far_depth / near_depth));
    float uniform_ = near_depth + (far_depth - near_depth) * items;
    return lambda * logarithmic + (1.0f - lambda) * uniform_;
}

static bool is_empty(const KeyBounds* bounds) { return bounds->least[0] == 0xFFFFFFFFu; }
static float least_of(const KeyBounds* bounds, uint i) { return key_to_float(bounds->least[i]); }
static float greatest_of(const KeyBounds* bounds, uint i) { return -key_to_float(bounds->least[i + 4]); }

#endif
#endif
