// SPDX-License-Identifier: MIT
// Pictures of a shadow map's texels as they lie over the camera's picture (diagnostic.h).
#include "rivals/shadow_map/diagnostic.h"

// Colours at these texels per pixel, linear between.
__constant float error_stops[7] = {0.0f, 1.0f / 7.75f, 1.0f / 3.25f, 1.0f, 3.25f, 7.75f, 10.0f};
__constant float error_colors[7][3] = {{0.2f, 0.0f, 0.0f}, {1.0f, 0.2f, 0.0f}, {1.0f, 1.0f, 0.0f}, {0.0f, 1.0f, 0.0f},
                                       {0.3f, 0.8f, 1.0f}, {0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.2f}};
static float3 error_color(float error) {
    for (int i = 0; i < 6; ++i)
        if (error < error_stops[i + 1]) {
            float share = (error - error_stops[i]) / (error_stops[i + 1] - error_stops[i]);
            return mix(color_at(error_colors[i]), color_at(error_colors[i + 1]), share);
        }
    return color_at(error_colors[6]);
}

// 1 where the texel coordinate is on a line of the grid. A line is an eighth of a texel or a pixel wide, the wider of
// the two.
static float grid_line(float at, float pixel) {
    float from_line = fabs(at - rint(at));
    float width = fmax(0.125f, fmin(pixel, 1.0f));
    return from_line < 0.5f * width ? 1.0f : 0.0f;
}

static float3 grid_color(float2 at, float2 ds, float2 dt) {
    float2 pixel = fabs(ds) + fabs(dt);
    if (pixel.x >= 1.0f || pixel.y >= 1.0f) return (float3)(0.5f, 0.5f, 0.5f);
    float line = fmax(grid_line(at.x, pixel.x), grid_line(at.y, pixel.y));
    return line != 0.0f ? (float3)(0.1f, 0.1f, 0.1f) : (float3)(0.9f, 0.9f, 0.9f);
}

// The factor by which the warp makes texels denser along an axis at x than the map without the warp.
static float warp_density(__global const MapView* view, __global const float* tables, uint axis, float x) {
    if (view->warp == WARP_LOGARITHMIC && axis == 1u)
        return view->log_strength / ((1.0f + view->log_strength * fmax(x, 0.0f)) * log1p(view->log_strength));
    if (view->warp == WARP_RECTILINEAR) {
        uint segments = view->warp_size;
        __global const float* table = tables + view->forward_first + axis * (segments + 1);
        uint segment = min((uint)(clamp(x, 0.0f, 1.0f) * (float)segments), segments - 1);
        return (table[segment + 1] - table[segment]) * (float)segments;
    }
    return 1.0f;
}

// Cells of the warped map as a checkerboard, `at` and the steps in texels. If a pixel is wider than a cell, the colour
// is between the two.
static float3 warp_color(__global const MapView* view, __global const float* tables, float2 uv, float2 at, float2 ds,
                         float2 dt) {
    float2 cells = (float2)(WARP_CELLS / (float)view->width, WARP_CELLS / (float)view->height);
    float2 cell = floor(at * cells), pixel = (fabs(ds) + fabs(dt)) * cells;
    bool is_dark = ((int)cell.x + (int)cell.y) % 2 != 0, is_mixed = pixel.x >= 1.0f || pixel.y >= 1.0f;
    float density = sqrt(warp_density(view, tables, 0u, uv.x) * warp_density(view, tables, 1u, uv.y));
    return error_color(density) * (is_mixed ? 0.8f : is_dark ? 0.6f : 1.0f);
}

// errors: texels per pixel, 0 for a point without texels; colors: red, green, blue.
__kernel void map_diagnostic(DiagnosticPlan plan, MapSet set, PointsLayout layout, ulong first_float,
                             __global const float* positions, __global const uint* receivers,
                             __global const float* vertices, __global const MapView* views,
                             __global const float* tables, __global float* errors, __global float* colors) {
    GN_FOR_EACH(i, layout.count) {
        float3 p = load_point(positions, layout, i), color = SKY;
        float error = 0.0f;
        if (is_present(p) && receivers[i] != GN_NO_ID) {
            uint index = select_view(set, views, p);
            color = (float3)(0.0f, 0.0f, 0.0f);
            if (index != NO_VIEW) {
                __global const MapView* view = views + index;
                Triangle t = load_triangle(vertices + first_float, receivers[i]);
                float2 ds, dt;
                pixel_footprint(&plan.steps, view, tables, t, p, &ds, &dt);
                float2 both = ds + dt, across = ds - dt;
                error = sqrt(fmax(both.x * both.x + both.y * both.y, across.x * across.x + across.y * across.y));
                float3 normal = unit3(cross3(t.b - t.a, t.c - t.a)), from_eye = unit3(p - plan.steps.eye.xyz);
                float facing = 0.35f + 0.65f * fabs(dot3(normal, from_eye));
                float3 at = map_uv(view, p);
                if (plan.diagnostic == DIAGNOSTIC_ALIASING)
                    color = error_color(error);
                else if (plan.diagnostic == DIAGNOSTIC_GRID)
                    color = grid_color(map_texels(view, tables, at.xy), ds, dt) * color_at(view_colors[index]);
                else if (plan.diagnostic == DIAGNOSTIC_VIEWS)
                    color = color_at(view_colors[index]) * facing;
                else if (plan.diagnostic == DIAGNOSTIC_WARP)
                    color = warp_color(view, tables, at.xy, map_texels(view, tables, at.xy), ds, dt);
                else
                    color = (float3)(clamp(at.z, 0.0f, 1.0f));
            }
        }
        errors[i] = error;
        vstore3(color, i, colors);
    }
}
