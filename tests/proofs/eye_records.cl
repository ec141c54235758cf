// SPDX-License-Identifier: MIT
// met before: picture 1
#include "occluders/eye_records.clh"
#include "trace/filter.clh"

// An edge function of a camera's record at the position (X, Y) of the picture, with the record's scale, and its Q.
__kernel void probe(float3 a, float3 b, float3 eye, __global const PictureRays* picture, float scale, float X, float Y,
                    float width, float height, __global float* value, __global float* size, __global float* bound) {
    PointBlock at_a = {a.x, a.y, a.z}, at_b = {b.x, b.y, b.z}, at_eye = {eye.x, eye.y, eye.z};
    PictureRays rays = *picture;
    LaneCross edge = lanes_cross(difference(at_a, at_eye), difference(at_b, at_a));
    *value = lanes_linear(dot_lanes(edge.value, rays.step_x) * scale, dot_lanes(edge.value, rays.step_y) * scale,
                          dot_lanes(edge.value, rays.corner) * scale, X, Y);
    float largest[3];
    for (int i = 0; i < 3; ++i)
        largest[i] = fabs(rays.corner[i]) + width * fabs(rays.step_x[i]) + height * fabs(rays.step_y[i]);
    *size = permanent_of(edge.size, same_point(largest[0], largest[1], largest[2]));
    *bound = EYE_EDGE_BOUND * *size;
}
