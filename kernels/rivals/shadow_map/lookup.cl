// SPDX-License-Identifier: MIT
// The lookup (contract: lookup.h) of depths or, with LOOKUP_STORED, of other stored quantities.
#include "rivals/shadow_map/lookup.h"

#ifdef LOOKUP_STORED
#include "rivals/shadow_map/moment_lookup.clh"
#else
#include "rivals/shadow_map/depth_lookup.clh"
#endif

__kernel void map_lookup(LookupPlan plan, MapSet set, PointsLayout layout, __global const float* positions,
                         __global const uint* receivers, __global const float* vertices, __global const MapView* views,
                         __global const float* tables, __global const float* depths, __global const void* planes,
                         __global const void* mips, __global float* visibility) {
    bool wants_receiver = layout.has_receivers && (plan.adaptive || plan.store.mips != 0);
    GN_FOR_EACH(i, layout.count) {
        float3 p;
        uint index;
        if (!is_looked_up(set, layout, positions, visibility, views, i, &p, &index)) continue;
        Triangle t;
        bool has_receiver = wants_receiver && receivers[i] < plan.triangle_count;
        if (has_receiver) t = load_triangle(vertices + plan.first_float, receivers[i]);
        float share = share_of_next(set, views, index, p), lit = 0.0f;
        for (uint next = 0; next <= (share > 0.0f ? 1u : 0u); ++next) {
            MapPoint point;
            make_map_point(views + index + next, tables, p, &point);
#ifdef LOOKUP_STORED
            float visible = lookup_in_view(&plan, &point, has_receiver ? &t : 0, p, set.texels, depths, planes, mips);
#else
            if (has_receiver) set_receiver_plane(&point, t);
            float visible = lookup_in_view(&plan, &point, p, depths);
#endif
            lit += (next ? share : 1.0f - share) * visible;
        }
        visibility[i] = lit;
    }
}
