// SPDX-License-Identifier: MIT
// Contract of a prepared light: what is kept of a light's frames while only the points change.
//
// The light's frames are fitted to the triangles instead of the points, as if the points were at the corners of
// prepared_domains()' boxes. A point within them changes nothing about the fit, so that all bounds hold for it that are
// proven for fitted points (docs/numerics.md, 6, Prepared lights). Any other point is decided without the lists: it is
// lit for certain, or it is a stray, and then the run is done as if nothing were prepared.
#ifndef GN_PREPARED_LIGHT_H
#define GN_PREPARED_LIGHT_H

#include "block_bounds.h"

// Where the points of one frame may be. A point strictly outside the lit bounds by its own error, or strictly nearer to
// the light than `top`, is lit for certain: no triangle can lie between.
GN_STRUCT_BEGIN(PreparedDomain)
    float lit_low[2], lit_high[2];      // grid x and y, as grid_values() says, moved out by the triangles' error
    float world_low[3], world_high[3];  // world x, y, z; in perspective [2]: W, low exclusive, the others unused
    float top;                          // parallel: the greatest height coordinate of a triangle, times sign_z
    uint has_triangles;                 // 0: no triangle can block a point of this frame
GN_STRUCT_END(PreparedDomain, 48)

#ifndef __cplusplus

// How far beyond its real place a grid coordinate may be, for coordinates up to `largest` (the bound of the fit is 4u;
// all uses of this have room for several times as much); and what underflow can add.
#define PREPARED_PADDING (32.0f * GN_U)
#define PREPARED_UNDERFLOW 0x1p-120f

// For the lanes that belong to this frame: which are lit for certain, and for which the fit's bounds hold.
typedef struct PreparedAnswer {
    LaneInt lit, inside;
} PreparedAnswer;

static PreparedAnswer prepared_answer(LightFrame frame, __global const PreparedDomain* domain, PointBlock points) {
    PointBlock values = grid_values(frame, points);
    PreparedAnswer answer;
    LaneFloat margin = 0.0f;
    LaneInt outside = (LaneInt)(domain->has_triangles ? 0 : -1), nearest = (LaneInt)(0);
    if (frame.perspective) {
        // The ratios of a face's points are at most 1 (and 8u), so that the lit bounds can hold their error. Nearer to
        // the lamp than `low` not even the face is certain.
        answer.inside = LANE_COMPARE(values.z, >, (LaneFloat)(domain->world_low[2])) &
                        LANE_COMPARE(values.z, <=, (LaneFloat)(domain->world_high[2]));
    } else {
        LaneFloat world[3] = {points.x, points.y, points.z};
        answer.inside = (LaneInt)(-1);
        for (int i = 0; i < 3; ++i)
            answer.inside &= LANE_COMPARE(world[i], >=, (LaneFloat)(domain->world_low[i])) &
                             LANE_COMPARE(world[i], <=, (LaneFloat)(domain->world_high[i]));
        margin = (fabs(points.x) + fabs(points.y) + fabs(points.z)) * PREPARED_PADDING + PREPARED_UNDERFLOW;
        nearest = LANE_COMPARE(along(points, frame.axis_z) * frame.sign_z, >, (LaneFloat)(domain->top));
    }
    outside |= LANE_COMPARE(values.x - margin, >, (LaneFloat)(domain->lit_high[0])) |
               LANE_COMPARE(values.x + margin, <, (LaneFloat)(domain->lit_low[0])) |
               LANE_COMPARE(values.y - margin, >, (LaneFloat)(domain->lit_high[1])) |
               LANE_COMPARE(values.y + margin, <, (LaneFloat)(domain->lit_low[1]));
    answer.lit = frame.perspective ? answer.inside & outside : outside | nearest;
    return answer;
}

// Of the open lanes: those that stay open, and those that are strays. The others are lit.
static LaneInt prepared_lanes(LightFrame light_frame, __global const PreparedDomain* domains, PointBlock points,
                              LaneInt lanes, LaneInt* strays) {
    LaneInt frames = frames_of(light_frame, points), open = (LaneInt)(0);
    *strays = (LaneInt)(0);
    while (LANES_ANY(lanes)) {
        int frame = LANE_OF_INT(frames, first_lane(lanes));
        LaneInt same = lanes & LANE_COMPARE(frames, ==, (LaneInt)(frame));
        lanes &= ~same;
        PreparedAnswer answer = prepared_answer(face_of(light_frame, (uint)frame), &domains[frame], points);
        open |= same & answer.inside & ~answer.lit;
        *strays |= same & ~answer.inside & ~answer.lit;
    }
    return open;
}

// Whether that is so of all open points of a direction's frame, by its bounds: all are within the world's bounds and
// the lit ones, so that prepared_lanes() would leave them open (or say that they are lit, which a trace comes to as
// well).
static bool points_stay_open(__global const PreparedDomain* domain, __global const PointBounds* bounds) {
    bool inside = true;
    for (int i = 0; i < 5; ++i) {
        float low = i < 2 ? domain->lit_low[i] : domain->world_low[i - 2];
        float high = i < 2 ? domain->lit_high[i] : domain->world_high[i - 2];
        inside = inside && -key_to_float(bounds->minus_lowest[i]) >= low && key_to_float(bounds->highest[i]) <= high;
    }
    return inside;
}

// The same of a block.
static bool block_stays_open(LightFrame frame, __global const PreparedDomain* domain,
                             __global const BlockBounds* block) {
    float z_low = block->height, z_high = -block->minus_height;
    if (frame.sign_z < 0.0f) {
        z_low = block->minus_height;
        z_high = -block->height;
    }
    float low[2] = {block->x, block->y}, high[2] = {-block->minus_x, -block->minus_y};
    float shear[2] = {frame.shear_x, frame.shear_y};
    uint axes[2] = {frame.axis_x, frame.axis_y};
    bool inside = z_low >= domain->world_low[frame.axis_z] && z_high <= domain->world_high[frame.axis_z];
    for (int i = 0; i < 2; ++i) {
        float world_low, world_high;
        world_bounds(low[i], high[i], shear[i], z_low, z_high, &world_low, &world_high);
        inside = inside && low[i] >= domain->lit_low[i] && high[i] <= domain->lit_high[i] &&
                 world_low >= domain->world_low[axes[i]] && world_high <= domain->world_high[axes[i]];
    }
    return inside;
}

#endif
#endif
