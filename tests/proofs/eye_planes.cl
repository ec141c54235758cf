// SPDX-License-Identifier: MIT
// met before: picture 1
// met before: quotient 5
#include "occluders/eye_records.clh"
#include "trace/filter.clh"

// A triangle's 1 / t in a camera's record at the position (X, Y) of the picture, and its margin.
__kernel void probe(float3 a, float3 b, float3 c, float3 eye, __global const PictureRays* picture, float X, float Y,
                    float width, float height, float largest_x, float largest_y, float largest_z, __global float* z,
                    __global float* margin) {
    PointBlock at_a = {a.x, a.y, a.z}, at_b = {b.x, b.y, b.z}, at_c = {c.x, c.y, c.z}, at_eye = {eye.x, eye.y, eye.z};
    LaneCross normal = lanes_cross(difference(at_b, at_a), difference(at_c, at_a));
    RecordBlock record;
    set_eye_plane(&record, &normal, difference(at_a, at_eye), *picture, same_point(largest_x, largest_y, largest_z),
                  width, height, -1);
    *z = lanes_linear(record.plane_x, record.plane_y, record.plane_0, X, Y);
    *margin = record.margin_plane;
}
