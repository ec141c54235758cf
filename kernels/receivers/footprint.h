// SPDX-License-Identifier: MIT
// Footprints: boxes around the samples of a pixel that lie on one receiver. A triangle can shadow, or miss, a footprint
// at once.
//
// In the world a footprint is  F = { C + a U + b V + d :  |a|, |b| <= 1,  |d_i| <= spread },  and the samples' shading
// points lie in it. The centres C are laid out like points. An absent centre (NaN) means that there is no sample; an
// infinite spread means that the region could not be bounded. The samples' stage makes them (samples/samples.cl).
//
// In a light's grid the positions (X, Y, Z) that project_points() would give the samples lie in
//     { (X, Y, Z)(C) + a u + b v + d :  |a|, |b| <= 1,  |d_i| <= slack_i }.
// Parallel: the map is linear, u = rows . U, and slack holds |row|_1 spread. Perspective: with g = row_x - X(C) row_z
// and W the height above the point light,
//     X(p) - X(C) = g . (p - C) / W(p),        Z(p) - Z(C) = -Z(C) row_z . (p - C) / W(p),
// and W(p) lies within W(C) (1 +- k), k = (|row_z . U| + |row_z . V| + |row_z|_1 spread) / W(C). So with u = g . U /
// W(C) the rest is at most |u| + |v| times k / (1 - k), and spread's part at most |g|_1 spread / (W(C) (1 - k)).
// Roundings: C and a point are each a point_error (height_error) away from their real positions, and k makes that at
// most twice as much for the differences, so that 4 errors are added. A row differs from the real one by 4u, W by 14u,
// and products, sums and quotients here round fewer than 20 times, so that 64u of the sum of magnitudes is added.
// FOOTPRINT_SLACK covers the roundings of slack itself.
#pragma once

#include "prelude.h"

// Arrays over the footprints beside their centres: the coordinates of U and V, and spread.
#define FOOTPRINT_FLOATS 7

// The visibility of a footprint: 0 if all samples are in shadow, 1 if all are lit, else this.
#define VISIBILITY_MIXED 0.5f

#ifndef __cplusplus

#include "receivers/light_frame.h"

#define FOOTPRINT_SLACK 1.01f
// Is added to each of a row's sizes, and to their sum: more than underflow takes (tests/proofs/footprints.v).
#define FOOTPRINT_NEAR 0x1p-90f
// A footprint that spans at most this number of bins per side lowers the depth of every bin that it touches, so that
// its samples find all their occluders there. (Of Sponza's 2.6 million footprints three span 32 or more.)
#define LISTED_SPAN 64

typedef struct FootprintBlock {
    PointBlock u, v;
    LaneFloat spread;
} FootprintBlock;

static FootprintBlock load_footprints(__global const float* footprints, PointsLayout layout, size_t block) {
    size_t count = layout.coordinate_stride;
    return (FootprintBlock){
        {load_lanes(footprints, layout, block), load_lanes(footprints + count, layout, block),
         load_lanes(footprints + 2 * count, layout, block)},
        {load_lanes(footprints + 3 * count, layout, block), load_lanes(footprints + 4 * count, layout, block),
         load_lanes(footprints + 5 * count, layout, block)},
        load_lanes(footprints + 6 * count, layout, block)};
}

// The reach of a footprint from its centre along each coordinate.
static PointBlock footprint_reach(const FootprintBlock* f) {
    return (PointBlock){fabs(f->u.x) + fabs(f->v.x) + f->spread, fabs(f->u.y) + fabs(f->v.y) + f->spread,
                        fabs(f->u.z) + fabs(f->v.z) + f->spread};
}

// The footprints that lie wholly in one frame: they are bounded and, in perspective, within the pyramid of the centre's
// face by more than roundings.
static LaneInt in_one_frame(LightFrame light_frame, PointBlock centres, const FootprintBlock* f) {
    LaneInt bounded = LANE_COMPARE(f->spread, <, (LaneFloat)(INFINITY));
    if (!IS_PERSPECTIVE(light_frame)) return bounded;
    PointBlock reach = footprint_reach(f);
    LaneFloat x = fabs(centres.x - light_frame.light[0]), y = fabs(centres.y - light_frame.light[1]),
              z = fabs(centres.z - light_frame.light[2]);
    LaneFloat low_x = (x - reach.x) * 0.9999f, low_y = (y - reach.y) * 0.9999f, low_z = (z - reach.z) * 0.9999f;
    LaneFloat high_x = x + reach.x, high_y = y + reach.y, high_z = z + reach.z;
    LaneInt face_x = LANE_COMPARE(low_x, >, high_y) & LANE_COMPARE(low_x, >, high_z);
    LaneInt face_y = LANE_COMPARE(low_y, >, high_x) & LANE_COMPARE(low_y, >, high_z);
    LaneInt face_z = LANE_COMPARE(low_z, >, high_x) & LANE_COMPARE(low_z, >, high_y);
    return bounded & (face_x | face_y | face_z);
}

// A footprint in the grid: centre, half axes, slack, and its whole reach. Lanes that are not `usable` are undefined.
typedef struct GridFootprint {
    PointBlock centre, u, v, slack, reach;
    LaneInt usable;
} GridFootprint;

// One coordinate: `g` as above, `size` at least the magnitudes in it, `scale` 1 / W(C), `stretch` 1 / (1 - k).
static void grid_coordinate(PointBlock g, PointBlock size, LaneFloat scale, LaneFloat stretch, LaneFloat k,
                            const FootprintBlock* f, LaneFloat* u, LaneFloat* v, LaneFloat* slack) {
    size.x += FOOTPRINT_NEAR, size.y += FOOTPRINT_NEAR, size.z += FOOTPRINT_NEAR;
    *u = (g.x * f->u.x + g.y * f->u.y + g.z * f->u.z) * scale;
    *v = (g.x * f->v.x + g.y * f->v.y + g.z * f->v.z) * scale;
    LaneFloat sizes = size.x * (fabs(f->u.x) + fabs(f->v.x)) + size.y * (fabs(f->u.y) + fabs(f->v.y)) +
                      size.z * (fabs(f->u.z) + fabs(f->v.z));
    *slack = FOOTPRINT_SLACK * stretch *
             (scale * ((size.x + size.y + size.z) * f->spread + (64.0f * GN_U) * sizes + FOOTPRINT_NEAR) +
              (fabs(*u) + fabs(*v)) * k);
}

static GridFootprint project_footprint(__constant const Projection* projection, PointBlock centres,
                                       const FootprintBlock* f) {
    __constant const float *row_x = projection->row_x, *row_y = projection->row_y, *row_z = projection->row_z;
    GridFootprint grid;
    grid.centre = project_points(projection, centres);
    LaneFloat x = grid.centre.x, y = grid.centre.y, z = grid.centre.z;
    PointBlock gx = {(LaneFloat)(row_x[0]), (LaneFloat)(row_x[1]), (LaneFloat)(row_x[2])};
    PointBlock gy = {(LaneFloat)(row_y[0]), (LaneFloat)(row_y[1]), (LaneFloat)(row_y[2])};
    PointBlock gz = {(LaneFloat)(row_z[0]), (LaneFloat)(row_z[1]), (LaneFloat)(row_z[2])};
    PointBlock size_x = {fabs(gx.x), fabs(gx.y), fabs(gx.z)}, size_y = {fabs(gy.x), fabs(gy.y), fabs(gy.z)};
    PointBlock size_z = {fabs(gz.x), fabs(gz.y), fabs(gz.z)};
    LaneFloat scale = (LaneFloat)(1.0f), stretch = (LaneFloat)(1.0f), k = (LaneFloat)(0.0f);
    LaneFloat height_error = (LaneFloat)(4.0f * projection->height_error);
    grid.usable = LANE_COMPARE(f->spread, <, (LaneFloat)(INFINITY));
    if (projection->indistinct) grid.usable = (LaneInt)(0);
    if (IS_PERSPECTIVE(*projection)) {
        scale = z;
        LaneFloat w_u = row_z[0] * f->u.x + row_z[1] * f->u.y + row_z[2] * f->u.z;
        LaneFloat w_v = row_z[0] * f->v.x + row_z[1] * f->v.y + row_z[2] * f->v.z;
        k = FOOTPRINT_SLACK * z * (fabs(w_u) + fabs(w_v) + (size_z.x + size_z.y + size_z.z) * f->spread);
        grid.usable &= LANE_COMPARE(k, <, (LaneFloat)(0.5f)) & LANE_COMPARE(z, >, (LaneFloat)(0.0f));
        stretch = (LaneFloat)(1.0f) / ((LaneFloat)(1.0f) - k);
        size_x.x += fabs(x) * size_z.x, size_x.y += fabs(x) * size_z.y, size_x.z += fabs(x) * size_z.z;
        size_y.x += fabs(y) * size_z.x, size_y.y += fabs(y) * size_z.y, size_y.z += fabs(y) * size_z.z;
        gx.x -= x * gz.x, gx.y -= x * gz.y, gx.z -= x * gz.z;
        gy.x -= y * gz.x, gy.y -= y * gz.y, gy.z -= y * gz.z;
        gz.x *= -z, gz.y *= -z, gz.z *= -z;
        size_z.x *= z, size_z.y *= z, size_z.z *= z;
        height_error *= z * stretch;
    }
    grid_coordinate(gx, size_x, scale, stretch, k, f, &grid.u.x, &grid.v.x, &grid.slack.x);
    grid_coordinate(gy, size_y, scale, stretch, k, f, &grid.u.y, &grid.v.y, &grid.slack.y);
    grid_coordinate(gz, size_z, scale, stretch, k, f, &grid.u.z, &grid.v.z, &grid.slack.z);
    // 4u of the grid position for the roundings of centre +- reach.
    grid.slack.x += 4.0f * projection->point_error + (4.0f * GN_U) * fabs(x);
    grid.slack.y += 4.0f * projection->point_error + (4.0f * GN_U) * fabs(y);
    grid.slack.z += height_error + (4.0f * GN_U) * fabs(z);
    grid.reach.x = (fabs(grid.u.x) + fabs(grid.v.x) + grid.slack.x) * FOOTPRINT_SLACK;
    grid.reach.y = (fabs(grid.u.y) + fabs(grid.v.y) + grid.slack.y) * FOOTPRINT_SLACK;
    grid.reach.z = (fabs(grid.u.z) + fabs(grid.v.z) + grid.slack.z) * FOOTPRINT_SLACK;
    LaneFloat out_of_range = (LaneFloat)(1.0e30f);
    grid.usable &= LANE_COMPARE(grid.reach.x, <, out_of_range) & LANE_COMPARE(grid.reach.y, <, out_of_range) &
                   LANE_COMPARE(grid.reach.z, <, out_of_range);
    return grid;
}

// The cells of 2^log2 texels per side that footprints span.
typedef struct CellSpan {
    LaneInt x0, y0, x1, y1;
} CellSpan;

static LaneInt cells_at(LaneFloat coordinate, uint texels, uint log2) {
    return LANES_TO_INT(clamp(coordinate, (LaneFloat)(0.0f), (LaneFloat)((float)texels - 0.5f))) >> (int)log2;
}

static CellSpan footprint_cells(__constant const Projection* projection, const GridFootprint* grid, uint log2) {
    return (CellSpan){cells_at(grid->centre.x - grid->reach.x, projection->width, log2),
                      cells_at(grid->centre.y - grid->reach.y, projection->height, log2),
                      cells_at(grid->centre.x + grid->reach.x, projection->width, log2),
                      cells_at(grid->centre.y + grid->reach.y, projection->height, log2)};
}

static LaneInt spans_below(const CellSpan* span, int cells) {
    LaneInt most = (LaneInt)(cells);
    return LANE_COMPARE(span->x1 - span->x0, <, most) & LANE_COMPARE(span->y1 - span->y0, <, most);
}

#endif
