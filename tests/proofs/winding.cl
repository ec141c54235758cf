// SPDX-License-Identifier: MIT
#include "horizons/height_field.cl"

__kernel void probe(float3 a, float3 b, float3 c, __global float* value, __global float* bound) {
    float bound_of_value;
    *value = area_over_ground(b - a, c - a, &bound_of_value);
    *bound = bound_of_value;
}
