// SPDX-License-Identifier: MIT
// Searches for the warp of each face of a point light's cube, and applies it (point_light_perspective.h):
//   ..._samples  (X, Y, A / z) and face of every k-th receiver (k: the stride)
//   ..._costs    the cost of each face's choices, one work-item for each: every device adds in the same order
//   ..._warp     the cheapest choice becomes the face's homography, one work-item per face
#include "rivals/shadow_map/partition.clh"
#include "rivals/shadow_map/point_light_perspective.h"
#include "simd/points.h"

static float dot2(float2 a, float2 b) { return a.x * b.x + a.y * b.y; }

typedef struct FaceWarp {
    float2 along, across;     // d and e
    float line, extent, x_c;  // least d . (X, Y), its range, and the middle of e . (X, Y)
} FaceWarp;

// The warp over the box of the face's receivers: no receiver lies before its line.
static FaceWarp make_warp(const KeyBounds* box, uint direction) {
    FaceWarp warp;
    float angle = 2.0f * (float)direction / (float)WARP_DIRECTIONS;
    warp.along = (float2)(cospi(angle), sinpi(angle));
    warp.across = (float2)(-warp.along.y, warp.along.x);
    float2 low = (float2)(min_of(box, 0), min_of(box, 1)), high = (float2)(greatest_of(box, 0), greatest_of(box, 1));
    float2 middle = 0.5f * (low + high), half_size = 0.5f * (high - low);
    float reach = fabs(warp.along.x) * half_size.x + fabs(warp.along.y) * half_size.y;
    warp.line = dot2(warp.along, middle) - reach;
    warp.extent = fmax(2.0f * reach, 1.0e-6f);
    warp.x_c = dot2(warp.across, middle);
    return warp;
}

static float distance_of(const FaceWarp* warp, uint choice) { return warp->extent * exp2(0.5f * (float)choice - 4.0f); }

__kernel void point_light_perspective_samples(ViewPlan plan, WarpSampling sampling, PointsLayout layout,
                                              __global const float* positions, __global const float* visibility,
                                              __global const PlannedView* planned, __global float* samples,
                                              __global uint* faces) {
    GN_FOR_EACH(k, sampling.sample_count) {
        uint i = (uint)k * sampling.stride;
        faces[k] = NO_FACE;
        float3 p = load_point(positions, layout, i);
        if (visibility[i] != 1.0f || !is_present(p)) continue;
        for (uint face = 0; face < plan.view_count && faces[k] == NO_FACE; ++face) {
            __global const PlannedView* view = planned + FIRST_VIEW + face;
            float4 position;
            if (!position_in_view(&plan, view, p, &position)) continue;
            float z = fmax(dot3(p - plan.eye.xyz, plan.forward.xyz), view->near_depth);
            faces[k] = face;
            vstore3((float3)(position.xy, position.z / z), k, samples);
        }
    }
}

__kernel void point_light_perspective_costs(ViewPlan plan, WarpSampling sampling, __global const float* samples,
                                            __global const uint* faces, __global const KeyBounds* bounds,
                                            __global float* costs) {
    GN_FOR_EACH(item, plan.view_count * WARP_DIRECTIONS * WARP_CHOICES) {
        uint face = (uint)item / (WARP_DIRECTIONS * WARP_CHOICES);
        uint direction = (uint)item / WARP_CHOICES % WARP_DIRECTIONS, choice = (uint)item % WARP_CHOICES;
        bool is_plain = choice == WARP_DISTANCES;
        costs[item] = INFINITY;
        KeyBounds box = bounds[FIRST_VIEW + face];
        if (is_empty(&box) || (is_plain && direction != 0)) continue;
        FaceWarp warp = make_warp(&box, direction);
        float n = distance_of(&warp, choice);
        float2 low = (float2)(INFINITY), high = (float2)(-INFINITY);
        float wide = 0.0f, deep = 0.0f;
        for (uint k = 0; k < sampling.sample_count; ++k) {
            if (faces[k] != face) continue;
            float3 sample = vload3(k, samples);
            float at = dot2(warp.along, sample.xy) - warp.line, beside = dot2(warp.across, sample.xy) - warp.x_c;
            float w = is_plain ? 1.0f : at + n;
            float2 uv = is_plain ? (float2)(beside, at) : (float2)(beside, 1.0f) / w;
            low = fmin(low, uv), high = fmax(high, uv);
            wide += w * sample.z;
            deep += w * w * sample.z;
        }
        if (low.x <= high.x) costs[item] = (high.x - low.x) * wide + (high.y - low.y) * deep;
    }
}

// Resets the bounds, which the next launch computes anew. A face that stays plain gets the same bounds again.
__kernel void point_light_perspective_warp(ViewPlan plan, __global const float* costs, __global KeyBounds* bounds,
                                           __global PlannedView* planned) {
    GN_FOR_EACH(face, plan.view_count) {
        __global PlannedView* view = planned + FIRST_VIEW + face;
        KeyBounds box = bounds[FIRST_VIEW + face];
        for (int i = 0; i < 8; ++i) bounds[FIRST_VIEW + face].least[i] = 0xFFFFFFFFu;
        uint first = (uint)face * WARP_DIRECTIONS * WARP_CHOICES, best = WARP_DISTANCES;
        for (uint i = 0; i < WARP_DIRECTIONS * WARP_CHOICES; ++i)
            if (costs[first + i] < costs[first + best]) best = i;
        if (is_empty(&box) || best == WARP_DISTANCES) continue;
        FaceWarp warp = make_warp(&box, best / WARP_CHOICES);
        float4 x = view->row_u, y = view->row_v, a = view->row_w;
        float4 u = x * warp.across.x + y * warp.across.y - a * warp.x_c;
        float4 w = x * warp.along.x + y * warp.along.y - a * (warp.line - distance_of(&warp, best % WARP_CHOICES));
        view->row_u = u;
        view->row_v = a;
        view->row_w = w;
        for (int axis = 0; axis < 2; ++axis) view->limit_low[axis] = -INFINITY, view->limit_high[axis] = INFINITY;
        view->face = (uint)face;
    }
}
