// SPDX-License-Identifier: MIT
// Lookups that compare depths: hard, percentage-closer filters, soft shadows by blocker search (contract: lookup.h).
//
//   visibility = sum of weight_i [depth_i >= receiver_i - receiver_bias] / sum of weight_i
// receiver_i is the nearer of two depths with adaptive bias: the point's depth, and the depth of the receiver's plane
// at texel i's centre (Dou, Yan, Kerzner, Dai, Wyman 2014); else it is the point's depth. With adaptive bias a flat
// receiver never shadows itself, whatever the angle, and the only remaining bias is for rounding.
#include "techniques/shadow_map/lookup.h"

static float tap(const LookupPlan* plan, const MapPoint* point, __global const float* depths, int x, int y) {
    float depth = point->depth;
    if (plan->adaptive && point->has_plane) {
        __global const float* columns = point->tables + point->view->centres_first;
        uint column = (uint)clamp(x, 0, (int)point->view->width - 1),
             row = (uint)clamp(y, 0, (int)point->view->height - 1);
        depth = fmin(depth, plane_depth(point, (float2)(columns[column], columns[point->view->width + row])));
    }
    return depths[texel_at(point, x, y)] >= depth - plan->receiver_bias ? 1.0f : 0.0f;
}

static float lookup_hard(const LookupPlan* plan, const MapPoint* point, __global const float* depths, float2 at) {
    return tap(plan, point, depths, (int)floor(at.x), (int)floor(at.y));
}

// taps x taps points a texel apart; each reads the texel that it lies in.
static float lookup_pcf(const LookupPlan* plan, const MapPoint* point, __global const float* depths) {
    float sum = 0.0f, first = -0.5f * (float)(plan->taps - 1);
    for (uint y = 0; y < plan->taps; ++y)
        for (uint x = 0; x < plan->taps; ++x)
            sum += lookup_hard(plan, point, depths, point->at_texels + first + (float2)(x, y));
    return sum / (float)(plan->taps * plan->taps);
}

// Weights of taps + 1 texels along an axis: each of the kernel's taps is a bilinear lookup, and so a share of two
// texels. As in Gruen's filter (2010), the kernel reads each texel once if neighbouring taps share it.
static void smooth_weights(const LookupPlan* plan, float fraction, float* weights) {
    float sigma = (float)plan->taps / 4.5f, middle = 0.5f * (float)(plan->taps - 1);
    float before = 0.0f;
    for (uint i = 0; i < plan->taps; ++i) {
        float from_middle = ((float)i - middle) / sigma;
        float w = plan->lookup == LOOKUP_GAUSSIAN ? exp(-0.5f * from_middle * from_middle) : 1.0f;
        weights[i] = before + w * (1.0f - fraction);
        before = w * fraction;
    }
    weights[plan->taps] = before;
}

static float lookup_smooth(const LookupPlan* plan, const MapPoint* point, __global const float* depths) {
    float2 corner = point->at_texels - 0.5f * (float)plan->taps, whole = floor(corner), fraction = corner - whole;
    float columns[MOST_TAPS + 1], rows[MOST_TAPS + 1];
    smooth_weights(plan, fraction.x, columns);
    smooth_weights(plan, fraction.y, rows);
    float sum = 0.0f, all = 0.0f;
    for (uint y = 0; y <= plan->taps; ++y)
        for (uint x = 0; x <= plan->taps; ++x) {
            float weight = columns[x] * rows[y];
            if (weight == 0.0f) continue;
            sum += weight * tap(plan, point, depths, (int)whole.x + (int)x, (int)whole.y + (int)y);
            all += weight;
        }
    return sum / all;
}

static float lookup_twelve(const LookupPlan* plan, const MapPoint* point, __global const float* depths,
                           __constant const float2* offsets) {
    float sum = 0.0f;
    for (int i = 0; i < 12; ++i)
        sum += lookup_hard(plan, point, depths, point->at_texels + plan->softness * offsets[i]);
    return sum / 12.0f;
}

// Grid of taps x taps points over `width` texels: mean visibility, and of the blockers their number and mean depth.
static float grid_of_taps(const LookupPlan* plan, const MapPoint* point, __global const float* depths, float2 width,
                          uint* blockers, float* blocker_depth) {
    float lit = 0.0f, depth = 0.0f;
    uint found = 0;
    for (uint y = 0; y < plan->taps; ++y)
        for (uint x = 0; x < plan->taps; ++x) {
            float2 at = point->at_texels + width * (((float2)(x, y) + 0.5f) / (float)plan->taps - 0.5f);
            float visible = lookup_hard(plan, point, depths, at);
            lit += visible;
            if (visible != 0.0f) continue;
            ++found;
            depth += depths[texel_at(point, (int)floor(at.x), (int)floor(at.y))];
        }
    *blockers = found;
    *blocker_depth = found != 0 ? depth / (float)found : 0.0f;
    return lit / (float)(plan->taps * plan->taps);
}

// The penumbra of a point light is (d_receiver - d_blocker) / d_blocker times the light's size; the penumbra of a
// directional light is the distance of receiver and blocker times the tangent of the angle. Both are widths at the
// receiver. The search covers the reach of a blocker half-way (point light) or at depth 0 (directional light).
static float lookup_pcss(const LookupPlan* plan, const MapPoint* point, __global const float* depths) {
    __global const MapView* view = point->view;
    float world_per_depth = 1.0f / length(vload3(0, view->row_depth));
    bool is_point_light = view->front_depth > -INFINITY;
    float2 texels = texels_per_length(point);
    float reach = is_point_light ? plan->light_size : plan->light_size * fmax(point->depth, 0.0f) * world_per_depth;
    uint blockers;
    float blocker_depth, ignored_depth;
    grid_of_taps(plan, point, depths, reach * texels, &blockers, &blocker_depth);
    if (blockers == 0) return 1.0f;
    float gap = fmax(point->depth - blocker_depth, 0.0f);
    float penumbra = plan->light_size *
                     (is_point_light ? gap / fmax(blocker_depth - view->front_depth, 1.0e-6f) : gap * world_per_depth);
    return grid_of_taps(plan, point, depths, fmax(fmin(penumbra, reach) * texels, 1.0f), &blockers, &ignored_depth);
}

static float lookup_in_view(const LookupPlan* plan, const MapPoint* point, __global const float* depths,
                            __constant const float2* offsets) {
    if (plan->lookup == LOOKUP_HARD) return lookup_hard(plan, point, depths, point->at_texels);
    if (plan->lookup == LOOKUP_PCF) return lookup_pcf(plan, point, depths);
    if (plan->lookup == LOOKUP_TWELVE) return lookup_twelve(plan, point, depths, offsets);
    if (plan->lookup == LOOKUP_PCSS) return lookup_pcss(plan, point, depths);
    return lookup_smooth(plan, point, depths);
}

__kernel void depth_lookup(LookupPlan plan, MapSet set, PointsLayout layout, __global const float* positions,
                           __global const uint* receivers, __global const float* vertices,
                           __global const MapView* views, __global const float* tables, __global const float* depths,
                           __constant const float2* offsets, __global float* visibility) {
    GN_FOR_EACH(i, layout.count) {
        float3 p, a, b;
        uint index;
        if (!is_looked_up(set, layout, positions, visibility, views, i, &p, &index)) continue;
        bool has_plane = plan.adaptive && layout.has_receivers && receivers[i] < plan.triangle_count &&
                         plane_tangents(load_triangle(vertices + plan.first_float, receivers[i]), &a, &b);
        float share = share_of_next(set, views, index, p), lit = 0.0f;
        for (uint next = 0; next <= (share > 0.0f ? 1u : 0u); ++next) {
            MapPoint point;
            make_map_point(views + index + next, tables, p, &point);
            point.has_plane = has_plane;
            if (has_plane) {
                point.tangent_a = homogeneous_direction(point.view, a);
                point.tangent_b = homogeneous_direction(point.view, b);
            }
            lit += (next ? share : 1.0f - share) * lookup_in_view(&plan, &point, depths, offsets);
        }
        visibility[i] = lit;
    }
}
