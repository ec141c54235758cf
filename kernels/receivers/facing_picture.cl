// SPDX-License-Identifier: MIT
// The facing stage (facing.h) on a CPU for a camera's picture under a directional light. A file of its own, so that a
// first start compiles none of the other kernels.
#include "receivers/facing_blocks.clh"

// face_cached() for such a picture. It loads coordinates in the order of the frame's axes, and tests no condition that
// is true for all blocks (.71 of the time).
GN_NOINLINE_ON_CPU void face_picture_directional(FacingParams params, const FacingBuffers* buffers, FacingSums* sums,
                                                 ItemRange items) {
    FacingBuffers to = *buffers;
    FacingSums all = *sums;
    PointsLayout layout = params.layout;
    LightFrame frame = params.light_frame;
    __global const float* coordinates = to.positions + layout.first;
    __global const float* along_x = coordinates + (size_t)layout.coordinate_stride * frame.axis_x;
    __global const float* along_y = coordinates + (size_t)layout.coordinate_stride * frame.axis_y;
    __global const float* along_z = coordinates + (size_t)layout.coordinate_stride * frame.axis_z;
    GN_FOR_EACH_OF(block, items) {
        BlockPlace place = place_in_picture(layout.picture_width, block);
        PointBlock points;
        points.x = load_strided(along_x, 1u, place);
        LaneInt open = LANE_COMPARE(LANES_SIZE_BITS(points.x), <, (LaneInt)(BITS_OF_INFINITY));
        if (LANES_ANY(open)) {
            points.y = load_strided(along_y, 1u, place);
            points.z = load_strided(along_z, 1u, place);
            open = present_lanes(points);
        }
        all.minus_absent += ~open;
        LaneInt backfacing = (LaneInt)(0);
        if (LANES_ANY(open)) {
            LaneInt ids = LANES_AS_INT(load_strided((__global const float*)to.receivers, 1u, place));
            backfacing = cached_backfacing(to.cache, to.vertices, ids, open & lanes_below(ids, params.triangles.count),
                                           params.triangles.count, layout, light_of(frame), &all.exact);
            open &= ~backfacing;
        }
        all.minus_backfacing += backfacing;
        store_at(visibility_of_lanes(backfacing, open), to.visibility, place);
        if (!LANES_ANY(open)) {
            to.blocks[block].frame = BLOCK_IN_NO_FRAME;
            continue;
        }
        PointBlock values = {points.x - frame.shear_x * points.z, points.y - frame.shear_y * points.z,
                             points.z * frame.sign_z};
        float8 span = span_of_lanes(values, values, open);
        all.bounds.span = min_of_two(span, all.bounds.span);
        all.bounds.minus_count += open;
        span.s6 = as_float(0u);
        span.s7 = as_float(LANES_ANY(~open) ? 0u : BLOCK_ALL_OPEN);
        vstore8(span, 0, (__global float*)&to.blocks[block]);
    }
    *sums = all;
}

FACING_KERNEL(facing_picture_directional, face_picture_directional)
