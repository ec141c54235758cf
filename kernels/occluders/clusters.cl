// SPDX-License-Identifier: MIT
// Clusters: boxes around neighbouring triangles (made once for a scene that does not change), and their cull for a
// projection (in every run). The cull is that of triangle_bounds, applied to a box (cluster_boxes.clh): it drops only
// clusters behind the light, outside the grid, or farther from the light than every point that they could cover.
#include "exact/cut_outs.clh"
#include "lists/group_scan.clh"
#include "lists/morton.h"
#include "occluders/cluster_boxes.clh"

__kernel void make_clusters(ClusterParams params, __global const float* vertices, __global ClusterBoxes* boxes) {
    GN_FOR_EACH(block, (params.cluster_count + GN_LANES - 1u) / GN_LANES) {
        ClusterBoxes made;
        make_boxes(vertices + params.triangles.first_float, params.triangles.count, block * GN_LANES, &made);
        boxes[block] = made;
    }
}

__kernel void triangle_box(const TrianglesLayout layout, __global const float* vertices, __global uint* bounds) {
    float3 low = (float3)(INFINITY), high = (float3)(-INFINITY);
    uint count = 0;
    GN_FOR_EACH(i, layout.count) {
        Triangle t = load_triangle(vertices + layout.first_float, i);
        if (!is_finite_triangle(t)) continue;
        low = fmin(low, low_of(t));
        high = fmax(high, high_of(t));
        ++count;
    }
    if (count == 0u) return;
    atomic_min(&bounds[0], float_to_key(low.x));
    atomic_min(&bounds[1], float_to_key(low.y));
    atomic_min(&bounds[2], float_to_key(low.z));
    atomic_max(&bounds[3], float_to_key(high.x));
    atomic_max(&bounds[4], float_to_key(high.y));
    atomic_max(&bounds[5], float_to_key(high.z));
    atomic_add(&bounds[6], count);
}

// The code of the middle of the triangle's box. No sum here can overflow.
static uint code_of_middle(Triangle t, MortonGrid grid) {
    float3 half_low = low_of(t) * 0.5f, half_high = high_of(t) * 0.5f;
    return morton_code(morton_cell(grid, (half_low + half_high) * 0.5f, MORTON_BITS));
}

__kernel void cluster_codes(MortonGrid grid, ClusterParams params, __global const float* vertices, __global uint* codes,
                            __global uint* numbers) {
    GN_FOR_EACH(i, params.triangles.count) {
        Triangle t = load_triangle(vertices + params.triangles.first_float, (uint)i);
        codes[i] = is_finite_triangle(t) ? code_of_middle(t, grid) : GN_NO_ID;
        numbers[i] = (uint)i;
    }
}

__kernel void cluster_gather(ClusterParams params, __global const float* vertices, __global const uint* numbers,
                             __global float* gathered) {
    GN_FOR_EACH(i, params.triangles.count) {
        __global const float* from = vertices + params.triangles.first_float + 9 * (size_t)numbers[i];
        for (uint k = 0; k < 9u; ++k) gathered[9 * i + k] = from[k];
    }
#ifdef GN_CUT_OUTS
    Triangles triangles = triangles_of(vertices, params.triangles);
    __global uint* words = (__global uint*)(gathered + 9 * (size_t)triangles.count);
    GN_FOR_EACH(group, CUT_OUT_CLASS_WORDS(triangles.count) / 2u) {
        uint first = (uint)group * CUT_OUT_GROUP, classes = 0u;
        for (uint k = 0; k < min(CUT_OUT_GROUP, triangles.count - first); ++k)
            classes |= cut_out_class(triangles, numbers[first + k]) << 2u * k;
        words[2 * group] = classes;
    }
#endif
}

// Lists the clusters that survive the cull; counts the triangles of the dropped clusters as triangle_bounds would.
__kernel void cull_clusters(ClusterParams params, __constant const Projection* projection,
                            __global const ClusterBoxes* boxes, __global const uint* pyramid, __global uint* listed,
                            __global FrameCounters* counters) {
    __local uint sum;
    uint outside = 0, too_far = 0, triangles_outside = 0, triangles_not_finite = 0;
    uint blocks = projection->active_points == 0u ? 0u : (params.cluster_count + GN_LANES - 1u) / GN_LANES;
    GN_FOR_EACH(block, blocks) {
        LaneInt clusters = (LaneInt)((int)block * GN_LANES) + LANE_INDEX;
        ClusterBoxes taken = boxes[block];
        LaneInt present = LANE_COMPARE(taken.low[0], <=, taken.high[0]);
        LaneInt far, visible = visible_boxes(&taken, present, projection, pyramid, params.has_pyramid != 0u, &far);
        outside += count_lanes(present & ~visible & ~far);
        too_far += count_lanes(far);
        LaneInt not_finite = taken.not_finite;
        uint slot = 0, wanted = count_lanes(visible);
        if (wanted != 0u) slot = atomic_add(&counters->clusters_listed, wanted);
        for (int lane = 0; lane < GN_LANES; ++lane) {
            uint cluster = (uint)LANE_OF_INT(clusters, lane);
            if (LANE_OF_INT(visible, lane)) {
                listed[slot++] = cluster;
            } else if (cluster < params.cluster_count) {
                uint mine = min(params.triangles.count - cluster * CLUSTER_TRIANGLES, CLUSTER_TRIANGLES);
                triangles_not_finite += (uint)LANE_OF_INT(not_finite, lane);
                triangles_outside += mine - (uint)LANE_OF_INT(not_finite, lane);
            }
        }
    }
    add_in_group(outside, &sum, &counters->clusters_outside);
    add_in_group(too_far, &sum, &counters->clusters_too_far);
    add_in_group(triangles_not_finite, &sum, &counters->not_finite);
    add_in_group(triangles_outside, &sum, &counters->outside);
}
