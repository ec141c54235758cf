// SPDX-License-Identifier: MIT
// Lookup of filtered quantities: bilinear in the prefiltered planes, between two levels of a mip chain, or a box of any
// width in summed areas; then the store's estimate of visibility (visibility_bounds.clh).
#include "techniques/shadow_map/lookup.h"
#include "techniques/shadow_map/texel_footprint.h"
#include "techniques/shadow_map/visibility_bounds.clh"

#define MOST_PLANES 32

// Adds `share` of the bilinear mean of one level.
static void add_bilinear(const StorePlan* plan, const MapPoint* point, MipLevel level, float share, uint texels,
                         __global const void* numbers, float* means) {
    float2 scale = (float2)(level.width, level.height) / (float2)(point->view->width, point->view->height);
    float2 corner = point->at_texels * scale - 0.5f, whole = floor(corner), f = corner - whole;
    int last_x = (int)level.width - 1, last_y = (int)level.height - 1;
    size_t x0 = (size_t)clamp((int)whole.x, 0, last_x), x1 = (size_t)clamp((int)whole.x + 1, 0, last_x);
    size_t row0 = level.first + (size_t)clamp((int)whole.y, 0, last_y) * level.row_stride,
           row1 = level.first + (size_t)clamp((int)whole.y + 1, 0, last_y) * level.row_stride;
    for (uint p = 0; p < plan->planes; ++p) {
        size_t plane = (size_t)p * texels;
        float n00 = load_number(plan->half_bits, numbers, plane + row0 + x0),
              n10 = load_number(plan->half_bits, numbers, plane + row0 + x1),
              n01 = load_number(plan->half_bits, numbers, plane + row1 + x0),
              n11 = load_number(plan->half_bits, numbers, plane + row1 + x1);
        float above = n00 + f.x * (n10 - n00), below = n01 + f.x * (n11 - n01);
        means[p] += share * (above + f.y * (below - above));
    }
}

// Chain level for a footprint: a texel is as wide as its longer side. A whole level plus the share of the next level.
static float level_of_footprint(const StorePlan* plan, const PixelSteps* steps, const MapPoint* point, Triangle t,
                                float3 p) {
    float2 ds, dt;
    pixel_footprint(steps, point->view, point->tables, t, p, &ds, &dt);
    float longer = fmax(length(ds), length(dt));
    return longer > 1.0f ? fmin(log2(longer), (float)plan->mips) : 0.0f;  // not a number (no plane): 0
}

static void fetch(const StorePlan* plan, const MapPoint* point, float level, uint texels, __global const void* planes,
                  __global const void* mips, float* means) {
    for (uint p = 0; p < plan->planes; ++p) means[p] = 0.0f;
    uint whole = (uint)level;
    while (whole > 0 && mip_level(point->view, whole).width == 0) --whole;  // a view with fewer levels than the largest
    MipLevel next = mip_level(point->view, whole + 1u);
    float share = whole < plan->mips && next.width != 0 ? fmin(level - (float)whole, 1.0f) : 0.0f;
    add_bilinear(plan, point, mip_level(point->view, whole), 1.0f - share, texels, whole == 0 ? planes : mips, means);
    if (share > 0.0f) add_bilinear(plan, point, next, share, texels, mips, means);
}

// Sum of all texels with column < x and row < y.
static uint sum_before(const MapPoint* point, __global const uint* sums, int x, int y) {
    if (x <= 0 || y <= 0) return 0;
    return sums[texel_at(point, x - 1, y - 1)];
}

// Sum over [x0, x1) x [y0, y1), whole texels inside the view.
static float box_sum(const MapPoint* point, __global const uint* sums, int x0, int y0, int x1, int y1) {
    if (x1 <= x0 || y1 <= y0) return 0.0f;
    return (float)(sum_before(point, sums, x1, y1) - sum_before(point, sums, x0, y1) - sum_before(point, sums, x1, y0) +
                   sum_before(point, sums, x0, y0));
}

// Mean over the box of plan->width texels around the point, border texels by their share. This equals the bilinear mean
// of the four boxes of whole texels.
static void fetch_summed(const StorePlan* plan, const MapPoint* point, uint texels, __global const uint* sums,
                         float* means) {
    int width = (int)rint(plan->width);
    float2 corner = point->at_texels - 0.5f * (float)width, whole = floor(corner), f = corner - whole;
    float weights[4] = {(1.0f - f.x) * (1.0f - f.y), f.x * (1.0f - f.y), (1.0f - f.x) * f.y, f.x * f.y};
    for (uint p = 0; p < plan->planes; ++p) means[p] = 0.0f;
    float all = 0.0f;
    for (int k = 0; k < 4; ++k) {
        int x0 = (int)whole.x + (k & 1), y0 = (int)whole.y + (k >> 1);
        int x1 = clamp(x0 + width, 0, (int)point->view->width), y1 = clamp(y0 + width, 0, (int)point->view->height);
        x0 = clamp(x0, 0, (int)point->view->width);
        y0 = clamp(y0, 0, (int)point->view->height);
        if (x1 <= x0 || y1 <= y0 || weights[k] == 0.0f) continue;
        all += weights[k];
        float share = weights[k] / ((float)((x1 - x0) * (y1 - y0)) * plan->summed_scale);
        for (uint p = 0; p < plan->planes; ++p)
            means[p] += share * box_sum(point, sums + (size_t)p * texels, x0, y0, x1, y1);
    }
    for (uint p = 0; p < plan->planes; ++p) {
        means[p] /= all;
        if (is_signed(plan)) means[p] = 2.0f * means[p] - 1.0f;
    }
}

// 1: all four texels around the point are at least as far as the point; -1: all are nearer; 0: they disagree.
static int agreement(const StorePlan* plan, const MapPoint* point, __global const float* depths) {
    float t = point->depth - plan->receiver_bias;
    int x = (int)floor(point->at_texels.x - 0.5f), y = (int)floor(point->at_texels.y - 0.5f), lit = 0;
    for (int k = 0; k < 4; ++k) lit += depths[texel_at(point, x + (k & 1), y + (k >> 1))] >= t;
    return lit == 4 ? 1 : lit == 0 ? -1 : 0;
}

static float lookup_in_view(const StorePlan* plan, const MapPoint* point, float level, uint texels,
                            __global const float* depths, __global const void* planes, __global const void* mips) {
    int agreed = plan->edges_only ? agreement(plan, point, depths) : 0;
    if (agreed != 0) return agreed > 0 ? 1.0f : 0.0f;
    float means[MOST_PLANES];
    if (plan->summed)
        fetch_summed(plan, point, texels, (__global const uint*)planes, means);
    else
        fetch(plan, point, level, texels, planes, mips, means);
    return visibility_estimate(plan, means, point->depth - plan->receiver_bias);
}

// With mips the points have receivers and a camera; plan.steps are the camera's pixel steps.
__kernel void moment_lookup(MomentLookupPlan plan, MapSet set, PointsLayout layout, __global const float* positions,
                            __global const uint* receivers, __global const float* vertices,
                            __global const MapView* views, __global const float* tables, __global const float* depths,
                            __global const void* planes, __global const void* mips, __global float* visibility) {
    GN_FOR_EACH(i, layout.count) {
        float3 p;
        uint index;
        if (!is_looked_up(set, layout, positions, visibility, views, i, &p, &index)) continue;
        float share = share_of_next(set, views, index, p), lit = 0.0f;
        for (uint next = 0; next <= (share > 0.0f ? 1u : 0u); ++next) {
            MapPoint point;
            make_map_point(views + index + next, tables, p, &point);
            float level = 0.0f;
            if (plan.store.mips != 0 && receivers[i] < plan.triangle_count)
                level = level_of_footprint(&plan.store, &plan.steps, &point,
                                           load_triangle(vertices + plan.first_float, receivers[i]), p);
            lit += (next ? share : 1.0f - share) *
                   lookup_in_view(&plan.store, &point, level, set.texels, depths, planes, mips);
        }
        visibility[i] = lit;
    }
}
