// SPDX-License-Identifier: MIT
// Virtual shadow maps: levels, requests, pages, drawing and lookup (contract: virtual_map.h).
#include "rivals/rasterizer/caster_chunks.clh"
#include "rivals/rasterizer/caster_windows.clh"
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

static uint2 texel_below(float2 texels, __global const MapView* view) {
    return convert_uint2(clamp(texels, (float2)(0.0f), (float2)(view->width - 1, view->height - 1)));
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
                                __global const uint* page_of, __global MapView* pages, __global uint* page_entries) {
    GN_FOR_EACH(entry, plan.view_count * plan.entries_per_view) {
        if (requested[entry] == 0) continue;
        Page page = page_of_entry(&plan, (uint)entry);
        MapView grid = level_views[page.view * plan.levels + page.level];
        grid.first_texel = page_of[entry] * PAGE_TEXELS - page.row * PAGE_TEXELS - page.column * PAGE_SIZE;
        pages[page_of[entry]] = grid;
        page_entries[page_of[entry]] = (uint)entry;
    }
}

static TexelRectangle texels_of_page(Page page) {
    return square_of_texels((uint2)(page.column, page.row) << PAGE_LOG2, PAGE_LOG2);
}

#ifdef GN_CPU
// An item draws a page. touched[page]: whether it overlaps the rectangle of some caster.
__kernel void virtual_map_windows(VirtualPass all, uint page_count, __global const float* vertices,
                                  __global const float* tables, __global const ClusterCovers* covers,
                                  __global const MapView* pages, __global const uint* page_entries,
                                  __global uint* touched, __global uint* keys) {
    DepthPass pass = all.pass;
    uint blocks = (pass.cluster_count + GN_LANES - 1u) / GN_LANES;
    GN_FOR_EACH(i, page_count) {
        Page page = page_of_entry(&all.plan, page_entries[i]);
        TexelRectangle window = texels_of_page(page);
        Drawing d = {pass, triangles_of(vertices, pass.triangles), pages + i, tables, keys, keys, window, window.low};
        touched[i] = draw_window(&d, covers + (size_t)page.view * blocks, page.level) ? 1u : 0u;
    }
}
#else
// The pages of a level that a triangle may cover.
static TexelRectangle pages_of(TexelRectangle covered) {
    return (TexelRectangle){covered.low >> PAGE_LOG2, covered.high >> PAGE_LOG2};
}

// A triangle that waits in local memory for the group's items.
typedef struct PagedCaster {
    uint view, id;
    MapBounds bounds;
} PagedCaster;
typedef char paged_caster_has_its_size[sizeof(PagedCaster) == 4 * PAGED_CASTER_WORDS ? 1 : -1];

static TexelRectangle pages_of_caster(const VirtualPlan* plan, __global const MapView* level_views,
                                      __global const float* tables, const PagedCaster* c, uint level) {
    __global const MapView* view = level_views + c->view * plan->levels + level;
    TexelLanes covered = texels_covered(view, tables, &c->bounds, -1);
    return pages_of(covered_by(&covered, 0));
}

// The pages of all levels with requests that a triangle may cover: their number.
static uint count_pages(const VirtualPlan* plan, Drawing* d, __global const MapView* level_views, PagedCaster* c,
                        __global const uint* page_of) {
    Casters caster;
    MapVertices h[3];
    uint count = 0;
    d->view = level_views + c->view * plan->levels;  // levels differ in the number of their texels alone
    if (!load_one_caster(d, c->id, &caster, h)) return 0u;
    c->bounds = map_bounds_of(h);
    for (uint level = 0; level < plan->levels; ++level) {
        uint first = page_entry(plan, c->view, level, 0, 0), across = plan->pages_across >> level;
        if (page_of[first] == page_of[first + across * across]) continue;  // no page of this level is requested
        count += texels_of(pages_of_caster(plan, level_views, d->tables, c, level));
    }
    return count;
}

// The entry of the i-th of these pages.
static uint entry_of_page(const VirtualPlan* plan, const Drawing* d, __global const MapView* level_views,
                          const PagedCaster* c, uint i, __global const uint* page_of) {
    for (uint level = 0; level < plan->levels; ++level) {
        uint first = page_entry(plan, c->view, level, 0, 0), across = plan->pages_across >> level;
        if (page_of[first] == page_of[first + across * across]) continue;
        TexelRectangle pages = pages_of_caster(plan, level_views, d->tables, c, level);
        uint columns = pages.high.x - pages.low.x + 1u, here = texels_of(pages);
        if (i < here) return page_entry(plan, c->view, level, pages.low.x + i % columns, pages.low.y + i / columns);
        i -= here;
    }
    return NO_PAGE;
}

// Loads the triangle for a page; returns its part there.
static TexelRectangle load_part(const VirtualPlan* plan, Drawing* d, __global const MapView* page_view, uint entry,
                                uint id, Casters* caster) {
    MapVertices h[3];
    d->view = page_view;
    TexelRectangle page = texels_of_page(page_of_entry(plan, entry));
    d->home = page.low;
    load_one_caster(d, id, caster, h);
    make_casters(h, caster);
    return common_texels(covered_by(&caster->covered, 0), page);
}

// Draws tiny parts of triangles in requested pages, and lists the other parts as pairs of triangle and entry. The group
// shares out its triangles' pages evenly. An item draws a part that finds no room at once.
__kernel void virtual_map_scatter(VirtualPass all, __global const float* vertices, __global const MapView* level_views,
                                  __global const float* tables, __global const uint2* listed,
                                  __global const uint* page_of, __global const MapView* pages, __global uint* touched,
                                  __global uint* keys, __global VirtualCounters* counters, __global uint2* pairs,
                                  __local PagedCaster* waiting) {
    __local uint reserved[GROUP_APPEND_WORDS];
    VirtualPlan plan = all.plan;
    DepthPass pass = all.pass;
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), count = listed_count(&pass, listed);
    __local uint* ends = (__local uint*)(waiting + items);
    if (item == 0u) reserved[0] = 0u;
    Drawing d = {pass, triangles_of(vertices, pass.triangles), pages, tables, keys, keys};
    d.reach = WHOLE_MAP;
    GN_ROUNDS(round, count) {
        uint i = index_in_round(round, count), wanted = 0u;
        if (i < count) {
            uint2 of = listed_triangle(&pass, listed, i);
            PagedCaster mine = {of.x, of.y};
            wanted = count_pages(&plan, &d, level_views, &mine, page_of);
            if (wanted != 0u) waiting[item] = mine;
        }
        scan_group(wanted, ends);
        for (uint begin = 0, total = ends[items - 1u]; begin < total; begin += items) {
            uint k = begin + item, entry = NO_PAGE, id = 0u;
            if (k < total) {
                uint owner = item_of_piece(ends, k);
                PagedCaster of = waiting[owner];
                id = of.id;
                entry = entry_of_page(&plan, &d, level_views, &of, piece_of_item(ends, owner, k), page_of);
            }
            bool is_left = false;
            Casters caster;
            TexelRectangle part;
            if (entry != NO_PAGE && page_of[entry] != page_of[entry + 1u]) {  // requested
                uint page = page_of[entry];
                if (GN_RELAXED_LOAD(&touched[page]) == 0) atomic_xchg(&touched[page], 1u);
                part = load_part(&plan, &d, pages + page, entry, id, &caster);
                is_left = texels_of(part) > TINY_TEXELS;
                if (!is_left) draw_alone(&d, &caster, id, part);
            }
            uint at = append_in_group(is_left ? 1u : 0u, reserved, &counters->pairs);
            if (is_left && at < pass.chunk_capacity)
                pairs[at] = (uint2)(id, entry);
            else if (is_left)
                draw_alone(&d, &caster, id, part);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// A work-group takes one pair. tile_keys: EMPTY_KEY before.
__kernel void virtual_map_pairs(VirtualPass all, __global const float* vertices, __global const float* tables,
                                __global const uint* page_of, __global const MapView* pages, __global uint* keys,
                                __global const VirtualCounters* counters, __global const uint2* pairs,
                                volatile __global uint* tile_keys) {
    __local PartTiles tiles;
    DepthPass pass = all.pass;
    Drawing d = {pass, triangles_of(vertices, pass.triangles), pages, tables, keys, keys};
    d.reach = WHOLE_MAP;
    uint count = min(counters->pairs, pass.chunk_capacity);
    GN_FOR_EACH_BY_GROUP(uint, i, count) {
        Casters caster;
        uint page = page_of[pairs[i].y];
        TexelRectangle part = load_part(&all.plan, &d, pages + page, pairs[i].y, pairs[i].x, &caster);
        draw_by_group(&d, &caster, pairs[i].x, part, tile_keys + page * (PAGE_TEXELS / 16u), &tiles);
    }
}
#endif

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
