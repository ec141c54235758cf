// SPDX-License-Identifier: MIT
// Contract of the light frame: the light's grid, fitted to the open points.
#pragma once

#include "simd/projection.h"

// A light's frames before the fit. A directional light has one frame. A point light has POINT_LIGHT_FRAMES, the faces
// of a cube around it: the members describe the first face, and face_of() makes the others.
GN_STRUCT_BEGIN(LightFrame)
    float light[4];          // homogeneous: w = 0 minus the direction of travel, w = 1 the position
    uint axis_x, axis_y;     // world coordinates that span the grid; axis_x, axis_y, axis_z are a cyclic order
    uint axis_z;             // world coordinate along which heights are measured
    float sign_z;            // +1 or -1: towards the light (parallel); the face's side of the light (perspective)
    float shear_x, shear_y;  // D_x / D_z, D_y / D_z of the light direction, each at most 1 in magnitude (parallel)
    uint perspective;        // 1: only points in this face's pyramid belong to the frame
    uint width, height;      // texels
    uint bin_log2, bins_x, bins_y;
GN_STRUCT_END(LightFrame, 64)

#define POINT_LIGHT_FRAMES 6u

// The grid does not separate points that are spread beyond this (beyond it floats overflow).
#define LARGEST_EXTENT 1.0e30f
// Nor points nearer to a point light than this, after scaling the farthest to within 2 (floats underflow).
#define SMALLEST_W 1.0e-15f

// Bounds of the points of a frame: keys of the highest values and of minus the lowest ones, so that atomic maxima
// collect them and zero bytes mean "no point".
#define BOUNDED_VALUES 5
GN_STRUCT_BEGIN(PointBounds)
    // Values 0 and 1 are grid x and y (grid_values()); 2 to 4 bound world x, y, z (in perspective only 4 is used, by
    // W).
    uint highest[BOUNDED_VALUES];
    uint minus_lowest[BOUNDED_VALUES];
    uint count;
GN_STRUCT_END(PointBounds, 44)
#define BOUNDS_WORDS 11

#ifndef __cplusplus

#include "simd/point_blocks.clh"

static uint frame_count_of(LightFrame light_frame) { return IS_PERSPECTIVE(light_frame) ? POINT_LIGHT_FRAMES : 1u; }

// Frame `face` of a light: the faces are +x, -x, +y, -y, +z, -z.
static LightFrame face_of(LightFrame light_frame, uint face) {
    LightFrame frame = light_frame;
    if (IS_PERSPECTIVE(frame)) {
        frame.axis_z = face / 2u;
        frame.axis_x = (frame.axis_z + 1u) % 3u;
        frame.axis_y = (frame.axis_z + 2u) % 3u;
        frame.sign_z = face % 2u == 0u ? 1.0f : -1.0f;
    }
    return frame;
}

// The frame of each point, or POINT_LIGHT_FRAMES if it has no frame. Parallel: 0. Perspective: the face of the largest
// difference to the light (first of equals), on its side. A point at the light itself has no frame: no occluder lies
// strictly between.
static LaneInt frames_of(LightFrame light_frame, PointBlock points) {
    if (!IS_PERSPECTIVE(light_frame)) return (LaneInt)(0);
    LaneFloat light_x = light_frame.light[0], light_y = light_frame.light[1], light_z = light_frame.light[2];
    LaneFloat x = points.x - light_x, y = points.y - light_y, z = points.z - light_z;
    LaneFloat size_x = fabs(x), size_y = fabs(y), size_z = fabs(z);
    LaneInt z_over_x = ~LANE_COMPARE(size_x, >=, size_z), z_over_y = ~LANE_COMPARE(size_y, >=, size_z);
    LaneInt along_x = LANE_COMPARE(size_x, >=, size_y) & ~z_over_x;
    LaneInt along_y = ~LANE_COMPARE(size_x, >=, size_y) & ~z_over_y;
    LaneFloat along = LANES_SELECT(LANES_SELECT(z, y, along_y), x, along_x);
    LaneInt face = LANES_SELECT(LANES_SELECT((LaneInt)(4), (LaneInt)(2), along_y), (LaneInt)(0), along_x);
    face -= LANE_COMPARE(along, <, (LaneFloat)(0.0f));
    // Where denormals are flushed, a difference of unlike positions can vanish. Such a point goes to the first frame
    // and makes the heights there indistinct.
    LaneInt none = LANE_COMPARE(along, ==, (LaneFloat)(0.0f));
    LaneInt unlike = LANE_COMPARE(LANES_AS_INT(points.x), !=, LANES_AS_INT(light_x)) |
                     LANE_COMPARE(LANES_AS_INT(points.y), !=, LANES_AS_INT(light_y)) |
                     LANE_COMPARE(LANES_AS_INT(points.z), !=, LANES_AS_INT(light_z));
    return LANES_SELECT(face, LANES_SELECT((LaneInt)(POINT_LIGHT_FRAMES), (LaneInt)(0), unlike), none);
}

// Grid positions of points, X and Y in texels, and Z. In perspective the division may be off by 3 ulp. Every kernel
// computes grid positions by this function, so that on one device they agree to the bit.
static PointBlock project_points(__constant const Projection* projection, PointBlock points) {
    PointBlock d = {points.x - projection->center[0], points.y - projection->center[1],
                    points.z - projection->center[2]};
    PointBlock h = {lanes_row_dot(projection->row_x, d), lanes_row_dot(projection->row_y, d),
                    lanes_row_dot(projection->row_z, d)};
    if (IS_PERSPECTIVE(*projection)) {
        h.x = h.x / h.z;
        h.y = h.y / h.z;
        h.z = (LaneFloat)(1.0f) / h.z;
    }
    if (projection->indistinct) {
        h.x = h.y = (LaneFloat)(0.5f);
        h.z = (LaneFloat)(0.0f);
    }
    return h;
}

static LaneInt texel_indices(LaneFloat coordinate, uint count) {
    return clamp(LANES_TO_INT(coordinate), (LaneInt)(0), (LaneInt)((int)count - 1));
}
static LaneInt bins_of(__constant const Projection* projection, PointBlock in_grid) {
    LaneInt x = texel_indices(in_grid.x, projection->width) >> (int)projection->bin_log2;
    LaneInt y = texel_indices(in_grid.y, projection->height) >> (int)projection->bin_log2;
    return y * (int)projection->bins_x + x;
}

// x, y and W are homogeneous. A power of two scales W below 2, so that products of three do not overflow in scenes of
// 1e10 units; it changes no rounding.
static float unit_of_farthest(float farthest_w) {
    float farthest = fmin(farthest_w, LARGEST_EXTENT);
    return farthest >= 1.0f ? ldexp(1.0f, -ilogb(farthest)) : 1.0f;
}

// PointBounds as floats: [0] and [1] grid x and y, [2] to [4] world x, y, z (in perspective only [4] is defined: W).
typedef struct FittedBounds {
    float low[BOUNDED_VALUES], high[BOUNDED_VALUES];
    uint count;
} FittedBounds;

static FittedBounds read_bounds(__global const PointBounds* keys) {
    FittedBounds bounds;
    for (int i = 0; i < BOUNDED_VALUES; ++i) {
        bounds.low[i] = -key_to_float(keys->minus_lowest[i]);
        bounds.high[i] = key_to_float(keys->highest[i]);
    }
    bounds.count = keys->count;
    return bounds;
}

static void set_bound(__global PointBounds* bounds, int i, float low, float high) {
    bounds->highest[i] = float_to_key(high);
    bounds->minus_lowest[i] = float_to_key(-low);
}

static float4 light_of(LightFrame light_frame) {
    return (float4)(light_frame.light[0], light_frame.light[1], light_frame.light[2], light_frame.light[3]);
}

static LaneFloat along(PointBlock v, uint axis) { return axis == 0u ? v.x : axis == 1u ? v.y : v.z; }

// Grid coordinates of points before scaling: x and y (sheared coordinates or, in perspective, ratios), and z along the
// frame's axis (in perspective W).
static PointBlock grid_values(LightFrame frame, PointBlock points) {
    PointBlock values;
    if (IS_PERSPECTIVE(frame)) {
        PointBlock d = {points.x - frame.light[0], points.y - frame.light[1], points.z - frame.light[2]};
        values.z = along(d, frame.axis_z) * frame.sign_z;
        values.x = along(d, frame.axis_x) / values.z;
        values.y = along(d, frame.axis_y) / values.z;
    } else {
        values.z = along(points, frame.axis_z);
        values.x = along(points, frame.axis_x) - frame.shear_x * values.z;
        values.y = along(points, frame.axis_y) - frame.shear_y * values.z;
    }
    return values;
}

#endif
