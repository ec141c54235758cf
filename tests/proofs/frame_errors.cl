// SPDX-License-Identifier: MIT
#include "receivers/light_frame.cl"
#include "simd/triangle_blocks.clh"

// A point's coordinate along a row, and their quotient and inverse, which are in the grid of a point light; and the
// bounds of their errors for points with coordinates from `low` to `high` and raw ones from `raw_low` to `raw_high`.
__kernel void probe(float3 point, float3 center, __constant const float* row, __constant const float* row_of_heights,
                    float2 raw_low, float2 raw_high, float3 low, float3 high, float2 shear, uint width,
                    __global float* value, __global float* height, __global float* point_error,
                    __global float* height_error, __global float* ratio, __global float* ratio_error,
                    __global float* inverse_error, __global float* largest_extent, __global float* smallest) {
    PointBlock d = difference((PointBlock){point.x, point.y, point.z}, (PointBlock){center.x, center.y, center.z});
    float x = lanes_row_dot(row, d), z = lanes_row_dot(row_of_heights, d);
    *value = x, *height = z, *ratio = x / z;
    LightFrame frame = {{0.0f}};
    frame.axis_x = 0u, frame.axis_y = 1u, frame.axis_z = 2u;
    frame.sign_z = 1.0f;
    frame.shear_x = shear.x, frame.shear_y = shear.y;
    frame.width = frame.height = width;
    FittedBounds bounds = {
        {raw_low.x, raw_low.y, low.x, low.y, low.z}, {raw_high.x, raw_high.y, high.x, high.y, high.z}, 1u};
    Projection projection;
    fit_parallel(frame, bounds, &projection);
    *point_error = projection.point_error, *height_error = projection.height_error;
    fit_perspective(frame, bounds, &projection);
    *ratio_error = projection.point_error, *inverse_error = projection.height_error;
    *largest_extent = LARGEST_EXTENT, *smallest = SMALLEST_W;
}
