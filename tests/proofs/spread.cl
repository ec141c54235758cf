// SPDX-License-Identifier: MIT
#include "samples/footprints.clh"

// One coordinate of a hit, with its error; of a footprint, from the hits of four rays and from two sides of its
// receiver.
__kernel void probe(float t, float ray, float eye, float relative, float reach, float ray_size, float eye_size,
                    float hit_0, float hit_1, float hit_2, float hit_3, float rest, float error, float largest, float a,
                    float b, float c, __global float* corner, __global float* corner_error, __global float* centre,
                    __global float* along_u, __global float* along_v, __global float* twist, __global float* spread,
                    __global float* own_centre, __global float* own_u, __global float* own_v,
                    __global float* own_spread) {
    RayLanes rays = {.direction = {ray, 0.0f, 0.0f}, .size = {ray_size, 0.0f, 0.0f}};
    *corner = hits_at(t, relative, -1, &rays, (float3)(eye, 0.0f, 0.0f)).at.x;
    *corner_error = error_of_hit(t, relative, reach, ray_size, eye_size);
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
