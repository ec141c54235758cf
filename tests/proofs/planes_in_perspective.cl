// SPDX-License-Identifier: MIT
// met before: quotient 5
#include "occluders/triangle_records.clh"
#include "trace/filter.clh"

// A triangle's plane under a point light as a record keeps it, its height at a point of the grid, and its margin, for
// projected vertices with x and y off by `error` and w off by error_w; and the error of N . a where a lies in the grid.
__kernel void probe(float3 a, float3 b, float3 c, float X, float Y, float side, float error, float error_w,
                    float point_error, float height_error, float orientation, __global float* height,
                    __global float* margin, __global float* in_grid) {
    Projected v[3] = {{a.x, a.y, a.z, 0.0f, error, error_w, 0.0f},
                      {b.x, b.y, b.z, 0.0f, error, error_w, 0.0f},
                      {c.x, c.y, c.z, 0.0f, error, error_w, 0.0f}};
    Rectangles rectangle = {0.0f, 0.0f, side, side};
    RecordBlock record;
    set_plane_perspective(&record, v, rectangle, orientation, -1, point_error, height_error);
    *height = lanes_linear(record.plane_x, record.plane_y, record.plane_0, X, Y);
    *margin = record.margin_plane;

    PlaneSides sides;
    sides.x1 = b.x - a.x, sides.y1 = b.y - a.y, sides.w1 = b.z - a.z;
    sides.x2 = c.x - a.x, sides.y2 = c.y - a.y, sides.w2 = c.z - a.z;
    sides.size_x = fabs(sides.y1 * sides.w2) + fabs(sides.w1 * sides.y2);
    sides.size_y = fabs(sides.w1 * sides.x2) + fabs(sides.x1 * sides.w2);
    sides.size_w = fabs(sides.x1 * sides.y2) + fabs(sides.y1 * sides.x2);
    float reach = side + point_error, e_a = error + reach * error_w, e_side = e_a + error + reach * error_w;
    *in_grid = determinant_error_in_grid(v, &sides, rectangle, reach, e_a, e_side, e_side);
}
