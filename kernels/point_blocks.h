// SPDX-License-Identifier: MIT
// Shading points as the kernels walk them: unsorted, in blocks of GN_LANES neighbours (16 on a CPU, one on a GPU), a
// coordinate in one vector each. The neighbours are 4 x 4 pixels where the points are a picture's, else 16 in a row;
// and what visibility says of a point that is still to be decided.
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
    if (layout.picture_width != 0u) return (LaneInt)(-1);  // a picture is whole blocks (points.h)
    return LANE_COMPARE((LaneInt)((int)min(layout.count - (uint)block * GN_LANES, (uint)GN_LANES)), >, LANE_INDEX);
}

#if GN_LANES == 1

static size_t point_of_lane(PointsLayout layout, size_t block, int lane) { return block; }
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

// Where a block is: lane i is point first + i / 4 * row + i % 4.
typedef struct BlockPlace {
    size_t first, row;
    uint count;  // of lanes that hold a point
} BlockPlace;

static BlockPlace place_in_picture(uint picture_width, size_t block) {
    uint blocks_x = picture_width / 4u;
    BlockPlace place = {4u * ((uint)block / blocks_x * (size_t)picture_width + (uint)block % blocks_x), picture_width,
                        GN_LANES};
    return place;
}
static BlockPlace place_of_block(PointsLayout layout, size_t block) {
    if (layout.picture_width != 0u) return place_in_picture(layout.picture_width, block);
    BlockPlace place = {block * GN_LANES, 4u, min(layout.count - (uint)block * GN_LANES, (uint)GN_LANES)};
    return place;
}
static size_t point_of_lane(PointsLayout layout, size_t block, int lane) {
    BlockPlace place = place_of_block(layout, block);
    return place.first + (size_t)(lane / 4) * place.row + (size_t)(lane % 4);
}

static float4 load_four(__global const float* values, size_t stride) {
    if (stride == 1u) return vload4(0, values);
    return (float4)(values[0], values[stride], values[2u * stride], values[3u * stride]);
}
// Values of lanes that hold no point are 0.
static LaneFloat load_strided(__global const float* values, size_t stride, BlockPlace place) {
    values += place.first * stride;
    size_t row = place.row * stride;
    if (place.count == GN_LANES)
        return (float16)(load_four(values, stride), load_four(values + row, stride),
                         load_four(values + 2u * row, stride), load_four(values + 3u * row, stride));
    LaneFloat lanes = 0.0f;
    for (uint lane = 0; lane < place.count; ++lane) LANE_OF_FLOAT(lanes, lane) = values[lane * stride];
    return lanes;
}
// Twice four points of three floats each, one after the other.
static void load_eight_points(__global const float* low, __global const float* high, float8* x, float8* y, float8* z) {
    float8 a = (float8)(vload4(0, low), vload4(0, high));  // x y z x
    float8 b = (float8)(vload4(1, low), vload4(1, high));  // y z x y
    float8 c = (float8)(vload4(2, low), vload4(2, high));  // z x y z
    *x = (float8)(a.s0, a.s3, b.s2, c.s1, a.s4, a.s7, b.s6, c.s5);
    *y = (float8)(a.s1, b.s0, b.s3, c.s2, a.s5, b.s4, b.s7, c.s6);
    *z = (float8)(a.s2, b.s1, c.s0, c.s3, a.s6, b.s5, c.s4, c.s7);
}
static PointBlock load_block(__global const float* positions, PointsLayout layout, size_t block) {
    __global const float* first = positions + layout.first;
    BlockPlace place = place_of_block(layout, block);
    PointBlock points;
    if (layout.point_stride == 3u && layout.coordinate_stride == 1u && place.count == GN_LANES) {
        __global const float* at = first + place.first * 3u;
        size_t row = place.row * 3u;
        float8 x, y, z, more_x, more_y, more_z;
        load_eight_points(at, at + row, &x, &y, &z);
        load_eight_points(at + 2u * row, at + 3u * row, &more_x, &more_y, &more_z);
        points.x = (float16)(x, more_x);
        points.y = (float16)(y, more_y);
        points.z = (float16)(z, more_z);
        return points;
    }
    points.x = load_strided(first, layout.point_stride, place);
    points.y = load_strided(first + layout.coordinate_stride, layout.point_stride, place);
    points.z = load_strided(first + 2 * (size_t)layout.coordinate_stride, layout.point_stride, place);
    return points;
}
static LaneFloat load_lanes(__global const float* values, PointsLayout layout, size_t block) {
    return load_strided(values, 1, place_of_block(layout, block));
}
static LaneInt load_lane_ids(__global const uint* ids, PointsLayout layout, size_t block) {
    return LANES_AS_INT(load_lanes((__global const float*)ids, layout, block));
}
static void store_at(LaneFloat lanes, __global float* values, BlockPlace place) {
    values += place.first;
    if (place.count == GN_LANES) {
        vstore4(lanes.lo.lo, 0, values);
        vstore4(lanes.lo.hi, 0, values + place.row);
        vstore4(lanes.hi.lo, 0, values + 2u * place.row);
        vstore4(lanes.hi.hi, 0, values + 3u * place.row);
    } else {
        for (uint lane = 0; lane < place.count; ++lane) values[lane] = LANE_OF_FLOAT(lanes, lane);
    }
}
static void store_lanes(LaneFloat lanes, __global float* values, PointsLayout layout, size_t block) {
    store_at(lanes, values, place_of_block(layout, block));
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

static LaneInt largest_size_bits(PointBlock p) {
    return max(max(LANES_SIZE_BITS(p.x), LANES_SIZE_BITS(p.y)), LANES_SIZE_BITS(p.z));
}
static LaneInt present_lanes(PointBlock points) {
    return LANE_COMPARE(largest_size_bits(points), <, (LaneInt)(BITS_OF_INFINITY));
}

#endif
