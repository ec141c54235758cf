// SPDX-License-Identifier: MIT
// Contract of the shadow maps' diagnostics: pictures of a map's texels as they lie over the camera's picture.
//
//   aliasing  texels per pixel, max(|ds + dt|, |ds - dt|) with ds, dt the steps through the map from a pixel to the
//             next along x and y. Green is one texel to a pixel; yellow, red, black is too coarse by 3.25, 7.75 and
//             more; light blue, blue, black is finer than needed by as much
//   grid      the map's texels as lines on the scene, an eighth of a texel or a pixel wide, the wider of the two (as
//             Lloyd 2007, 6.8, draws them); evenly grey where a pixel is wider than a texel
//   views     a colour per view (cascade, side, cube face); black where no view serves
//   depth     the map's depth of the visible points, black nearest to the light
//   warp      a checkerboard of WARP_CELLS x WARP_CELLS equal shares of the map's texels: small where the map is dense.
//             In the colours of aliasing: the factor, per side, by which the warp (map_view.h) makes texels denser than
//             in the map without it; green where the factor is 1
// Steps are computed as in texel_footprint.h. Points without a camera or a receiver, and the sky, have colour SKY.
#pragma once

#include "rivals/shadow_map/texel_footprint.h"

#define DIAGNOSTIC_ALIASING 0u
#define DIAGNOSTIC_GRID 1u
#define DIAGNOSTIC_VIEWS 2u
#define DIAGNOSTIC_DEPTH 3u
#define DIAGNOSTIC_WARP 4u
#define WARP_CELLS 32.0f

GN_STRUCT_BEGIN(DiagnosticPlan)
    PixelSteps steps;
    uint diagnostic;
    uint padding[3];
GN_STRUCT_END(DiagnosticPlan, 80)

#ifndef __cplusplus

#define SKY (float3)(0.25f, 0.25f, 0.25f)

__constant float view_colors[8][3] = {{0.9f, 0.3f, 0.25f}, {0.95f, 0.75f, 0.2f}, {0.4f, 0.75f, 0.3f},
                                      {0.25f, 0.7f, 0.8f}, {0.3f, 0.4f, 0.9f},   {0.65f, 0.35f, 0.8f},
                                      {0.9f, 0.5f, 0.7f},  {0.6f, 0.5f, 0.4f}};

static float3 color_at(__constant const float* color) { return vload3(0, color); }

#endif
