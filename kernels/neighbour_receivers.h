// SPDX-License-Identifier: MIT
// The receivers of an edge pixel's samples, guessed and proven: nearly always they are the pixel's own and those of its
// neighbours in the picture. 16 pixels of a tile at once (one on a GPU), each with a few triangles of its own.
//
// Which samples meet a triangle is linear in the place: with r = r0 + x r_x + y r_y, the ray through (x, y) of the
// pixel, each edge function is det(u, v, r0) + x det(u, v, r_x) + y det(u, v, r_y), three determinants for all samples.
// Each is off by its float level's bound (sizes as for a ray: 4 times the magnitudes), two fma round u of what is
// then summed, less than 3u of the three magnitudes, as 0 <= x, y <= 1, and a division by the bound and products with
// it another 3u. The samples that this leaves open are decided exactly, one by one.
//
// Samples off the pixel's own receiver that meet one guess belong to that, if no other triangle can be nearer: if none
// in the tile's list but the guesses may be met within the box around these samples, or only behind. 1 / t is linear in
// the place as well: over the box it is nowhere less, or more, than at one of the corners. And a computed edge function
// or plane, being made of fma that are monotone in the coordinate and in what they add, is nowhere in a box more than
// in the corner that the signs of its slopes choose.
#ifndef GN_NEIGHBOUR_RECEIVERS_H
#define GN_NEIGHBOUR_RECEIVERS_H

#include "camera_rays.h"
#include "samples.h"

// Receivers beside the pixel's own: guesses, and what else is found in the tile's list.
#define GUESSES 3
#define OTHER_RECEIVERS 7

// A box in the picture, in pixels.
typedef struct PictureBox {
    LaneFloat low_x, low_y, high_x, high_y;
} PictureBox;

// The most that a x + b y + c, as lanes_linear computes it, is in a box.
static LaneFloat most_in_box(float a, float b, float c, const PictureBox* box) {
    return lanes_linear(a, b, c, a > 0.0f ? box->high_x : box->low_x, b > 0.0f ? box->high_y : box->low_y);
}

// Boxes within which a ray may meet the triangle.
static LaneInt may_meet_boxes(__global const TriangleRecord* r, const PictureBox* box, LaneInt lanes) {
    for (int i = 0; i < 3; ++i)
        lanes &=
            ~LANE_COMPARE(most_in_box(r->edge_x[i], r->edge_y[i], r->edge_0[i], box), <, (LaneFloat)(-r->margin_edge));
    return lanes;
}

// The box around the samples of each mask, in pixels from the pixel's corner.
static PictureBox box_of_samples(__constant const SamplePattern* pattern, LaneInt mask) {
    PictureBox box = {(LaneFloat)(1.0f), (LaneFloat)(1.0f), (LaneFloat)(0.0f), (LaneFloat)(0.0f)};
    for (uint sample = 0; sample < pattern->count; ++sample) {
        LaneInt is_in = LANE_COMPARE(mask << (int)(31u - sample), <, (LaneInt)(0));
        LaneFloat x = (LaneFloat)(pattern->place_x[sample]), y = (LaneFloat)(pattern->place_y[sample]);
        box.low_x = LANES_SELECT(box.low_x, LANES_MIN(x, box.low_x), is_in);
        box.low_y = LANES_SELECT(box.low_y, LANES_MIN(y, box.low_y), is_in);
        box.high_x = LANES_SELECT(box.high_x, LANES_MAX(x, box.high_x), is_in);
        box.high_y = LANES_SELECT(box.high_y, LANES_MAX(y, box.high_y), is_in);
    }
    return box;
}

// The edge functions of triangles, each over a pixel, in units of the bounds of their errors.
typedef struct PixelSides {
    LaneFloat at[3], per_x[3], per_y[3];
    LaneInt met_by_some;  // not edge-on
    LaneInt usable;       // all bounds are finite
} PixelSides;

static PointBlock ray_step(const float* step) { return same_point(step[0], step[1], step[2]); }

static PixelSides sides_over_pixels(const TriangleBlock* t, PictureRays picture, LaneFloat x, LaneFloat y, float3 eye,
                                    LaneInt lanes) {
    PointBlock step_x = ray_step(picture.step_x), step_y = ray_step(picture.step_y);
    PointBlock size_x = {4.0f * fabs(step_x.x), 4.0f * fabs(step_x.y), 4.0f * fabs(step_x.z)};
    PointBlock size_y = {4.0f * fabs(step_y.x), 4.0f * fabs(step_y.y), 4.0f * fabs(step_y.z)};
    RayLanes corner = rays_at(picture, x, y);
    OutlineLanes outlines = outlines_of(t, eye, lanes);
    PixelSides sides;
    sides.met_by_some = LANE_COMPARE(outlines.orientation, !=, (LaneInt)(0));
    sides.usable = (LaneInt)(-1);
    for (int i = 0; i < 3; ++i) {
        LaneFloat bound_at, bound_x, bound_y;
        LaneFloat at = lanes_det3(&outlines.sides[i], corner.direction, corner.size, &bound_at);
        LaneFloat per_x = lanes_det3(&outlines.sides[i], step_x, size_x, &bound_x);
        LaneFloat per_y = lanes_det3(&outlines.sides[i], step_y, size_y, &bound_y);
        LaneFloat bound =
            1.01f * (bound_at + bound_x + bound_y + (6.0f * GN_U) * (fabs(at) + fabs(per_x) + fabs(per_y)));
        sides.usable &= LANE_COMPARE(bound, <, (LaneFloat)(INFINITY));
        LaneFloat scale = LANES_TO_FLOAT(outlines.orientation) / bound;
        sides.at[i] = at * scale;
        sides.per_x[i] = per_x * scale;
        sides.per_y[i] = per_y * scale;
    }
    return sides;
}

// Of the samples `asked`, those that meet the triangle for certain; `open`: that may.
static LaneInt samples_met(const PixelSides* sides, __constant const SamplePattern* pattern, LaneInt asked,
                           LaneInt* open) {
    LaneInt met = (LaneInt)(0), missed = (LaneInt)(0);
    for (uint sample = 0; sample < pattern->count; ++sample) {
        LaneFloat x = (LaneFloat)(pattern->place_x[sample]), y = (LaneFloat)(pattern->place_y[sample]);
        LaneFloat e0 = fma(x, sides->per_x[0], fma(y, sides->per_y[0], sides->at[0]));
        LaneFloat e1 = fma(x, sides->per_x[1], fma(y, sides->per_y[1], sides->at[1]));
        LaneFloat e2 = fma(x, sides->per_x[2], fma(y, sides->per_y[2], sides->at[2]));
        LaneFloat least = LANES_MIN(e0, LANES_MIN(e1, e2));
        LaneInt bit = (LaneInt)((int)(1u << sample));
        met |= LANE_COMPARE(least, >, (LaneFloat)(1.0f)) & bit;
        missed |= LANE_COMPARE(least, <, (LaneFloat)(-1.0f)) & bit;
    }
    met &= sides->usable & sides->met_by_some;
    missed = (missed & sides->usable) | ~sides->met_by_some;
    *open = asked & ~met & ~missed;
    return asked & met;
}

// Where samples' rays are found: in tables with an entry for each sample of each column, then of each row.
typedef struct SampleRays {
    __global const float* tables;
    uint columns, samples;
} SampleRays;

// The samples `asked` that meet triangles, one for each pixel.
static LaneInt samples_on(const TriangleBlock* t, PictureRays picture, __constant const SamplePattern* pattern,
                          SampleRays rays, LaneInt column, LaneInt row, float3 eye, LaneInt asked) {
    PixelSides sides = sides_over_pixels(t, picture, LANES_TO_FLOAT(column), LANES_TO_FLOAT(row), eye,
                                         LANE_COMPARE(asked, !=, (LaneInt)(0)));
    LaneInt open, met = samples_met(&sides, pattern, asked, &open);
    for (int lane = 0; lane < GN_LANES; ++lane) {
        uint left = (uint)LANE_OF_INT(open, lane);
        if (left == 0u) continue;
        Outline outline = outline_of(lane_triangle(t, lane), eye);
        while (left != 0u) {
            uint sample = take_lowest_bit(&left);
            Ray ray = load_ray(rays.tables, (uint)LANE_OF_INT(column, lane) * rays.samples + sample,
                               (rays.columns + (uint)LANE_OF_INT(row, lane)) * rays.samples + sample);
            if (covers(&outline, eye, ray)) LANE_OF_INT(met, lane) |= (int)(1u << sample);
        }
    }
    return met;
}

// 1 / t of triangles' planes over boxes.
static NearnessLanes nearness_over_boxes(const TriangleBlock* t, const RayLanes* corners, float3 eye) {
    PlaneLanes planes = planes_of(t, eye);
    NearnessLanes over = {(LaneFloat)(INFINITY), (LaneFloat)(-INFINITY)};
    for (int corner = 0; corner < 4; ++corner) {
        NearnessLanes at = nearness_of_planes(&planes, &corners[corner]);
        over.low = LANES_MIN(at.low, over.low);
        over.high = LANES_MAX(at.high, over.high);
    }
    return over;
}

// What is known of some edge pixels.
typedef struct GuessedPixels {
    LaneInt pixel;                               // of the batch
    LaneInt column, row;                         // in the picture
    LaneInt own;                                 // their receivers
    LaneInt own_mask, rest;                      // samples on it, and off it
    LaneInt ids[OTHER_RECEIVERS];                // first the guesses; GN_NO_ID where there are fewer
    LaneInt masks[OTHER_RECEIVERS];              // the samples of each
    NearnessLanes near[OTHER_RECEIVERS];         // over the box around the rest
    LaneFloat highs[OTHER_RECEIVERS - GUESSES];  // the most that 1 / t is, of what was found beside the guesses
    LaneFloat left_out;                          // likewise, of what there was no room for
    LaneInt proven;
} GuessedPixels;

// The receivers of the neighbours that lie where the samples of `box` do, from the pixel's middle.
static void guess_receivers(PixelBatch batch, __global const uint* pixel_receivers, const PictureBox* box,
                            GuessedPixels* p) {
    LaneFloat x = box->low_x + box->high_x - 1.0f, y = box->low_y + box->high_y - 1.0f;
    for (int g = 0; g < OTHER_RECEIVERS; ++g) p->ids[g] = (LaneInt)((int)GN_NO_ID);
    for (int i = 0; i < OTHER_RECEIVERS - GUESSES; ++i) p->highs[i] = (LaneFloat)(-INFINITY);
    p->left_out = (LaneFloat)(-INFINITY);
    for (int lane = 0; lane < GN_LANES; ++lane) {
        if (LANE_OF_INT(p->rest, lane) == 0) continue;
        float to_x = LANE_OF_FLOAT(x, lane), to_y = LANE_OF_FLOAT(y, lane);
        int dx = to_x < 0.0f ? -1 : 1, dy = to_y < 0.0f ? -1 : 1, found = 0;
        bool mostly_x = fabs(to_x) > fabs(to_y);
        const int steps_x[5] = {mostly_x ? dx : 0, mostly_x ? 0 : dx, dx, mostly_x ? 0 : -dx, mostly_x ? -dx : 0};
        const int steps_y[5] = {mostly_x ? 0 : dy, mostly_x ? dy : 0, dy, mostly_x ? -dy : 0, mostly_x ? 0 : -dy};
        for (int i = 0; i < 5 && found < GUESSES; ++i) {
            int column = LANE_OF_INT(p->column, lane) + steps_x[i], row = LANE_OF_INT(p->row, lane) + steps_y[i];
            if (column < 0 || row < 0 || column >= (int)batch.width || row >= (int)batch.height) continue;
            int id = (int)pixel_receivers[(uint)row * batch.width + (uint)column];
            bool is_new = id != (int)GN_NO_ID && id != LANE_OF_INT(p->own, lane);
            for (int g = 0; g < found; ++g) is_new &= id != LANE_OF_INT(p->ids[g], lane);
            if (is_new) LANE_OF_INT(p->ids[found++], lane) = id;
        }
    }
}

// The samples of some receivers. Where two hold one sample, and the box does not say which is the nearer, nothing is
// proven.
static void share_samples(TileLists lists, __constant const SamplePattern* pattern, float3 eye, const RayLanes* corners,
                          SampleRays rays, int first, int end, GuessedPixels* p) {
    for (int g = first; g < end; ++g) {
        p->masks[g] = (LaneInt)(0);
        if (g < GUESSES) {
            LaneInt covered = (LaneInt)(0);
            for (int other = 0; other < g; ++other) covered |= p->masks[other];
            p->ids[g] |= LANE_COMPARE(covered, ==, p->rest);
        }
        LaneInt asked =
            LANES_SELECT(p->rest, (LaneInt)(0), LANE_COMPARE(p->ids[g], ==, (LaneInt)((int)GN_NO_ID)) | ~p->proven);
        LaneInt lanes = LANE_COMPARE(asked, !=, (LaneInt)(0));
        if (!LANES_ANY(lanes)) continue;
        TriangleBlock t = load_triangles_of(lists.vertices, p->ids[g], lanes);
        p->masks[g] = samples_on(&t, lists.picture, pattern, rays, p->column, p->row, eye, asked);
        p->near[g] = nearness_over_boxes(&t, corners, eye);
        for (int other = 0; other < g; ++other) {
            LaneInt both = p->masks[g] & p->masks[other];
            if (!LANES_ANY(both)) continue;
            LaneInt this_one = LANE_COMPARE(p->near[g].low, >, p->near[other].high);
            LaneInt other_one = LANE_COMPARE(p->near[g].high, <, p->near[other].low);
            p->proven &= this_one | other_one | LANE_COMPARE(both, ==, (LaneInt)(0));
            p->masks[g] &= ~(both & other_one);
            p->masks[other] &= ~(both & this_one);
        }
    }
}

// What the rest's samples meet has a 1 / t of at least this.
static LaneFloat nearness_of_rest(const GuessedPixels* p, int count) {
    LaneFloat least = (LaneFloat)(INFINITY);
    LaneInt covered = (LaneInt)(0);
    for (int g = 0; g < count; ++g) {
        LaneInt holds = LANE_COMPARE(p->masks[g], !=, (LaneInt)(0));
        if (!LANES_ANY(holds)) continue;
        covered |= p->masks[g];
        least = LANES_SELECT(least, LANES_MIN(p->near[g].low, least), holds);
    }
    return LANES_SELECT((LaneFloat)(-INFINITY), least, LANE_COMPARE(covered, ==, p->rest));
}

// Keeps a triangle, whose 1 / t is at most `high`, for some pixels: in the place of the farthest where all are taken.
static void keep_receiver(LaneInt id, LaneFloat high, LaneInt lanes, GuessedPixels* p) {
    LaneFloat lowest = (LaneFloat)(INFINITY);
    for (int i = GUESSES; i < OTHER_RECEIVERS; ++i) lowest = LANES_MIN(p->highs[i - GUESSES], lowest);
    LaneFloat lost = LANES_MIN(high, lowest);
    p->left_out = LANES_SELECT(p->left_out, LANES_MAX(lost, p->left_out), lanes);
    lanes &= LANE_COMPARE(high, >, lowest);
    for (int i = GUESSES; i < OTHER_RECEIVERS && LANES_ANY(lanes); ++i) {
        LaneInt here = lanes & LANE_COMPARE(p->highs[i - GUESSES], ==, lowest);
        p->ids[i] = LANES_SELECT(p->ids[i], id, here);
        p->highs[i - GUESSES] = LANES_SELECT(p->highs[i - GUESSES], high, here);
        lanes &= ~here;
    }
}

// One of the tile's list, for pixels whose box it may be met in, if it is not behind `near`.
static void look_at_other(TileLists lists, uint slot, LaneInt lanes, const PictureBox* box, LaneFloat near,
                          GuessedPixels* p) {
    __global const TriangleRecord* r = &lists.records[slot];
    LaneInt others = may_meet_boxes(r, box, lanes);
    if (!LANES_ANY(others)) return;
    LaneFloat high =
        LANES_MIN(most_in_box(r->plane_x, r->plane_y, r->plane_0, box) + r->margin_plane, (LaneFloat)(r->z_high));
    others &= ~LANE_COMPARE(high, <, near);
    LaneInt id = (LaneInt)((int)lists.bounds[slot].id);
    others &= LANE_COMPARE(p->own, !=, id);
    for (int g = 0; g < GUESSES; ++g) others &= LANE_COMPARE(p->ids[g], !=, id);
    if (LANES_ANY(others)) keep_receiver(id, high, others, p);
}

// The other triangles of the tile's list that may be met in the box, and not behind `near`: the nearest of them.
static void look_for_others(TileLists lists, __constant const Projection* projection, uint tile, LaneInt lanes,
                            const PictureBox* box, LaneFloat near, GuessedPixels* p) {
    float x_units = texel_units(projection->width), y_units = texel_units(projection->height);
    QuantisedBlock block =
        block_of_lanes(LANES_TO_INT(clamp(box->low_x * x_units, 0.0f, 65535.0f)),
                       LANES_TO_INT(clamp(box->low_y * y_units, 0.0f, 65535.0f)),
                       LANES_TO_INT(clamp(box->high_x * x_units, 0.0f, 65535.0f)),
                       LANES_TO_INT(clamp(box->high_y * y_units, 0.0f, 65535.0f)), quantised_nearness(near), lanes);
    uint2 range = lists.ranges[tile];
#if GN_LANES == 1
    for (uint next = range.x; next < range.y;) {
        uint first = next, meeting = next_that_meet(lists.entries, range, &next, block, GN_NO_ID);
        while (meeting != 0u)
            look_at_other(lists, ENTRY_SLOT(&lists.entries[first + take_lowest_bit(&meeting)], 0), lanes, box, near, p);
    }
#else
    uint ahead = entries_to_look_at(lists.entries, lists.records, lists.bounds, range.x, range.y, block);
    for (uint i = range.x; i < range.y; ++i) {
        uint meeting = ahead;
        ahead = entries_to_look_at(lists.entries, lists.records, lists.bounds, i + 1u, range.y, block);
        while (meeting != 0u)
            look_at_other(lists, ENTRY_SLOT(&lists.entries[i], take_lowest_bit(&meeting)), lanes, box, near, p);
    }
#endif
}

#endif
