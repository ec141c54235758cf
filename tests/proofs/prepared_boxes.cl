// SPDX-License-Identifier: MIT
#include "prepared/prepared_light.h"

// A point's raw coordinates in a frame of a direction and in one of a point light, by how much the first is moved
// towards the triangles, and where the greatest raw coordinate of triangles is moved to, whose coordinates are up to
// `largest`.
__kernel void probe(float3 point, float2 shear, float3 light, float high, float largest, __global float* raw,
                    __global float* moved, __global float* lit_high, __global float* ratio, __global float* smallest) {
    LightFrame frame = {{0.0f}};
    frame.axis_x = 0u, frame.axis_y = 1u, frame.axis_z = 2u;
    frame.sign_z = 1.0f;
    frame.shear_x = shear.x, frame.shear_y = shear.y;
    PointBlock at = {point.x, point.y, point.z};
    LaneFloat raw_x = grid_values(frame, at).x;
    *raw = raw_x, *moved = raw_x - prepared_margin(at), *lit_high = high + prepared_padding(largest);
    frame.perspective = 1u;
    frame.light[0] = light.x, frame.light[1] = light.y, frame.light[2] = light.z;
    *ratio = grid_values(frame, at).x, *smallest = SMALLEST_W;
}
