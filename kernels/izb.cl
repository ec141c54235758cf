// SPDX-License-Identifier: MIT
// Irregular z-buffer: the points that still need an answer, listed by bin of light space, contiguous (count, scan,
// scatter) and as a structure of arrays; with the coarse shadow test inside its build (Johnson et al. 2005, Aila and
// Laine 2004 for the structure; Mizoguchi and Tokuyoshi, section 3.1, for the test).
//
// Coarse test: a point below its texel's conservative height is in shadow for certain and never listed. If the point
// has a receiver, the receiver itself might be what covers the texel: then the exact predicate says whether the
// receiver would block the point, and only if not (so that the cover must be another triangle) is the point settled
// here. An eye does not spare that: it says that light and eye are on one side of the receiver, not that a caller's
// point is.
#include "exact/blocks.h"
#include "light_frame.h"
#include "triangle_setup.h"

static bool is_decided_by_map(__constant const Projection* projection, float3 p, float3 point, uint receiver,
                              ulong first_float, uint triangle_count, __global const float* vertices,
                              __global const uint* map) {
    uint texel = texel_index(point.y, projection->height) * projection->width + texel_index(point.x, projection->width);
    if (!(float_to_key(point.z) < map[texel])) return false;
    if (receiver >= triangle_count) return true;
    int level = DET3_BY_FLOAT;
    Triangle own = load_triangle(vertices + first_float, receiver);
    float4 light = (float4)(projection->light[0], projection->light[1], projection->light[2], projection->light[3]);
    return !is_finite_triangle(own) || !blocks(own, p, light, &level);
}

__kernel void izb_count(LightFrame frame, PointsLayout layout, __constant const Projection* projection, uint has_map,
                        ulong first_float, uint triangle_count, __global const float* positions,
                        __global const uint* receivers, __global const float* vertices, __global const uint* map,
                        __global float* visibility, __global uint* counts, __global uint* farthest,
                        __global FrameCounters* counters) {
    uint decided = 0, listed = 0;
    GN_FOR_EACH(i, layout.count) {
        float3 p;
        if (!is_open_in_frame(frame, layout, positions, visibility, i, &p)) continue;
        float3 point = project_point(projection, p);
        uint receiver = layout.has_receivers ? receivers[i] : GN_NO_ID;
        if (has_map && !projection->indistinct &&
            is_decided_by_map(projection, p, point, receiver, first_float, triangle_count, vertices, map)) {
            visibility[i] = 0.0f;
            ++decided;
            continue;
        }
        uint bin = bin_of(projection, point);
        atomic_inc(&counts[bin]);
        atomic_min(&farthest[bin], float_to_key(point.z));
        ++listed;
    }
    if (decided != 0) atomic_add(&counters->decided_by_map, decided);
    if (listed != 0) atomic_add(&counters->listed, listed);
}

__kernel void izb_scatter(LightFrame frame, PointsLayout layout, __constant const Projection* projection,
                          __global const float* positions, __global const float* visibility,
                          __global const uint* offsets, __global uint* cursors, __global float* sorted_x,
                          __global float* sorted_y, __global float* sorted_z, __global uint* order,
                          __global uint* block_bin) {
    GN_FOR_EACH(i, layout.count) {
        float3 p;
        if (!is_open_in_frame(frame, layout, positions, visibility, i, &p)) continue;
        float3 point = project_point(projection, p);
        uint bin = bin_of(projection, point);
        uint place = atomic_inc(&cursors[bin]);
        uint slot = offsets[bin] + place;
        sorted_x[slot] = point.x;
        sorted_y[slot] = point.y;
        sorted_z[slot] = point.z;
        order[slot] = (uint)i;
        if (place % GN_LANES == 0u) block_bin[slot / GN_LANES] = bin;
    }
}
