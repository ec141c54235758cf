// SPDX-License-Identifier: MIT
#include "occluders/hull_bounds.clh"

// One coordinate of a vertex as both sides of a rectangle, of which bounds_of() takes a point's error: moved out by its
// own quotient's slack, and by that of a hull that is wholly in front; under a direction; what is compared with 0 of a
// vertex near W = 0; and the height 1 / W, moved down and up.
__kernel void probe(float h, float w, float inverse, float error, float error_w, float nearest, float size, float reach,
                    float point_error, __global float* slack, __global float* low, __global float* high,
                    __global float* product, __global float* in_front, __global float* low_in_front,
                    __global float* high_in_front, __global float* low_parallel, __global float* high_parallel,
                    __global float* near_zero, __global float* below_zero, __global float* above_zero,
                    __global float* of_height, __global float* low_height, __global float* high_height) {
    LaneFloat least, most, by = sides_of_quotient(h, error, w, error_w, &least, &most);
    *slack = by, *low = least - point_error, *high = most + point_error;
    LaneFloat x = h * inverse, by_all = slack_in_front(size, error, error_w, nearest);
    *product = x, *in_front = by_all;
    *low_in_front = x - by_all - point_error, *high_in_front = x + by_all + point_error;
    LaneFloat from = h, to = h;
    widen_parallel(&from, &to, error);
    *low_parallel = from - point_error, *high_parallel = to + point_error;
    LaneFloat by_near = slack_near_zero(error, w, error_w, reach), by_height = slack_of_height(inverse, error_w);
    *near_zero = by_near, *below_zero = h + by_near, *above_zero = h - by_near;
    *of_height = by_height, *low_height = inverse - by_height, *high_height = inverse + by_height;
}
