// SPDX-License-Identifier: MIT
#define GN_DIRECTIONAL_ONLY
#include "receivers/light_frame.cl"
#include "simd/triangle_blocks.clh"

// The first row that is fitted to points with coordinates from `low` to `high` and raw ones from `raw_low` to
// `raw_high`; the raw coordinate of one of the points, and its coordinate in the grid.
__kernel void probe(float3 low, float3 high, float2 raw_low, float2 raw_high, float2 shear, uint width, float3 point,
                    float3 center, __constant const float* row, __global float* scale, __global float* row_z,
                    __global float* offset, __global float* raw, __global float* value,
                    __global float* largest_extent) {
    LightFrame frame = {{0.0f}};
    frame.axis_x = 0u, frame.axis_y = 1u, frame.axis_z = 2u;
    frame.sign_z = 1.0f;
    frame.shear_x = shear.x, frame.shear_y = shear.y;
    frame.width = frame.height = width;
    FittedBounds bounds = {
        {raw_low.x, raw_low.y, low.x, low.y, low.z}, {raw_high.x, raw_high.y, high.x, high.y, high.z}, 1u};
    Projection projection;
    fit_parallel(frame, bounds, &projection);
    *scale = projection.row_x[0], *row_z = projection.row_x[2], *offset = projection.row_x[3];
    PointBlock at = {point.x, point.y, point.z};
    *largest_extent = LARGEST_EXTENT;
    *raw = grid_values(frame, at).x;
    *value = lanes_row_dot(row, difference(at, (PointBlock){center.x, center.y, center.z}));
}
