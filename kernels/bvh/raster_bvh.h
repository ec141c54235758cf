// SPDX-License-Identifier: MIT
// Contract of the BVH over an implicit raster (simd/points.h). Its nodes are those of wide_bvh.h. A leaf is a patch of
// squares and is nowhere stored: leaf row * columns of patches + column. A walk writes the leaf that it visits into a
// slot of its own work-item, or on a GPU of its own work-group.
#pragma once

#include "bvh/wide_bvh.h"

#define PATCH_COLUMNS 4u
#define PATCH_ROWS_ON_CPU 2u
#define PATCH_ROWS_ON_GPU 4u
// Floats of a slot: the rows of a leaf, and its ids.
#define RASTER_SLOT_ROWS (BVH_LEAF_ROWS + 1u)

// raster_nodes makes the nodes of one level, each over children_across x children_down children that lie side by side.
GN_STRUCT_BEGIN(RasterBvhParams)
    uint first, columns, rows;                    // of the nodes
    uint child_first, child_columns, child_rows;  // of their children
    uint children_across, children_down;
    uint are_leaves;  // the children
    uint padding;
GN_STRUCT_END(RasterBvhParams, 40)
