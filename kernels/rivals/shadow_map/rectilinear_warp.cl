// SPDX-License-Identifier: MIT
// Rectilinear texture warping (rectilinear_warp.h): the importance of each cell of each view, then the views' tables.
#include "rivals/shadow_map/homography.clh"
#include "rivals/shadow_map/lookup.h"
#include "rivals/shadow_map/rectilinear_warp.h"

#define CELLS (WARP_SEGMENTS * WARP_SEGMENTS)

static float camera_depth(const ViewPlan* plan, float3 p) { return dot3(p - plan->eye.xyz, plan->forward.xyz); }

// Importance of a surface by its distance and its direction; normal of any length and sign, 0 if there is none.
static float surface_importance(const ViewPlan* plan, const WarpPlan* warp, float3 p, float3 normal, float farthest) {
    float importance = 1.0f;
    if (warp->functions & IMPORTANCE_DISTANCE) importance *= 1.0f - clamp(camera_depth(plan, p) / farthest, 0.0f, 1.0f);
    if (warp->functions & IMPORTANCE_NORMAL) {
        float3 view = p - plan->eye.xyz;
        float size = sqrt(dot3(normal, normal) * dot3(view, view));
        if (size > 0.0f) importance *= 1.0f + NORMAL_GAIN * fabs(dot3(normal, view)) / size;
    }
    return importance;
}

static uint cell_at(float3 uv) {
    float2 at = clamp(uv.xy * (float)WARP_SEGMENTS, 0.0f, (float)(WARP_SEGMENTS - 1));
    return (uint)at.y * WARP_SEGMENTS + (uint)at.x;
}

// Importances are positive, so their bits have the same order as their values.
__kernel void rectilinear_backward(ViewPlan plan, WarpPlan warp, MapSet set, PointsLayout layout, ulong first_float,
                                   __global const float* positions, __global const uint* receivers,
                                   __global const float* vertices, __global const float* visibility,
                                   __global const MapView* views, __global const KeyBounds* bounds,
                                   __global uint* importance) {
    KeyBounds depths = bounds[1];
    float farthest = greatest_of(&depths, 2);
    GN_FOR_EACH(i, layout.count) {
        float3 p;
        uint view;
        if (!is_looked_up(set, layout, positions, visibility, views, i, &p, &view)) continue;
        float3 normal = (float3)(0.0f);
        if (layout.has_receivers && receivers[i] != GN_NO_ID) {
            Triangle t = load_triangle(vertices + first_float, receivers[i]);
            normal = cross3(t.b - t.a, t.c - t.a);
        }
        float mine = surface_importance(&plan, &warp, p, normal, farthest);
        atomic_max(&importance[view * CELLS + cell_at(map_uv(views + view, p))], as_uint(mine));
    }
}

// ---- Forward: a small map of the light ------------------------------------------------------------------------------

// The point at (u, v, depth), by Cramer's rule: (row_u - u row_w) . q = 0, (row_v - v row_w) . q = 0,
// row_depth . q = depth.
static float3 point_at(__global const MapView* view, float u, float v, float depth) {
    float3 row_w = view->row_w.xyz, c = view->row_depth.xyz;
    float3 a = view->row_u.xyz - u * row_w, b = view->row_v.xyz - v * row_w;
    float3 right =
        (float3)(u * view->row_w.w - view->row_u.w, v * view->row_w.w - view->row_v.w, depth - view->row_depth.w);
    float3 bc = cross3(b, c), ca = cross3(c, a), ab = cross3(a, b);
    return (bc * right.x + ca * right.y + ab * right.z) / dot3(a, bc) + view->origin.xyz;
}

static bool is_in_view(const ViewPlan* plan, float3 p) {
    float3 from_eye = p - plan->eye.xyz;
    float z = camera_depth(plan, p);
    float x = dot3(from_eye, plan->right.xyz);
    float y = dot3(from_eye, plan->up.xyz);
    return z > 0.0f && fabs(x) <= z * plan->right.w && fabs(y) <= z * plan->up.w;
}

static float depth_of(__global const float* depths, __global const MapView* view, int x, int y) {
    int2 at = clamp((int2)(x, y), 0, (int)WARP_SEGMENTS - 1);
    return depths[view->first_texel + (uint)at.y * view->row_stride + (uint)at.x];
}

// True if depth jumps here: a plane changes evenly across each pair of opposite neighbours; a larger change is a jump.
static bool is_edge(__global const float* depths, __global const MapView* view, int x, int y) {
    const int2 ways[4] = {(int2)(1, 0), (int2)(0, 1), (int2)(1, 1), (int2)(1, -1)};
    float here = depth_of(depths, view, x, y);
    for (int i = 0; i < 4; ++i) {
        float before = depth_of(depths, view, x - ways[i].x, y - ways[i].y);
        float after = depth_of(depths, view, x + ways[i].x, y + ways[i].y);
        if (fabs(after - 2.0f * here + before) > EDGE_JUMP) return true;
    }
    return false;
}

static float forward_importance(const ViewPlan* plan, const WarpPlan* warp, __global const MapView* view,
                                __global const float* depths, int x, int y, float farthest) {
    float here = depth_of(depths, view, x, y);
    if (here >= 1.0f) return 0.0f;  // the texel is empty
    float cell = 1.0f / (float)WARP_SEGMENTS, u = ((float)x + 0.5f) * cell, v = ((float)y + 0.5f) * cell;
    float3 p = point_at(view, u, v, here);
    if ((warp->functions & IMPORTANCE_VIEW) && !is_in_view(plan, p)) return 0.0f;
    float3 across = point_at(view, u + cell, v, depth_of(depths, view, x + 1, y)) - p;
    float3 along = point_at(view, u, v + cell, depth_of(depths, view, x, y + 1)) - p;
    return surface_importance(plan, warp, p, cross3(across, along), farthest);
}

// `views` and `depths` belong to the small map.
__kernel void rectilinear_forward(ViewPlan plan, WarpPlan warp, __global const MapView* views,
                                  __global const float* depths, __global const KeyBounds* bounds,
                                  __global uint* importance) {
    KeyBounds points = bounds[1];
    float farthest = greatest_of(&points, 2);
    GN_FOR_EACH(i, (size_t)plan.view_count * CELLS) {
        __global const MapView* view = views + i / CELLS;
        if (view->width == 0) continue;
        uint cell = (uint)(i % CELLS);
        int x = (int)(cell % WARP_SEGMENTS), y = (int)(cell / WARP_SEGMENTS);
        float mine = warp.analysis == ANALYSIS_HYBRID ? as_float(importance[i])
                                                      : forward_importance(&plan, &warp, view, depths, x, y, farthest);
        if ((warp.functions & IMPORTANCE_EDGE) && is_edge(depths, view, x, y)) mine *= 1.0f + EDGE_GAIN;
        importance[i] = as_uint(mine);
    }
}

// ---- Tables ---------------------------------------------------------------------------------------------------------

static float blurred(__local const float* lines, int line) {
    float sum = 0.0f, weights = 0.0f;
    for (int step = -BLUR_REACH; step <= BLUR_REACH; ++step) {
        float weight = exp(-0.5f * (float)(step * step) / (BLUR_SIGMA * BLUR_SIGMA));
        sum += weight * lines[clamp(line + step, 0, (int)WARP_SEGMENTS - 1)];
        weights += weight;
    }
    return sum / weights;
}

// Work-group g: view g / 2, axis g % 2. `lines` has 2 WARP_SEGMENTS floats.
__kernel void rectilinear_tables(WarpPlan warp, __global const uint* importance, __global MapView* views,
                                 __global float* tables, __local float* lines) {
    uint view = (uint)get_group_id(0) / 2, axis = (uint)get_group_id(0) % 2;
    __global const uint* cells = importance + view * CELLS;
    GN_FOR_EACH_IN_GROUP(line, WARP_SEGMENTS) {
        uint largest = 0;
        for (uint i = 0; i < WARP_SEGMENTS; ++i)
            largest = max(largest, cells[axis == 0u ? i * WARP_SEGMENTS + line : line * WARP_SEGMENTS + i]);
        lines[line] = as_float(largest);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    GN_FOR_EACH_IN_GROUP(line, WARP_SEGMENTS) lines[WARP_SEGMENTS + line] = blurred(lines, (int)line);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) != 0) return;

    __local float* shares = lines + WARP_SEGMENTS;
    float largest = 0.0f, sum = 0.0f;
    for (uint i = 0; i < WARP_SEGMENTS; ++i) largest = fmax(largest, shares[i]);
    // If no point gives importance, all columns have the same importance.
    float least = largest > 0.0f ? MIN_IMPORTANCE * largest : 1.0f;
    for (uint i = 0; i < WARP_SEGMENTS; ++i) {
        shares[i] = fmax(shares[i], least);
        sum += shares[i];
    }
    uint first = warp.tables_first + view * 2 * (WARP_SEGMENTS + 1);
    __global float* table = tables + first + axis * (WARP_SEGMENTS + 1);
    float before = 0.0f;
    for (uint i = 0; i < WARP_SEGMENTS; ++i) {
        table[i] = before / sum;
        before += shares[i];
    }
    table[WARP_SEGMENTS] = 1.0f;
    if (axis != 0) return;
    views[view].warp = WARP_RECTILINEAR;
    views[view].warp_size = WARP_SEGMENTS;
    views[view].forward_first = first;
}
