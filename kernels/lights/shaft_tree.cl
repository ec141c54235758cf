// SPDX-License-Identifier: MIT
// The tree of a shaft's triangles (shaft.h), level by level from the leaves. Boxes are exact: minima and maxima of
// coordinates, compared as keys (float_to_key), so that flushed denormals cannot move a side.
#include "exact/cut_outs.clh"
#include "lights/shaft.h"

#ifdef GN_CPU
#define SHAFT_WIDTH SHAFT_WIDTH_ON_CPU
#else
#define SHAFT_WIDTH SHAFT_WIDTH_ON_GPU
#endif

// Triangles in the order of `numbers`; rows of one leaf lie together. Absent ones, and those with a vertex that is not
// finite, are NaN: no comparison with one is true. With cut-outs, so are clear ones, and masked ones have SHAFT_MASKED
// in their ids.
__kernel void shaft_leaves(const ShaftTree tree, const TrianglesLayout layout, __global const float* vertices,
                           __global const uint* numbers, __global float* leaves, __global uint* ids) {
    GN_FOR_EACH(i, tree.leaf_count * SHAFT_WIDTH) {
        bool is_present = i < tree.triangle_count;
        uint id = is_present ? numbers[i] : GN_NO_ID;
        Triangle t = load_triangle(vertices + layout.first_float, is_present ? id : 0u);
        bool is_masked = false;
#ifdef GN_CUT_OUTS
        if (is_present) {
            uint of_triangle = cut_out_class(triangles_of(vertices, layout), id);
            is_present = of_triangle != CUT_OUT_CLEAR;
            is_masked = of_triangle == CUT_OUT_MASKED;
        }
#endif
        if (!is_present || !is_finite_triangle(t)) t = (Triangle){(float3)(NAN), (float3)(NAN), (float3)(NAN)};
        ids[i] = is_masked ? id | SHAFT_MASKED : id;
        __global float* row = leaves + i / SHAFT_WIDTH * (SHAFT_LEAF_ROWS * SHAFT_WIDTH) + i % SHAFT_WIDTH;
        row[0] = t.a.x, row[SHAFT_WIDTH] = t.a.y, row[2u * SHAFT_WIDTH] = t.a.z;
        row[3u * SHAFT_WIDTH] = t.b.x, row[4u * SHAFT_WIDTH] = t.b.y, row[5u * SHAFT_WIDTH] = t.b.z;
        row[6u * SHAFT_WIDTH] = t.c.x, row[7u * SHAFT_WIDTH] = t.c.y, row[8u * SHAFT_WIDTH] = t.c.z;
    }
}

// The boxes of one level, `below` the number of the level's boxes: box i covers a leaf (level 0) or a node of the level
// below.
__kernel void shaft_boxes(const ShaftTree tree, uint level, __global const float* leaves, __global float* nodes) {
    uint boxes = tree.leaf_count;
    for (uint l = 0; l < level; ++l) boxes = (boxes + SHAFT_WIDTH - 1u) / SHAFT_WIDTH;
    uint padded = (boxes + SHAFT_WIDTH - 1u) / SHAFT_WIDTH * SHAFT_WIDTH;
    GN_FOR_EACH(i, padded) {
        for (uint c = 0; c < 3u; ++c) {
            // Nothing: no shaft meets it.
            uint low = float_to_key(INFINITY), high = float_to_key(-INFINITY);
            for (uint k = 0; i < boxes && k < SHAFT_WIDTH; ++k) {
                if (level == 0u) {
                    for (uint corner = 0; corner < 3u; ++corner) {
                        float x = leaves[(i * SHAFT_LEAF_ROWS + 3u * corner + c) * SHAFT_WIDTH + k];
                        if (isnan(x)) continue;
                        low = min(low, float_to_key(x));
                        high = max(high, float_to_key(x));
                    }
                } else {
                    size_t node = (tree.first_node[level - 1u] + i) * SHAFT_NODE_ROWS;
                    low = min(low, float_to_key(nodes[(node + c) * SHAFT_WIDTH + k]));
                    high = max(high, float_to_key(nodes[(node + 3u + c) * SHAFT_WIDTH + k]));
                }
            }
            size_t node = (tree.first_node[level] + i / SHAFT_WIDTH) * SHAFT_NODE_ROWS;
            nodes[(node + c) * SHAFT_WIDTH + i % SHAFT_WIDTH] = key_to_float(low);
            nodes[(node + 3u + c) * SHAFT_WIDTH + i % SHAFT_WIDTH] = key_to_float(high);
        }
    }
}
