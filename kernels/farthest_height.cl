// SPDX-License-Identifier: MIT
// Farthest height: per bin of light space, the height of the point farthest from the light, and a pyramid of minima
// over it. A triangle that lies wholly below (farther than) every point it could cover blocks none of them (Wyman et
// al. 2016, "Frustum-Traced Irregular Z-Buffers", section on early-z; the pyramid is ours).
//
// Heights are kept as order-preserving keys, so that integer minima serve; an empty bin holds 0xFFFFFFFF, above all.
#include "light_frame.h"

__kernel void farthest_height(LightFrame frame, PointsLayout layout, __constant const Projection* projection,
                              __global const float* positions, __global const float* visibility,
                              __global uint* pyramid) {
    GN_FOR_EACH(i, layout.count) {
        float3 p;
        if (!is_open_in_frame(frame, layout, positions, visibility, i, &p)) continue;
        float3 point = project_point(projection, p);
        atomic_min(&pyramid[bin_of(projection, point)], float_to_key(point.z));
    }
}

// One level from the one below it: each cell is the minimum of up to 2 x 2.
__kernel void farthest_height_reduce(uint width_below, uint height_below, uint first_below, __global uint* pyramid) {
    uint width = (width_below + 1) / 2, height = (height_below + 1) / 2;
    __global const uint* below = pyramid + first_below;
    __global uint* level = pyramid + first_below + width_below * height_below;
    GN_FOR_EACH(i, width * height) {
        uint x = 2 * (uint)(i % width), y = 2 * (uint)(i / width);
        uint x1 = min(x + 1, width_below - 1), y1 = min(y + 1, height_below - 1);
        level[i] = min(min(below[y * width_below + x], below[y * width_below + x1]),
                       min(below[y1 * width_below + x], below[y1 * width_below + x1]));
    }
}
