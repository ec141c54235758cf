// SPDX-License-Identifier: MIT
// Light-space perspective for point lights: the warp of LiSPSM on the faces of the cube around the light.
//
// Seen from a point light, after its own perspective, rays are positions (X, Y) on a face: X = x / A, Y = y / A, A the
// distance along the face's axis. There the light is a direction (Stamminger and Drettakis 2002; Wimmer, Scherzer,
// Purgathofer 2004, section 3), and the warp is LiSPSM's: with a unit vector d across the face, e across d, and the
// line d . (X, Y) = y_c a distance n before the receivers,
//   w = d . (X, Y) - y_c,   u = (e . (X, Y) - x_c) / w,   v = 1 / w.
//
// With Du and Dv the ranges of u and v, a texel of unit resolution is Du w A wide and Dv w^2 A long where it meets a
// receiver, and a pixel there is as wide as the camera depth z. For a directional light Wimmer et al. derive the best n
// from z_near and z_far, because z grows along the map. For a point light z / A decides, and camera and light alone do
// not determine where and how fast z / A grows: on a floor it is linear in (X, Y), between walls it is not. So a search
// chooses d and n, with the plain face among the choices. It minimises the sum of width and length of the receivers'
// texels, in pixels,
//   sum over receivers of (Du w + Dv w^2) A / z.
// The number of wrong pixels along edges of any orientation is in proportion to this sum. (Tried: the least product of
// the largest ratios, as in logpsm. A few receivers near the camera dominate it; it made more points wrong, not fewer.)
// A sample of the receivers suffices: a poor choice costs sharpness, never coverage.
#pragma once

#include "rivals/shadow_map/map_projection.h"

#define WARP_DIRECTIONS 16u                 // of d, evenly around
#define WARP_DISTANCES 16u                  // of n, half octaves from a 16th of the range of d . (X, Y)
#define WARP_CHOICES (WARP_DISTANCES + 1u)  // per direction: the last is the plain face, of direction 0 alone
#define WARP_SAMPLES 8192u                  // number of sampled receivers, about

// Sample k is point k * stride.
GN_STRUCT_BEGIN(WarpSampling)
    uint stride, sample_count;
GN_STRUCT_END(WarpSampling, 8)
