// SPDX-License-Identifier: MIT
// The facing stage (facing.h) on a GPU, where a block is one point: by each point, by a cache of all triangles, or by a
// float filter with an exact fallback.
#include "receivers/facing_blocks.clh"

// Fills the cache of facing_cached.
__kernel void facing_triangles(FacingParams params, __global const float* vertices, __global uchar* cache,
                               __global FrameCounters* counters) {
    uint exact = 0;
    GN_FOR_EACH(i, params.triangles.count) {
        TriangleBlock t = load_triangles(vertices + params.triangles.first_float, (uint)i, params.triangles.count);
        ReceiverFacing found = classify_triangles(&t, -1, 0, params.layout, light_of(params.light_frame), &exact);
        cache[i] = (uchar)-found.backfacing;
    }
    if (exact != 0) atomic_add(&counters->facing_exact, exact);
}

// The visibility of a point between the two kernels below. Their points are no footprints, and none may shadow itself.
#define VISIBILITY_UNDECIDED 4.0f

static void face_filter(FacingParams params, const FacingBuffers* buffers, FacingSums* sums, ItemRange items) {
    FacingBuffers to = *buffers;
    GN_FOR_EACH_OF(point, items) {
        FacingBlock at;
        if (!load_facing_block(params, to, point, &at, sums)) continue;
        LaneInt ids, on_triangle = load_receivers(params, to, point, at.present, &ids);
        if (on_triangle) {
            LaneInt undecided;
            TriangleBlock t = load_triangles_of(to.vertices, ids, on_triangle);
            at.backfacing = filter_backfacing(&t, on_triangle, params.layout, light_of(params.light_frame), &undecided);
            if (undecided) {
                uint slot = atomic_inc(&to.undecided[0]);
                if (slot < UNDECIDED_CAPACITY) to.undecided[1 + slot] = (uint)point;
                to.visibility[point] = VISIBILITY_UNDECIDED;
                continue;
            }
        }
        open_facing_block(params, 0u, to, point, &at, sums);
    }
}

// If the list had no room for all undecided points, this pass finds the undecided points by their visibility.
static void face_exact_fallback(FacingParams params, const FacingBuffers* buffers, FacingSums* sums, ItemRange items) {
    FacingBuffers to = *buffers;
    bool all_are_listed = to.undecided[0] <= UNDECIDED_CAPACITY;
    if (all_are_listed) items = item_range(to.undecided[0]);
    GN_FOR_EACH_OF(i, items) {
        size_t point = all_are_listed ? to.undecided[1 + i] : i;
        if (!all_are_listed && to.visibility[point] != VISIBILITY_UNDECIDED) continue;
        FacingBlock at;
        if (!load_facing_block(params, to, point, &at, sums)) continue;
        LaneInt ids, on_triangle = load_receivers(params, to, point, at.present, &ids);
        at.backfacing = classify_receivers(ids, on_triangle, 0, params.layout, light_of(params.light_frame),
                                           to.vertices, &sums->exact)
                            .backfacing;
        open_facing_block(params, 0u, to, point, &at, sums);
        // Each point has its own bounds: the list's order varies, and margins must not depend on it.
        flush_bounds(params.light_frame, &sums->bounds, to.shared);
        start_bounds(&sums->bounds, 0u);
    }
}

FACING_KERNEL(facing, face_each)
FACING_KERNEL(facing_cached, face_cached)
FACING_KERNEL(facing_cached_footprints, face_cached_footprints)
FACING_KERNEL(facing_filter, face_filter)
FACING_KERNEL(facing_exact_fallback, face_exact_fallback)
