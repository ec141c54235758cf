// SPDX-License-Identifier: MIT
// Finds the receivers of the edge pixels' samples on a GPU, from records only: an item takes a pixel, and makes a mask
// of the samples that meet each triangle. (An item for each sample took eight times the instructions.) A group's pixels
// are neighbours in their list, mostly of one tile: the group copies the records that may meet one of its pixels to
// local memory, each item marks the records that may meet its own pixel, and then makes only their masks. As on a CPU
// (coverage_masks.clh explains why this is exact) the receivers of the neighbours in the picture come first, and hide
// most of the list. What records leave open becomes pairs for samples_open_pairs (samples_filter.cl). A pixel is left
// to samples_filter if it has more receivers or open pairs than fit, has a masked triangle, or lies in a tile with a
// long list.
#include "samples/pixel_masks_gpu.clh"

#if GN_LANES == 1

// Pixels of tiles with longer lists are left: a group would walk these lists while all other groups have ended. (H100,
// Sponza, this kernel and samples_filter: 150, 300, 600 entries, all .67, .67, .71, 1.02 ms.)
#define LONGEST_LIST 256u

// Tries the pixel's own receiver, then those of the neighbours to the left and right, above and below. Every item must
// call this.
static void try_neighbours(const GpuMasksWork* work, uint2 at, bool is_present, PixelMasks* pixel) {
    __local MasksGroup* group = work->group;
    uint width = work->batch.width, place = at.y * width + at.x, ids[1 + NEIGHBOURS], wanted = 0u;
    ids[0] = work->pixel_receivers[place];
    ids[1] = at.x > 0u ? work->pixel_receivers[place - 1u] : ids[0];
    ids[2] = at.x + 1u < width ? work->pixel_receivers[place + 1u] : ids[0];
    ids[3] = at.y > 0u ? work->pixel_receivers[place - width] : ids[0];
    ids[4] = at.y + 1u < work->batch.height ? work->pixel_receivers[place + width] : ids[0];
    for (uint i = 0; i < 1u + NEIGHBOURS; ++i) {
        bool is_new = is_present;
        for (uint k = 0; k < i; ++k) is_new &= ids[i] != ids[k];
        pixel->tried[i] = is_new ? slot_of_triangle(work->from, ids[i]) : GN_NO_ID;
        wanted += pixel->tried[i] != GN_NO_ID ? 1u : 0u;
    }
    if (get_local_id(0) == 0) group->pairs = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint first = atomic_add(&group->pairs, wanted), pair = first;
    for (uint i = 0; i < 1u + NEIGHBOURS; ++i)
        if (pixel->tried[i] != GN_NO_ID) add_pair(group, pair++, pixel->tried[i]);
    make_masks(work);
    for (pair = first; pair < first + wanted; ++pair)
        keep_pair(work, pair, pair == first && pixel->tried[0] != GN_NO_ID, pixel);
    barrier(CLK_LOCAL_MEM_FENCE);
}

// ---- The tile's list ------------------------------------------------------------------------------------------------

// The box around the pixels of the items that search, and the farthest height that they need. Every item must call
// this.
static QuantisedBlock box_of_group(const GpuMasksWork* work, const PixelMasks* pixel, bool searches) {
    __local MasksGroup* group = work->group;
    PixelBatch batch = work->batch;
    if (get_local_id(0) == 0) {
        group->low_x = group->low_y = group->farthest = 0xFFFFu;
        group->high_x = group->high_y = 0u;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (searches) {
        atomic_min(&group->low_x, (uint)quantised_texel(pixel->box.low_x, batch.width));
        atomic_min(&group->low_y, (uint)quantised_texel(pixel->box.low_y, batch.height));
        atomic_max(&group->high_x, (uint)quantised_texel(pixel->box.high_x, batch.width));
        atomic_max(&group->high_y, (uint)quantised_texel(pixel->box.high_y, batch.height));
        atomic_min(&group->farthest, (uint)quantised_farthest(pixel->farthest));
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    QuantisedBlock box = {(ushort)group->low_x, (ushort)group->low_y, (ushort)group->high_x, (ushort)group->high_y,
                          (ushort)group->farthest};
    barrier(CLK_LOCAL_MEM_FENCE);
    return box;
}

// Copies the next records that may meet the box; returns the first entry that is not read. Every item must call this.
static uint copy_records(const GpuMasksWork* work, uint first, uint end, QuantisedBlock box) {
    __local MasksGroup* group = work->group;
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), copied = 0u;
    while (first < end && copied + items <= MAX_COPIED) {
        EntryWords entry = *(__global const EntryWords*)&work->lists.entries[min(first + item, end - 1u)];
        if (first + item < end && entry_meets(entry, box)) {
            uint at = atomic_inc(&group->copied), slot = slot_of_words(entry);
            __global const float4* record = (__global const float4*)&work->lists.records[slot];
            group->slots[at] = slot;
            for (uint i = 0; i < 4u; ++i) group->copies[at][i] = record[i];
        }
        first += items;
        barrier(CLK_LOCAL_MEM_FENCE);
        copied = group->copied;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    return first;
}

// True if a copied record may be that of a receiver of the item's pixel.
static bool may_be_receiver(__local const float4* copy, const PixelMasks* pixel) {
    float4 x = copy[0], y = copy[1], c = copy[2], plane = copy[3];  // (edges, margin), (.., z_low), (plane, z_high)
    bool may = !(max_in_box(x.x, y.x, c.x, &pixel->box) < -x.w) && !(max_in_box(x.y, y.y, c.y, &pixel->box) < -x.w) &&
               !(max_in_box(x.z, y.z, c.z, &pixel->box) < -x.w);
    float high = max_in_box(plane.x, plane.y, plane.z, &pixel->box) + y.w;
    return may && !(high < pixel->farthest) && !(plane.w < pixel->farthest);
}

static bool was_tried(const PixelMasks* pixel, uint slot) {
    bool was = false;
    for (uint i = 0; i < 1u + NEIGHBOURS; ++i) was |= pixel->tried[i] == slot;
    return was;
}

// Tries the copied records in `marks`, a bit each, for the item's pixel. Every item must call this. (The loop is left
// only at its end: PoCL 3.0 loses `wanted` if a loop with barriers is left in the middle.)
static void try_marked(const GpuMasksWork* work, uint marks, PixelMasks* pixel) {
    __local MasksGroup* group = work->group;
    uint pairs;
    do {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (get_local_id(0) == 0) group->pairs = 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        uint wanted = min(popcount(marks), PAIRS_OF_ITEM), pair = wanted != 0u ? atomic_add(&group->pairs, wanted) : 0u;
        for (uint k = 0; k < wanted; ++k) add_pair(group, pair + k, group->slots[take_lowest_bit(&marks)]);
        make_masks(work);
        pairs = group->pairs;
        for (uint k = 0; k < wanted; ++k) keep_pair(work, pair + k, false, pixel);
    } while (pairs != 0u);
}

// Tries the triangles of a tile's list for the pixels of the items that search. Every item must call this.
static void try_list(const GpuMasksWork* work, uint tile, bool searches, PixelMasks* pixel) {
    __local MasksGroup* group = work->group;
    QuantisedBlock box = box_of_group(work, pixel, searches);
    uint2 range = work->lists.ranges[tile];
    for (uint first = range.x; first < range.y;) {
        if (get_local_id(0) == 0) group->copied = 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        first = copy_records(work, first, range.y, box);
        uint marks = 0u, count = searches ? group->copied : 0u;
        for (uint i = 0; i < count; ++i)
            if (may_be_receiver(group->copies[i], pixel) && !was_tried(pixel, group->slots[i])) marks |= 1u << i;
        try_marked(work, marks, pixel);
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

// Tries the lists of the tiles of all items that search, tile by tile. Every item must call this.
static void try_lists(const GpuMasksWork* work, uint tile, bool searches, PixelMasks* pixel) {
    __local MasksGroup* group = work->group;
    for (;;) {
        if (get_local_id(0) == 0) group->tile = GN_NO_ID;
        barrier(CLK_LOCAL_MEM_FENCE);
        if (searches) atomic_min(&group->tile, tile);
        barrier(CLK_LOCAL_MEM_FENCE);
        uint next = group->tile;
        barrier(CLK_LOCAL_MEM_FENCE);
        if (next == GN_NO_ID) return;
        try_list(work, next, searches && tile == next, pixel);
        searches &= tile != next;
    }
}

// ---- What is found --------------------------------------------------------------------------------------------------

// Writes the open pairs of the group's pixels, and the receivers of their samples so far. Pixels that do not fit are
// left to samples_filter. Every item must call this.
static void store_open(const GpuMasksWork* work, OpenSamples open, uint i, uint own, PixelMasks* pixel,
                       __global SampleCounters* counters) {
    __local MasksGroup* group = work->group;
    uint item = (uint)get_local_id(0);
    bool is_open = pixel->is_open && !pixel->is_left;
    uint at = append_in_group(is_open ? 1u : 0u, group->reserved, &counters->open_pixels);
    uint count = min(group->opens, MAX_OPEN_OF_GROUP);
    uint first = reserve_for_group(count, group->reserved, &counters->open_pairs);
    bool has_slot = is_open && at < open.capacities.pixels;
    if (is_open && (!has_slot || first + count > open.capacities.pairs)) leave_pixel(pixel);
    group->open_pixels[item] = has_slot && !pixel->is_left ? at : GN_NO_ID;
    if (has_slot) open.pixels[at] = pixel->is_left ? GN_NO_ID : i;
    if (has_slot && !pixel->is_left)
        for (uint sample = 0; sample < work->pattern->count; ++sample) {
            uint slot = GN_NO_ID;
            EACH_RECEIVER(k)
            slot = (work->group->receiver_masks[k][(uint)get_local_id(0)] >> sample & 1u) != 0u
                       ? work->group->receiver_slots[k][(uint)get_local_id(0)]
                       : slot;
            open.receivers[at * MAX_SAMPLES + sample] = (pixel->own_mask >> sample & 1u) != 0u ? own
                                                        : slot == GN_NO_ID                     ? GN_NO_ID
                                                                           : work->lists.bounds[slot].id;
        }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint k = item; k < count; k += (uint)get_local_size(0)) {
        uint place = group->open_places[k], of = group->open_pixels[place / MAX_SAMPLES];
        if (first + k < open.capacities.pairs)
            open.pairs[first + k] = (uint2)(of == GN_NO_ID ? 0u : of * MAX_SAMPLES + place % MAX_SAMPLES,
                                            of == GN_NO_ID ? GN_NO_ID : group->open_slots[k]);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}

// Writes the fragments of a pixel; the fragments on further receivers go to the extra slots from `extra` on.
static void store_masks(const GpuMasksWork* work, Fragments fragments, uint i, uint extra, const PixelMasks* pixel) {
    fragments.masks[i] = pixel->own_mask;
    fragments.lit[i] = popcount(pixel->rest & ~pixel->covered);
    EACH_RECEIVER(k) {
        if (work->group->receiver_masks[k][(uint)get_local_id(0)] != 0u)
            store_extra(fragments, work->batch, extra++, i,
                        work->lists.bounds[work->group->receiver_slots[k][(uint)get_local_id(0)]].id,
                        work->group->receiver_masks[k][(uint)get_local_id(0)]);
    }
}

#ifdef SAMPLES_SMALL_GROUPS
#define MASKS_GROUP_SIZE
#else
#define MASKS_GROUP_SIZE __attribute__((reqd_work_group_size(MASKS_GROUP, 1, 1)))
#endif

MASKS_GROUP_SIZE __kernel void samples_masks_gpu(SamplesParams params, __constant const SamplePattern* pattern,
                                                 __global const TriangleRecord* records,
                                                 __global const TriangleBounds* bounds, __global const uint2* ranges,
                                                 __global const BinEntries* entries,
                                                 __global const uint* pixel_receivers, __global const uint* slots,
                                                 __global uint* edges, __global uint* fragment_words,
                                                 __global uint* open_words, __global SampleCounters* counters) {
    __local MasksGroup group;
    PixelBatch batch = params.batch;
    GpuMasksWork work = {{ranges, entries, records, bounds, {0, 0u}, 0, params.picture},
                         camera_records(slots, params.triangles.count, records, bounds),
                         batch,
                         pattern,
                         pixel_receivers,
                         &group};
    Fragments fragments = fragments_of(fragment_words, batch);
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), sky_count = 0u;
    for (uint sample = item; sample < MAX_SAMPLES; sample += items) {
        group.position_x[sample] = pattern->position_x[sample];
        group.position_y[sample] = pattern->position_y[sample];
    }
    if (item == 0u) group.reserved[0] = group.sky = 0u;
    for (uint start = (uint)get_group_id(0) * items; start < params.count; start += (uint)get_global_size(0)) {
        if (item == 0u) group.opens = 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        bool is_present = start + item < params.count;
        uint i = edges[min(start + item, params.count - 1u)];
        uint2 at = place_of_pixel(batch, i);
        PixelMasks pixel;
        begin_masks(&work, at, &pixel);
        group.pixel_x[item] = pixel.x, group.pixel_y[item] = pixel.y;
        uint2 range = ranges[tile_of_pixel(batch, i)];
        if (is_present && range.y - range.x > LONGEST_LIST) leave_pixel(&pixel);
        try_neighbours(&work, at, is_present && !pixel.is_left, &pixel);
        try_lists(&work, tile_of_pixel(batch, i), is_present && pixel.rest != 0u && !pixel.is_left, &pixel);
        store_open(&work, open_samples(open_words, params.open), i, pixel_receivers[at.y * batch.width + at.x], &pixel,
                   counters);
        bool is_found = is_present && !pixel.is_left && !pixel.is_open;
        uint wanted = 0u;
        EACH_RECEIVER(k) wanted += is_found && group.receiver_masks[k][(uint)get_local_id(0)] != 0u ? 1u : 0u;
        uint extra = append_in_group(wanted, group.reserved, &counters->extra);
        uint left = append_in_group(pixel.is_left ? 1u : 0u, group.reserved, &counters->left);
        if (pixel.is_left) edges[batch.edge_slots + left] = i;
        if (!is_found) continue;
        store_masks(&work, fragments, i, extra, &pixel);
        sky_count += popcount(pixel.rest & ~pixel.covered);
    }
    if (sky_count != 0u) atomic_add(&group.sky, sky_count);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0u && group.sky != 0u) atomic_add(&counters->lit, group.sky);
}

#endif
