// SPDX-License-Identifier: MIT
// Contract of a prepared light: the data of a light's frames that stay valid while only the points change.
//
// The light's frames are fitted to the triangles instead of the points, as if the points were at the corners of
// prepared_domains()' boxes. A point within the boxes does not change the fit, so that all bounds proven for fitted
// points are valid for it (docs/numerics.md, 6, Prepared lights). Any other point is decided without the lists: it is
// certainly lit, or it is a fallback point, and then the run is done as if no light were prepared.
//
// All tables lie in one buffer, each aligned to 16 bytes: the ranges of the bins of all frames first, then the tables
// of PreparedTables (trace/trace.h).
#pragma once

#include "receivers/block_bounds.h"
#include "trace/trace.h"

// The domain of one frame's points. A point strictly outside the lit bounds by its own error, or strictly nearer to the
// light than `top`, is certainly lit: no triangle can lie between.
GN_STRUCT_BEGIN(PreparedDomain)
    float lit_low[2], lit_high[2];      // grid x and y, as grid_values() has them, moved out by the triangles' error
    float world_low[3], world_high[3];  // world x, y, z; in perspective [2]: W, low exclusive, the others unused
    float top;                          // parallel: the greatest height coordinate of a triangle, times sign_z
    uint has_triangles;                 // 0: no triangle can block a point of this frame
GN_STRUCT_END(PreparedDomain, 48)

GN_STRUCT_BEGIN(PreparedParams)
    TrianglesLayout triangles;
    LightFrame light_frame;
    PreparedTables tables;
    uint record_count;  // unshadowed_triangles: kept records of all frames
    uint sample_step;   // unshadowed_triangles: kept records per tested record
    uint padding;
GN_STRUCT_END(PreparedParams, 112)

// One frame's lists, to be copied behind those of the frames before.
GN_STRUCT_BEGIN(KeptFrame)
    PreparedTables tables;
    uint entry_count, slot_count, bin_count;  // of the frame's own lists
    uint record_count;                        // records that an entry names; by_id: triangles
    uint first_entry, first_record, first_bin;
    uint by_id;  // 1, on a CPU under a direction: a record's kept slot is its triangle's id
GN_STRUCT_END(KeptFrame, 52)

#ifndef __cplusplus

static __global const float4* prepared_table(__global const uint2* ranges, uint offset) {
    return (__global const float4*)ranges + offset;
}
static __global const PreparedDomain* prepared_domains_of(PreparedTables tables, __global const uint2* ranges) {
    return (__global const PreparedDomain*)prepared_table(ranges, tables.domains);
}

// The error of a grid coordinate, in parts of the largest coordinate (the bound of the fit is 4u; all uses of this have
// room for several times as much), and what underflow can add.
#define PREPARED_PADDING (32.0f * GN_U)
#define PREPARED_UNDERFLOW 0x1p-120f

// By how much the grid coordinates of triangles up to `largest`, and of points, are moved
// (tests/proofs/prepared_boxes.v).
static float prepared_padding(float largest) { return PREPARED_PADDING * largest + PREPARED_UNDERFLOW; }
static LaneFloat prepared_margin(PointBlock points) {
    return (fabs(points.x) + fabs(points.y) + fabs(points.z)) * PREPARED_PADDING + PREPARED_UNDERFLOW;
}

// For the lanes in this frame: the lanes that are certainly lit, and the lanes for which the fit's bounds are valid.
typedef struct PreparedAnswer {
    LaneInt lit, inside;
} PreparedAnswer;

static PreparedAnswer prepared_answer(LightFrame frame, __global const PreparedDomain* domain, PointBlock points) {
    PointBlock values = grid_values(frame, points);
    PreparedAnswer answer;
    LaneFloat margin = 0.0f;
    LaneInt outside = (LaneInt)(domain->has_triangles ? 0 : -1), nearest = (LaneInt)(0);
    if (IS_PERSPECTIVE(frame)) {
        // The ratios of a face's points are at most 1 (and 8u), so that the lit bounds can include their error. Nearer
        // to the point light than `low` even the face is uncertain.
        answer.inside = LANE_COMPARE(values.z, >, (LaneFloat)(domain->world_low[2])) &
                        LANE_COMPARE(values.z, <=, (LaneFloat)(domain->world_high[2]));
    } else {
        LaneFloat world[3] = {points.x, points.y, points.z};
        answer.inside = (LaneInt)(-1);
        for (int i = 0; i < 3; ++i)
            answer.inside &= LANE_COMPARE(world[i], >=, (LaneFloat)(domain->world_low[i])) &
                             LANE_COMPARE(world[i], <=, (LaneFloat)(domain->world_high[i]));
        margin = prepared_margin(points);
        nearest = LANE_COMPARE(along(points, frame.axis_z) * frame.sign_z, >, (LaneFloat)(domain->top));
    }
    outside |= LANE_COMPARE(values.x - margin, >, (LaneFloat)(domain->lit_high[0])) |
               LANE_COMPARE(values.x + margin, <, (LaneFloat)(domain->lit_low[0])) |
               LANE_COMPARE(values.y - margin, >, (LaneFloat)(domain->lit_high[1])) |
               LANE_COMPARE(values.y + margin, <, (LaneFloat)(domain->lit_low[1]));
    answer.lit = IS_PERSPECTIVE(frame) ? answer.inside & outside : outside | nearest;
    return answer;
}

// Returns the lanes that stay open, and sets the lanes that are fallback points. The others are lit.
static LaneInt prepared_lanes(LightFrame light_frame, __global const PreparedDomain* domains, PointBlock points,
                              LaneInt lanes, LaneInt* fallback_points) {
    LaneInt frames = frames_of(light_frame, points), open = (LaneInt)(0);
    *fallback_points = (LaneInt)(0);
    while (LANES_ANY(lanes)) {
        int frame = LANE_OF_INT(frames, first_lane(lanes));
        LaneInt same = lanes & LANE_COMPARE(frames, ==, (LaneInt)(frame));
        lanes &= ~same;
        PreparedAnswer answer = prepared_answer(face_of(light_frame, (uint)frame), &domains[frame], points);
        open |= same & answer.inside & ~answer.lit;
        *fallback_points |= same & ~answer.inside & ~answer.lit;
    }
    return open;
}

static LaneInt lanes_between(LaneFloat v, float low, float high) {
    return LANE_COMPARE(v, >=, (LaneFloat)(low)) & LANE_COMPARE(v, <=, (LaneFloat)(high));
}

// For a directional light's frame, with world coordinates in the order of its axes.
static PreparedDomain domain_in_order(__global const PreparedDomain* domain, LightFrame frame) {
    PreparedDomain ordered = *domain;
    const uint axes[3] = {frame.axis_x, frame.axis_y, frame.axis_z};
    for (int i = 0; i < 3; ++i) {
        ordered.world_low[i] = domain->world_low[axes[i]];
        ordered.world_high[i] = domain->world_high[axes[i]];
    }
    return ordered;
}

// The points of a directional light's frame that are within both the world's bounds and the lit bounds, so that
// prepared_lanes() would leave them open (or find them lit; a trace finds that as well). `points` and `domain` are in
// the order of the frame's axes, `values` are the points' grid values.
static LaneInt lanes_stay_open(const PreparedDomain* domain, PointBlock points, PointBlock values) {
    return lanes_between(values.x, domain->lit_low[0], domain->lit_high[0]) &
           lanes_between(values.y, domain->lit_low[1], domain->lit_high[1]) &
           lanes_between(points.x, domain->world_low[0], domain->world_high[0]) &
           lanes_between(points.y, domain->world_low[1], domain->world_high[1]) &
           lanes_between(points.z, domain->world_low[2], domain->world_high[2]);
}

static bool is_between(float low, float high, float least, float greatest) {
    return (low >= least) & (high <= greatest);
}

// True only if that is true for all points within a block's bounds. All comparisons are done at once: the outcome is
// nearly always the same, and one jump is cheaper than one for each.
static bool block_stays_open(const PreparedDomain* domain, LightFrame frame, const BlockBounds* block) {
    float z_low = frame.sign_z < 0.0f ? block->minus_height : block->height;
    float z_high = frame.sign_z < 0.0f ? -block->height : -block->minus_height;
    float x_low, x_high, y_low, y_high;
    world_bounds(block->x, -block->minus_x, frame.shear_x, z_low, z_high, &x_low, &x_high);
    world_bounds(block->y, -block->minus_y, frame.shear_y, z_low, z_high, &y_low, &y_high);
    return is_between(block->x, -block->minus_x, domain->lit_low[0], domain->lit_high[0]) &
           is_between(block->y, -block->minus_y, domain->lit_low[1], domain->lit_high[1]) &
           is_between(x_low, x_high, domain->world_low[0], domain->world_high[0]) &
           is_between(y_low, y_high, domain->world_low[1], domain->world_high[1]) &
           is_between(z_low, z_high, domain->world_low[2], domain->world_high[2]);
}

#endif
