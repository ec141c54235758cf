// SPDX-License-Identifier: MIT
#include "camera/camera_rays.clh"

// A coordinate of a camera's ray in float, from its table and from its position in the picture, with the sizes; and a
// determinant with a ray that has met roundings, and its bound.
__kernel void probe(float3 column_high, float3 column_low, float3 row_high, float3 row_low, float corner, float step_x,
                    float step_y, float X, float Y, float3 u1, float3 u0, float3 v1, float3 v0, float3 w, float3 size_w,
                    __global float* ray, __global float* ray_size, __global float* in_picture,
                    __global float* picture_size, __global float* value, __global float* size, __global float* bound) {
    float3 sizes;
    *ray = ray_float((Ray){column_high, column_low, row_high, row_low}, &sizes).x;
    *ray_size = sizes.x;
    PictureRays picture = {{corner, 0.0f, 0.0f, 0.0f}, {step_x, 0.0f, 0.0f, 0.0f}, {step_y, 0.0f, 0.0f, 0.0f}};
    float size_in_picture;
    *in_picture = picture_coordinate(picture, 0, X, Y, &size_in_picture);
    *picture_size = size_in_picture;
    Det3FloatCross cross = det3_cross_float(u1 - u0, v1 - v0);
    float bound_of_value;
    *value = det3_float(cross, w, size_w, &bound_of_value);
    *size = size_w.x * cross.size.x + size_w.y * cross.size.y + size_w.z * cross.size.z;
    *bound = bound_of_value;
}
