// SPDX-License-Identifier: MIT
// The test of a triangle against a bin, shared by the stages that walk a triangle's bins (bins, conservative_map).
#ifndef GN_BIN_TEST_H
#define GN_BIN_TEST_H

#include "projection.h"
#include "triangle_setup.h"

static float highest_at_corners(float slope_x, float slope_y, float constant_term, float4 square) {
    float corner_x = slope_x > 0.0f ? square.z : square.x;
    float corner_y = slope_y > 0.0f ? square.w : square.y;
    return fma(slope_x, corner_x, fma(slope_y, corner_y, constant_term));
}

// Can the triangle block any point listed in bin (x, y)? No if it certainly misses the bin's square (an edge function
// below -margin at its best corner: conservative rasterization), or certainly lies below (farther than) the farthest
// point listed there, by its highest vertex or its plane's highest corner. `farthest` holds keys per bin, 0xFFFFFFFF
// where no point is listed.
static bool may_matter(const TriangleRecord* record, __constant const Projection* projection, uint x, uint y,
                       uint has_heights, __global const uint* farthest) {
    float size = (float)(1u << projection->bin_log2);
    float4 square = (float4)((float)x, (float)y, (float)(x + 1u), (float)(y + 1u)) * size;
    for (int i = 0; i < 3; ++i)
        if (highest_at_corners(record->edge_x[i], record->edge_y[i], record->edge_0[i], square) < -record->margin_edge)
            return false;
    if (!has_heights) return true;
    uint key = farthest[y * projection->bins_x + x];
    if (key == 0xFFFFFFFFu) return false;  // no point is listed here
    float lowest = key_to_float(key);
    float highest =
        highest_at_corners(record->plane_x, record->plane_y, record->plane_0, square) + record->margin_plane;
    return record->z_high >= lowest && !(highest < lowest);
}

// Bin i of a triangle's rectangle of bins, row by row.
static uint2 bin_of_rectangle(uint4 bins, uint i) {
    uint width = bins.z - bins.x + 1u;
    return (uint2)(bins.x + i % width, bins.y + i / width);
}
static uint bins_of_rectangle(uint4 bins) { return (bins.z - bins.x + 1u) * (bins.w - bins.y + 1u); }

// A huge triangle's chunks are numbered on from those of the huge triangles before it (`before` of them), and chunk n
// of all belongs to work-group n % groups. The first chunk of this triangle that is this group's; the next is `groups`
// on.
static uint first_chunk_of_group(uint before) {
    uint groups = (uint)get_num_groups(0);
    return ((uint)get_group_id(0) + groups - before % groups) % groups;
}

#endif
