// SPDX-License-Identifier: MIT
// Lookup of filtered quantities: bilinear in the prefiltered planes, or a box of any width in summed areas; then the
// store's estimate of visibility (visibility_bounds.h).
#include "lookup.h"
#include "visibility_bounds.h"

#define MOST_PLANES 32

static void fetch_bilinear(const StorePlan* plan, const Receiver* r, uint texels, __global const void* planes,
                           float* means) {
    float2 corner = r->at_texels - 0.5f, whole = floor(corner), f = corner - whole;
    int x = (int)whole.x, y = (int)whole.y;
    size_t at00 = texel_at(r, x, y), at10 = texel_at(r, x + 1, y), at01 = texel_at(r, x, y + 1),
           at11 = texel_at(r, x + 1, y + 1);
    for (uint p = 0; p < plan->planes; ++p) {
        size_t plane = (size_t)p * texels;
        float z00 = load_number(plan->half_bits, planes, plane + at00),
              z10 = load_number(plan->half_bits, planes, plane + at10),
              z01 = load_number(plan->half_bits, planes, plane + at01),
              z11 = load_number(plan->half_bits, planes, plane + at11);
        float above = z00 + f.x * (z10 - z00), below = z01 + f.x * (z11 - z01);
        means[p] = above + f.y * (below - above);
    }
}

// Sum of all texels with column < x and row < y.
static uint sum_before(const Receiver* r, __global const uint* sums, int x, int y) {
    if (x <= 0 || y <= 0) return 0;
    return sums[texel_at(r, x - 1, y - 1)];
}

// Sum over [x0, x1) x [y0, y1), whole texels inside the view.
static float box_sum(const Receiver* r, __global const uint* sums, int x0, int y0, int x1, int y1) {
    if (x1 <= x0 || y1 <= y0) return 0.0f;
    return (float)(sum_before(r, sums, x1, y1) - sum_before(r, sums, x0, y1) - sum_before(r, sums, x1, y0) +
                   sum_before(r, sums, x0, y0));
}

// Mean over the box of plan->width texels around the point, border texels by their share: bilinear between the four
// boxes of whole texels, which is the same.
static void fetch_summed(const StorePlan* plan, const Receiver* r, uint texels, __global const uint* sums,
                         float* means) {
    int width = (int)rint(plan->width);
    float2 corner = r->at_texels - 0.5f * (float)width, whole = floor(corner), f = corner - whole;
    float weights[4] = {(1.0f - f.x) * (1.0f - f.y), f.x * (1.0f - f.y), (1.0f - f.x) * f.y, f.x * f.y};
    for (uint p = 0; p < plan->planes; ++p) means[p] = 0.0f;
    float all = 0.0f;
    for (int k = 0; k < 4; ++k) {
        int x0 = (int)whole.x + (k & 1), y0 = (int)whole.y + (k >> 1);
        int x1 = clamp(x0 + width, 0, (int)r->view->width), y1 = clamp(y0 + width, 0, (int)r->view->height);
        x0 = clamp(x0, 0, (int)r->view->width);
        y0 = clamp(y0, 0, (int)r->view->height);
        if (x1 <= x0 || y1 <= y0 || weights[k] == 0.0f) continue;
        all += weights[k];
        float share = weights[k] / ((float)((x1 - x0) * (y1 - y0)) * plan->summed_scale);
        for (uint p = 0; p < plan->planes; ++p)
            means[p] += share * box_sum(r, sums + (size_t)p * texels, x0, y0, x1, y1);
    }
    for (uint p = 0; p < plan->planes; ++p) {
        means[p] /= all;
        if (is_signed(plan)) means[p] = 2.0f * means[p] - 1.0f;
    }
}

// 1: all four texels around the point are no nearer than it; -1: all are; 0: they disagree.
static int agreement(const StorePlan* plan, const Receiver* r, __global const float* depths) {
    float t = r->depth - plan->receiver_bias;
    int x = (int)floor(r->at_texels.x - 0.5f), y = (int)floor(r->at_texels.y - 0.5f), lit = 0;
    for (int k = 0; k < 4; ++k) lit += depths[texel_at(r, x + (k & 1), y + (k >> 1))] >= t;
    return lit == 4 ? 1 : lit == 0 ? -1 : 0;
}

__kernel void moment_lookup(StorePlan plan, MapSet set, PointsLayout layout, __global const float* positions,
                            __global const MapView* views, __global const float* tables, __global const float* depths,
                            __global const void* planes, __global float* visibility) {
    GN_FOR_EACH(i, layout.count) {
        if (visibility[i] != 1.0f) continue;
        float3 p = load_point(positions, layout, i);
        if (!is_present(p)) continue;
        uint index = select_view(set, views, p);
        if (index == NO_VIEW) continue;
        Receiver r;
        make_receiver(views + index, tables, p, &r);
        if (plan.edges_only) {
            int agreed = agreement(&plan, &r, depths);
            if (agreed < 0) visibility[i] = 0.0f;
            if (agreed != 0) continue;
        }
        float means[MOST_PLANES];
        if (plan.summed)
            fetch_summed(&plan, &r, set.texels, (__global const uint*)planes, means);
        else
            fetch_bilinear(&plan, &r, set.texels, planes, means);
        visibility[i] = visibility_estimate(&plan, means, r.depth - plan.receiver_bias);
    }
}
