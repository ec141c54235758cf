// SPDX-License-Identifier: MIT
// met before: share 1
// met before: farther 2
// met before: climb 1
// met before: low 1
// met before: high 1
// met before: height 1
#include "horizons/sweeps.cl"

// The ground at an edge that a vertex's own ray meets, over the plane through the ray, and what it is compared with: by
// shares that the host rounded, and along a ray that is walked alone.
__kernel void probe(float share_low, float low, float share_high, float high, float climb, float share, float farther,
                    float height, float near_margin, __global float* ground, __global float* walked,
                    __global float* below, __global float* above, __global float* of_sizes,
                    __global float* of_nothing) {
    *ground = height_of_crossing(share_low, low, share_high, high, climb);
    *walked = height_of_edge(low, high, share, climb, farther);
    *below = height - near_margin, *above = height + near_margin;
    *of_sizes = SWEEP_CROSSING_ERROR, *of_nothing = SWEEP_LOST;
}
