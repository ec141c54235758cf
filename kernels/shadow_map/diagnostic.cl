// SPDX-License-Identifier: MIT
// Pictures of how a shadow map's texels lie over what the camera sees (diagnostic.h).
#include "diagnostic.h"

#define SKY (float3)(0.25f, 0.25f, 0.25f)

// Of slide 65: colours at these texels per pixel, linear between.
__constant float error_stops[7] = {0.0f, 1.0f / 7.75f, 1.0f / 3.25f, 1.0f, 3.25f, 7.75f, 10.0f};
__constant float error_colors[7][3] = {{0.2f, 0.0f, 0.0f}, {1.0f, 0.2f, 0.0f}, {1.0f, 1.0f, 0.0f}, {0.0f, 1.0f, 0.0f},
                                       {0.3f, 0.8f, 1.0f}, {0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 0.2f}};
__constant float view_colors[8][3] = {{0.9f, 0.3f, 0.25f}, {0.95f, 0.75f, 0.2f}, {0.4f, 0.75f, 0.3f},
                                      {0.25f, 0.7f, 0.8f}, {0.3f, 0.4f, 0.9f},   {0.65f, 0.35f, 0.8f},
                                      {0.9f, 0.5f, 0.7f},  {0.6f, 0.5f, 0.4f}};

static float3 color_at(__constant const float* color) { return (float3)(color[0], color[1], color[2]); }

static float3 error_color(float error) {
    for (int i = 0; i < 6; ++i)
        if (error < error_stops[i + 1]) {
            float share = (error - error_stops[i]) / (error_stops[i + 1] - error_stops[i]);
            return mix(color_at(error_colors[i]), color_at(error_colors[i + 1]), share);
        }
    return color_at(error_colors[6]);
}

// Is the texel coordinate on a line of the grid? A line is an eighth of a texel, or a pixel where that is wider.
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

// errors: texels per pixel, 0 where there are none; colors: red, green, blue.
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
                float3 normal = unit3(cross3(t.b - t.a, t.c - t.a)), from_eye = unit3(p - to_float3(plan.steps.eye));
                float facing = 0.35f + 0.65f * fabs(dot3(normal, from_eye));
                float3 at = map_uv(view, p);
                if (plan.diagnostic == DIAGNOSTIC_ALIASING)
                    color = error_color(error);
                else if (plan.diagnostic == DIAGNOSTIC_GRID)
                    color = grid_color(map_texels(view, tables, at.xy), ds, dt) * color_at(view_colors[index]);
                else if (plan.diagnostic == DIAGNOSTIC_VIEWS)
                    color = color_at(view_colors[index]) * facing;
                else
                    color = (float3)(clamp(at.z, 0.0f, 1.0f));
            }
        }
        errors[i] = error;
        colors[3 * i] = color.x;
        colors[3 * i + 1] = color.y;
        colors[3 * i + 2] = color.z;
    }
}
