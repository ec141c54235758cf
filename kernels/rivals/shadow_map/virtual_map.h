// SPDX-License-Identifier: MIT
// Contract of virtual shadow maps (Olsson, Sintorn, Kaempe, Billeter, Assarsson 2014, "Efficient Virtual Shadow Maps
// for Many Lights"): the map has only the pages that shading points request.
//
// Several lights share one pool: their views stand one after the other, and so do their entries and pages.
//
// Each fitted view (map_view.h) of size x size texels has levels 0, 1, 2 ... of size, size / 2, size / 4 ... texels per
// side, down to one page of PAGE_SIZE x PAGE_SIZE. A page's entry counts through views, their levels, rows and columns:
//   entry = view entries_per_view + (pages of finer levels) + row pages_across(level) + column
// A point requests the page under it at the coarsest level whose texels, across the light, are no wider than its
// pixel's footprint,
//   footprint = camera depth x pixel_size / detail,  pixel_size = 2 tan(fov / 2) / height,
// or, without a camera, at the level of a setting. Requests are marked per entry; a prefix sum over the marks gives
// every requested entry a physical page, and only these are cleared and drawn, exactly as the depth pass draws a whole
// map (caster.clh): a page's texels have the bits that a shadow map of its level's size would have.
//
// A physical page is a MapView of its level's grid. Its first_texel is the index that texel (0, 0) would have, so that
// the page's own texels fall into its PAGE_TEXELS words; first_texel may wrap, and sums are taken modulo 2^32.
#pragma once

#include "rivals/rasterizer/depth_pass.h"

#define PAGE_LOG2 7u
#define PAGE_SIZE (1u << PAGE_LOG2)
#define PAGE_TEXELS (1u << (2u * PAGE_LOG2))
#define NO_PAGE 0xFFFFFFFFu
// Of a GPU's local memory, for each triangle whose pages wait there.
#define PAGED_CASTER_WORDS 7u

GN_STRUCT_BEGIN(VirtualPlan)
    uint pages_across;      // of level 0: a power of two
    uint levels;            // pages_across is 2^(levels - 1)
    uint entries_per_view;  // (4 pages_across^2 - 1) / 3
    uint view_count;        // of all lights
    float pixel_size;       // a pixel's side at camera depth 1; 0: no camera
    float detail;           // texels per pixel side, at least
    uint level;             // without a camera
    float receiver_bias;    // depth; subtracted from the receiver's depth
GN_STRUCT_END(VirtualPlan, 32)

// A pass over the pages.
GN_STRUCT_BEGIN(VirtualPass)
    DepthPass pass;
    VirtualPlan plan;
GN_STRUCT_END(VirtualPass, 80)

// One light of a run.
GN_STRUCT_BEGIN(VirtualLight)
    ulong first_point;  // of the light's point entries
    uint first_view;    // of the light's views
    uint view_count;
GN_STRUCT_END(VirtualLight, 16)

GN_STRUCT_BEGIN(VirtualCounters)
    uint points_outside;   // open points that no view serves
    uint pages_requested;  // physical pages
    uint pairs;            // (triangle, page): also those beyond the buffer's capacity
GN_STRUCT_END(VirtualCounters, 12)

#ifndef __cplusplus

// Entries of a view before level l: pages_across^2 (1 + 1/4 + 1/16 + ...), l terms.
static uint entries_before(const VirtualPlan* plan, uint level) {
    uint across = plan->pages_across >> level;
    return 4 * (plan->pages_across * plan->pages_across - across * across) / 3;
}

static uint page_entry(const VirtualPlan* plan, uint view, uint level, uint column, uint row) {
    return view * plan->entries_per_view + entries_before(plan, level) + row * (plan->pages_across >> level) + column;
}

typedef struct Page {
    uint view, level, column, row;
} Page;

static Page page_of_entry(const VirtualPlan* plan, uint entry) {
    Page page;
    page.view = entry / plan->entries_per_view;
    uint rest = entry % plan->entries_per_view;
    page.level = 0;
    while (page.level + 1 < plan->levels && rest >= entries_before(plan, page.level + 1)) ++page.level;
    rest -= entries_before(plan, page.level);
    page.row = rest / (plan->pages_across >> page.level);
    page.column = rest % (plan->pages_across >> page.level);
    return page;
}

#endif
