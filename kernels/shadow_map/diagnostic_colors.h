// SPDX-License-Identifier: MIT
// Colours that the diagnostics of shadow maps share: views and levels by number, and the survey's scale of texels per
// pixel (slide 65).
#ifndef GN_SHADOW_DIAGNOSTIC_COLORS_H
#define GN_SHADOW_DIAGNOSTIC_COLORS_H

#include "../prelude.h"

#define SKY (float3)(0.25f, 0.25f, 0.25f)

__constant float view_colors[8][3] = {{0.9f, 0.3f, 0.25f}, {0.95f, 0.75f, 0.2f}, {0.4f, 0.75f, 0.3f},
                                      {0.25f, 0.7f, 0.8f}, {0.3f, 0.4f, 0.9f},   {0.65f, 0.35f, 0.8f},
                                      {0.9f, 0.5f, 0.7f},  {0.6f, 0.5f, 0.4f}};

static float3 color_at(__constant const float* color) { return (float3)(color[0], color[1], color[2]); }

static void store_color(float3 color, size_t i, __global float* colors) {
    colors[3 * i] = color.x;
    colors[3 * i + 1] = color.y;
    colors[3 * i + 2] = color.z;
}

#endif
