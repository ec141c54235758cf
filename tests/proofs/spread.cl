// SPDX-License-Identifier: MIT
#include "samples/footprints.clh"

// One coordinate of a footprint, from the hits of four rays and from two sides of its receiver.
__kernel void probe(float hit_0, float hit_1, float hit_2, float hit_3, float rest, float error, float largest, float a,
                    float b, float c, __global float* centre, __global float* along_u, __global float* along_v,
                    __global float* twist, __global float* spread, __global float* own_centre, __global float* own_u,
                    __global float* own_v, __global float* own_spread) {
    HitLanes h[4] = {{.at = {hit_0, 0.0f, 0.0f}},
                     {.at = {hit_1, 0.0f, 0.0f}},
                     {.at = {hit_2, 0.0f, 0.0f}},
                     {.at = {hit_3, 0.0f, 0.0f}}};
    *centre = combined(h, 1.0f, 1.0f, 1.0f, 1.0f).x, *along_u = combined(h, -1.0f, 1.0f, -1.0f, 1.0f).x;
    *along_v = combined(h, -1.0f, -1.0f, 1.0f, 1.0f).x, *twist = combined(h, 1.0f, -1.0f, -1.0f, 1.0f).x;
    *spread = spread_of_hits(rest, error, largest);
    TriangleBlock receiver = {{a, 0.0f, 0.0f}, {b, 0.0f, 0.0f}, {c, 0.0f, 0.0f}};
    FragmentBounds own = parallelogram_of(&receiver, largest);
    *own_centre = own.centre.x, *own_u = own.shape.u.x, *own_v = own.shape.v.x, *own_spread = own.shape.spread;
}
