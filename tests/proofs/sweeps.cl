// SPDX-License-Identifier: MIT
// met before: share 1
// met before: farther 2
// met before: climb 1
// met before: low 1
// met before: high 1
// met before: height 1
// met before: slope 1
// met before: rest 1
#include "horizons/sweeps.cl"

// The ground at an edge that a vertex's own ray meets, over the plane through
// the ray, and what it is compared with: by shares that the host rounded, and
// along a ray that is walked alone. And how much the ground between two lines
// may be above straight lines between them, where diagonals rise and where they
// fall; and what is kept of a line that a sweep meets.
__kernel void probe(float share_low, float low, float share_high, float high, float climb, float share, float farther,
                    float height, float near_margin, __global float* ground, __global float* walked,
                    __global float* below, __global float* above, __global float* of_sizes, __global float* of_nothing,
                    __global float* of_heights, __global float* of_climb, float4 h, float4 n, float slope, float rest,
                    float lines, float2 bound, __global float* rising, __global float* falling,
                    __global float* most_low, __global float* most_high, __global float* least_low,
                    __global float* least_high, __global float* across, __global float* ray, __global const float* copy,
                    __global const LightSweep* light, float before_low, float before_high, float last_low,
                    float last_high, __global float* kept_low, __global float* kept_high) {
    *ground = height_of_crossing(share_low, low, share_high, high, climb);
    *walked = height_of_edge(low, high, share, climb, farther);
    *below = height - near_margin, *above = height + near_margin;
    *of_sizes = SWEEP_CROSSING_ERROR, *of_nothing = SWEEP_LOST;
    *of_heights = SWEEP_HEIGHT_ROUNDINGS, *of_climb = SWEEP_CLIMB_ROUNDINGS;
    const float line[4] = {h.x, h.y, h.z, h.w}, next[4] = {n.x, n.y, n.z, n.w};
    *rising = bend_between(line, next, slope, true), *falling = bend_between(line, next, slope, false);
    StripLine upper, lower, strip = {{bound.x, bound.y}};
    bounds_of_line(line, rest, climb * lines, &upper, &lower);
    *most_low = upper.at[0], *most_high = upper.at[1], *least_low = lower.at[0], *least_high = lower.at[1];
    *across = height_across(&strip, 1.0f - rest), *ray = height - climb * lines;

    // Line 0, after line 1: rests and climbs are 0 there.
    __builtin_assume(light->lines == 2u), __builtin_assume(light->is_rising == 1u);
    __builtin_assume(light->first == 0u), __builtin_assume(light->line_stride == 4);
    __builtin_assume(light->has_holes == 0u);
    SweepStrips strips = no_strips();
    strips.high.at[0] = before_low, strips.high.at[1] = before_high;
    strips.last.at[0] = last_low, strips.last.at[1] = last_high;
    meet_line(&strips, copy, copy, light, 0u, 1);
    *kept_low = strips.high.at[0], *kept_high = strips.high.at[1];
}
