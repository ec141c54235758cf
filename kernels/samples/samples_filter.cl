// SPDX-License-Identifier: MIT
// Finds the receivers of the samples of edge pixels that samples_masks_gpu.cl leaves, from records only; then decides
// the pairs of a sample and a triangle that records leave open. (With the exact predicates in it the search would take
// three times the registers, and a third of the groups would run at once.) The kernels in the order of their launches:
//
// samples_filter          finds receivers; writes the fragments of pixels without an open pair, lists the others
// samples_open_pairs      decides the open pairs of listed pixels
// samples_open_fragments  writes the fragments of the listed pixels
//
// A sample that meets the pixel's own receiver has that receiver, whatever hides it; any other sample has the nearest
// triangle that it meets. The order of hits is total (camera.h): it does not matter in which order open pairs are
// decided. A masked triangle is always open. Pixels with more open pairs than fit are left to samples_fragments.
#include "samples/find_receivers_gpu.clh"
#include "samples/footprints.clh"
#include "samples/open_samples.clh"

#if GN_LANES == 1

typedef struct FilterWork {
    SamplesParams params;
    TileLists lists;
    __constant const SamplePattern* pattern;
    CameraRecords from;
    __global const uint* pixel_receivers;
} FilterWork;

typedef struct SampleSearch {
    uint sample;
    int searching;
    bool is_own;  // it certainly meets the pixel's own receiver
    RayBlock ray;
    NearestLanes best;
    uint farthest;  // quantised: candidates below it are hidden
    uint held;      // slot of the open pair that is held back, or GN_NO_ID
    float held_high;
} SampleSearch;

static void keep_open_pair(uint sample, uint slot, __local FragmentGroup* group) {
    uint at = atomic_inc(&group->open_count);
    if (at >= MAX_OPEN_PAIRS) return;
    group->open_samples[at] = sample;
    group->open_slots[at] = slot;
}

// Tests the record of the pixel's own receiver.
static void begin_search(const FilterWork* work, uint2 at, uint own_slot, SampleSearch* search,
                         __local FragmentGroup* group) {
    uint sample = search->sample;
    search->searching = sample < work->pattern->count ? -1 : 0;
    search->is_own = false;
    search->best = nothing_near();
    search->held = GN_NO_ID;
    search->farthest = 0u;
    if (!search->searching) return;
    search->ray.x = (float)at.x + group->position_x[sample];
    search->ray.y = (float)at.y + group->position_y[sample];
    if (own_slot != GN_NO_ID) {
        TriangleRecord record = work->lists.records[own_slot];
        NearestLanes none = nothing_near();
        NearestFilter found = filter_nearest(&record, &search->ray, -1, &none);
        search->is_own = found.inside && !is_masked(&work->lists.bounds[own_slot]);
        if (found.possible && !search->is_own) keep_open_pair(sample, own_slot, group);
    }
    if (search->is_own)
        search->searching = 0;
    else
        atomic_inc(&group->searching);
}

// Tests a candidate's record, as test_in_search() does (camera/nearest_gpu.clh).
static void test_candidate(const FilterWork* work, uint slot, SampleSearch* search, __local FragmentGroup* group) {
    TriangleRecord record = work->lists.records[slot];
    NearestFilter found = filter_nearest(&record, &search->ray, search->searching, &search->best);
    if (!found.possible) return;
    if (is_masked(&work->lists.bounds[slot])) found.inside = 0;  // it may be clear there
    NearestLanes* best = &search->best;
    bool wins = found.inside && found.nearer;
    if (!wins) {
        if (search->held != GN_NO_ID && search->held_high >= best->low)
            keep_open_pair(search->sample, search->held, group);
        search->held = slot;
        search->held_high = found.high;
        if (!found.inside) return;
    }
    best->slot = wins ? (int)slot : best->slot;
    best->low = fmax(best->low, found.low);
    best->high = fmax(best->high, found.high);
    search->farthest = quantised_farthest(best->low);
}

// Finds the receivers of one pixel's samples. Every item must call this function.
static void search_pixel(const FilterWork* work, uint pixel, uint2 at, uint own, __local FragmentGroup* group) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), samples = work->pattern->count;
    PixelBatch batch = work->params.batch;
    PictureBox box = box_of_pixel(work->pattern, at);
    QuantisedBlock block = quantised_box(&box, batch);
    uint2 range = work->lists.ranges[tile_of_pixel(batch, pixel)];
    uint own_slot = slot_of_triangle(work->from, own);
    if (item == 0u) group->open_count = group->others = 0u;
    for (uint first = 0; first < samples; first += items) {
        if (item == 0u) group->searching = 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        SampleSearch search;
        search.sample = first + item;
        begin_search(work, at, own_slot, &search, group);
        barrier(CLK_LOCAL_MEM_FENCE);
        uint end = group->searching != 0u ? range.y : range.x, per_round = items * ENTRIES_OF_ITEM;
        for (uint start = range.x; start < end; start += per_round) {
            find_candidates(work->lists, start, min(start + per_round, end), block, &box, group);
            uint count = search.searching ? group->candidate_count : 0u;
            for (uint c = 0; c < count; ++c)
                if (group->heights[c] >= search.farthest && group->candidates[c] != own_slot)
                    test_candidate(work, group->candidates[c], &search, group);
            barrier(CLK_LOCAL_MEM_FENCE);
        }
        if (search.held != GN_NO_ID && search.held_high >= search.best.low)
            keep_open_pair(search.sample, search.held, group);
        uint slot = (uint)search.best.slot;
        if (search.sample < samples)
            group->receivers[search.sample] = search.is_own      ? own
                                              : slot == GN_NO_ID ? GN_NO_ID
                                                                 : work->lists.bounds[slot].id;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// Lists a pixel with open pairs. Every item must call this function.
static void store_open_pixel(const FilterWork* work, uint pixel, OpenSamples open, __global uint* unproven,
                             __local FragmentGroup* group, __global SampleCounters* counters) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), samples = work->pattern->count;
    uint count = group->open_count;
    if (item == 0u) {
        uint at = count <= MAX_OPEN_PAIRS ? reserve_slots(1u, &counters->open_pixels) : open.capacities.pixels;
        uint pair = at < open.capacities.pixels ? reserve_slots(count, &counters->open_pairs) : 0u;
        group->open_pixel = at;
        group->open_pair = pair;
        if (at >= open.capacities.pixels || pair + count > open.capacities.pairs)
            unproven[reserve_slots(1u, &counters->unproven)] = pixel;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    uint at = group->open_pixel, pair = group->open_pair;
    if (at >= open.capacities.pixels) return;
    bool fits = pair + count <= open.capacities.pairs;
    if (item == 0u) open.pixels[at] = fits ? pixel : GN_NO_ID;
    for (uint sample = item; sample < samples; sample += items)
        open.receivers[at * MAX_SAMPLES + sample] = group->receivers[sample];
    for (uint i = item; i < count; i += items)
        if (pair + i < open.capacities.pairs)
            open.pairs[pair + i] =
                (uint2)(at * MAX_SAMPLES + group->open_samples[i], fits ? group->open_slots[i] : GN_NO_ID);
}

__kernel void samples_filter(SamplesParams params, __constant const SamplePattern* pattern,
                             __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                             __global const uint2* ranges, __global const BinEntries* entries,
                             __global const uint* pixel_receivers, __global const uint* slots, __global uint* edges,
                             __global uint* fragment_words, __global uint* open_words,
                             __global SampleCounters* counters) {
    __local FragmentGroup group;
    FilterWork work = {params,
                       {ranges, entries, records, bounds, {0, 0u}, 0, params.picture},
                       pattern,
                       camera_records(slots, params.triangles.count, records, bounds),
                       pixel_receivers};
    Fragments fragments = fragments_of(fragment_words, params.batch);
    OpenSamples open = open_samples(open_words, params.open);
    uint item = (uint)get_local_id(0), samples = pattern->count, sky_count = 0;
    uint count = counters->left;
    __global uint *left = edges + params.batch.edge_slots, *unproven = left + params.batch.edge_slots;
    begin_group(pattern, &group);
    // (H100: with 8 neighbouring pixels for each group this took .29 ms, with one pixel .10.)
    GN_FOR_EACH_BY_GROUP(uint, k, count) {
        uint i = left[k];
        uint2 at = place_of_pixel(params.batch, i);
        uint own = pixel_receivers[at.y * params.batch.width + at.x];
        search_pixel(&work, i, at, own, &group);
        if (group.open_count == 0u) {
            sky_count += store_fragments(params, samples, i, own, &group, fragments, counters);
        } else {
            store_open_pixel(&work, i, open, unproven, &group, counters);
            barrier(CLK_LOCAL_MEM_FENCE);
        }
    }
    if (item == 0u) mark_unused_slots(fragments, params.batch, group.next, group.end);
    if (sky_count != 0) atomic_add(&counters->lit, sky_count);
}

__kernel void samples_open_pairs(SamplesParams params, __global const float* vertices, __global const float* rays,
                                 __global const TriangleBounds* bounds, __global const uint* pixel_receivers,
                                 __global uint* open_words, __global const SampleCounters* counters) {
    Triangles triangles = triangles_of(vertices, params.triangles);
    TileLists lists = {0, 0, 0, bounds, triangles, rays, params.picture};
    OpenSamples open = open_samples(open_words, params.open);
    float3 eye = eye_of_samples(params);
    GN_FOR_EACH(i, min(counters->open_pairs, params.open.pairs)) {
        uint2 pair = open.pairs[i];
        if (pair.y == GN_NO_ID) continue;
        uint id = bounds[pair.y].id, sample = pair.x % MAX_SAMPLES, samples = params.samples;
        uint2 at = place_of_pixel(params.batch, open.pixels[pair.x / MAX_SAMPLES]);
        uint own = pixel_receivers[at.y * params.batch.width + at.x];
        Ray ray = load_ray(rays, at.x * samples + sample, (params.batch.width + at.y) * samples + sample);
        Outline outline = outline_of(load_triangle(triangles.vertices, id), eye);
        if (!covers(&outline, eye, ray) || !is_seen_opaque(&lists, id, eye, ray)) continue;
        __global uint* receiver = &open.receivers[pair.x];
        for (uint other = GN_RELAXED_LOAD((volatile __global uint*)receiver); other != own || own == GN_NO_ID;) {
            if (id != own && other != GN_NO_ID && !is_nearer(&lists, eye, ray, id, other)) break;
            uint before = atomic_cmpxchg(receiver, other, id);
            if (before == other) break;
            other = before;
        }
    }
}

__kernel void samples_open_fragments(SamplesParams params, __constant const SamplePattern* pattern,
                                     __global const uint* pixel_receivers, __global uint* fragment_words,
                                     __global uint* open_words, __global SampleCounters* counters) {
    __local FragmentGroup group;
    Fragments fragments = fragments_of(fragment_words, params.batch);
    OpenSamples open = open_samples(open_words, params.open);
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), samples = pattern->count, sky_count = 0;
    uint count = min(counters->open_pixels, params.open.pixels);
    begin_group(pattern, &group);
    GN_FOR_EACH_BY_GROUP(uint, k, count) {
        uint i = open.pixels[k];
        if (i == GN_NO_ID) continue;
        uint2 at = place_of_pixel(params.batch, i);
        uint own = pixel_receivers[at.y * params.batch.width + at.x];
        if (item == 0u) group.others = 0u;
        for (uint sample = item; sample < samples; sample += items)
            group.receivers[sample] = open.receivers[k * MAX_SAMPLES + sample];
        barrier(CLK_LOCAL_MEM_FENCE);
        sky_count += store_fragments(params, samples, i, own, &group, fragments, counters);
    }
    if (item == 0u) mark_unused_slots(fragments, params.batch, group.next, group.end);
    if (sky_count != 0) atomic_add(&counters->lit, sky_count);
}

#endif
