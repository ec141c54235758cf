// SPDX-License-Identifier: MIT
// Makes the nodes of the BVH over an implicit raster (raster_bvh.h), one level after the other from the lowest one.
#include "bvh/bvh_rows.clh"
#include "bvh/raster_bvh.h"

#ifdef GN_CPU
#define PATCH_ROWS PATCH_ROWS_ON_CPU
#else
#define PATCH_ROWS PATCH_ROWS_ON_GPU
#endif

// The box of the finite vertices of a patch; empty if it has none.
static void box_of_patch(__global const float* raster, uint row, uint column, float3* low, float3* high) {
    __global const RasterHead* head = (__global const RasterHead*)raster;
    for (uint r = row; r <= min(row + PATCH_ROWS, head->rows - 1u); ++r)
        for (uint c = column; c <= min(column + PATCH_COLUMNS, head->columns - 1u); ++c) {
            float3 p = raster_vertex(raster, r, c, 0u);
            if (!is_present(p)) continue;
            *low = fmin(*low, p);
            *high = fmax(*high, p);
        }
}

static void box_of_node(__global const float* node, float3* low, float3* high) {
    for (uint k = 0; k < BVH_WIDTH; ++k, ++node) {
        *low = fmin(*low, (float3)(node[0], node[BVH_WIDTH], node[2u * BVH_WIDTH]));
        *high = fmax(*high, (float3)(node[3u * BVH_WIDTH], node[4u * BVH_WIDTH], node[5u * BVH_WIDTH]));
    }
}

__kernel void raster_nodes(const RasterBvhParams params, __global const float* raster, __global float* nodes) {
    const size_t floats = BVH_NODE_ROWS * BVH_WIDTH;
    GN_FOR_EACH(i, params.columns * (size_t)params.rows) {
        uint across = (uint)(i % params.columns) * params.children_across;
        uint down = (uint)(i / params.columns) * params.children_down;
        __global float* node = nodes + (params.first + i) * floats;
        for (uint k = 0; k < BVH_WIDTH; ++k) {
            uint column = across + k % params.children_across, row = down + k / params.children_across, child = 0u;
            float3 low = (float3)(INFINITY), high = (float3)(-INFINITY);
            if (column < params.child_columns && row < params.child_rows) {
                child = params.child_first + row * params.child_columns + column;
                if (params.are_leaves != 0u)
                    box_of_patch(raster, row * PATCH_ROWS, column * PATCH_COLUMNS, &low, &high);
                else
                    box_of_node(nodes + child * floats, &low, &high);
            }
            write_box(node, k, low, high);
            ((__global uint*)node)[BVH_CODES + k] = params.are_leaves != 0u ? BVH_LEAF | child : child;
        }
    }
}
