// SPDX-License-Identifier: MIT
// Samples: several per pixel. Contract in samples.h; for techniques that cannot settle footprints, samples_mean alone.
//
// samples_rays     the tables of the samples' rays
// samples_whole    which pixels' samples lie on one receiver, with their footprints; the others are edges
// samples_guess    the receiver of each sample of the edges, exactly, and their pieces, where those of neighbours in
//                  the picture will do (neighbour_receivers.h)
// samples_pieces   the other edges' receivers and pieces; on a CPU in two steps:
// samples_seek         the receivers
// samples_group        the pieces
// samples_bound    the footprints of these pieces
// samples_sort     what the technique settled is counted, the rest listed
// samples_points   the samples of mixed pieces and their shading points
// samples_count    what became of them
//
// Footprints. In real arithmetic the ray through a place of the picture is linear in it, so the samples' rays lie in
// the convex hull of those through the corners of a box around them (up to 2^-47: the table's rounding). Where these
// meet the receiver's plane in front of the eye, at h = eye + t r, t = n . (a - eye) / n . r, so do all others, in the
// convex hull of the four corners' hits: a projective map whose denominator keeps its sign keeps hulls. With
//     C = (h00 + h10 + h01 + h11) / 4,  U = (h10 - h00 + h11 - h01) / 4,  V = (h01 - h00 + h11 - h10) / 4,
//     R = (h00 - h10 - h01 + h11) / 4      the corners are  C +- U +- V +- R,
// so R and every error go into the footprint's spread: that of the corners, and a shading point's distance from its
// hit, below 9 ulp of the larger of hit and eye (camera.h), 18u of it. A corner: t is off by a relative e as in
// nearness_lanes (bounds of both determinants), the ray by u times its size, and h by two roundings: |t r| e + t u size
// + 3u (|t r| + |eye|) per coordinate.
#include "samples/samples.h"

#include "camera/shading_point.clh"
#include "lists/append.h"
#include "receivers/footprint.h"
#include "samples/neighbour_receivers.clh"

// visibility: sample by sample, `pixels` each. The first batch starts the sum, the last one's scale makes it the mean.
// Sums of 0 and 1 are exact, and so is the mean, because the number of samples is a power of two; filtered techniques'
// values are added in the samples' order on every device.
__kernel void samples_mean(uint pixels, uint samples, uint is_first, float scale, __global const float* visibility,
                           __global float* mean) {
    GN_FOR_EACH(pixel, pixels) {
        float sum = is_first ? 0.0f : mean[pixel];
        for (uint sample = 0; sample < samples; ++sample) sum += visibility[(size_t)sample * pixels + pixel];
        mean[pixel] = sum * scale;
    }
}

// The tables of exact rays (camera.h) of all samples, those of one column, or row, together: the bits of the host's
// camera_tables().
__kernel void samples_rays(RayAxes axes, __constant const SamplePattern* pattern, uint width, uint height,
                           __global float* rays) {
    Wide pixel = wide_of_bits(axes.pixel);
    GN_FOR_EACH(i, pattern->count * (width + height)) {
        uint sample = (uint)i % pattern->count, entry = (uint)i / pattern->count;
        bool is_column = entry < width;
        // Sums of small multiples of 1 / SAMPLE_UNITS: exact.
        float place =
            is_column ? (float)entry + pattern->place_x[sample] : (float)(entry - width) + pattern->place_y[sample];
        Wide across = is_column ? wide_sub(wide_of_float(place), wide_of_bits(axes.half_width))
                                : wide_sub(wide_of_bits(axes.half_height), wide_of_float(place));
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

// ---- Footprints -----------------------------------------------------------------------------------------------------

// Hits of a plane, with the largest error of a coordinate; `met` where they are in front of the eye for certain.
typedef struct HitLanes {
    PointBlock at;
    LaneFloat error;
    LaneInt met;
} HitLanes;

static HitLanes hits_of(const PlaneLanes* planes, const RayLanes* rays, float3 eye) {
    LaneFloat bound;
    LaneFloat along = lanes_det3(&planes->normal, rays->direction, rays->size, &bound);
    LaneFloat t = planes->depth / along;
    HitLanes hit;
    hit.met = planes->good & LANE_COMPARE(4.0f * bound, <, fabs(along)) & LANE_COMPARE(t, >, (LaneFloat)(0.0f));
    LaneFloat relative = 1.4f * (bound / fabs(along) + planes->relative_error) + 1.0e-6f;
    hit.at.x = fma(t, rays->direction.x, (LaneFloat)(eye.x));
    hit.at.y = fma(t, rays->direction.y, (LaneFloat)(eye.y));
    hit.at.z = fma(t, rays->direction.z, (LaneFloat)(eye.z));
    LaneFloat reach = t * largest_of(rays->direction), size = largest_of(rays->size);
    float eye_size = fmax(fabs(eye.x), fmax(fabs(eye.y), fabs(eye.z)));
    hit.error = reach * relative + GN_U * (t * size + 3.0f * (reach + eye_size));
    return hit;
}

static PointBlock combined(const HitLanes* h, float s0, float s1, float s2, float s3) {
    PointBlock sum = {0.25f * (s0 * h[0].at.x + s1 * h[1].at.x + s2 * h[2].at.x + s3 * h[3].at.x),
                      0.25f * (s0 * h[0].at.y + s1 * h[1].at.y + s2 * h[2].at.y + s3 * h[3].at.y),
                      0.25f * (s0 * h[0].at.z + s1 * h[1].at.z + s2 * h[2].at.z + s3 * h[3].at.z)};
    return sum;
}

static PointBlock selected(PointBlock no, PointBlock yes, LaneInt lanes) {
    PointBlock chosen = {LANES_SELECT(no.x, yes.x, lanes), LANES_SELECT(no.y, yes.y, lanes),
                         LANES_SELECT(no.z, yes.z, lanes)};
    return chosen;
}

// The rays through the corners of boxes in the picture.
static void corner_rays(PictureRays picture, LaneFloat low_x, LaneFloat low_y, LaneFloat high_x, LaneFloat high_y,
                        RayLanes* rays) {
    for (int corner = 0; corner < 4; ++corner)
        rays[corner] = rays_at(picture, corner & 1 ? high_x : low_x, corner & 2 ? high_y : low_y);
}

// A piece's footprint: where it lies, and its shape.
typedef struct PieceBounds {
    PointBlock centre;
    FootprintBlock shape;
} PieceBounds;

static PointBlock scaled(PointBlock v, float by) {
    PointBlock result = {by * v.x, by * v.y, by * v.z};
    return result;
}

// How far a footprint reaches from its centre, at most.
static LaneFloat size_of_shape(const FootprintBlock* shape) {
    return largest_of(shape->u) + largest_of(shape->v) + shape->spread;
}

// The part of each receiver's plane that is seen between four rays. Unbounded ones keep their centre at the eye; lanes
// without a piece are absent.
static PieceBounds bounds_of_pieces(const TriangleBlock* receivers, const RayLanes* rays, float3 eye, LaneInt lanes) {
    PlaneLanes planes = planes_of(receivers, eye);
    HitLanes h[4];
    LaneInt met = lanes;
    LaneFloat error = (LaneFloat)(0.0f), largest = (LaneFloat)(fmax(fabs(eye.x), fmax(fabs(eye.y), fabs(eye.z))));
    for (int corner = 0; corner < 4; ++corner) {
        h[corner] = hits_of(&planes, &rays[corner], eye);
        met &= h[corner].met;
        LaneFloat size = largest_of(h[corner].at);
        error = LANES_MAX(h[corner].error, error);
        largest = LANES_MAX(size, largest);
    }
    PointBlock rest = combined(h, 1.0f, -1.0f, -1.0f, 1.0f);
    // 18u: the lift. 32u: the sums here, and those of footprint.h and facing.cl with places of this size.
    LaneFloat spread = 1.01f * (largest_of(rest) + error + (50.0f * GN_U) * largest) + 1.0e-30f;
    met &= LANE_COMPARE(spread, <, (LaneFloat)(1.0e30f)) & LANE_COMPARE(largest, <, (LaneFloat)(1.0e30f));
    PointBlock none = same_point(0.0f, 0.0f, 0.0f), absent = same_point(NAN, NAN, NAN);
    PieceBounds bounds;
    bounds.centre = selected(absent, same_point(eye.x, eye.y, eye.z), lanes);
    bounds.centre = selected(bounds.centre, combined(h, 1.0f, 1.0f, 1.0f, 1.0f), met);
    bounds.shape.u = selected(none, combined(h, -1.0f, 1.0f, -1.0f, 1.0f), met);
    bounds.shape.v = selected(none, combined(h, -1.0f, -1.0f, 1.0f, 1.0f), met);
    bounds.shape.spread = LANES_SELECT((LaneFloat)(INFINITY), spread, met);
    return bounds;
}

// Where a receiver reaches less far than the rays around its samples, which miss it in part, the parallelogram of two
// of its sides says more: the samples meet the receiver.
static void narrow_to_receivers(const TriangleBlock* receivers, float3 eye, LaneInt lanes, PieceBounds* bounds) {
    PointBlock ab = difference(receivers->b, receivers->a), ac = difference(receivers->c, receivers->a);
    LaneFloat largest = (LaneFloat)(fmax(fabs(eye.x), fmax(fabs(eye.y), fabs(eye.z))));
    LaneFloat corners[3] = {largest_of(receivers->a), largest_of(receivers->b), largest_of(receivers->c)};
    for (int i = 0; i < 3; ++i) largest = LANES_MAX(corners[i], largest);
    PieceBounds own;
    own.shape.u = scaled(ab, 0.5f);
    own.shape.v = scaled(ac, 0.5f);
    own.shape.spread = (50.0f * GN_U) * largest + 1.0e-30f;
    own.centre.x = receivers->a.x + (own.shape.u.x + own.shape.v.x);
    own.centre.y = receivers->a.y + (own.shape.u.y + own.shape.v.y);
    own.centre.z = receivers->a.z + (own.shape.u.z + own.shape.v.z);
    lanes &= LANE_COMPARE(size_of_shape(&own.shape), <, size_of_shape(&bounds->shape)) &
             LANE_COMPARE(largest, <, (LaneFloat)(1.0e30f));
    bounds->centre = selected(bounds->centre, own.centre, lanes);
    bounds->shape.u = selected(bounds->shape.u, own.shape.u, lanes);
    bounds->shape.v = selected(bounds->shape.v, own.shape.v, lanes);
    bounds->shape.spread = LANES_SELECT(bounds->shape.spread, own.shape.spread, lanes);
}

static PieceBounds no_pieces(void) {
    PointBlock none = same_point(0.0f, 0.0f, 0.0f);
    PieceBounds bounds = {same_point(NAN, NAN, NAN), {none, none, (LaneFloat)(INFINITY)}};
    return bounds;
}

static void store_piece_lanes(LaneFloat values, const uint* places, LaneInt written, bool in_a_row,
                              __global float* all) {
#if GN_LANES == 16
    if (in_a_row) {
        vstore16(values, 0, all + places[0]);
        return;
    }
#endif
    for (int lane = 0; lane < GN_LANES; ++lane)
        if (LANE_OF_INT(written, lane)) all[places[lane]] = LANE_OF_FLOAT(values, lane);
}

// Those of the lanes `written`, to their places; in_a_row: all lanes, and the places follow each other.
static void store_bounds(const PieceBounds* bounds, const uint* places, LaneInt written, bool in_a_row,
                         PixelBatch batch, __global float* centres, __global float* footprints) {
    const FootprintBlock* f = &bounds->shape;
    LaneFloat at[3] = {bounds->centre.x, bounds->centre.y, bounds->centre.z};
    LaneFloat shape[FOOTPRINT_FLOATS] = {f->u.x, f->u.y, f->u.z, f->v.x, f->v.y, f->v.z, f->spread};
    for (int i = 0; i < 3; ++i) store_piece_lanes(at[i], places, written, in_a_row, centres + i * (size_t)batch.places);
    for (int i = 0; i < FOOTPRINT_FLOATS; ++i)
        store_piece_lanes(shape[i], places, written, in_a_row, footprints + i * (size_t)batch.places);
}

// ---- Pieces ---------------------------------------------------------------------------------------------------------

static uint tile_of_pixel(PixelBatch batch, uint pixel) {
    return (pixel / batch.width >> CAMERA_TILE_LOG2) * batch.tiles_x + (pixel % batch.width >> CAMERA_TILE_LOG2);
}

// Triangles that cover all four rays for certain.
static LaneInt covering_all(const TriangleBlock* t, const RayLanes* rays, float3 eye, LaneInt lanes) {
    OutlineLanes outlines = outlines_of(t, eye, lanes);
    for (int corner = 0; corner < 4 && LANES_ANY(lanes); ++corner)
        lanes &= coverage_of(&outlines, &rays[corner]).certain;
    return lanes;
}

// What becomes of a block of pixels: the first of them in the batch, and which lanes are whole, edges, or see the sky.
typedef struct WholePixels {
    uint first;
    LaneInt whole, edges, sky;
} WholePixels;

#define WHOLE_BLOCKS_PER_TILE ((1u << 2 * CAMERA_TILE_LOG2) / GN_LANES)
#define WHOLE_EACH 4u  // pixels that a GPU's item looks at before its group claims places

// Writes the own pieces (edges: still empty) of a block of pixels, with bounds, and starts the sums `lit`. Blocks are
// counted tile by tile, so that edges that meet the same triangles follow each other.
static WholePixels find_whole(PictureRays picture, __constant const SamplePattern* pattern, PixelBatch batch,
                              float3 eye, __global const float* vertices, __global const uint* pixel_receivers,
                              __global const uint2* tile_ranges, uint block, __global uint* receivers,
                              __global uint* masks, __global uint* lit, __global float* centres,
                              __global float* footprints) {
    const uint tile_pixels = 1u << CAMERA_TILE_LOG2, blocks_per_row = tile_pixels / GN_LANES;
    uint tile = block / WHOLE_BLOCKS_PER_TILE, within = block % WHOLE_BLOCKS_PER_TILE;
    uint column = (tile % batch.tiles_x) * tile_pixels + (within % blocks_per_row) * GN_LANES;
    uint row = (tile / batch.tiles_x) * tile_pixels + within / blocks_per_row;
    WholePixels found = {row * batch.width + column, (LaneInt)(0), (LaneInt)(0), (LaneInt)(0)};
    if (column >= batch.width || row * batch.width >= batch.count) return found;
    uint places[GN_LANES];
    LaneInt columns = (LaneInt)((int)column) + LANE_INDEX;
    LaneInt present = LANE_COMPARE(columns, <, (LaneInt)((int)batch.width)), ids = (LaneInt)((int)GN_NO_ID);
    for (int lane = 0; lane < GN_LANES; ++lane) {
        places[lane] = found.first + lane;
        if (LANE_OF_INT(present, lane)) LANE_OF_INT(ids, lane) = (int)pixel_receivers[batch.first + places[lane]];
    }
    uint2 range = tile_ranges[batch.first / batch.width / tile_pixels * batch.tiles_x + tile];
    LaneInt whole = LANE_COMPARE(ids, !=, (LaneInt)((int)GN_NO_ID));
    PieceBounds bounds = no_pieces();
    if (LANES_ANY(whole)) {
        LaneFloat x = LANES_TO_FLOAT(columns), y = (LaneFloat)((float)(batch.first / batch.width + row));
        TriangleBlock t = load_triangles_of(vertices, ids, whole);
        RayLanes rays[4];
        corner_rays(picture, x + pattern->low[0], y + pattern->low[1], x + pattern->high[0], y + pattern->high[1],
                    rays);
        whole = covering_all(&t, rays, eye, whole);
        if (LANES_ANY(whole)) bounds = bounds_of_pieces(&t, rays, eye, whole);
    }
    found.whole = whole;
    if (range.x == range.y)
        found.sky = present;
    else
        found.edges = present & ~whole;
    store_bounds(&bounds, places, present, !LANES_ANY(~present), batch, centres, footprints);
    for (int lane = 0; lane < GN_LANES; ++lane) {
        if (!LANE_OF_INT(present, lane)) continue;
        receivers[places[lane]] = (uint)LANE_OF_INT(ids, lane);
        masks[places[lane]] = LANE_OF_INT(whole, lane) ? pattern->all : 0u;
        lit[places[lane]] = LANE_OF_INT(found.sky, lane) ? pattern->count : 0u;
    }
    return found;
}

// find_whole() of all blocks, and the list of edges.
__kernel void samples_whole(PictureRays picture, __constant const SamplePattern* pattern, PixelBatch batch,
                            float4 eye_and_zero, ulong first_float, __global const float* vertices,
                            __global const uint* pixel_receivers, __global const uint2* tile_ranges,
                            __global uint* receivers, __global uint* masks, __global uint* lit, __global uint* edges,
                            __global float* centres, __global float* footprints, __global SampleCounters* counters) {
    float3 eye = eye_and_zero.xyz;
    uint block_count = batch.bands * batch.tiles_x * WHOLE_BLOCKS_PER_TILE;
    LaneInt minus_whole = (LaneInt)(0), minus_sky = (LaneInt)(0);
    vertices += first_float;
#if GN_LANES == 1
    // The edges that a group finds in a round lie in a tile or two, and together in the list: neighbours in a warp then
    // walk the same lists.
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
            WholePixels found = find_whole(picture, pattern, batch, eye, vertices, pixel_receivers, tile_ranges, block,
                                           receivers, masks, lit, centres, footprints);
            minus_whole += found.whole;
            minus_sky += found.sky;
            if (found.edges) found_edges[count++] = found.first;
        }
        uint place = claim_in_group(count, reserved, &counters->edges);
        for (uint k = 0; k < count; ++k) edges[place + k] = found_edges[k];
    }
    atomic_add(&sums[0], (uint)-minus_whole);
    atomic_add(&sums[1], (uint)-minus_sky);
    barrier(CLK_LOCAL_MEM_FENCE);
    uint whole_count = get_local_id(0) == 0 ? sums[0] : 0u, sky_count = get_local_id(0) == 0 ? sums[1] : 0u;
#else
    Reservation reserved = no_reservation();
    GN_FOR_EACH(block, block_count) {
        WholePixels found = find_whole(picture, pattern, batch, eye, vertices, pixel_receivers, tile_ranges,
                                       (uint)block, receivers, masks, lit, centres, footprints);
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

// Marks places, [first, end), that were claimed and are not needed.
static void mark_unused_slots(uint first, uint end, PixelBatch batch, uint capacity, __global uint* extra_pixels,
                              __global uint* receivers, __global uint* masks) {
    for (uint place = first; place < min(end, capacity); ++place) {
        extra_pixels[place] = 0u;
        receivers[batch.count + place] = GN_NO_ID;
        masks[batch.count + place] = 0u;
    }
}

// The pieces of edge pixels whose samples lie on the pixel's receiver and those of its neighbours, where that can be
// proven; the others are listed, to be sought in.
__kernel void samples_guess(__constant const Projection* projection, PictureRays picture,
                            __constant const SamplePattern* pattern, PixelBatch batch, uint edge_count,
                            uint extra_capacity, ulong first_float, __global const float* vertices,
                            __global const float* rays, __global const TriangleRecord* records,
                            __global const TriangleBounds* bounds, __global const uint2* ranges,
                            __global const BinEntries* entries, __global const uint* pixel_receivers,
                            __global const uint* edges, __global uint* sought, __global uint* extra_pixels,
                            __global uint* receivers, __global uint* masks, __global uint* lit,
                            __global SampleCounters* counters) {
    TileLists lists = {ranges, entries, records, bounds, vertices + first_float, rays, picture};
    SampleRays sample_rays = {rays, batch.width, pattern->count};
    float3 eye = center_of(projection);
    Reservation places = no_reservation(), sought_places = no_reservation();
    uint sky_count = 0;
    GN_FOR_EACH(block, (edge_count + GN_LANES - 1u) / GN_LANES) {
        GuessedPixels p;
        LaneInt lanes = (LaneInt)(0), tiles = (LaneInt)(0);
        p.column = p.row = p.pixel = (LaneInt)(0);
        p.own = (LaneInt)((int)GN_NO_ID);
        for (int lane = 0; lane < GN_LANES; ++lane) {
            uint edge = (uint)block * GN_LANES + lane;
            if (edge >= edge_count || edges[edge] == GN_NO_ID) continue;
            uint pixel = batch.first + edges[edge];
            LANE_OF_INT(lanes, lane) = -1;
            LANE_OF_INT(p.pixel, lane) = (int)edges[edge];
            LANE_OF_INT(p.column, lane) = (int)(pixel % batch.width);
            LANE_OF_INT(p.row, lane) = (int)(pixel / batch.width);
            LANE_OF_INT(p.own, lane) = (int)pixel_receivers[pixel];
            LANE_OF_INT(tiles, lane) = (int)tile_of_pixel(batch, pixel);
        }
        if (!LANES_ANY(lanes)) continue;
        p.own_mask = LANES_SELECT((LaneInt)(0), (LaneInt)((int)pattern->all),
                                  lanes & LANE_COMPARE(p.own, !=, (LaneInt)((int)GN_NO_ID)));
        if (LANES_ANY(p.own_mask)) {
            TriangleBlock t = load_triangles_of(lists.vertices, p.own, LANE_COMPARE(p.own_mask, !=, (LaneInt)(0)));
            p.own_mask = samples_on(&t, picture, pattern, sample_rays, p.column, p.row, eye, p.own_mask);
        }
        p.rest = LANES_SELECT((LaneInt)(0), (LaneInt)((int)pattern->all) & ~p.own_mask, lanes);
        p.proven = lanes;
        PictureBox box = box_of_samples(pattern, p.rest);
        guess_receivers(batch, pixel_receivers, &box, &p);
        LaneFloat x = LANES_TO_FLOAT(p.column), y = LANES_TO_FLOAT(p.row);
        box.low_x += x, box.low_y += y, box.high_x += x, box.high_y += y;
        RayLanes corners[4];
        corner_rays(picture, box.low_x, box.low_y, box.high_x, box.high_y, corners);
        share_samples(lists, pattern, eye, corners, sample_rays, 0, GUESSES, &p);
        LaneFloat near = nearness_of_rest(&p, GUESSES);
#if GN_LANES == 1
        // Whatever lies in the box may be what the others meet: more work for one item than for samples_pieces.
        p.proven &= LANE_COMPARE(near, >, -INFINITY);
#endif
        LaneInt left = p.proven & LANE_COMPARE(p.rest, !=, (LaneInt)(0));
        while (LANES_ANY(left)) {
            int tile = LANE_OF_INT(tiles, first_lane(left));
            LaneInt same_tile = left & LANE_COMPARE(tiles, ==, (LaneInt)(tile));
            look_for_others(lists, projection, (uint)tile, same_tile, &box, near, &p);
            left &= ~same_tile;
        }
        share_samples(lists, pattern, eye, corners, sample_rays, GUESSES, OTHER_RECEIVERS, &p);
        near = nearness_of_rest(&p, OTHER_RECEIVERS);
        p.proven &= LANE_COMPARE(p.left_out, <, near) | LANE_COMPARE(p.left_out, ==, (LaneFloat)(-INFINITY));
        for (int lane = 0; lane < GN_LANES; ++lane) {
            if (!LANE_OF_INT(lanes, lane)) continue;
            uint i = (uint)LANE_OF_INT(p.pixel, lane);
            if (!LANE_OF_INT(p.proven, lane)) {
                sought[reservation(&sought_places, &counters->sought)] = i;
                continue;
            }
            masks[i] = (uint)LANE_OF_INT(p.own_mask, lane);
            uint sky = (uint)LANE_OF_INT(p.rest, lane);
            for (int g = 0; g < OTHER_RECEIVERS; ++g) {
                uint mask = (uint)LANE_OF_INT(p.masks[g], lane);
                if (mask == 0u) continue;
                sky &= ~mask;
                uint place = reservation(&places, &counters->extra);
                if (place >= extra_capacity) continue;
                extra_pixels[place] = i;
                receivers[batch.count + place] = (uint)LANE_OF_INT(p.ids[g], lane);
                masks[batch.count + place] = mask;
            }
            lit[i] = popcount(sky);
            sky_count += popcount(sky);
        }
    }
    for (; sought_places.next < sought_places.end; ++sought_places.next) sought[sought_places.next] = GN_NO_ID;
    mark_unused_slots(places.next, places.end, batch, extra_capacity, extra_pixels, receivers, masks);
    if (sky_count != 0) atomic_add(&counters->lit, sky_count);
}

#if GN_LANES == 1

// Items of a group of samples_pieces at most, and entries that each of them looks at in one go.
#define PIECES_ITEMS 32u
#define PIECES_ENTRIES 4u

// What the items of a group share.
typedef struct PiecesGroup {
    float place_x[MOST_SAMPLES], place_y[MOST_SAMPLES];
    uint seen[MOST_SAMPLES];                         // the receivers of the pixel's samples
    uint masks[MOST_SAMPLES];                        // of the pieces, each at its first sample; 0 elsewhere
    uint ranks[MOST_SAMPLES];                        // of the pieces on other receivers than the pixel's own
    uint met[PIECES_ITEMS * PIECES_ENTRIES];         // records whose entries meet the pixel
    uint candidates[PIECES_ITEMS * PIECES_ENTRIES];  // of these, those whose triangles may
    uint met_count, candidate_count;
    uint searching;  // samples that do
    uint others;     // pieces on other receivers
    uint next, end;  // places claimed for them
} PiecesGroup;

// Those of the entries [first, end) that may meet the box. Every item must come here.
static void find_candidates(TileLists lists, uint first, uint end, QuantisedBlock block, const PictureBox* box,
                            __local PiecesGroup* group) {
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0);
    if (item == 0u) group->met_count = group->candidate_count = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    EntryWords some[PIECES_ENTRIES];
    for (uint k = 0; k < PIECES_ENTRIES; ++k)
        some[k] = *(__global const EntryWords*)&lists.entries[min(first + item + k * items, end - 1u)];
    for (uint k = 0; k < PIECES_ENTRIES; ++k)
        if (first + item + k * items < end && entry_meets(some[k], block))
            group->met[atomic_inc(&group->met_count)] = slot_of_words(some[k]);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = item; i < group->met_count; i += items)
        if (may_meet_boxes(&lists.records[group->met[i]], box, -1))
            group->candidates[atomic_inc(&group->candidate_count)] = group->met[i];
    barrier(CLK_LOCAL_MEM_FENCE);
}

// Of up to 32 candidates those that may be the nearest that a sample meets, by their records. From here on best->low is
// no less than that of any which is met for certain, so that what lies behind one of them is not looked at.
static uint candidates_of_sample(TileLists lists, __local const uint* candidates, uint count, const RayBlock* ray,
                                 NearestLanes* best) {
    uint possible = 0;
    for (uint c = 0; c < count; ++c) {
        NearestFilter found = filter_nearest(&lists.records[candidates[c]], ray, -1, best);
        if (!found.possible) continue;
        possible |= 1u << c;
        if (found.inside) best->low = fmax(best->low, found.low);
    }
    return possible;
}

// samples_seek and samples_group in one, a group of a few dozen items per pixel. They share out the list of the pixel's
// tile: what cannot meet the box around the samples is dismissed, mostly without a look at its record. Then each of
// them takes a sample over the few triangles that are left, all of them over the same one.
__kernel void samples_pieces(__constant const Projection* projection, PictureRays picture,
                             __constant const SamplePattern* pattern, PixelBatch batch, uint edge_count,
                             uint extra_capacity, ulong first_float, __global const float* vertices,
                             __global const float* rays, __global const TriangleRecord* records,
                             __global const TriangleBounds* bounds, __global const uint2* ranges,
                             __global const BinEntries* entries, __global const uint* pixel_receivers,
                             __global const uint* edges, __global uint* extra_pixels, __global uint* receivers,
                             __global uint* masks, __global uint* lit, __global SampleCounters* counters) {
    __local PiecesGroup group;
    TileLists lists = {ranges, entries, records, bounds, vertices + first_float, rays, picture};
    float3 eye = center_of(projection);
    uint item = (uint)get_local_id(0), items = (uint)get_local_size(0), samples = pattern->count;
    uint per_round = items * PIECES_ENTRIES, sky_count = 0;
    for (uint sample = item; sample < samples; sample += items) {
        group.place_x[sample] = pattern->place_x[sample];
        group.place_y[sample] = pattern->place_y[sample];
    }
    if (item == 0u) group.next = group.end = 0u;
    for (uint edge = (uint)get_group_id(0); edge < edge_count; edge += (uint)get_num_groups(0)) {
        uint i = edges[edge], pixel = batch.first + i, own = pixel_receivers[pixel];
        uint x = pixel % batch.width, y = pixel / batch.width;
        PictureBox box = {(float)x + pattern->low[0], (float)y + pattern->low[1], (float)x + pattern->high[0],
                          (float)y + pattern->high[1]};
        QuantisedBlock block = {
            quantised_texel(box.low_x, projection->width), quantised_texel(box.low_y, projection->height),
            quantised_texel(box.high_x, projection->width), quantised_texel(box.high_y, projection->height), 0};
        for (uint first = 0; first < samples; first += items) {
            uint sample = first + item;
            int searching = sample < samples ? -1 : 0;
            RayBlock ray = {0.0f, 0.0f, 0, 0};
            if (item == 0u) group.searching = group.others = 0u;
            barrier(CLK_LOCAL_MEM_FENCE);
            if (searching) {
                ray.x = (float)x + group.place_x[sample];
                ray.y = (float)y + group.place_y[sample];
                ray.column = (int)(x * samples + sample);
                ray.row = (int)((batch.width + y) * samples + sample);
                group.seen[sample] = own;
                if (own != GN_NO_ID) searching &= ~lanes_met(lists, eye, &ray, own, searching);
                if (searching) atomic_inc(&group.searching);
            }
            barrier(CLK_LOCAL_MEM_FENCE);
            uint2 range = group.searching != 0u ? ranges[tile_of_pixel(batch, pixel)] : (uint2)(0u);
            NearestLanes best = nothing_near();
            for (uint start = range.x; start < range.y; start += per_round) {
                find_candidates(lists, start, min(start + per_round, range.y), block, &box, &group);
                uint count = searching ? group.candidate_count : 0u;
                for (uint c = 0; c < count; c += 32u) {
                    uint possible = candidates_of_sample(lists, group.candidates + c, min(count - c, 32u), &ray, &best);
                    while (possible != 0u)
                        look_at_record(lists, eye, &ray, group.candidates[c + take_lowest_bit(&possible)], searching,
                                       &best);
                }
                barrier(CLK_LOCAL_MEM_FENCE);
            }
            if (searching) group.seen[sample] = (uint)best.id;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        for (uint sample = item; sample < samples; sample += items) {
            uint id = group.seen[sample], mask = 0u;
            for (uint other = 0; other < samples; ++other) mask |= (group.seen[other] == id ? 1u : 0u) << other;
            bool is_first = (mask & ((1u << sample) - 1u)) == 0u;
            group.masks[sample] = is_first ? mask : 0u;
            if (is_first && id != own && id != GN_NO_ID) group.ranks[sample] = atomic_inc(&group.others);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        uint wanted = group.others;
        if (item == 0u && group.end - group.next < wanted) {
            mark_unused_slots(group.next, group.end, batch, extra_capacity, extra_pixels, receivers, masks);
            group.next = reserve_slots(PIECES_CLAIM, &counters->extra);
            group.end = group.next + PIECES_CLAIM;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        for (uint sample = item; sample < samples; sample += items) {
            uint id = group.seen[sample], mask = group.masks[sample];
            if (mask == 0u) continue;
            if (id == GN_NO_ID) {
                lit[i] = popcount(mask);
                sky_count += popcount(mask);
            } else if (id == own) {
                masks[i] = mask;
            } else if (group.next + group.ranks[sample] < extra_capacity) {
                uint place = group.next + group.ranks[sample];
                extra_pixels[place] = i;
                receivers[batch.count + place] = id;
                masks[batch.count + place] = mask;
            }
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item == 0u) group.next += wanted;
    }
    if (item == 0u) mark_unused_slots(group.next, group.end, batch, extra_capacity, extra_pixels, receivers, masks);
    if (sky_count != 0) atomic_add(&counters->lit, sky_count);
}

#else

// seen[edge of this part * samples + sample]. One work-item takes GN_LANES samples of a pixel.
__kernel void samples_seek(__constant const Projection* projection, PictureRays picture,
                           __constant const SamplePattern* pattern, PixelBatch batch, uint first_edge, uint edge_count,
                           ulong first_float, __global const float* vertices, __global const float* rays,
                           __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                           __global const uint2* ranges, __global const BinEntries* entries,
                           __global const uint* pixel_receivers, __global const uint* edges, __global uint* seen) {
    TileLists lists = {ranges, entries, records, bounds, vertices + first_float, rays, picture};
    float3 eye = center_of(projection);
    uint samples = pattern->count, blocks = (samples + GN_LANES - 1u) / GN_LANES;
    GN_FOR_EACH(item, edge_count * blocks) {
        uint edge = (uint)item / blocks, first = (uint)item % blocks * GN_LANES;
        if (edges[first_edge + edge] == GN_NO_ID) continue;
        uint pixel = batch.first + edges[first_edge + edge];
        uint x = pixel % batch.width, y = pixel / batch.width;
        RayBlock block;
        LaneInt sample = (LaneInt)((int)first) + LANE_INDEX;
        LaneInt searching = LANE_COMPARE(sample, <, (LaneInt)((int)samples)), present = searching;
        block.column = sample + (int)(x * samples);
        block.row = sample + (int)((batch.width + y) * samples);
        // Lanes past the last sample hold 0.
        block.x = (float)x + LANES_STRIDED(pattern->place_x + first, 1);
        block.y = (float)y + LANES_STRIDED(pattern->place_y + first, 1);
        uint own = pixel_receivers[pixel];
        if (own != GN_NO_ID) searching &= ~lanes_met(lists, eye, &block, own, searching);
        LaneInt nearest = nearest_of_tile(lists, projection, tile_of_pixel(batch, pixel), block, searching);
        nearest = LANES_SELECT((LaneInt)((int)own), nearest, searching);
        for (int lane = 0; lane < GN_LANES; ++lane)
            if (LANE_OF_INT(present, lane))
                seen[(size_t)edge * samples + first + lane] = (uint)LANE_OF_INT(nearest, lane);
    }
}

// One piece for each receiver that an edge pixel's samples have: the own one's in its place, others behind.
__kernel void samples_group(__constant const SamplePattern* pattern, PixelBatch batch, uint first_edge, uint edge_count,
                            uint extra_capacity, __global const uint* pixel_receivers, __global const uint* edges,
                            __global const uint* seen, __global uint* extra_pixels, __global uint* receivers,
                            __global uint* masks, __global uint* lit, __global SampleCounters* counters) {
    Reservation places = no_reservation();
    uint sky_count = 0;
    GN_FOR_EACH(edge, edge_count) {
        uint i = edges[first_edge + edge];
        if (i == GN_NO_ID) continue;
        __global const uint* mine = seen + (size_t)edge * pattern->count;
        uint own = pixel_receivers[batch.first + i], left = pattern->all;
        while (left != 0u) {
            uint first = 31u - clz(left & (0u - left)), id = mine[first], mask = 0u;
            for (uint sample = first; sample < pattern->count; ++sample)
                if (mine[sample] == id) mask |= 1u << sample;
            left &= ~mask;
            if (id == GN_NO_ID) {
                lit[i] = popcount(mask);
                sky_count += popcount(mask);
            } else if (id == own) {
                masks[i] = mask;
            } else {
                uint place = reservation(&places, &counters->extra);
                if (place >= extra_capacity) continue;
                extra_pixels[place] = i;
                receivers[batch.count + place] = id;
                masks[batch.count + place] = mask;
            }
        }
    }
    mark_unused_slots(places.next, places.end, batch, extra_capacity, extra_pixels, receivers, masks);
    if (sky_count != 0) atomic_add(&counters->lit, sky_count);
}

#endif

static uint pixel_of_piece(PixelBatch batch, __global const uint* extra_pixels, uint piece) {
    return piece < batch.count ? piece : extra_pixels[piece - batch.count];
}

// The bounds of the edges' pieces: their own and `extra_count` others.
__kernel void samples_bound(PictureRays picture, __constant const SamplePattern* pattern, PixelBatch batch,
                            uint edge_count, uint extra_count, float4 eye_and_zero, ulong first_float,
                            __global const float* vertices, __global const uint* edges,
                            __global const uint* extra_pixels, __global const uint* receivers,
                            __global const uint* masks, __global float* centres, __global float* footprints) {
    float3 eye = eye_and_zero.xyz;
    uint count = edge_count + extra_count;
    GN_FOR_EACH(block, (count + GN_LANES - 1u) / GN_LANES) {
        uint places[GN_LANES];
        LaneInt written = (LaneInt)(0), mask = (LaneInt)(0), ids = (LaneInt)((int)GN_NO_ID);
        LaneFloat x = (LaneFloat)(0.0f), y = x;
        for (int lane = 0; lane < GN_LANES; ++lane) {
            uint i = (uint)block * GN_LANES + lane;
            if (i >= count) continue;
            uint place = i < edge_count ? edges[i] : batch.count + (i - edge_count);
            if (place == GN_NO_ID) continue;
            places[lane] = place;
            LANE_OF_INT(written, lane) = -1;
            LANE_OF_INT(mask, lane) = (int)masks[place];
            LANE_OF_INT(ids, lane) = (int)receivers[place];
            uint pixel = batch.first + pixel_of_piece(batch, extra_pixels, place);
            LANE_OF_FLOAT(x, lane) = (float)(pixel % batch.width);
            LANE_OF_FLOAT(y, lane) = (float)(pixel / batch.width);
        }
        LaneInt lanes = LANE_COMPARE(mask, !=, (LaneInt)(0));
        PieceBounds bounds = no_pieces();
        if (LANES_ANY(lanes)) {
            PictureBox box = box_of_samples(pattern, mask);
            TriangleBlock t = load_triangles_of(vertices + first_float, ids, lanes);
            RayLanes rays[4];
            corner_rays(picture, x + box.low_x, y + box.low_y, x + box.high_x, y + box.high_y, rays);
            bounds = bounds_of_pieces(&t, rays, eye, lanes);
            narrow_to_receivers(&t, eye, lanes, &bounds);
        }
        store_bounds(&bounds, places, written, false, batch, centres, footprints);
    }
}

// ---- What was settled, and the rest ---------------------------------------------------------------------------------

__kernel void samples_sort(PixelBatch batch, uint piece_count, __global const uint* extra_pixels,
                           __global const uint* masks, __global const float* visibility, __global uint* lit,
                           __global uint* mixed, __global SampleCounters* counters) {
    Reservation places = no_reservation();
    uint in_shadow = 0, lit_count = 0, mixed_count = 0, mixed_samples = 0, pieces = 0;
    __local uint sums[5];  // of the group: on one address a GPU adds too slowly for every item
    if (get_local_id(0) == 0)
        for (int i = 0; i < 5; ++i) sums[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    GN_FOR_EACH(piece, piece_count) {
        uint samples = popcount(masks[piece]);
        if (samples == 0u) continue;
        ++pieces;
        if (visibility[piece] == 0.0f) {
            in_shadow += samples;
        } else if (visibility[piece] == 1.0f) {
            lit_count += samples;
            atomic_add(&lit[pixel_of_piece(batch, extra_pixels, (uint)piece)], samples);
        } else {
            ++mixed_count;
            mixed_samples += samples;
            mixed[reservation(&places, &counters->mixed)] = (uint)piece;
        }
    }
    for (; places.next < places.end; ++places.next) mixed[places.next] = GN_NO_ID;
    const uint found[5] = {pieces, in_shadow, lit_count, mixed_count, mixed_samples};
    for (int i = 0; i < 5; ++i)
        if (found[i] != 0u) atomic_add(&sums[i], found[i]);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) != 0) return;
    atomic_add(&counters->pieces, sums[0]);
    atomic_add(&counters->in_shadow, sums[1]);
    atomic_add(&counters->lit, sums[2]);
    atomic_add(&counters->mixed_pieces, sums[3]);
    atomic_add(&counters->mixed_samples, sums[4]);
}

// The points of some samples of a piece, from `place` on.
static void write_points(PixelBatch batch, uint samples, uint stride, float3 eye, __global const float* vertices,
                         __global const float* rays, __global const uint* extra_pixels,
                         __global const uint* piece_receivers, uint piece, uint mask, uint place,
                         __global uint2* places, __global uint* receivers, __global float* positions,
                         __global float* visibility) {
    uint pixel = pixel_of_piece(batch, extra_pixels, piece), at = batch.first + pixel;
    uint column = at % batch.width * samples, row = (batch.width + at / batch.width) * samples;
    SeenTriangle seen = see_triangle(vertices, piece_receivers[piece], eye);
    for (; mask != 0u; ++place) {
        uint sample = take_lowest_bit(&mask);
        places[place] = (uint2)(pixel, sample);
        receivers[place] = seen.id;
        visibility[place] = VISIBILITY_OPEN;
        float3 p = shading_point(&seen, eye, load_ray(rays, column + sample, row + sample));
        positions[place] = p.x;
        positions[place + stride] = p.y;
        positions[place + 2 * (size_t)stride] = p.z;
    }
}

// places[i] = (pixel of the batch, sample) of point i, its receiver, and its shading point: x of `stride` points, then
// y, then z. They are open (point_blocks.h). A piece's samples share a plane and lie together: a CPU's work-item takes
// all of them, a GPU's a part.
__kernel void samples_points(PixelBatch batch, uint samples, uint first_mixed, uint mixed_count, uint stride,
                             float4 eye_and_zero, ulong first_float, __global const float* vertices,
                             __global const float* rays, __global const uint* extra_pixels,
                             __global const uint* piece_receivers, __global const uint* masks,
                             __global const uint* mixed, __global uint2* places, __global uint* receivers,
                             __global float* positions, __global float* visibility, __global SampleCounters* counters) {
    float3 eye = eye_and_zero.xyz;
    vertices += first_float;
#if GN_LANES == 1
    __local uint reserved[GROUP_APPEND_WORDS];
    if (get_local_id(0) == 0) reserved[0] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint start = (uint)get_group_id(0) * (uint)get_local_size(0); start < mixed_count * PARTS_OF_PIECES;
         start += (uint)get_global_size(0)) {
        uint i = start + (uint)get_local_id(0), part = i % PARTS_OF_PIECES, piece = 0u, mask = 0u;
        if (i < mixed_count * PARTS_OF_PIECES) {
            piece = mixed[first_mixed + i / PARTS_OF_PIECES];
            mask = masks[piece] & (SAMPLES_OF_PART << part * (MOST_SAMPLES / PARTS_OF_PIECES));
        }
        uint place = claim_in_group(popcount(mask), reserved, &counters->placed);
        if (mask != 0u)
            write_points(batch, samples, stride, eye, vertices, rays, extra_pixels, piece_receivers, piece, mask, place,
                         places, receivers, positions, visibility);
    }
#else
    GN_FOR_EACH(i, mixed_count) {
        uint piece = mixed[first_mixed + i];
        if (piece == GN_NO_ID) continue;
        uint place = atomic_add(&counters->placed, popcount(masks[piece]));
        write_points(batch, samples, stride, eye, vertices, rays, extra_pixels, piece_receivers, piece, masks[piece],
                     place, places, receivers, positions, visibility);
    }
#endif
}

__kernel void samples_count(uint count, __global const uint2* places, __global const float* visibility,
                            __global uint* lit) {
    GN_FOR_EACH(i, count) {
        if (visibility[i] == 1.0f) atomic_inc(&lit[places[i].x]);
    }
}

__kernel void samples_mean_of_sums(PixelBatch batch, float scale, __global const uint* lit, __global float* mean) {
    GN_FOR_EACH(i, batch.count) mean[batch.first + i] = (float)lit[i] * scale;
}
