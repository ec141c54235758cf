// SPDX-License-Identifier: MIT
// Prepared light: fits a light's frames to the triangles, and keeps the parts of the stages' lists that a trace needs.
//
// Proof that a point outside the triangles' bounds is lit. Parallel: the raw grid coordinates of light_frame.h are off
// by at most 4u M (M the largest world coordinate) and the underflow, for vertices and points alike; a triangle's
// coordinates lie between its vertices'. The bounds are moved out by PREPARED_PADDING M of the vertices, and a point
// counts as outside by PREPARED_PADDING times the sum of its own coordinates. If a point's coordinate along the light's
// axis is greater than every vertex's, all triangles are on the far side: that is exact. Perspective: a face's
// triangles are those with a vertex at W > 0. If all vertices have W > 0 the triangle's ratios lie between theirs (off
// by 8u), else they may be any; a face has only points with ratios up to 1. A triangle with W < 0 at all vertices lies
// behind. W of a point is greater than 0 once it is above SMALLEST_W, far above what underflow could make of any other.
#include "occluders/bin_lists.h"
#include "occluders/triangle_setup.h"
#include "prepared/prepared_facing.clh"

// ---- Bounds of the triangles ----------------------------------------------------------------------------------------

static void include_value(FittedBounds* bounds, int i, float low, float high) {
    bounds->low[i] = fmin(bounds->low[i], low);
    bounds->high[i] = fmax(bounds->high[i], high);
}

static void include_parallel(FittedBounds* bounds, LightFrame frame, const float3* vertices) {
    for (int i = 0; i < 3; ++i) {
        float3 v = vertices[i];
        float x = coordinate_of(v, frame.axis_x), y = coordinate_of(v, frame.axis_y);
        float z = coordinate_of(v, frame.axis_z);
        const float values[BOUNDED_VALUES] = {x - frame.shear_x * z, y - frame.shear_y * z, v.x, v.y, v.z};
        for (int k = 0; k < BOUNDED_VALUES; ++k) include_value(bounds, k, values[k], values[k]);
    }
    ++bounds->count;
}

// A triangle that lies outside one of the face's sides by this blocks no point of the face.
#define FACE_SIDE (1.0f + 64.0f * GN_U)

static void include_perspective(FittedBounds* bounds, LightFrame frame, const float3* vertices) {
    bool behind = true, in_front = true;
    float3 low = (float3)(INFINITY), high = (float3)(-INFINITY);  // of x / W, y / W and W
    for (int i = 0; i < 3; ++i) {
        float3 d = vertices[i] - light_of(frame).xyz;
        float w = coordinate_of(d, frame.axis_z) * frame.sign_z;
        float3 at = (float3)(coordinate_of(d, frame.axis_x) / w, coordinate_of(d, frame.axis_y) / w, w);
        behind = behind && w < 0.0f;
        in_front = in_front && w > SMALLEST_W && GN_FINITE(at.x) && GN_FINITE(at.y);
        low = fmin(low, at), high = fmax(high, at);
    }
    if (behind || (in_front && (fmax(low.x, low.y) > FACE_SIDE || fmin(high.x, high.y) < -FACE_SIDE))) return;
    if (!in_front) low.xy = (float2)(-1.0f), high.xy = (float2)(1.0f);
    include_value(bounds, 0, fmax(low.x, -1.0f), fmin(high.x, 1.0f));
    include_value(bounds, 1, fmax(low.y, -1.0f), fmin(high.y, 1.0f));
    include_value(bounds, 4, fmax(low.z, SMALLEST_W), fmax(high.z, SMALLEST_W));
    ++bounds->count;
}

static void raise_bound(volatile __global uint* highest, float value) {
    uint key = float_to_key(value);
    if (key > GN_RELAXED_LOAD(highest)) atomic_max(highest, key);
}

// The bounds are zeroed before.
__kernel void prepared_bounds(const PreparedParams params, __global const float* vertices,
                              volatile __global uint* frame_bounds) {
    for (uint face = 0; face < frame_count_of(params.light_frame); ++face) {
        LightFrame frame = face_of(params.light_frame, face);
        FittedBounds bounds;
        bounds.count = 0;
        for (int i = 0; i < BOUNDED_VALUES; ++i) bounds.low[i] = INFINITY, bounds.high[i] = -INFINITY;
        GN_FOR_EACH(i, params.triangles.count) {
            Triangle t = load_triangle(vertices + params.triangles.first_float, i);
            if (!is_finite_triangle(t)) continue;
            float3 corners[3] = {t.a, t.b, t.c};
            if (frame.perspective)
                include_perspective(&bounds, frame, corners);
            else
                include_parallel(&bounds, frame, corners);
        }
        if (bounds.count == 0) continue;
        volatile __global uint* words = frame_bounds + face * BOUNDS_WORDS;
        for (int i = 0; i < BOUNDED_VALUES; ++i) {
            raise_bound(&words[i], bounds.high[i]);
            raise_bound(&words[BOUNDED_VALUES + i], -bounds.low[i]);
        }
        atomic_add(&words[2 * BOUNDED_VALUES], bounds.count);
    }
}

// ---- Domains --------------------------------------------------------------------------------------------------------

// How far beyond the triangles points may lie, in parts of the largest extent; and how much farther from a point light.
// A larger first value costs precision, a larger second value does not.
#define ROOM_AROUND 0.25f
#define ROOM_BEYOND 1024.0f
// Beyond this many times the least height the lists' 16 bits do not separate a point light's heights, 1 / W.
#define HEIGHT_RANGE 0x1p16f

static void make_parallel(LightFrame frame, const float* low, const float* high, __global PointBounds* bounds,
                          PreparedDomain* domain) {
    float largest = 0.0f, extent = 0.0f;
    for (int i = 2; i < 5; ++i) {
        largest = fmax(largest, fmax(fabs(low[i]), fabs(high[i])));
        extent = fmax(extent, high[i] - low[i]);
    }
    float room = ROOM_AROUND * extent + 2.0f * PREPARED_PADDING * largest + PREPARED_UNDERFLOW;
    for (int i = 0; i < 3; ++i) {
        domain->world_low[i] = low[2 + i] - room;
        domain->world_high[i] = high[2 + i] + room;
        set_bound(bounds, 2 + i, domain->world_low[i], domain->world_high[i]);
    }
    domain->top = frame.sign_z > 0.0f ? high[2 + frame.axis_z] : -low[2 + frame.axis_z];
    // A point of this box that is not lit lies at most its margin, three times the padding, beyond the lit bounds.
    float beyond = 4.0f * PREPARED_PADDING * (largest + room) + 4.0f * PREPARED_UNDERFLOW;
    for (int i = 0; i < 2; ++i) {
        domain->lit_low[i] = low[i] - prepared_padding(largest);
        domain->lit_high[i] = high[i] + prepared_padding(largest);
        set_bound(bounds, i, domain->lit_low[i] - beyond, domain->lit_high[i] + beyond);
    }
}

static void make_perspective(const float* low, const float* high, __global PointBounds* bounds,
                             PreparedDomain* domain) {
    // If even the triangles reach beyond LARGEST_EXTENT the fit finds the frame indistinct.
    float farthest = fmax(high[4], fmin(ROOM_BEYOND * high[4], 0.5f * LARGEST_EXTENT));
    domain->world_low[2] = SMALLEST_W / unit_of_farthest(farthest);
    domain->world_high[2] = farthest;
    set_bound(bounds, 4, fmax(low[4], fmax(high[4] / HEIGHT_RANGE, 2.0f * domain->world_low[2])), farthest);
    for (int i = 0; i < 2; ++i) {
        domain->lit_low[i] = low[i] - PREPARED_PADDING;
        domain->lit_high[i] = high[i] + PREPARED_PADDING;
        set_bound(bounds, i, domain->lit_low[i], domain->lit_high[i]);
    }
}

// Turns the triangles' bounds of each frame into its domain, and into the bounds that the light frame is fitted to.
__kernel void prepared_domains(const PreparedParams params, __global PointBounds* frame_bounds,
                               __global float4* tables) {
    LightFrame light_frame = params.light_frame;
    __global PreparedDomain* domains = (__global PreparedDomain*)(tables + params.tables.domains);
    GN_FOR_EACH(face, frame_count_of(light_frame)) {
        __global PointBounds* bounds = &frame_bounds[face];
        FittedBounds of = read_bounds(bounds);
        PreparedDomain domain = {{0.0f}};  // every member is 0
        domain.top = INFINITY;
        domain.has_triangles = bounds->count != 0u;
        if (!domain.has_triangles) {
            domain.world_low[2] = SMALLEST_W;
            domain.world_high[2] = FLT_MAX;
        } else if (light_frame.perspective) {
            make_perspective(of.low, of.high, bounds, &domain);
        } else {
            make_parallel(light_frame, of.low, of.high, bounds, &domain);
        }
        domains[face] = domain;
    }
}

// ---- Lists ----------------------------------------------------------------------------------------------------------

static bool is_used(__global const BinEntries* entries, uint lane) {
    __global BinEntries* at = (__global BinEntries*)entries;
    return ENTRY_LANE(at, x0, lane) <= ENTRY_LANE(at, x1, lane);
}

// Gives each record that a list names its kept slot: its triangle's id, so that a walk needs no bounds to know it; or
// from first_record on, in about the order of the lists, so that records that are read together are neighbours.
// kept_slots[slot] is GN_NO_ID before.
__kernel void prepared_kept_slots(const KeptFrame frame, __global const BinEntries* entries,
                                  __global const TriangleBounds* bounds, __global uint* kept_slots,
                                  __global uint* kept_count) {
    GN_FOR_EACH(i, frame.entry_count) {
        for (uint lane = 0; lane < GN_LANES; ++lane) {
            if (!is_used(&entries[i], lane)) continue;
            uint slot = ENTRY_SLOT(&entries[i], lane);
            if (frame.by_id)
                atomic_xchg(&kept_slots[slot], bounds[slot].id);
            else if (atomic_cmpxchg(&kept_slots[slot], GN_NO_ID, 0u) == GN_NO_ID)
                atomic_xchg(&kept_slots[slot], frame.first_record + atomic_inc(kept_count));
        }
    }
}

__kernel void prepared_records(const KeptFrame frame, __global const uint* kept_slots,
                               __global const TriangleRecord* records, __global const TriangleBounds* bounds,
                               __global TriangleRecord* kept_records, __global TriangleBounds* kept_bounds) {
    GN_FOR_EACH(slot, frame.slot_count) {
        uint kept = kept_slots[slot];
        if (kept == GN_NO_ID) continue;
        kept_records[kept] = records[slot];
        kept_bounds[kept] = bounds[slot];
    }
}

// The slot of each triangle's record. A triangle may be in several of a point light's frames: the last one counts.
__kernel void prepared_slots(const KeptFrame frame, __global const TriangleBounds* kept_bounds,
                             __global float4* tables) {
    __global uint* slots = (__global uint*)(tables + frame.tables.slots);
    GN_FOR_EACH(i, frame.record_count) {
        uint slot = frame.first_record + (uint)i;
        slots[kept_bounds[slot].id] = slot;
    }
}

#if GN_LANES > 1
// The place of entry `lane` of heights[own] in its run, highest first; equal heights keep their order.
static uint place_in_run(const LaneUshort* heights, uint count, uint own, uint lane) {
    LaneUshort z = (LaneUshort)(((const ushort*)&heights[own])[lane]);
    short16 before = (heights[own] == z) & (convert_short16(LANE_INDEX) < (short16)((short)lane));
    for (uint i = 0; i < count; ++i) before += i < own ? heights[i] >= z : heights[i] > z;  // each true one is -1
    short8 eight = before.lo + before.hi;
    short4 four = eight.lo + eight.hi;
    return (uint)(-(four.x + four.y + four.z + four.w));
}

// Copies one run of a list, highest first, with the kept slots. Unused lanes are last, and so is the height 0.
GN_NOINLINE_ON_CPU void keep_run(__global const BinEntries* entries, uint count, __global const uint* kept_slots,
                                 __global BinEntries* kept) {
    LaneUshort heights[KEPT_RUN];
    __global BinEntries* run = (__global BinEntries*)entries;
    for (uint i = 0; i < count; ++i) heights[i] = run[i].z & as_ushort16(run[i].x0 <= run[i].x1);
    kept[count - 1u].x0 = (LaneUshort)(65535);
    kept[count - 1u].x1 = (LaneUshort)(0);
    for (uint i = 0; i < count * GN_LANES && is_used(&run[i / GN_LANES], i % GN_LANES); ++i) {
        __global BinEntries* from = &run[i / GN_LANES];
        uint lane = i % GN_LANES, place = place_in_run(heights, count, i / GN_LANES, lane), to = place % GN_LANES;
        __global BinEntries* at = &kept[place / GN_LANES];
        ENTRY_LANE(at, x0, to) = ENTRY_LANE(from, x0, lane);
        ENTRY_LANE(at, y0, to) = ENTRY_LANE(from, y0, lane);
        ENTRY_LANE(at, x1, to) = ENTRY_LANE(from, x1, lane);
        ENTRY_LANE(at, y1, to) = ENTRY_LANE(from, y1, lane);
        ENTRY_LANE(at, z, to) = ENTRY_LANE(from, z, lane);
        ((__global uint*)&at->slot)[to] = kept_slots[ENTRY_SLOT(from, lane)];
    }
}
#endif

// Copies a frame's entries, with the kept slots of their records. On a CPU each run of KEPT_RUN is put in order.
__kernel void prepared_entries(const KeptFrame frame, __global const uint2* ranges, __global const BinEntries* entries,
                               __global const uint* kept_slots, __global BinEntries* kept_entries) {
#if GN_LANES > 1
    GN_FOR_EACH(bin, frame.bin_count) {
        uint2 range = ranges[bin];
        for (uint i = range.x; i < range.y; i += KEPT_RUN)
            keep_run(&entries[i], min(range.y - i, KEPT_RUN), kept_slots, &kept_entries[frame.first_entry + i]);
    }
#else
    GN_FOR_EACH(i, frame.entry_count) {
        __global BinEntries* kept = &kept_entries[frame.first_entry + i];
        *kept = entries[i];
        if (is_used(&entries[i], 0)) kept->slot = kept_slots[ENTRY_SLOT(&entries[i], 0)];
    }
#endif
}

__kernel void prepared_ranges(const KeptFrame frame, __global const uint2* ranges, __global uint2* kept_ranges) {
    GN_FOR_EACH(i, frame.bin_count) kept_ranges[frame.first_bin + i] = ranges[i] + frame.first_entry;
}

// ---- Receivers ------------------------------------------------------------------------------------------------------

// The plane of each triangle, and the largest coordinate of all finite triangles, as bits; it is 0 before.
__kernel void prepared_planes(const PreparedParams params, __global const float* vertices, __global float4* tables) {
    LightFrame light_frame = params.light_frame;
    uint triangle_count = params.triangles.count;
    __global float4* planes = tables + params.tables.planes;
    volatile __global uint* largest_coordinate = (volatile __global uint*)(tables + params.tables.largest);
    PointBlock light = same_point(light_frame.light[0], light_frame.light[1], light_frame.light[2]);
    PointBlock zero = same_point(0.0f, 0.0f, 0.0f);
    LaneInt largest = (LaneInt)(0);
    uint exact = 0;
    GN_FOR_EACH(block, triangle_count / GN_LANES + (triangle_count % GN_LANES != 0u)) {
        size_t first = block * GN_LANES;
        TriangleBlock t = load_triangles(vertices + params.triangles.first_float, first, triangle_count);
        LaneInt size = largest_triangle_bits(&t), finite = finite_triangles(&t);
        LaneCross normals = triangle_normals(&t);
        LaneInt sides = lanes_side(&t, &normals, &light, light_frame.light[3] != 0.0f ? &t.a : &zero, finite, &exact);
        PlaneBlock kept = planes_towards_light(&t, &normals, sides);
        for (uint lane = 0; lane < min((uint)(triangle_count - first), (uint)GN_LANES); ++lane)
            planes[first + lane] = (float4)(lane_point(kept.n, (int)lane), LANE_OF_FLOAT(kept.minus_offset, lane));
        largest = max(largest, size & finite);
    }
    uint bits = (uint)LANES_MAXIMUM(largest);
    if (bits > GN_RELAXED_LOAD(largest_coordinate)) atomic_max(largest_coordinate, bits);
}
