// SPDX-License-Identifier: MIT
// Contract: the box that the open points of a block span in the light's frame. The facing stage writes one per block of
// several points, so that later stages can decide a whole block without loading its points.
#pragma once

#include "receivers/light_frame.h"

GN_STRUCT_BEGIN(BlockBounds)
    // The least of grid_values(), and minus the greatest. Component z is the height (z towards the light; -W under a
    // point light).
    float x, minus_x, y, minus_y, height, minus_height;
    uint frame;  // the frame of all open points, or BLOCK_IN_*
    uint flags;  // BLOCK_ALL_OPEN, BLOCK_MAY_SELF_SHADOW
GN_STRUCT_END(BlockBounds, 32)

#define BLOCK_IN_NO_FRAME 0xFFFFFFFFu  // no point is open
#define BLOCK_IN_FRAMES 0xFFFFFFFEu    // the open points are in several frames; the other members are undefined
#define BLOCK_ALL_OPEN 1u              // every lane is open
#define BLOCK_MAY_SELF_SHADOW 2u       // an open lane may shadow itself

#ifndef __cplusplus

static float8 min_of_two(float8 a, float8 b) { return select(b, a, a < b); }

// The spans of points in the order of BlockBounds; the last two components are undefined.
#if GN_LANES == 1
// (The one lane is set.)
static float8 span_of_lanes(PointBlock low, PointBlock high, LaneInt lanes) {
    return (float8)(low.x, -high.x, low.y, -high.y, low.z, -high.z, INFINITY, INFINITY);
}
#else
// Minima of eight values each: a transposition halves the work of each step; eight separate reductions would not.
static float8 min_of_pairs(float8 a, float8 b) {
    float8 low = (float8)(a.s0, b.s0, a.s1, b.s1, a.s4, b.s4, a.s5, b.s5);
    float8 high = (float8)(a.s2, b.s2, a.s3, b.s3, a.s6, b.s6, a.s7, b.s7);
    return min_of_two(low, high);  // a b a b, twice
}
static float8 min_of_fours(float8 ab, float8 cd) {
    float8 low = (float8)(ab.s01, cd.s01, ab.s45, cd.s45), high = (float8)(ab.s23, cd.s23, ab.s67, cd.s67);
    return min_of_two(low, high);  // a b c d, twice
}
static float8 min_half(float16 v) { return min_of_two(v.lo, v.hi); }

static float8 span_of_lanes(PointBlock low, PointBlock high, LaneInt lanes) {
    LaneFloat none = (LaneFloat)(INFINITY);
    float8 x = min_of_pairs(min_half(LANES_SELECT(none, low.x, lanes)), min_half(LANES_SELECT(none, -high.x, lanes)));
    float8 y = min_of_pairs(min_half(LANES_SELECT(none, low.y, lanes)), min_half(LANES_SELECT(none, -high.y, lanes)));
    float8 z = min_of_pairs(min_half(LANES_SELECT(none, low.z, lanes)), min_half(LANES_SELECT(none, -high.z, lanes)));
    float8 xy = min_of_fours(x, y), zz = min_of_fours(z, z);
    float8 low_halves = (float8)(xy.lo, zz.lo), high_halves = (float8)(xy.hi, zz.hi);
    return min_of_two(low_halves, high_halves);
}
#endif

// The bounds of points with these grid values, in a directional light's frame.
static BlockBounds bounds_of_block(LightFrame frame, PointBlock values, LaneInt lanes) {
    values.z *= frame.sign_z;
    float8 span = span_of_lanes(values, values, lanes);
    return (BlockBounds){span.s0, span.s1, span.s2, span.s3, span.s4, span.s5, 0u, 0u};
}

// World coordinates of grid coordinates from low to high and these z: x = grid x + shear z. The grid coordinates are
// off by 4u M, the products and sums here by less.
static void world_bounds(float low, float high, float shear, float z_low, float z_high, float* world_low,
                         float* world_high) {
    float margin = 16.0f * GN_U * (fmax(fabs(low), fabs(high)) + fmax(fabs(z_low), fabs(z_high)));
    *world_low = low + fmin(shear * z_low, shear * z_high) - margin;
    *world_high = high + fmax(shear * z_low, shear * z_high) + margin;
}

// A frame's projection from grid values to its grid.
typedef struct BlockGrid {
    float origin_x, scale_x, offset_x, origin_y, scale_y, offset_y;
    float origin_height, unit;
    float error;  // in texels
    bool perspective, indistinct;
} BlockGrid;

// A box around a block's points in the grid, all errors included: texels, and heights as the projection computes them.
typedef struct BlockBox {
    uint x0, y0, x1, y1;
    float z0, z1;
} BlockBox;

// The error. Let X be the projection's real map (light_frame.cl); every point's computed grid position is within
// point_error of X. Here the grid position comes from grid values instead, which are off by 4u M (M the largest world
// coordinate; 8u for ratios), as is origin; the difference and the sum round once each. Their sum is below 16u M scale
// (block_error has 32u M scale; for ratios below 10u scale, which point_error has) and u times the position's
// magnitudes (point_error has ten times that). So block_error = 2 point_error + 32u M scale (light_frame.cl).
static BlockGrid block_grid(LightFrame light_frame, __constant const Projection* projection, uint face) {
    LightFrame frame = face_of(light_frame, face);
    BlockGrid grid;
    grid.perspective = IS_PERSPECTIVE(frame) != 0u;
    grid.indistinct = projection->indistinct != 0u;
    grid.error = projection->block_error;
    grid.unit = fabs(projection->row_z[frame.axis_z]);  // a power of two (point light)
    float z = projection->center[frame.axis_z];
    if (IS_PERSPECTIVE(frame)) {
        grid.scale_x = projection->row_x[frame.axis_x] / grid.unit;
        grid.scale_y = projection->row_y[frame.axis_y] / grid.unit;
        grid.offset_x = projection->row_x[frame.axis_z] * frame.sign_z / grid.unit;
        grid.offset_y = projection->row_y[frame.axis_z] * frame.sign_z / grid.unit;
        grid.origin_x = grid.origin_y = grid.origin_height = 0.0f;
    } else {
        grid.scale_x = projection->row_x[frame.axis_x];
        grid.scale_y = projection->row_y[frame.axis_y];
        grid.offset_x = projection->row_x[3];
        grid.offset_y = projection->row_y[3];
        grid.origin_x = projection->center[frame.axis_x] - frame.shear_x * z;
        grid.origin_y = projection->center[frame.axis_y] - frame.shear_y * z;
        grid.origin_height = frame.sign_z * z;
    }
    return grid;
}

// A computed height. Parallel: the same operation as in project_points(); it is monotone. Perspective: a quotient,
// which may be off by 3 ulp, as in project_points().
static float height_of_block(const BlockGrid* grid, float height, float error) {
    if (!grid->perspective) return height - grid->origin_height;
    return 1.0f / (grid->unit * -height) * (1.0f + error);
}

static BlockBox block_box(const BlockGrid* grid, __constant const Projection* projection, const BlockBounds* block) {
    BlockBox box;
    float x0 = fma(grid->scale_x, block->x - grid->origin_x, grid->offset_x) - grid->error;
    float x1 = fma(grid->scale_x, -block->minus_x - grid->origin_x, grid->offset_x) + grid->error;
    float y0 = fma(grid->scale_y, block->y - grid->origin_y, grid->offset_y) - grid->error;
    float y1 = fma(grid->scale_y, -block->minus_y - grid->origin_y, grid->offset_y) + grid->error;
    box.x0 = texel_index(x0, projection->width);
    box.y0 = texel_index(y0, projection->height);
    box.x1 = texel_index(x1, projection->width);
    box.y1 = texel_index(y1, projection->height);
    box.z0 = height_of_block(grid, block->height, -16.0f * GN_U);
    box.z1 = height_of_block(grid, -block->minus_height, 16.0f * GN_U);
    return box;
}

#endif
