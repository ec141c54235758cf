// SPDX-License-Identifier: MIT
// TriangleRecords of GN_LANES triangles at a time: a member in one vector each, in the order of TriangleRecord, so that
// records and block are one matrix and its transposed.
#ifndef GN_RECORD_BLOCKS_H
#define GN_RECORD_BLOCKS_H

#include "lanes.h"
#include "triangle_setup.h"

typedef struct RecordBlock {
    LaneFloat edge_x[3];
    LaneFloat margin_edge;
    LaneFloat edge_y[3];
    LaneFloat margin_plane;
    LaneFloat edge_0[3];
    LaneFloat z_low;
    LaneFloat plane_x, plane_y, plane_0;
    LaneFloat z_high;
} RecordBlock;
typedef char RecordBlock_has_size[sizeof(RecordBlock) == GN_LANES * sizeof(TriangleRecord) ? 1 : -1];

// Every test of these is uncertain.
static void set_undecided(RecordBlock* record, LaneInt lanes) {
    const LaneFloat zero = (LaneFloat)(0.0f), infinite = (LaneFloat)(INFINITY);
    for (int i = 0; i < 3; ++i) {
        record->edge_x[i] = LANES_SELECT(record->edge_x[i], zero, lanes);
        record->edge_y[i] = LANES_SELECT(record->edge_y[i], zero, lanes);
        record->edge_0[i] = LANES_SELECT(record->edge_0[i], zero, lanes);
    }
    record->plane_x = LANES_SELECT(record->plane_x, zero, lanes);
    record->plane_y = LANES_SELECT(record->plane_y, zero, lanes);
    record->plane_0 = LANES_SELECT(record->plane_0, zero, lanes);
    record->margin_edge = LANES_SELECT(record->margin_edge, infinite, lanes);
    record->margin_plane = LANES_SELECT(record->margin_plane, infinite, lanes);
    record->z_low = LANES_SELECT(record->z_low, -infinite, lanes);
    record->z_high = LANES_SELECT(record->z_high, infinite, lanes);
}

#if GN_LANES == 1
static void store_records(const RecordBlock* block, LaneInt lanes, const uint* slots, __global TriangleRecord* to) {
    if (lanes) to[slots[0]] = *(const TriangleRecord*)block;
}
#else
#define RECORD_MEMBERS (sizeof(TriangleRecord) / sizeof(float))

// One record in all lanes.
static void spread_record(__global const TriangleRecord* record, RecordBlock* block) {
    __global const float* from = (__global const float*)record;
    for (uint i = 0; i < RECORD_MEMBERS; ++i) ((LaneFloat*)block)[i] = (LaneFloat)(from[i]);
}
static void spread_lane(const RecordBlock* records, uint lane, RecordBlock* block) {
    const float* from = (const float*)records + lane;
    for (uint i = 0; i < RECORD_MEMBERS; ++i) ((LaneFloat*)block)[i] = (LaneFloat)(from[i * GN_LANES]);
}

// Member `first` to first + 3 of lanes `lane` to lane + 3, as four floats of each lane.
static void transpose_four(const RecordBlock* block, uint first, uint lane, float4* rows) {
    const float* from = (const float*)block + first * GN_LANES + lane;
    float4 a = vload4(0, from), b = vload4(0, from + GN_LANES);
    float4 c = vload4(0, from + 2 * GN_LANES), d = vload4(0, from + 3 * GN_LANES);
    float4 ab_low = (float4)(a.x, b.x, a.y, b.y), ab_high = (float4)(a.z, b.z, a.w, b.w);
    float4 cd_low = (float4)(c.x, d.x, c.y, d.y), cd_high = (float4)(c.z, d.z, c.w, d.w);
    rows[0] = (float4)(ab_low.lo, cd_low.lo), rows[1] = (float4)(ab_low.hi, cd_low.hi);
    rows[2] = (float4)(ab_high.lo, cd_high.lo), rows[3] = (float4)(ab_high.hi, cd_high.hi);
}

// Those of `lanes` to their slots.
static void store_records(const RecordBlock* block, LaneInt lanes, const uint* slots, __global TriangleRecord* to) {
    for (uint lane = 0; lane < GN_LANES; lane += 4u) {
        float4 parts[4][4];
        for (uint part = 0; part < 4u; ++part) transpose_four(block, 4u * part, lane, parts[part]);
        for (uint k = 0; k < 4u; ++k) {
            if (!LANE_OF_INT(lanes, lane + k)) continue;
            __global float4* record = (__global float4*)&to[slots[lane + k]];
            for (uint part = 0; part < 4u; ++part) record[part] = parts[part][k];
        }
    }
}
#endif

#endif
