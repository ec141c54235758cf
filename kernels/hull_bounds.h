// SPDX-License-Identifier: MIT
// What the convex hull of some projected vertices can cover of a grid, and how near to the light it reaches, for
// GN_LANES hulls at a time: a triangle is the hull of three vertices, a cluster's box of eight.
//
// The bound of a grid coordinate. X <= x holds wherever W > 0 if h_x - x W <= 0 at all vertices, since the left side is
// linear and so at most what it is at one of them. In front of the light (or eye) a vertex asks for x >= X, behind for
// x <= X, near W = 0 for h_x <= 0 whatever x of the grid. So the bound is the largest X in front, if those behind and
// near agree with it, else there is none; the lower bound likewise. Heights: Z is linear, or 1 / W with W linear, so a
// hull wholly in front reaches no higher than its highest vertex.
//
// Errors: each vertex is moved out by the bound of its hull's projection (triangle_blocks.h) and of the division, so
// the bounds hold for the hull of the real vertices; a point's own error is added at the end.
#ifndef GN_HULL_BOUNDS_H
#define GN_HULL_BOUNDS_H

#include "bin_test.h"
#include "light_frame.h"
#include "triangle_blocks.h"

// For bounds that are computed in float with all terms positive: covers the roundings of that computation (fewer than
// 100, each under 2^-23) many times over.
#define BOUND_INFLATION 1.01f
// Beyond this (texels) a projected vertex no longer says anything useful.
#define WILD_TEXELS 1.0e12f

// Where hulls lie, seen from the light.
typedef struct HullSides {
    LaneInt wild;       // too far for floats: nothing else is known
    LaneInt behind;     // the light: wholly
    LaneInt straddles;  // not wholly in front of the light for certain
} HullSides;

static HullSides sides_of_hulls(const Projected* v, int count, __constant const Projection* projection) {
    HullSides sides = {(LaneInt)(0), (LaneInt)(0), (LaneInt)(0)};
    LaneInt largest = (LaneInt)(0);  // NaN and infinity are larger than anything
    for (int i = 0; i < count; ++i) {
        LaneInt position = max(LANES_SIZE_BITS(v[i].x), LANES_SIZE_BITS(v[i].y));
        largest = max(largest, max(position, max(LANES_SIZE_BITS(v[i].w), LANES_SIZE_BITS(v[i].error))));
    }
    sides.wild = LANE_COMPARE(largest, >=, LANES_AS_INT((LaneFloat)(WILD_TEXELS)));
    if (!IS_PERSPECTIVE(*projection)) return sides;
    sides.behind = (LaneInt)(-1);
    for (int i = 0; i < count; ++i) {
        sides.behind &= LANE_COMPARE(v[i].w, <, -v[i].error_w);
        sides.straddles |= ~LANE_COMPARE(v[i].w, >, v[i].error_w * 2.0f);
    }
    return sides;
}

// ---- Rectangles -----------------------------------------------------------------------------------------------------

// Texel rectangles.
typedef struct Rectangles {
    LaneFloat x0, y0, x1, y1;
} Rectangles;

// One grid coordinate of the vertices so far.
typedef struct Interval {
    LaneFloat low, high;                // of the vertices in front
    LaneFloat behind_low, behind_high;  // of those behind
    LaneInt has_low, has_high;          // no vertex near W = 0 speaks against the bound
} Interval;

static Interval empty_interval(void) {
    Interval interval;
    interval.low = interval.behind_low = (LaneFloat)(INFINITY);
    interval.high = interval.behind_high = (LaneFloat)(-INFINITY);
    interval.has_low = interval.has_high = (LaneInt)(-1);
    return interval;
}

// h is the vertex's coordinate before the division, w and its error as in Projected, reach the largest coordinate.
static void include_vertex(Interval* interval, LaneFloat h, LaneFloat error, LaneFloat w, LaneFloat error_w,
                           float reach) {
    LaneInt far = LANE_COMPARE(fabs(w), >, error_w * 2.0f);
    if (LANES_ANY(far)) {
        // The quotient is off by at most (error + |x| error_w) / (|w| - error_w), the division by at most 3 ulp.
        LaneFloat x = h / w, size = fabs(x);
        LaneFloat slack = ((error + size * error_w) / (fabs(w) - error_w) + size * (8.0f * GN_U)) * BOUND_INFLATION;
        LaneFloat least = x - slack, most = x + slack;
        // An infinite quotient says nothing, and its NaN difference to the slack would be passed over.
        LaneInt known = ~far | LANE_COMPARE(slack, <, (LaneFloat)(INFINITY));
        interval->has_low &= known;
        interval->has_high &= known;
        LaneInt front = far & LANE_COMPARE(w, >, (LaneFloat)(0.0f)), behind = far & ~front;
        interval->low = LANES_SELECT(interval->low, LANES_MIN(least, interval->low), front);
        interval->high = LANES_SELECT(interval->high, LANES_MAX(most, interval->high), front);
        interval->behind_low = LANES_SELECT(interval->behind_low, LANES_MIN(least, interval->behind_low), behind);
        interval->behind_high = LANES_SELECT(interval->behind_high, LANES_MAX(most, interval->behind_high), behind);
    }
    LaneInt near = ~far;
    if (LANES_ANY(near)) {
        LaneFloat slack = (error + (fabs(w) + error_w) * reach) * BOUND_INFLATION;
        interval->has_high &= far | LANE_COMPARE(h + slack, <=, (LaneFloat)(0.0f));
        interval->has_low &= far | LANE_COMPARE(h - slack, >=, (LaneFloat)(0.0f));
    }
}

// The bounds within [-1, last + 1] (a bound outside the grid is as good as any farther one, and serves where no vertex
// is in front), a point's error added.
static void bounds_of(const Interval* interval, float point_error, float last, LaneFloat* bound_low,
                      LaneFloat* bound_high) {
    LaneFloat low = LANES_MIN(interval->low, (LaneFloat)(last + 1.0f));
    LaneFloat high = LANES_MAX(interval->high, (LaneFloat)(-1.0f));
    LaneInt has_low = interval->has_low & LANE_COMPARE(low, >=, interval->behind_high);
    LaneInt has_high = interval->has_high & LANE_COMPARE(high, <=, interval->behind_low);
    *bound_low = LANES_SELECT((LaneFloat)(0.0f), low - point_error, has_low);
    *bound_high = LANES_SELECT((LaneFloat)(last), high + point_error, has_high);
}

// The same where W is 1, of coordinates from low to high: as far out as any of them, since rounding is monotone.
static void widen_parallel(LaneFloat* low, LaneFloat* high, LaneFloat error) {
    LaneFloat size_low = fabs(*low), size_high = fabs(*high), size = LANES_MAX(size_low, size_high);
    LaneFloat slack = (error + size * (8.0f * GN_U)) * BOUND_INFLATION;
    *low -= slack, *high += slack;
}

// Texel rectangles that hold everything the hulls can cover of the grid; returns those that can cover any of it.
GN_WITHIN LaneInt covered_rectangles(const Projected* v, int count, __constant const Projection* projection,
                                     Rectangles* rectangle) {
    float width = (float)projection->width, height = (float)projection->height;
    Rectangles r;
    if (IS_PERSPECTIVE(*projection)) {
        Interval x = empty_interval(), y = empty_interval();
        for (int i = 0; i < count; ++i) {
            include_vertex(&x, v[i].x, v[i].error, v[i].w, v[i].error_w, width + 1.0f);
            include_vertex(&y, v[i].y, v[i].error, v[i].w, v[i].error_w, height + 1.0f);
        }
        bounds_of(&x, projection->point_error, width, &r.x0, &r.x1);
        bounds_of(&y, projection->point_error, height, &r.y0, &r.y1);
    } else {
        r.x0 = r.x1 = v[0].x;
        r.y0 = r.y1 = v[0].y;
        for (int i = 1; i < count; ++i) {
            r.x0 = LANES_MIN(v[i].x, r.x0), r.x1 = LANES_MAX(v[i].x, r.x1);
            r.y0 = LANES_MIN(v[i].y, r.y0), r.y1 = LANES_MAX(v[i].y, r.y1);
        }
        widen_parallel(&r.x0, &r.x1, v[0].error);  // the same for all (project_hulls)
        widen_parallel(&r.y0, &r.y1, v[0].error);
        r.x0 -= projection->point_error, r.x1 += projection->point_error;
        r.y0 -= projection->point_error, r.y1 += projection->point_error;
    }
    const LaneFloat zero = (LaneFloat)(0.0f), last_x = (LaneFloat)(width), last_y = (LaneFloat)(height);
    rectangle->x0 = LANES_MAX(r.x0, zero);
    rectangle->y0 = LANES_MAX(r.y0, zero);
    rectangle->x1 = LANES_MIN(r.x1, last_x);
    rectangle->y1 = LANES_MIN(r.y1, last_y);
    // A difference of unlike floats is not 0, and keeps its sign when it is rounded.
    LaneFloat beyond_x = r.x0 - last_x, beyond_y = r.y0 - last_y;
    return LANE_COMPARE(LANES_MIN(r.x1, r.y1), >=, zero) & LANE_COMPARE(LANES_MAX(beyond_x, beyond_y), <, zero);
}

// ---- Heights --------------------------------------------------------------------------------------------------------

// The vertices' least and greatest height, moved out by their errors and the points'.
static void height_intervals(const Projected* v, int count, LaneInt straddles, __constant const Projection* projection,
                             LaneFloat* z_low, LaneFloat* z_high) {
    LaneFloat low = (LaneFloat)(INFINITY), high = (LaneFloat)(-INFINITY);
    for (int i = 0; i < count; ++i) {
        LaneFloat slack = v[i].error_z;
        // In perspective Z = 1 / W with W off by error_w and the division by 2.5 ulp, 5u.
        if (IS_PERSPECTIVE(*projection))
            slack = v[i].z * (v[i].error_w / (v[i].w - v[i].error_w) + 6.0f * GN_U) * BOUND_INFLATION;
        LaneFloat least = v[i].z - slack, most = v[i].z + slack;
        low = LANES_MIN(least, low);
        high = LANES_MAX(most, high);
    }
    // The points' own error: absolute (parallel), or relative to Z (perspective).
    float height_error = BOUND_INFLATION * projection->height_error;
    low -= IS_PERSPECTIVE(*projection) ? fabs(low) * height_error : (LaneFloat)(height_error);
    high += IS_PERSPECTIVE(*projection) ? fabs(high) * height_error : (LaneFloat)(height_error);
    *z_low = LANES_SELECT(low, (LaneFloat)(-INFINITY), straddles);
    *z_high = LANES_SELECT(high, (LaneFloat)(INFINITY), straddles);
}

// Which of these hulls are farther from the light than every point under their rectangles?
static LaneInt lanes_hidden(Rectangles rectangle, LaneFloat z_high, LaneInt lanes,
                            __constant const Projection* projection, __global const uint* pyramid) {
    BinRectangles bins = {texel_indices(rectangle.x0, projection->width) >> (int)projection->bin_log2,
                          texel_indices(rectangle.y0, projection->height) >> (int)projection->bin_log2,
                          texel_indices(rectangle.x1, projection->width) >> (int)projection->bin_log2,
                          texel_indices(rectangle.y1, projection->height) >> (int)projection->bin_log2};
    return lanes & LANE_COMPARE(z_high, <, lanes_lowest_height_under(pyramid, projection, bins));
}

#endif
