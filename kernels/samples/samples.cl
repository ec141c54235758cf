// SPDX-License-Identifier: MIT
// Samples: several per pixel. Contract in samples.h. A technique that cannot classify footprints uses only
// samples_mean. The kernels in the order of their launches:
//
// samples_rays            the tables of the samples' rays
// samples_whole           the whole pixels and their footprints; lists the edge pixels
// samples_guess           guesses that an edge pixel's samples lie on the receivers of its neighbours; writes the
//                         fragments of the pixels for which it proves this; lists the unproven pixels
// samples_fragments       GPU: the receivers and fragments of the unproven pixels. A CPU takes two kernels:
// samples_receivers           the receivers
// samples_group               the fragments
// samples_bound           the footprints of the edge pixels' fragments
// samples_resolve         after the footprints are classified: adds up the decided samples, lists the mixed fragments
// samples_points          the samples of mixed fragments and their shading points
// samples_count_lit       adds up the samples that the trace found lit
// samples_mean_of_sums    the pixels' means
#include "samples/samples.h"

#include "camera/shading_point.clh"
#include "samples/find_receivers_gpu.clh"
#include "samples/footprints.clh"

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

// ---- Fragments ------------------------------------------------------------------------------------------------------

__kernel void samples_whole(SamplesParams params, __constant const SamplePattern* pattern,
                            __global const float* vertices, __global const uint* pixel_receivers,
                            __global const uint2* tile_ranges, __global uint* fragment_words, __global uint* edges,
                            __global float* centres, __global float* footprints, __global SampleCounters* counters) {
    Fragments fragments = fragments_of(fragment_words, params.batch);
    float3 eye = eye_of_samples(params);
    uint block_count = params.batch.bands * params.batch.tiles_x * WHOLE_BLOCKS_PER_TILE;
    LaneInt minus_whole = (LaneInt)(0), minus_sky = (LaneInt)(0);
    vertices += params.triangles.first_float;
#if GN_LANES == 1
    // The edge pixels that a group finds in a round lie in one or two tiles and are neighbours in the list: neighbours
    // in a warp then walk the same lists.
    __local uint reserved[GROUP_APPEND_WORDS], sums[2];
    uint items = (uint)get_local_size(0);
    if (get_local_id(0) == 0) reserved[0] = sums[0] = sums[1] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint start = (uint)get_group_id(0) * items * WHOLE_EACH; start < block_count;
         start += (uint)get_global_size(0) * WHOLE_EACH) {
        uint found_edges[WHOLE_EACH], count = 0u;
        for (uint k = 0; k < WHOLE_EACH; ++k) {
            uint block = start + k * items + (uint)get_local_id(0);
            if (block >= block_count) break;
            WholePixels found = find_whole(params, pattern, eye, vertices, pixel_receivers, tile_ranges, block,
                                           fragments, centres, footprints);
            minus_whole += found.whole;
            minus_sky += found.sky;
            if (found.edges) found_edges[count++] = found.first;
        }
        uint slot = append_in_group(count, reserved, &counters->edges);
        for (uint k = 0; k < count; ++k) edges[slot + k] = found_edges[k];
    }
    atomic_add(&sums[0], (uint)-minus_whole);
    atomic_add(&sums[1], (uint)-minus_sky);
    barrier(CLK_LOCAL_MEM_FENCE);
    uint whole_count = get_local_id(0) == 0 ? sums[0] : 0u, sky_count = get_local_id(0) == 0 ? sums[1] : 0u;
#else
    Reservation reserved = no_reservation();
    GN_FOR_EACH(block, block_count) {
        WholePixels found = find_whole(params, pattern, eye, vertices, pixel_receivers, tile_ranges, (uint)block,
                                       fragments, centres, footprints);
        minus_whole += found.whole;
        minus_sky += found.sky;
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(found.edges, lane)) edges[reservation(&reserved, &counters->edges)] = found.first + lane;
    }
    for (; reserved.next < reserved.end; ++reserved.next) edges[reserved.next] = GN_NO_ID;
    uint whole_count = (uint)-LANES_SUM(minus_whole), sky_count = (uint)-LANES_SUM(minus_sky);
#endif
    if (whole_count != 0) atomic_add(&counters->whole, whole_count);
    if (sky_count != 0) atomic_add(&counters->lit, sky_count * pattern->count);
}

// edges: the list of edge pixels. The kernel writes the list of unproven pixels behind it.
__kernel void samples_guess(SamplesParams params, __constant const SamplePattern* pattern,
                            __global const float* vertices, __global const float* rays,
                            __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                            __global const uint2* ranges, __global const BinEntries* entries,
                            __global const uint* pixel_receivers, __global uint* edges, __global uint* fragment_words,
                            __global SampleCounters* counters) {
    Triangles triangles = triangles_of(vertices, params.triangles);
    TileLists lists = {ranges, entries, records, bounds, triangles, rays, params.picture};
    SampleRays sample_rays = {rays, params.batch.width, pattern->count};
    Fragments fragments = fragments_of(fragment_words, params.batch);
    __global uint* unproven = edges + params.batch.edge_slots;
    float3 eye = eye_of_samples(params);
    Reservation extra = no_reservation(), unproven_slots = no_reservation();
    uint sky_count = 0;
    GN_FOR_EACH(block, (params.count + GN_LANES - 1u) / GN_LANES) {
        GuessedPixels p;
        load_edge_pixels(params.batch, edges, params.count, (uint)block, pixel_receivers, &p);
        if (!LANES_ANY(p.lanes)) continue;
        prove_receivers(lists, params.batch, pattern, sample_rays, pixel_receivers, eye, &p);
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(p.lanes, lane)) continue;
            if (LANE_OF_INT(p.proven, lane))
                sky_count += store_guessed(&p, lane, fragments, params.batch, &extra, counters);
            else
                unproven[reservation(&unproven_slots, &counters->unproven)] = (uint)LANE_OF_INT(p.pixel, lane);
        }
    }
    for (; unproven_slots.next < unproven_slots.end; ++unproven_slots.next) unproven[unproven_slots.next] = GN_NO_ID;
    mark_unused_slots(fragments, params.batch, extra.next, extra.end);
    if (sky_count != 0) atomic_add(&counters->lit, sky_count);
}

#if GN_LANES == 1

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
    __global const uint* unproven = edges + params.batch.edge_slots;
    float3 eye = eye_of_samples(params);
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), samples = pattern->count, sky_count = 0;
    for (uint sample = item; sample < samples; sample += items) {
        group.position_x[sample] = pattern->position_x[sample];
        group.position_y[sample] = pattern->position_y[sample];
    }
    if (item == 0u) group.next = group.end = 0u;
    for (uint edge = (uint)get_group_id(0); edge < params.count; edge += (uint)get_num_groups(0)) {
        uint i = unproven[edge], pixel = params.batch.first + i, own = pixel_receivers[pixel];
        find_sample_receivers(lists, params.batch, pattern, eye, pixel, own, &group);
        group_by_receiver(params, samples, own, &group, fragments, counters);
        sky_count += store_fragments(params, samples, i, own, &group, fragments);
    }
    if (item == 0u) mark_unused_slots(fragments, params.batch, group.next, group.end);
    if (sky_count != 0) atomic_add(&counters->lit, sky_count);
}

#else

// sample_receivers[unproven pixel of this part * samples + sample]. One work-item takes GN_LANES samples of a pixel.
__kernel void samples_receivers(SamplesParams params, __constant const Projection* projection,
                                __constant const SamplePattern* pattern, __global const float* vertices,
                                __global const float* rays, __global const TriangleRecord* records,
                                __global const TriangleBounds* bounds, __global const uint2* ranges,
                                __global const BinEntries* entries, __global const uint* pixel_receivers,
                                __global const uint* edges, __global uint* sample_receivers) {
    Triangles triangles = triangles_of(vertices, params.triangles);
    TileLists lists = {ranges, entries, records, bounds, triangles, rays, params.picture};
    PixelBatch batch = params.batch;
    __global const uint* unproven = edges + batch.edge_slots + params.first;
    float3 eye = eye_of_samples(params);
    uint samples = pattern->count, blocks = (samples + GN_LANES - 1u) / GN_LANES;
    GN_FOR_EACH(item, params.count * blocks) {
        uint edge = (uint)item / blocks, first = (uint)item % blocks * GN_LANES;
        if (unproven[edge] == GN_NO_ID) continue;
        uint pixel = batch.first + unproven[edge];
        uint x = pixel % batch.width, y = pixel / batch.width;
        RayBlock block;
        LaneInt sample = (LaneInt)((int)first) + LANE_INDEX;
        LaneInt searching = LANE_COMPARE(sample, <, (LaneInt)((int)samples)), present = searching;
        block.column = sample + (int)(x * samples);
        block.row = sample + (int)((batch.width + y) * samples);
        // Lanes past the last sample are 0.
        block.x = (float)x + LANES_STRIDED(pattern->position_x + first, 1);
        block.y = (float)y + LANES_STRIDED(pattern->position_y + first, 1);
        uint own = pixel_receivers[pixel];
        if (own != GN_NO_ID) searching &= ~lanes_met(lists, eye, &block, own, searching);
        QuantisedBlock box = box_of_rays(projection, &block, searching);
        uint likely = GN_NO_ID;
        LaneInt nearest =
            nearest_of_tile(lists, projection, tile_of_pixel(batch, pixel), block, box, searching, &likely);
        nearest = LANES_SELECT((LaneInt)((int)own), nearest, searching);
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(present, lane))
                sample_receivers[(size_t)edge * samples + first + lane] = (uint)LANE_OF_INT(nearest, lane);
    }
}

// One fragment for each receiver of an unproven pixel's samples: the fragment on the own receiver goes into the pixel's
// slot, every other fragment into an extra slot.
__kernel void samples_group(SamplesParams params, __constant const SamplePattern* pattern,
                            __global const uint* pixel_receivers, __global const uint* edges,
                            __global const uint* sample_receivers, __global uint* fragment_words,
                            __global SampleCounters* counters) {
    Fragments fragments = fragments_of(fragment_words, params.batch);
    __global const uint* unproven = edges + params.batch.edge_slots + params.first;
    Reservation extra = no_reservation();
    uint sky_count = 0;
    GN_FOR_EACH(edge, params.count) {
        uint i = unproven[edge];
        if (i == GN_NO_ID) continue;
        __global const uint* ids = sample_receivers + (size_t)edge * pattern->count;
        uint own = pixel_receivers[params.batch.first + i], left = pattern->all;
        while (left != 0u) {
            uint first = 31u - clz(left & (0u - left)), id = ids[first], mask = 0u;
            for (uint sample = first; sample < pattern->count; ++sample)
                if (ids[sample] == id) mask |= 1u << sample;
            left &= ~mask;
            if (id == GN_NO_ID) {
                fragments.lit[i] = popcount(mask);
                sky_count += popcount(mask);
            } else if (id == own) {
                fragments.masks[i] = mask;
            } else {
                store_extra(fragments, params.batch, reservation(&extra, &counters->extra), i, id, mask);
            }
        }
    }
    mark_unused_slots(fragments, params.batch, extra.next, extra.end);
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
        LaneFloat x = (LaneFloat)(0.0f), y = x;
        for (int lane = 0; lane < GN_LANES; ++lane) {
            uint i = (uint)block * GN_LANES + lane;
            if (i >= count) continue;
            uint slot = i < edge_count ? edges[i] : batch.count + (i - edge_count);
            if (slot == GN_NO_ID) continue;
            slots[lane] = slot;
            LANE_OF_INT(written, lane) = -1;
            LANE_OF_INT(mask, lane) = (int)fragments.masks[slot];
            LANE_OF_INT(ids, lane) = (int)fragments.receivers[slot];
            uint pixel = batch.first + pixel_of_fragment(fragments, batch, slot);
            LANE_OF_FLOAT(x, lane) = (float)(pixel % batch.width);
            LANE_OF_FLOAT(y, lane) = (float)(pixel / batch.width);
        }
        LaneInt lanes = LANE_COMPARE(mask, !=, (LaneInt)(0));
        FragmentBounds bounds = no_fragments();
        if (LANES_ANY(lanes)) {
            PictureBox box = box_of_samples(pattern, mask);
            TriangleBlock t = load_triangles_of(vertices + params.triangles.first_float, ids, lanes);
            RayLanes rays[4];
            box.low_x += x, box.low_y += y, box.high_x += x, box.high_y += y;
            corner_rays(params.picture, &box, rays);
            bounds = bounds_of_fragments(&t, rays, eye, lanes);
            narrow_to_receivers(&t, eye, lanes, &bounds);
        }
        store_bounds(&bounds, slots, written, false, batch, centres, footprints);
    }
}

// ---- Undecided fragments --------------------------------------------------------------------------------------------

// visibility: the class of each fragment's footprint. Appends to `mixed`.
__kernel void samples_resolve(SamplesParams params, __global uint* fragment_words, __global const float* visibility,
                              __global uint* mixed, __global SampleCounters* counters) {
    Fragments fragments = fragments_of(fragment_words, params.batch);
    Reservation mixed_slots = no_reservation();
    uint in_shadow = 0, lit_count = 0, mixed_count = 0, mixed_samples = 0, fragment_count = 0;
    __local uint sums[5];  // of the group: atomics of every item on one address are too slow on a GPU
    if (get_local_id(0) == 0)
        for (int i = 0; i < 5; ++i) sums[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    GN_FOR_EACH(slot, params.count) {
        uint samples = popcount(fragments.masks[slot]);
        if (samples == 0u) continue;
        ++fragment_count;
        if (visibility[slot] == 0.0f) {
            in_shadow += samples;
        } else if (visibility[slot] == 1.0f) {
            lit_count += samples;
            atomic_add(&fragments.lit[pixel_of_fragment(fragments, params.batch, (uint)slot)], samples);
        } else {
            ++mixed_count;
            mixed_samples += samples;
            mixed[reservation(&mixed_slots, &counters->mixed)] = (uint)slot;
        }
    }
    for (; mixed_slots.next < mixed_slots.end; ++mixed_slots.next) mixed[mixed_slots.next] = GN_NO_ID;
    const uint found[5] = {fragment_count, in_shadow, lit_count, mixed_count, mixed_samples};
    for (int i = 0; i < 5; ++i)
        if (found[i] != 0u) atomic_add(&sums[i], found[i]);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) != 0) return;
    atomic_add(&counters->fragments, sums[0]);
    atomic_add(&counters->in_shadow, sums[1]);
    atomic_add(&counters->lit, sums[2]);
    atomic_add(&counters->mixed_fragments, sums[3]);
    atomic_add(&counters->mixed_samples, sums[4]);
}

// The output points of mixed samples. The points are open (point_blocks.h). x of point_stride points, then y, then z.
typedef struct SamplePoints {
    __global uint2* samples;  // (pixel of the batch, sample)
    __global uint* receivers;
    __global float* positions;
    __global float* visibility;
} SamplePoints;

// Writes the points of the samples in `mask` of a fragment, from `point` on.
static void write_points(SamplesParams params, __global const float* vertices, __global const float* rays,
                         Fragments fragments, uint slot, uint mask, uint point, SamplePoints points) {
    PixelBatch batch = params.batch;
    uint pixel = pixel_of_fragment(fragments, batch, slot), at = batch.first + pixel;
    uint column = at % batch.width * params.samples, row = (batch.width + at / batch.width) * params.samples;
    float3 eye = eye_of_samples(params);
    SeenTriangle seen = see_triangle(vertices, fragments.receivers[slot], eye);
    for (; mask != 0u; ++point) {
        uint sample = take_lowest_bit(&mask);
        points.samples[point] = (uint2)(pixel, sample);
        points.receivers[point] = seen.id;
        points.visibility[point] = VISIBILITY_OPEN;
        float3 p = shading_point(&seen, eye, load_ray(rays, column + sample, row + sample));
        points.positions[point] = p.x;
        points.positions[point + params.point_stride] = p.y;
        points.positions[point + 2 * (size_t)params.point_stride] = p.z;
    }
}

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
            mask = fragments.masks[slot] & (SAMPLES_OF_PART << part * (MOST_SAMPLES / PARTS_OF_FRAGMENT));
        }
        uint point = append_in_group(popcount(mask), reserved, &counters->points);
        if (mask != 0u) write_points(params, vertices, rays, fragments, slot, mask, point, points);
    }
#else
    GN_FOR_EACH(i, params.count) {
        uint slot = mixed[i];
        if (slot == GN_NO_ID) continue;
        uint point = atomic_add(&counters->points, popcount(fragments.masks[slot]));
        write_points(params, vertices, rays, fragments, slot, fragments.masks[slot], point, points);
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
    GN_FOR_EACH(i, params.batch.count) mean[params.batch.first + i] = (float)lit[i] * scale;
}
