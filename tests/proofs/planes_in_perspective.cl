// SPDX-License-Identifier: MIT
// met before: quotient 5
#include "occluders/triangle_records.clh"
#include "trace/filter.clh"

// A triangle's plane under a point light as a record keeps it, its height at a point of the grid, and its margin, for
// projected vertices with x and y off by `error` and w off by error_w.
__kernel void probe(float3 a, float3 b, float3 c, float X, float Y, float side, float error, float error_w,
                    float point_error, float height_error, float orientation, __global float* height,
                    __global float* margin) {
    Projected v[3] = {{a.x, a.y, a.z, 0.0f, error, error_w, 0.0f},
                      {b.x, b.y, b.z, 0.0f, error, error_w, 0.0f},
                      {c.x, c.y, c.z, 0.0f, error, error_w, 0.0f}};
    Rectangles rectangle = {0.0f, 0.0f, side, side};
    RecordBlock record;
    set_plane_perspective(&record, v, rectangle, orientation, -1, point_error, height_error);
    *height = lanes_linear(record.plane_x, record.plane_y, record.plane_0, X, Y);
    *margin = record.margin_plane;
}
