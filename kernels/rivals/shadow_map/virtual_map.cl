// SPDX-License-Identifier: MIT
// Virtual shadow maps: levels, requests, pages, drawing and lookup (contract: virtual_map.h).
#include "rivals/shadow_map/caster.clh"
#include "rivals/shadow_map/diagnostic.h"
#include "rivals/shadow_map/lookup.h"
#include "rivals/shadow_map/virtual_map.h"

// The grids of all levels of one light's views: level_views[view levels + level].
__kernel void virtual_map_levels(VirtualPlan plan, VirtualLight light, __global const MapView* views,
                                 __global MapView* level_views) {
    GN_FOR_EACH(i, light.view_count * plan.levels) {
        uint view = light.first_view + (uint)i / plan.levels, level = (uint)i % plan.levels;
        uint size = plan.pages_across << PAGE_LOG2;
        MapView grid = views[i / plan.levels];
        if (grid.width != 0) grid.width = grid.height = size >> level;
        // Columns and rows of finer levels: 2 size (1 + 1/2 + 1/4 + ...).
        grid.centres_first = view * 4 * size + 4 * (size - (size >> level));
        grid.first_texel = 0;
        grid.row_stride = PAGE_SIZE;
        level_views[view * plan.levels + level] = grid;
    }
}

static uint wanted_level(const VirtualPlan* plan, MapSet set, const MapPoint* point, float3 p) {
    if (plan->pixel_size == 0.0f) return min(plan->level, plan->levels - 1);
    float2 density = texels_per_length(point);
    float texels = fmax(density.x, density.y) * fabs(camera_depth_of(set, p)) * plan->pixel_size / plan->detail;
    uint level = 0;
    for (; level + 1 < plan->levels && texels >= 2.0f; ++level) texels *= 0.5f;
    return level;
}

// Runs for one light. requested: 0 before. point_entries: the entry that each point requests, NO_PAGE if none.
__kernel void virtual_map_request(VirtualPlan plan, VirtualLight light, MapSet set, PointsLayout layout,
                                  __global const float* positions, __global const float* visibility,
                                  __global const MapView* views, __global const float* tables, __global uint* requested,
                                  __global uint* point_entries, __global VirtualCounters* counters) {
    GN_FOR_EACH(i, layout.count) {
        point_entries[light.first_point + i] = NO_PAGE;
        if (visibility[i] != 1.0f) continue;
        float3 p = load_point(positions, layout, i);
        if (!is_present(p)) continue;
        uint index = select_view(set, views, p);
        if (index == NO_VIEW) {
            atomic_inc(&counters->points_outside);
            continue;
        }
        MapPoint point;
        make_map_point(views + index, tables, p, &point);
        uint level = wanted_level(&plan, set, &point, p);
        uint2 page = texel_below(point.at_texels, point.view) >> (PAGE_LOG2 + level);
        uint entry = page_entry(&plan, light.first_view + index, level, page.x, page.y);
        point_entries[light.first_point + i] = entry;
        // Many points request one page: most points need not write.
        if (GN_RELAXED_LOAD(&requested[entry]) == 0 && atomic_xchg(&requested[entry], 1u) == 0)
            atomic_inc(&counters->pages_requested);
    }
}

__kernel void virtual_map_pages(VirtualPlan plan, __global const MapView* level_views, __global const uint* requested,
                                __global const uint* page_of, __global MapView* pages) {
    GN_FOR_EACH(entry, plan.view_count * plan.entries_per_view) {
        if (requested[entry] == 0) continue;
        Page page = page_of_entry(&plan, (uint)entry);
        MapView grid = level_views[page.view * plan.levels + page.level];
        grid.first_texel = page_of[entry] * PAGE_TEXELS - page.row * PAGE_TEXELS - page.column * PAGE_SIZE;
        pages[page_of[entry]] = grid;
    }
}

static void clip_to_page(Caster* caster, uint2 page) {
    caster->covered.low = max(caster->covered.low, page << PAGE_LOG2);
    caster->covered.high = min(caster->covered.high, ((page + 1u) << PAGE_LOG2) - 1u);
}

// Draws triangle i into the requested pages of one level of one view, or lists it with each.
static void draw_into_pages(const VirtualPlan* plan, const DepthPass* pass, uint level_view, uint triangle,
                            const Caster* caster, __global const uint* requested, __global const uint* page_of,
                            __global const MapView* pages, __global const float* tables, __global uint* touched,
                            __global uint* keys, __global VirtualCounters* counters, __global uint2* pairs) {
    bool is_small = texels_of(caster->covered) <= SMALL_TEXELS;
    for (uint row = caster->covered.low.y >> PAGE_LOG2; row <= caster->covered.high.y >> PAGE_LOG2; ++row)
        for (uint column = caster->covered.low.x >> PAGE_LOG2; column <= caster->covered.high.x >> PAGE_LOG2;
             ++column) {
            uint entry = page_entry(plan, level_view / plan->levels, level_view % plan->levels, column, row);
            if (requested[entry] == 0) continue;
            uint page = page_of[entry];
            if (GN_RELAXED_LOAD(&touched[page]) == 0) atomic_xchg(&touched[page], 1u);
            if (is_small) {
                Caster part = *caster;
                clip_to_page(&part, (uint2)(column, row));
                draw_rectangle(pass, pages + page, tables, &part, part.covered, keys, keys);
                continue;
            }
            uint at = atomic_inc(&counters->pairs);
            if (at < pass->chunk_capacity) pairs[at] = (uint2)(triangle, entry);
        }
}

__kernel void virtual_map_small(VirtualPlan plan, DepthPass pass, __global const float* vertices,
                                __global const MapView* level_views, __global const float* tables,
                                __global const uint* requested, __global const uint* page_of,
                                __global const MapView* pages, __global uint* touched, __global uint* keys,
                                __global VirtualCounters* counters, __global uint2* pairs) {
    for (uint level_view = 0; level_view < plan.view_count * plan.levels; ++level_view) {
        uint first = page_entry(&plan, level_view / plan.levels, level_view % plan.levels, 0, 0);
        uint across = plan.pages_across >> (level_view % plan.levels);
        if (page_of[first] == page_of[first + across * across]) continue;  // no page of this level is requested
        GN_FOR_EACH(i, pass.triangle_count) {
            Caster caster;
            if (load_caster(level_views + level_view, tables, vertices, &pass, (uint)i, &caster))
                draw_into_pages(&plan, &pass, level_view, (uint)i, &caster, requested, page_of, pages, tables, touched,
                                keys, counters, pairs);
        }
    }
}

// One work-group takes one pair, one work-item one tile of the pair's page.
__kernel void virtual_map_large(VirtualPlan plan, DepthPass pass, __global const float* vertices,
                                __global const float* tables, __global const uint* page_of,
                                __global const MapView* pages, __global uint* keys,
                                __global const VirtualCounters* counters, __global const uint2* pairs) {
    uint count = min(counters->pairs, pass.chunk_capacity);
    for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
        uint2 pair = pairs[i];
        Page page = page_of_entry(&plan, pair.y);
        __global const MapView* view = pages + page_of[pair.y];
        Caster caster;
        load_caster(view, tables, vertices, &pass, pair.x, &caster);
        clip_to_page(&caster, (uint2)(page.column, page.row));
        uint2 tiles = tiles_of(caster.covered);
        for (uint t = (uint)get_local_id(0); t < tiles.x * tiles.y; t += (uint)get_local_size(0))
            draw_tile(&pass, view, tables, &caster, (uint2)(t % tiles.x, t / tiles.x), keys, keys);
    }
}

__kernel void virtual_map_lookup(VirtualPlan plan, VirtualLight light, PointsLayout layout,
                                 __global const float* positions, __global const float* tables,
                                 __global const uint* point_entries, __global const uint* page_of,
                                 __global const MapView* pages, __global const uint* keys, __global float* visibility) {
    GN_FOR_EACH(i, layout.count) {
        uint entry = point_entries[light.first_point + i];
        if (entry == NO_PAGE) continue;
        MapPoint point;
        make_map_point(pages + page_of[entry], tables, load_point(positions, layout, i), &point);
        // Sizes are powers of two, so this texel lies in the requested page.
        uint2 texel = texel_below(point.at_texels, point.view);
        uint at = point.view->first_texel + texel.y * point.view->row_stride + texel.x;
        visibility[i] = as_float(keys[at]) >= point.depth - plan.receiver_bias ? 1.0f : 0.0f;
    }
}

// The diagnostic "page": a colour per level, lighter and darker page by page; black for a point without a page.
__kernel void virtual_map_page_colors(VirtualPlan plan, PointsLayout layout, __global const float* positions,
                                      __global const uint* point_entries, __global float* colors) {
    GN_FOR_EACH(i, layout.count) {
        float3 color = (float3)(0.0f, 0.0f, 0.0f);
        if (!is_present(load_point(positions, layout, i))) {
            color = SKY;
        } else if (point_entries[i] != NO_PAGE) {
            Page page = page_of_entry(&plan, point_entries[i]);
            color = color_at(view_colors[page.level]) * ((page.column + page.row) % 2 != 0 ? 0.75f : 1.0f);
        }
        vstore3(color, i, colors);
    }
}
