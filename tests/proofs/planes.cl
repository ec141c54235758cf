// SPDX-License-Identifier: MIT
// met before: quotient 5
#include "occluders/triangle_records.clh"
#include "trace/filter.clh"

// A triangle's plane under a direction as a record keeps it, its height at a point of the grid, and its margin, for
// projected vertices with x and y off by `error` and heights off by `error_z`.
__kernel void probe(float3 a, float3 b, float3 c, float X, float Y, float reach, float error, float error_z,
                    float point_error, float height_error, float orientation, __global float* plane_x,
                    __global float* plane_y, __global float* plane_0, __global float* height, __global float* margin) {
    Projected v[3] = {{a.x, a.y, 1.0f, a.z, error, 0.0f, error_z},
                      {b.x, b.y, 1.0f, b.z, error, 0.0f, error_z},
                      {c.x, c.y, 1.0f, c.z, error, 0.0f, error_z}};
    Rectangles rectangle = {0.0f, 0.0f, reach, reach};
    RecordBlock record;
    set_plane_parallel(&record, v, rectangle, orientation, point_error, height_error);
    *plane_x = record.plane_x;
    *plane_y = record.plane_y;
    *plane_0 = record.plane_0;
    *height = lanes_linear(record.plane_x, record.plane_y, record.plane_0, X, Y);
    *margin = record.margin_plane;
}
