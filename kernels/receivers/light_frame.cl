// SPDX-License-Identifier: MIT
// Light frame: fits the grid to the open points (Mizokuchi and Tokuyoshi, section 3: "the light's frustum is fitted to
// the bounding box of the shading points"). The bounds come from the facing stage, which loads every point anyway, and
// are not read back.
//
// The fit is conservative by padding. The raw coordinates below are off by at most 4u M (M the largest world
// coordinate; 4u for ratios), the projected coordinates by point_error. The fit leaves FRAME_PADDING = 32u M and a
// quarter of a texel on each side, so that every point's computed texel lies inside the grid, and the clamp of
// texel_index never acts (tests/proofs/frame_fit.v; frame_errors.v has point_error and height_error).
#include "receivers/light_frame.h"

#define FRAME_PADDING (32.0f * GN_U)
#define EDGE_TEXELS 0.25f

// Texels per unit and the offset that brings [low, high] inside [EDGE_TEXELS, texels - EDGE_TEXELS].
static float fitted_scale(float low, float high, float padding, float texels) {
    float extent = fmax((high - low) + 2.0f * padding, 1.0e-18f);
    return (texels - 2.0f * EDGE_TEXELS) / extent;
}

static void set_row(float* row, uint axis_a, float a, uint axis_b, float b, float offset) {
    row[axis_a] = a;
    row[axis_b] = b;
    row[3] = offset;
}

// Spreads the points' heights over the 16 bits of bin_lists.h. Any positive scale is correct; this one separates them.
static void fit_heights(float low, float high, Projection* projection) {
    projection->z_origin = low;
    projection->z_scale = 65535.0f / clamp(high - low, 1.0e-30f, LARGEST_EXTENT);
}

static void fit_parallel(LightFrame frame, FittedBounds bounds, Projection* projection) {
    float largest = 0.0f;
    for (int i = 0; i < 3; ++i) {
        projection->center[i] = 0.5f * bounds.low[2 + i] + 0.5f * bounds.high[2 + i];
        largest = fmax(largest, fmax(fabs(bounds.low[2 + i]), fabs(bounds.high[2 + i])));
    }
    float padding = FRAME_PADDING * largest;
    float scale_x = fitted_scale(bounds.low[0], bounds.high[0], padding, (float)frame.width);
    float scale_y = fitted_scale(bounds.low[1], bounds.high[1], padding, (float)frame.height);
    float c_x = projection->center[frame.axis_x], c_y = projection->center[frame.axis_y];
    float c_z = projection->center[frame.axis_z];
    float offset_x = EDGE_TEXELS - scale_x * ((bounds.low[0] - padding) - (c_x - frame.shear_x * c_z));
    float offset_y = EDGE_TEXELS - scale_y * ((bounds.low[1] - padding) - (c_y - frame.shear_y * c_z));
    set_row(projection->row_x, frame.axis_x, scale_x, frame.axis_z, -scale_x * frame.shear_x, offset_x);
    set_row(projection->row_y, frame.axis_y, scale_y, frame.axis_z, -scale_y * frame.shear_y, offset_y);
    set_row(projection->row_z, frame.axis_z, frame.sign_z, 3u, 0.0f, 0.0f);

    float reach[3];
    for (int i = 0; i < 3; ++i)
        reach[i] = 1.01f * fmax(fabs(bounds.high[2 + i] - projection->center[i]),
                                fabs(bounds.low[2 + i] - projection->center[i]));
    float size_x = scale_x * (reach[frame.axis_x] + fabs(frame.shear_x) * reach[frame.axis_z]) + fabs(offset_x);
    float size_y = scale_y * (reach[frame.axis_y] + fabs(frame.shear_y) * reach[frame.axis_z]) + fabs(offset_y);
    projection->point_error = 1.01f * PROJECTION_ERROR * fmax(size_x, size_y);
    projection->block_error = 2.0f * projection->point_error + padding * fmax(scale_x, scale_y);
    projection->height_error = 1.01f * PROJECTION_ERROR * reach[frame.axis_z];
    projection->indistinct = !(largest < LARGEST_EXTENT);
    if (!projection->indistinct) fit_heights(-reach[frame.axis_z], reach[frame.axis_z], projection);
}

static void fit_perspective(LightFrame frame, FittedBounds bounds, Projection* projection) {
    for (int i = 0; i < 3; ++i) projection->center[i] = frame.light[i];
    float scale_x = fitted_scale(bounds.low[0], bounds.high[0], FRAME_PADDING, (float)frame.width);
    float scale_y = fitted_scale(bounds.low[1], bounds.high[1], FRAME_PADDING, (float)frame.height);
    float offset_x = EDGE_TEXELS - scale_x * (bounds.low[0] - FRAME_PADDING);
    float offset_y = EDGE_TEXELS - scale_y * (bounds.low[1] - FRAME_PADDING);
    float unit = unit_of_farthest(bounds.high[4]);
    set_row(projection->row_x, frame.axis_x, scale_x * unit, frame.axis_z, offset_x * frame.sign_z * unit, 0.0f);
    set_row(projection->row_y, frame.axis_y, scale_y * unit, frame.axis_z, offset_y * frame.sign_z * unit, 0.0f);
    set_row(projection->row_z, frame.axis_z, frame.sign_z * unit, 3u, 0.0f, 0.0f);
    // |x| <= (scale + |offset|) W, since the other coordinates of a face's points are at most W; the quotient by W
    // adds W's own error times X and the division's 3 ulp.
    float texels = (float)max(frame.width, frame.height);
    float size = fmax(scale_x + fabs(offset_x), scale_y + fabs(offset_y));
    projection->point_error = 1.01f * (PROJECTION_ERROR * (size + texels) + 4.0f * GN_U * texels);
    projection->block_error = 2.0f * projection->point_error;
    projection->height_error = PROJECTION_ERROR + 4.0f * GN_U;
    projection->indistinct = !(bounds.low[4] * unit > SMALLEST_W && bounds.high[4] < LARGEST_EXTENT);
    if (!projection->indistinct) fit_heights(1.0f / (bounds.high[4] * unit), 1.0f / (bounds.low[4] * unit), projection);
}

GN_NOINLINE_ON_CPU void fit_frame(LightFrame frame, __global const PointBounds* keys, __global Projection* result) {
    FittedBounds bounds = read_bounds(keys);
    Projection projection = {{0.0f}};  // every member is 0
    for (int i = 0; i < 4; ++i) projection.light[i] = frame.light[i];
    projection.width = frame.width;
    projection.height = frame.height;
    projection.bin_log2 = frame.bin_log2;
    projection.bins_x = frame.bins_x;
    projection.bins_y = frame.bins_y;
    projection.perspective = frame.perspective;
    projection.handedness = frame.sign_z;
    projection.active_points = bounds.count;
    projection.z_scale = 1.0f;
    if (bounds.count == 0)
        projection.indistinct = 1;
    else if (frame.perspective)
        fit_perspective(frame, bounds, &projection);
    else
        fit_parallel(frame, bounds, &projection);
    *result = projection;
}

__kernel void light_frame_fit(LightFrame light_frame, __global const PointBounds* frame_bounds,
                              __global Projection* projections) {
    GN_FOR_EACH(face, frame_count_of(light_frame)) {
        fit_frame(face_of(light_frame, (uint)face), &frame_bounds[face], &projections[face]);
    }
}
