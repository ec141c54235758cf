// SPDX-License-Identifier: MIT
#include "horizons/horizons.cl"

// A point's height in units, the slope of the ray from there to a height of the pyramid, and a light's slope as it is
// compared with that from below and from above.
__kernel void probe(float z, float lowest, float units, float bound, float inverse, float light, __global float* height,
                    __global float* slope, __global float* less, __global float* more, __global float* slack) {
    HeightField field;
    field.lowest = lowest, field.units = units;
    LaneFloat h = height_in_units(z, &field);
    *height = h, *slope = slope_to(bound, h, inverse);
    *less = light * SLOPE_BELOW, *more = light * SLOPE_ABOVE;
    *slack = FIELD_SLACK;
}
