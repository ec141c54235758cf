// SPDX-License-Identifier: MIT
// Light-space perspective for lamps: the warp of LiSPSM on the faces of the cube around a positional light.
//
// Seen from a lamp, after its own perspective, rays are places (X, Y) of a face: X = x / A, Y = y / A, A the distance
// along the face's axis. There the light is a direction (Stamminger and Drettakis 2002; Wimmer, Scherzer, Purgathofer
// 2004, section 3), and the warp is LiSPSM's: with a unit vector d across the face, e across d, and the line
// d . (X, Y) = y_c a distance n before the receivers,
//   w = d . (X, Y) - y_c,   u = (e . (X, Y) - x_c) / w,   v = 1 / w.
//
// With Du and Dv what u and v range over, a texel of unit resolution is Du w A wide and Dv w^2 A long where it meets a
// receiver, and a pixel there as wide as the camera depth z. For a direction Wimmer et al. know the best n from z_near
// and z_far, because z grows along the map. Around a lamp it is z / A that matters, and neither where it grows nor how
// fast follows from camera and light alone: on a floor it is linear in (X, Y), between walls it is not. So d and n are
// searched for, with the plain face among the choices: those for which the texels of the receivers have the least width
// and length together, in pixels,
//   sum over receivers of (Du w + Dv w^2) A / z,
// to which the pixels that edges of any orientation get wrong are in proportion. (Tried: the least product of the
// largest ratios, as logpsm has it. A few receivers near the camera rule it; it made more points wrong, not fewer.)
// A sample of the receivers will do: a poor choice costs sharpness, never coverage.
#ifndef GN_SHADOW_POINT_LIGHT_PERSPECTIVE_H
#define GN_SHADOW_POINT_LIGHT_PERSPECTIVE_H

#include "techniques/shadow_map/projection.h"

#define WARP_DIRECTIONS 16u                 // of d, evenly around
#define WARP_DISTANCES 16u                  // of n, half octaves from a 16th of what d . (X, Y) ranges over
#define WARP_CHOICES (WARP_DISTANCES + 1u)  // per direction: the last is the plain face, of direction 0 alone
#define WARP_SAMPLES 8192u                  // receivers that are looked at, about

#endif
