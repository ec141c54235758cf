// SPDX-License-Identifier: MIT
// Samples: several per pixel. Contract in samples.h. A technique that cannot classify footprints uses only
// samples_mean. The kernels in the order of their launches:
//
// samples_rays            the tables of the samples' rays
// samples_slots           the slots of the triangles' records
// samples_whole           the whole pixels and their footprints; lists the edge pixels
// samples_masks           on a CPU: finds the receivers of the edge pixels' samples and writes their fragments
// samples_fragments       on a GPU: the same for pixels that samples_masks_gpu.cl, then samples_filter.cl leave
// samples_bound           the footprints of the edge pixels' fragments
// samples_resolve         after the footprints are classified: adds up the decided samples, lists the mixed fragments
// samples_split           on a CPU: the pixels of mixed squares, which are classified and resolved one by one
// samples_points          the samples of mixed fragments and their shading points
// samples_count_lit       adds up the samples that the trace found lit
// samples_mean_of_sums    the pixels' means
#include "samples/samples.h"

#include "samples/coverage_masks.clh"
#include "samples/find_receivers_gpu.clh"
#include "samples/footprints.clh"
#include "samples/sample_points.clh"

// visibility: sample by sample, `pixels` each. The first batch starts the sum; the last batch's scale makes it the
// mean. Sums of 0 and 1 are exact. The mean is exact because the number of samples is a power of two. On every device
// the values of filtered techniques are added in the samples' order.
__kernel void samples_mean(MeanParams params, __global const float* visibility, __global float* mean) {
    GN_FOR_EACH(pixel, params.pixels) {
        float sum = params.is_first ? 0.0f : mean[pixel];
        for (uint sample = 0; sample < params.samples; ++sample)
            sum += visibility[(size_t)sample * params.pixels + pixel];
        mean[pixel] = sum * params.scale;
    }
}

// The tables of exact rays (camera.h) of all samples, with the samples of one column, or row, side by side. The bits
// equal those of the host's camera_tables().
__kernel void samples_rays(RayAxes axes, __constant const SamplePattern* pattern, __global float* rays) {
    Wide pixel = wide_of_bits(axes.pixel);
    GN_FOR_EACH(i, pattern->count * (axes.width + axes.height)) {
        uint sample = (uint)i % pattern->count, entry = (uint)i / pattern->count;
        bool is_column = entry < axes.width;
        // Sums of small multiples of 1 / SAMPLE_UNITS: exact.
        float position = is_column ? (float)entry + pattern->position_x[sample]
                                   : (float)(entry - axes.width) + pattern->position_y[sample];
        Wide across = is_column ? wide_sub(wide_of_float(position), wide_of_bits(axes.half_width))
                                : wide_sub(wide_of_bits(axes.half_height), wide_of_float(position));
        across = wide_mul(across, pixel);
        for (int c = 0; c < 3; ++c) {
            Wide v = wide_mul(across, wide_of_bits(is_column ? axes.right[c] : axes.up[c]));
            if (is_column) v = wide_add(wide_of_bits(axes.forward[c]), v);
            float high = float_of_wide(v);
            rays[RAY_FLOATS * i + c] = high;
            rays[RAY_FLOATS * i + 3 + c] = float_of_wide(wide_sub(v, wide_of_float(high)));
        }
    }
}

// Writes for each triangle that has a record the record's slot, and behind them the number of slots.
__kernel void samples_slots(SamplesParams params, __global const FrameCounters* camera,
                            __global const TriangleBounds* bounds, __global uint* slots) {
    if (get_global_id(0) == 0) slots[params.triangles.count] = camera->slots;
    GN_FOR_EACH(slot, camera->slots) {
        if (bounds[slot].x0 <= bounds[slot].x1) slots[bounds[slot].id] = (uint)slot;
    }
}

// ---- Fragments ------------------------------------------------------------------------------------------------------

typedef struct WholeCounts {
    LaneInt minus_whole, minus_sky;
} WholeCounts;

#if GN_LANES == 1
// The edge pixels that a group finds in a round lie in one or two tiles and are neighbours in the list: neighbours in a
// warp then walk the same lists.
GN_INLINE void find_all_whole(const WholeWork* work, uint block_count, __local uint* reserved, __global uint* edges,
                              __global SampleCounters* counters, WholeCounts* counts) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), run = items % 16u == 0u ? 16u : 1u;
    if (item == 0u) reserved[0] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint start = (uint)get_group_id(0) * items * WHOLE_EACH; start < block_count;
         start += (uint)get_global_size(0) * WHOLE_EACH) {
        uint found_edges[WHOLE_EACH], count = 0u;
        for (uint k = 0; k < WHOLE_EACH; ++k) {
            uint block = start + (item / run * WHOLE_EACH + k) * run + item % run;
            if (block >= block_count) continue;
            WholePixels found;
            find_whole(work, block, &found);
            store_whole(work, block, &found, found.whole);
            counts->minus_whole += found.whole;
            counts->minus_sky += found.sky;
            if (found.edges) found_edges[count++] = block;
        }
        uint slot = append_in_group(count, reserved, &counters->edges);
        for (uint k = 0; k < count; ++k) edges[slot + k] = found_edges[k];
    }
}
#else
// A square of whole pixels on one receiver becomes a fragment in an extra slot, and its pixels' fragments are empty.
// (On an H100 squares take classify_footprints from .64 to 1.22 ms, and the depths from .13 to .26.)
GN_NOINLINE_ON_CPU void find_all_whole(ItemRange items, const WholeWork* work, __global uint* edges,
                                       __global SampleCounters* counters, WholeCounts* counts) {
    PixelBatch batch = work->params.batch;
    Reservation reserved = no_reservation(), extra = no_reservation();
    GN_FOR_EACH_OF(block, items) {
        WholePixels found;
        find_whole(work, (uint)block, &found);
        counts->minus_whole += found.whole;
        counts->minus_sky += found.sky;
        bool square =
            work->params.squares && !LANES_ANY(~found.whole | LANE_COMPARE(found.ids, !=, (LaneInt)(found.ids.s0)));
        store_whole(work, (uint)block, &found, square ? (LaneInt)(0) : found.whole);
        if (square)
            store_extra(work->fragments, batch, reservation(&extra, &counters->extra),
                        (uint)block * GN_LANES | IS_SQUARE, (uint)found.ids.s0, work->pattern->all);
        if (!LANES_ANY(found.edges)) continue;
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(found.edges, lane))
                edges[reservation(&reserved, &counters->edges)] = (uint)block * GN_LANES + lane;
    }
    for (; reserved.next < reserved.end; ++reserved.next) edges[reserved.next] = GN_NO_ID;
    mark_unused_slots(work->fragments, batch, extra.next, extra.end);
}
#endif

__kernel void samples_whole(SamplesParams params, __constant const SamplePattern* pattern,
                            __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                            __global const uint* slots, __global const uint* pixel_receivers,
                            __global const uint2* tile_ranges, __global uint* fragment_words, __global uint* edges,
                            __global float* centres, __global float* footprints, __global SampleCounters* counters) {
    __local uint sums[2];
    WholeWork work = {params,
                      pattern,
                      eye_of_samples(params),
                      camera_records(slots, params.triangles.count, records, bounds),
                      pixel_receivers,
                      tile_ranges,
                      fragments_of(fragment_words, params.batch),
                      centres,
                      footprints};
    if (get_local_id(0) == 0) sums[0] = sums[1] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    WholeCounts counts = {(LaneInt)(0), (LaneInt)(0)};
#if GN_LANES == 1
    __local uint reserved[GROUP_APPEND_WORDS];
    find_all_whole(&work, params.batch.count, reserved, edges, counters, &counts);
#else
    find_all_whole(item_range(params.batch.count / GN_LANES), &work, edges, counters, &counts);
#endif
    atomic_add(&sums[0], count_lanes(counts.minus_whole));
    atomic_add(&sums[1], count_lanes(counts.minus_sky));
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) != 0) return;
    if (sums[0] != 0u) atomic_add(&counters->whole, sums[0]);
    if (sums[1] != 0u) atomic_add(&counters->lit, sums[1] * pattern->count);
}

#if GN_LANES > 1
// The receivers of the edge pixels' samples, and their fragments (coverage_masks.clh).
__kernel void samples_masks(SamplesParams params, __constant const SamplePattern* pattern,
                            __global const float* vertices, __global const float* rays,
                            __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                            __global const uint2* ranges, __global const BinEntries* entries,
                            __global const uint* pixel_receivers, __global const uint* slots, __global uint* edges,
                            __global uint* fragment_words, __global SampleCounters* counters) {
    Triangles triangles = triangles_of(vertices, params.triangles);
    MasksWork work = {{ranges, entries, records, bounds, triangles, rays, params.picture},
                      params.batch,
                      pattern,
                      eye_of_samples(params),
                      pixel_receivers,
                      camera_records(slots, params.triangles.count, records, bounds),
                      edges,
                      fragments_of(fragment_words, params.batch),
                      counters};
    find_masks(item_range((params.count + GN_LANES - 1u) / GN_LANES), params.count, &work);
}
#else
// One group takes one unproven pixel (find_receivers_gpu.clh).
__kernel void samples_fragments(SamplesParams params, __constant const SamplePattern* pattern,
                                __global const float* vertices, __global const float* rays,
                                __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                                __global const uint2* ranges, __global const BinEntries* entries,
                                __global const uint* pixel_receivers, __global const uint* edges,
                                __global uint* fragment_words, __global SampleCounters* counters) {
    __local FragmentGroup group;
    Triangles triangles = triangles_of(vertices, params.triangles);
    TileLists lists = {ranges, entries, records, bounds, triangles, rays, params.picture};
    Fragments fragments = fragments_of(fragment_words, params.batch);
    __global const uint* unproven = edges + 2u * (size_t)params.batch.edge_slots;
    float3 eye = eye_of_samples(params);
    uint item = (uint)get_local_id(0), samples = pattern->count, sky_count = 0;
    begin_group(pattern, &group);
    GN_FOR_EACH_BY_GROUP(uint, edge, params.count) {
        uint i = unproven[edge];
        uint2 at = place_of_pixel(params.batch, i);
        uint own = pixel_receivers[at.y * params.batch.width + at.x];
        find_sample_receivers(lists, params.batch, pattern, eye, i, at, own, &group);
        sky_count += store_fragments(params, samples, i, own, &group, fragments, counters);
    }
    if (item == 0u) mark_unused_slots(fragments, params.batch, group.next, group.end);
    if (sky_count != 0) atomic_add(&counters->lit, sky_count);
}

#endif

// The footprints of the edge pixels' fragments: `count` in the pixels' slots and `extra_count` in extra slots.
__kernel void samples_bound(SamplesParams params, __constant const SamplePattern* pattern,
                            __global const float* vertices, __global const uint* edges, __global uint* fragment_words,
                            __global float* centres, __global float* footprints) {
    Fragments fragments = fragments_of(fragment_words, params.batch);
    PixelBatch batch = params.batch;
    float3 eye = eye_of_samples(params);
    uint edge_count = params.count, count = edge_count + params.extra_count;
    GN_FOR_EACH(block, (count + GN_LANES - 1u) / GN_LANES) {
        uint slots[GN_LANES];
        LaneInt written = (LaneInt)(0), mask = (LaneInt)(0), ids = (LaneInt)((int)GN_NO_ID);
        LaneFloat x = (LaneFloat)(0.0f), y = x, more = x;  // pixels to the right and down
        for (int lane = 0; lane < GN_LANES; ++lane) {
            uint i = (uint)block * GN_LANES + lane;
            if (i >= count) continue;
            uint slot = i < edge_count ? edges[i] : batch.count + (i - edge_count);
            if (slot == GN_NO_ID) continue;
            slots[lane] = slot;
            LANE_OF_INT(written, lane) = -1;
            LANE_OF_INT(mask, lane) = (int)fragments.masks[slot];
            LANE_OF_INT(ids, lane) = (int)fragments.receivers[slot];
            uint2 at = place_of_pixel(batch, pixel_of_fragment(fragments, batch, slot));
            LANE_OF_FLOAT(x, lane) = (float)at.x;
            LANE_OF_FLOAT(y, lane) = (float)at.y;
            if (is_square(fragments, batch, slot)) LANE_OF_FLOAT(more, lane) = 3.0f;
        }
        LaneInt lanes = LANE_COMPARE(mask, !=, (LaneInt)(0));
        FragmentBounds bounds = no_fragments();
        if (LANES_ANY(lanes)) {
            PictureBox box = box_of_samples(pattern, mask);
            TriangleBlock t = load_triangles_of(vertices + params.triangles.first_float, ids, lanes);
            RayLanes rays[4];
            box.low_x += x, box.low_y += y, box.high_x += x + more, box.high_y += y + more;
            corner_rays(params.picture, &box, rays);
            bounds = bounds_of_fragments(&t, rays, eye, lanes);
            narrow_to_receivers(&t, eye, lanes, &bounds);
        }
        store_bounds(&bounds, slots, written, batch, centres, footprints);
    }
}

// ---- Undecided fragments --------------------------------------------------------------------------------------------

// The fragments that samples_resolve has found.
typedef struct ResolvedFragments {
    Reservation mixed, squares;
    uint fragments, in_shadow, lit, mixed_fragments, mixed_samples;
} ResolvedFragments;

// Adds up a fragment by its class; lists it in `mixed` or `squares` if it is mixed.
static void resolve_fragment(PixelBatch batch, Fragments fragments, uint slot, float visibility, __global uint* mixed,
                             __global uint* squares, __global SampleCounters* counters, ResolvedFragments* found) {
    uint samples = popcount(fragments.masks[slot]);
    if (samples == 0u) return;
    bool square = is_square(fragments, batch, slot);
    uint pixel = pixel_of_fragment(fragments, batch, slot), pixels = square ? SQUARE_PIXELS : 1u;
    if (visibility != 0.0f && visibility != 1.0f && square) {
        squares[reservation(&found->squares, &counters->squares)] = pixel / SQUARE_PIXELS;
        return;
    }
    found->fragments += pixels;
    if (visibility == 0.0f) {
        found->in_shadow += samples * pixels;
    } else if (visibility == 1.0f) {
        found->lit += samples * pixels;
        for (uint i = 0; i < pixels; ++i) atomic_add(&fragments.lit[pixel + i], samples);
    } else {
        ++found->mixed_fragments;
        found->mixed_samples += samples;
        mixed[reservation(&found->mixed, &counters->mixed)] = slot;
    }
}

// visibility: the class of each fragment's footprint. Appends to `mixed` and `squares`. With params.extra_count, the
// fragments are those of the pixels of extra_count squares.
__kernel void samples_resolve(SamplesParams params, __global uint* fragment_words, __global const float* visibility,
                              __global uint* mixed, __global uint* squares, __global SampleCounters* counters) {
    Fragments fragments = fragments_of(fragment_words, params.batch);
    ResolvedFragments found = {no_reservation(), no_reservation(), 0u, 0u, 0u, 0u, 0u};
    __local uint sums[5];  // of the group: atomics of every item on one address are too slow on a GPU
    if (get_local_id(0) == 0)
        for (int i = 0; i < 5; ++i) sums[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    GN_FOR_EACH(i, params.count) {
        uint slot = (uint)i;
        if (params.extra_count != 0u) {
            uint square = squares[slot / SQUARE_PIXELS];
            if (square == GN_NO_ID) continue;
            slot = square * SQUARE_PIXELS + slot % SQUARE_PIXELS;
        }
        resolve_fragment(params.batch, fragments, slot, visibility[slot], mixed, squares, counters, &found);
    }
    for (; found.mixed.next < found.mixed.end; ++found.mixed.next) mixed[found.mixed.next] = GN_NO_ID;
    for (; found.squares.next < found.squares.end; ++found.squares.next) squares[found.squares.next] = GN_NO_ID;
    const uint counts[5] = {found.fragments, found.in_shadow, found.lit, found.mixed_fragments, found.mixed_samples};
    for (int i = 0; i < 5; ++i)
        if (counts[i] != 0u) atomic_add(&sums[i], counts[i]);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) != 0) return;
    atomic_add(&counters->fragments, sums[0]);
    atomic_add(&counters->in_shadow, sums[1]);
    atomic_add(&counters->lit, sums[2]);
    atomic_add(&counters->mixed_fragments, sums[3]);
    atomic_add(&counters->mixed_samples, sums[4]);
}

#if GN_LANES == SQUARE_PIXELS
// Splits the mixed squares into the fragments of their pixels, which are classified next.
__kernel void samples_split(SamplesParams params, __constant const SamplePattern* pattern,
                            __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                            __global const uint* slots, __global const uint* squares, __global uint* fragment_words,
                            __global float* centres, __global float* footprints, __global float* visibility) {
    WholeWork work = {params,
                      pattern,
                      eye_of_samples(params),
                      camera_records(slots, params.triangles.count, records, bounds),
                      0,
                      0,
                      fragments_of(fragment_words, params.batch),
                      centres,
                      footprints};
    GN_FOR_EACH(i, params.count) {
        if (squares[i] != GN_NO_ID) split_square(&work, squares[i], visibility);
    }
}
#endif

// A fragment's samples share a plane, and their points are neighbours in the buffers. A CPU's work-item takes all
// samples of a fragment, a GPU's work-item a part.
__kernel void samples_points(SamplesParams params, __global const float* vertices, __global const float* rays,
                             __global uint* fragment_words, __global const uint* mixed, __global uint2* point_samples,
                             __global uint* receivers, __global float* positions, __global float* visibility,
                             __global SampleCounters* counters) {
    Fragments fragments = fragments_of(fragment_words, params.batch);
    SamplePoints points = {point_samples, receivers, positions, visibility};
    vertices += params.triangles.first_float;
    mixed += params.first;
#if GN_LANES == 1
    __local uint reserved[GROUP_APPEND_WORDS];
    if (get_local_id(0) == 0) reserved[0] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint start = (uint)get_group_id(0) * (uint)get_local_size(0); start < params.count * PARTS_OF_FRAGMENT;
         start += (uint)get_global_size(0)) {
        uint i = start + (uint)get_local_id(0), part = i % PARTS_OF_FRAGMENT, slot = 0u, mask = 0u;
        if (i < params.count * PARTS_OF_FRAGMENT) {
            slot = mixed[i / PARTS_OF_FRAGMENT];
            mask = fragments.masks[slot] & (SAMPLES_OF_PART << part * (MAX_SAMPLES / PARTS_OF_FRAGMENT));
        }
        uint point = append_in_group(popcount(mask), reserved, &counters->points);
        if (mask != 0u) write_points(&params, vertices, rays, fragments, slot, mask, point, &points);
    }
#else
    GN_FOR_EACH(i, params.count) {
        uint slot = mixed[i];
        if (slot == GN_NO_ID) continue;
        uint point = atomic_add(&counters->points, popcount(fragments.masks[slot]));
        write_points(&params, vertices, rays, fragments, slot, fragments.masks[slot], point, &points);
    }
#endif
}

__kernel void samples_count_lit(SamplesParams params, __global const uint2* point_samples,
                                __global const float* visibility, __global uint* fragment_words) {
    __global uint* lit = fragments_of(fragment_words, params.batch).lit;
    GN_FOR_EACH(i, params.count) {
        if (visibility[i] == 1.0f) atomic_inc(&lit[point_samples[i].x]);
    }
}

__kernel void samples_mean_of_sums(SamplesParams params, __global uint* fragment_words, __global float* mean) {
    __global const uint* lit = fragments_of(fragment_words, params.batch).lit;
    float scale = 1.0f / (float)params.samples;  // exact: a power of two
    GN_FOR_EACH(block, params.batch.count / GN_LANES) {
        PlaceLanes at = places_of_block(params.batch, (uint)block);
        LaneInt sums = LANES_AS_INT(LANES_STRIDED((__global const float*)lit + block * GN_LANES, 1));
        store_at_places(&at, params.batch.width, LANES_AS_INT(LANES_TO_FLOAT(sums) * scale), (__global uint*)mean);
    }
}
