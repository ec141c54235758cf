// SPDX-License-Identifier: MIT
// Shading points as the kernels walk them: unsorted, in blocks of GN_LANES neighbours (16 on a CPU, one on a GPU), a
// coordinate in one vector each; and what visibility says of a point that is still to be decided.
#ifndef GN_POINT_BLOCKS_H
#define GN_POINT_BLOCKS_H

#include "lanes.h"
#include "points.h"

typedef struct PointBlock {
    LaneFloat x, y, z;
} PointBlock;

static uint block_count(PointsLayout layout) { return layout.count / GN_LANES + (layout.count % GN_LANES != 0u); }

// The lanes of a block that hold a point.
static LaneInt valid_lanes(PointsLayout layout, size_t block) {
    return LANE_COMPARE((LaneInt)((int)min(layout.count - (uint)block * GN_LANES, (uint)GN_LANES)), >, LANE_INDEX);
}

#if GN_LANES == 1

static PointBlock load_block(__global const float* positions, PointsLayout layout, size_t block) {
    float3 p = load_point(positions, layout, block);
    PointBlock points = {p.x, p.y, p.z};
    return points;
}
static LaneFloat load_lanes(__global const float* values, PointsLayout layout, size_t block) { return values[block]; }
static LaneInt load_lane_ids(__global const uint* ids, PointsLayout layout, size_t block) { return (int)ids[block]; }
static void store_lanes(LaneFloat lanes, __global float* values, PointsLayout layout, size_t block) {
    values[block] = lanes;
}

#else

// Values of lanes that hold no point are 0.
static LaneFloat load_strided(__global const float* values, size_t stride, uint count) {
    if (stride == 1u && count == GN_LANES) return vload16(0, values);
    if (count == GN_LANES) return LANES_STRIDED(values, stride);
    LaneFloat lanes = 0.0f;
    for (uint lane = 0; lane < count; ++lane) LANE_OF_FLOAT(lanes, lane) = values[lane * stride];
    return lanes;
}
static uint lanes_in_block(PointsLayout layout, size_t block) {
    return min(layout.count - (uint)block * GN_LANES, (uint)GN_LANES);
}
static PointBlock load_block(__global const float* positions, PointsLayout layout, size_t block) {
    __global const float* first = positions + layout.first + block * GN_LANES * layout.point_stride;
    uint count = lanes_in_block(layout, block);
    PointBlock points;
    points.x = load_strided(first, layout.point_stride, count);
    points.y = load_strided(first + layout.coordinate_stride, layout.point_stride, count);
    points.z = load_strided(first + 2 * (size_t)layout.coordinate_stride, layout.point_stride, count);
    return points;
}
static LaneFloat load_lanes(__global const float* values, PointsLayout layout, size_t block) {
    return load_strided(values + block * GN_LANES, 1, lanes_in_block(layout, block));
}
static LaneInt load_lane_ids(__global const uint* ids, PointsLayout layout, size_t block) {
    return LANES_AS_INT(load_lanes((__global const float*)ids, layout, block));
}
static void store_lanes(LaneFloat lanes, __global float* values, PointsLayout layout, size_t block) {
    uint count = lanes_in_block(layout, block);
    values += block * GN_LANES;
    if (count == GN_LANES)
        vstore16(lanes, 0, values);
    else
        for (uint lane = 0; lane < count; ++lane) values[lane] = LANE_OF_FLOAT(lanes, lane);
}

#endif

static float3 lane_point(PointBlock points, int lane) {
    return (float3)(LANE_OF_FLOAT(points.x, lane), LANE_OF_FLOAT(points.y, lane), LANE_OF_FLOAT(points.z, lane));
}

static LaneFloat lanes_row_dot(__constant const float* row, PointBlock d) {
    return fma((LaneFloat)(row[0]), d.x,
               fma((LaneFloat)(row[1]), d.y, fma((LaneFloat)(row[2]), d.z, (LaneFloat)(row[3]))));
}

// Visibility while a run goes on: 0 and 1 are final, anything from VISIBILITY_OPEN on is not. DOUBTFUL: the point's own
// receiver would block it, so that a cover which does not say whose it is (the conservative map) must not decide.
#define VISIBILITY_OPEN 2.0f
#define VISIBILITY_DOUBTFUL 3.0f

// Lanes past the last point are 0 in `visibility` (load_lanes) and so never open.
static LaneInt open_lanes(LaneFloat visibility) { return LANE_COMPARE(visibility, >=, (LaneFloat)(VISIBILITY_OPEN)); }
static LaneInt doubtful_lanes(LaneFloat visibility) {
    return LANE_COMPARE(visibility, >=, (LaneFloat)(VISIBILITY_DOUBTFUL));
}

static LaneInt present_lanes(PointBlock points) {
    return LANE_COMPARE(fabs(points.x), <=, (LaneFloat)(FLT_MAX)) &
           LANE_COMPARE(fabs(points.y), <=, (LaneFloat)(FLT_MAX)) &
           LANE_COMPARE(fabs(points.z), <=, (LaneFloat)(FLT_MAX));
}

#endif
