// SPDX-License-Identifier: MIT
// Facing: the one pass over all points. Decides those that the light cannot reach by definition of shading, opens the
// others, and takes the bounds of the light's frames on the way.
//
// A point faces away if the light is not strictly on the eye's side of its receiver's plane: with e and l the signs of
// det(b - a, c - a, eye - a) and det(b - a, c - a, D) (D = minus the direction of travel, or S - a), unless e l > 0.
// Decided exactly. Asked only where the points carry an eye. Absent points (NaN) and points at the lamp are lit.
//
// An open point is doubtful if its receiver's plane is strictly between it and the light, that is if det(b - a, c - a,
// a - P) has the sign l: only then can the receiver block it (exact/blocks.h), which by contract it never does. What
// the camera makes is lifted off its receiver and never doubtful; a caller's point may be.
//
// Which way a receiver faces is the same for all points on it. Where no point is doubtful, each triangle is asked once.
// On a GPU triangles_away asks all of them, in order, where there are many more points, and a point looks its
// receiver's answer up: a byte in place of nine floats from anywhere. On a CPU the first point that wants to know asks,
// for GN_LANES triangles in a row, which are neighbours in most meshes; where the points of a block lie on triangles
// from anywhere, they ask for themselves, and nothing is kept.
//
// What the exact predicate needs of a GPU's registers would slow down those who never ask it. So where points there ask
// for themselves, facing_filter leaves those that floats do not decide unsure, for facing_exact_fallback.
//
// Of footprints (footprint.h) the same is asked: what holds for a receiver holds for all samples on it, which the
// camera has made. Those that no frame takes in as a whole are mixed at once; the bounds are those of all places in the
// others. Samples of a mixed footprint face the light, as it did, and are not asked again: they come as points without
// receivers.
#include "receivers/block_bounds.h"
#include "receivers/facing_cache.clh"
#include "receivers/footprint.h"
#include "simd/frame_counters.h"

// ---- Bounds of the frames -------------------------------------------------------------------------------------------

// From the grid values of footprints' centres to the least and greatest in the footprints, of which the frame takes in
// all.
static void widen_values(LightFrame frame, PointBlock centres, const FootprintBlock* f, PointBlock* low,
                         PointBlock* high) {
    PointBlock reach = footprint_reach(f);
    LaneFloat reach_z = along(reach, frame.axis_z);
    low->z -= reach_z;
    high->z += reach_z;
    if (IS_PERSPECTIVE(frame)) {
        PointBlock d = {centres.x - frame.light[0], centres.y - frame.light[1], centres.z - frame.light[2]};
        LaneFloat reach_x = along(reach, frame.axis_x), reach_y = along(reach, frame.axis_y);
        LaneFloat x = along(d, frame.axis_x), y = along(d, frame.axis_y);
        low->x = fmin((x - reach_x) / low->z, (x - reach_x) / high->z);
        high->x = fmax((x + reach_x) / low->z, (x + reach_x) / high->z);
        low->y = fmin((y - reach_y) / low->z, (y - reach_y) / high->z);
        high->y = fmax((y + reach_y) / low->z, (y + reach_y) / high->z);
    } else {
        LaneFloat across_x = fabs(along(f->u, frame.axis_x) - frame.shear_x * along(f->u, frame.axis_z)) +
                             fabs(along(f->v, frame.axis_x) - frame.shear_x * along(f->v, frame.axis_z)) +
                             f->spread * (1.0f + fabs(frame.shear_x));
        LaneFloat across_y = fabs(along(f->u, frame.axis_y) - frame.shear_y * along(f->u, frame.axis_z)) +
                             fabs(along(f->v, frame.axis_y) - frame.shear_y * along(f->v, frame.axis_z)) +
                             f->spread * (1.0f + fabs(frame.shear_y));
        low->x -= across_x;
        high->x += across_x;
        low->y -= across_y;
        high->y += across_y;
    }
}

// A work-item's bounds of the frame that its last points were in.
typedef struct RunningBounds {
    uint frame;
    float8 span;  // as span_of_lanes() has it
    LaneInt minus_count;
} RunningBounds;

static void start_bounds(RunningBounds* bounds, uint frame) {
    bounds->frame = frame;
    bounds->minus_count = (LaneInt)(0);
    bounds->span = (float8)(INFINITY);
}

// Into the work-group's bounds of all frames. Most values are inside already: a look saves the atomic.
static void raise_to(volatile __local uint* highest, float value) {
    uint key = float_to_key(value);
    if (key > GN_RELAXED_LOAD(highest)) atomic_max(highest, key);
}
static void flush_bounds(LightFrame light_frame, const RunningBounds* bounds, __local uint* shared) {
    uint count = (uint)-LANES_SUM(bounds->minus_count);
    if (count == 0u) return;
    LightFrame frame = face_of(light_frame, bounds->frame);
    bool flips = IS_PERSPECTIVE(frame) || frame.sign_z < 0.0f;  // heights grow where z falls
    float8 span = bounds->span;
    float low[BOUNDED_VALUES] = {span.s0, span.s2, 0.0f, 0.0f, 0.0f};
    float high[BOUNDED_VALUES] = {-span.s1, -span.s3, 0.0f, 0.0f, 0.0f};
    float z_low = flips ? span.s5 : span.s4, z_high = flips ? -span.s4 : -span.s5;
    uint axis_z = IS_PERSPECTIVE(frame) ? 2u : frame.axis_z;
    low[2 + axis_z] = z_low;
    high[2 + axis_z] = z_high;
    if (!IS_PERSPECTIVE(frame)) {
        uint axis_x = 2u + frame.axis_x, axis_y = 2u + frame.axis_y;
        world_bounds(low[0], high[0], frame.shear_x, z_low, z_high, &low[axis_x], &high[axis_x]);
        world_bounds(low[1], high[1], frame.shear_y, z_low, z_high, &low[axis_y], &high[axis_y]);
    }
    __local uint* words = shared + bounds->frame * BOUNDS_WORDS;
    for (int i = 0; i < BOUNDED_VALUES; ++i) {
        raise_to(&words[i], high[i]);
        raise_to(&words[BOUNDED_VALUES + i], -low[i]);
    }
    atomic_add(&words[2 * BOUNDED_VALUES], count);
}

// `footprints` is null where points are points. Returns what the points span, and in *in_frame their one frame, or
// BLOCK_*.
static float8 include_points(RunningBounds* bounds, LightFrame light_frame, PointBlock points,
                             const FootprintBlock* footprints, LaneInt lanes, __local uint* shared, uint* in_frame) {
    LaneInt frames = frames_of(light_frame, points);
    float8 span = (float8)(INFINITY);
    *in_frame = BLOCK_IN_NO_FRAME;
    while (LANES_ANY(lanes)) {
        LaneInt same = lanes;
        uint frame = 0;
        if (IS_PERSPECTIVE(light_frame)) {
            frame = (uint)LANE_OF_INT(frames, first_lane(lanes));
            same &= LANE_COMPARE(frames, ==, (LaneInt)((int)frame));
        }
        lanes &= ~same;
        if (bounds->frame != frame) {
            flush_bounds(light_frame, bounds, shared);
            start_bounds(bounds, frame);
        }
        LightFrame face = face_of(light_frame, frame);
        PointBlock low = grid_values(face, points), high = low;
        if (footprints) widen_values(face, points, footprints, &low, &high);
        if (IS_PERSPECTIVE(face) || face.sign_z < 0.0f) {
            LaneFloat z = low.z;
            low.z = -high.z;
            high.z = -z;
        }
        span = span_of_lanes(low, high, same);
        bounds->span = least_of_two(span, bounds->span);
        bounds->minus_count += same;
        *in_frame = *in_frame == BLOCK_IN_NO_FRAME ? frame : BLOCK_IN_FRAMES;
    }
    return span;
}

#if GN_LANES == 1
#define TRIANGLES_AWAY_PARAMETERS                                                        \
    PointsLayout layout, LightFrame light_frame, ulong first_float, uint triangle_count, \
        __global const float *vertices, __global uchar *away, __global FrameCounters *counters
GN_KERNEL_OF_ITEMS(triangles_away, triangle_count, TRIANGLES_AWAY_PARAMETERS,
                   (items, layout, light_frame, first_float, triangle_count, vertices, away, counters)) {
    uint exact = 0;
    GN_FOR_EACH_OF(i, items) {
        TriangleBlock t = load_triangles(vertices + first_float, (uint)i, triangle_count);
        ReceiverFacing answer = classify_triangles(&t, -1, 0, layout, light_of(light_frame), &exact);
        away[i] = (uchar)-answer.backfacing;
    }
    if (exact != 0) atomic_add(&counters->facing_exact, exact);
}
#endif

// What the points are held against, and what is written of each.
typedef struct FacingBuffers {
    __global const float *positions, *footprints;
    __global const uint* receivers;
    __global const float* vertices;  // from the first triangle on
    FacingCache answers;
    __global float* visibility;
    __global BlockBounds* blocks;
    __global uint* undecided;
    __local uint* shared;
} FacingBuffers;

// What a work-item counts.
typedef struct FacingCounts {
    LaneInt minus_absent, minus_away;
    uint exact;
} FacingCounts;

// False only if no point of the block is present: where coordinates lie apart, the sky is known by the first of them.
static bool may_be_present(__global const float* positions, PointsLayout layout, size_t block) {
#if GN_LANES > 1
    if (layout.point_stride == 1u) {
        LaneFloat x = load_lanes(positions + layout.first, layout, block);
        return LANES_ANY(LANE_COMPARE(LANES_SIZE_BITS(x), <, (LaneInt)(BITS_OF_INFINITY)));
    }
#endif
    return true;
}

// How receivers are asked: point by point; or by answers that are there to be looked up, where no point is doubtful;
// so, and the run is a usual one. On a GPU, no point being doubtful: point by point by floats alone, which leaves some
// points unsure; and those.
#define ASKS_EACH 0u
#define LOOKS_UP 1u
#define LOOKS_UP_AS_USUAL 2u
#define ASKS_FLOATS 3u
#define ASKS_THE_UNSURE 4u

#if GN_LANES == 1
// The visibility of a point in between. They are listed as well, behind their number, if it is no more than
// UNDECIDED_CAPACITY.
#define VISIBILITY_UNSURE 4.0f

static void list_unsure(__global uint* undecided, uint point) {
    uint place = atomic_inc(&undecided[0]);
    if (place < UNDECIDED_CAPACITY) undecided[1 + place] = point;
}

// Else there are more of them than the list holds, and all points must be looked through.
static bool all_unsure_are_listed(__global const uint* undecided) { return undecided[0] <= UNDECIDED_CAPACITY; }
#endif

// Inlined for each kind of run (below): a CPU's compiler leaves out what an argument that is a constant rules out, and
// keeps in registers what it would carry through memory around that.
__attribute__((always_inline)) static void face_points(PointsLayout layout, LightFrame light_frame, uint opens,
                                                       uint has_footprints, uint way, uint has_blocks,
                                                       uint triangle_count, FacingBuffers to, RunningBounds* bounds,
                                                       FacingCounts* counts, ItemRange items) {
    GN_FOR_EACH_OF(at, items) {
        size_t block = at;
#if GN_LANES == 1
        if (way == ASKS_THE_UNSURE && all_unsure_are_listed(to.undecided))
            block = to.undecided[1 + at];
        else if (way == ASKS_THE_UNSURE && load_lanes(to.visibility, layout, block) != VISIBILITY_UNSURE)
            continue;
#endif
        LaneInt valid = valid_lanes(layout, block), open = valid;
        PointBlock points;
        if (may_be_present(to.positions, layout, block)) {
            points = load_block(to.positions, layout, block);
            open &= present_lanes(points);
        } else {
            open = (LaneInt)(0);
        }
        counts->minus_absent += valid & ~open;
        if (!LANES_ANY(open)) {
            store_lanes((LaneFloat)(1.0f), to.visibility, layout, block);
            if (has_blocks) to.blocks[block].frame = BLOCK_IN_NO_FRAME;
            continue;
        }
        LaneInt away = (LaneInt)(0), doubtful = (LaneInt)(0), undecided = (LaneInt)(0);
        if (layout.has_receivers) {
            LaneInt ids = load_lane_ids(to.receivers, layout, block), asked = open & lanes_below(ids, triangle_count);
            if (way == LOOKS_UP) {
                away = cached_backfacing(to.answers, to.vertices, ids, asked, triangle_count, layout,
                                         light_of(light_frame), &counts->exact);
#if GN_LANES == 1
            } else if (way == ASKS_FLOATS) {
                if (asked) {
                    TriangleBlock t = load_triangles_of(to.vertices, ids, asked);
                    away = filter_backfacing(&t, asked, layout, light_of(light_frame), &undecided);
                    if (undecided) list_unsure(to.undecided, (uint)block);
                }
#endif
            } else if (LANES_ANY(asked)) {
                bool doubts = !has_footprints && !layout.is_lifted;
                ReceiverFacing answer = classify_receivers(ids, asked, doubts ? &points : 0, layout,
                                                           light_of(light_frame), to.vertices, &counts->exact);
                away = answer.backfacing;
                doubtful = answer.may_self_shadow;
            }
        }
        counts->minus_away += away;
        if (opens == FACING_DECIDES) open = (LaneInt)(0);
        open &= ~away & ~undecided;
        if (IS_PERSPECTIVE(light_frame))
            open &= LANE_COMPARE(frames_of(light_frame, points), !=, (LaneInt)((int)POINT_LIGHT_FRAMES));
        LaneFloat result = visibility_of_lanes(away, open);
        FootprintBlock around;
        if (has_footprints) {
            around = load_footprints(to.footprints, layout, block);
            LaneInt present = valid & present_lanes(points);
            open &= in_one_frame(light_frame, points, &around);
            result = LANES_SELECT(result, (LaneFloat)(VISIBILITY_MIXED), present & ~away);
            result = LANES_SELECT(result, (LaneFloat)(VISIBILITY_OPEN), open);
        }
        result = LANES_SELECT(result, (LaneFloat)(VISIBILITY_MAY_SELF_SHADOW), open & doubtful);
#if GN_LANES == 1
        if (undecided) result = VISIBILITY_UNSURE;
#endif
        store_lanes(result, to.visibility, layout, block);
        uint in_frame = BLOCK_IN_NO_FRAME;
        float8 span = (float8)(INFINITY);
        if (opens == FACING_BOUNDS && LANES_ANY(open))
            span =
                include_points(bounds, light_frame, points, has_footprints ? &around : 0, open, to.shared, &in_frame);
        if (way == ASKS_THE_UNSURE) {  // one by one, since they are listed in any order
            flush_bounds(light_frame, bounds, to.shared);
            start_bounds(bounds, 0u);
        }
        if (has_blocks) {
            uint flags = LANES_ANY(~open) ? 0u : BLOCK_ALL_OPEN;
            if (LANES_ANY(open & doubtful)) flags |= BLOCK_MAY_SELF_SHADOW;
            span.s6 = as_float(in_frame);
            span.s7 = as_float(flags);
            vstore8(span, 0, (__global float*)&to.blocks[block]);
        }
    }
}

GN_NOINLINE_ON_CPU void face_asked(PointsLayout layout, LightFrame light_frame, uint opens, uint has_footprints,
                                   uint has_blocks, uint triangle_count, const FacingBuffers* to, RunningBounds* bounds,
                                   FacingCounts* counts, ItemRange items) {
    face_points(layout, light_frame, opens, has_footprints, ASKS_EACH, has_blocks, triangle_count, *to, bounds, counts,
                items);
}
GN_NOINLINE_ON_CPU void face_looked_up(PointsLayout layout, LightFrame light_frame, uint opens, uint has_blocks,
                                       uint triangle_count, const FacingBuffers* to, RunningBounds* bounds,
                                       FacingCounts* counts, ItemRange items) {
    face_points(layout, light_frame, opens, 0u, LOOKS_UP, has_blocks, triangle_count, *to, bounds, counts, items);
}
GN_NOINLINE_ON_CPU void face_looked_up_around(PointsLayout layout, LightFrame light_frame, uint opens, uint has_blocks,
                                              uint triangle_count, const FacingBuffers* to, RunningBounds* bounds,
                                              FacingCounts* counts, ItemRange items) {
    face_points(layout, light_frame, opens, 1u, LOOKS_UP, has_blocks, triangle_count, *to, bounds, counts, items);
}
#if GN_LANES > 1
// face_points() of a picture, under a direction (is_picture_directional() of host/receivers/facing.cpp): coordinates in
// the order of the frame's axes, and nothing asked that is the same for all.
GN_NOINLINE_ON_CPU void face_picture_directional(PointsLayout layout, LightFrame frame, uint triangle_count,
                                                 const FacingBuffers* buffers, RunningBounds* bounds,
                                                 FacingCounts* total, ItemRange items) {
    FacingBuffers to = *buffers;
    FacingCounts counts = *total;
    RunningBounds all = *bounds;
    __global const float* coordinates = to.positions + layout.first;
    __global const float* along_x = coordinates + (size_t)layout.coordinate_stride * frame.axis_x;
    __global const float* along_y = coordinates + (size_t)layout.coordinate_stride * frame.axis_y;
    __global const float* along_z = coordinates + (size_t)layout.coordinate_stride * frame.axis_z;
    GN_FOR_EACH_OF(block, items) {
        BlockPlace place = place_in_picture(layout.picture_width, block);
        PointBlock points;
        points.x = load_strided(along_x, 1u, place);
        LaneInt open = LANE_COMPARE(LANES_SIZE_BITS(points.x), <, (LaneInt)(BITS_OF_INFINITY));
        if (LANES_ANY(open)) {
            points.y = load_strided(along_y, 1u, place);
            points.z = load_strided(along_z, 1u, place);
            open = present_lanes(points);
        }
        counts.minus_absent += ~open;
        LaneInt away = (LaneInt)(0);
        if (LANES_ANY(open)) {
            LaneInt ids = LANES_AS_INT(load_strided((__global const float*)to.receivers, 1u, place));
            away = cached_backfacing(to.answers, to.vertices, ids, open & lanes_below(ids, triangle_count),
                                     triangle_count, layout, light_of(frame), &counts.exact);
            open &= ~away;
        }
        counts.minus_away += away;
        store_at(visibility_of_lanes(away, open), to.visibility, place);
        if (!LANES_ANY(open)) {
            to.blocks[block].frame = BLOCK_IN_NO_FRAME;
            continue;
        }
        PointBlock values = {points.x - frame.shear_x * points.z, points.y - frame.shear_y * points.z,
                             points.z * frame.sign_z};
        float8 span = span_of_lanes(values, values, open);
        all.span = least_of_two(span, all.span);
        all.minus_count += open;
        span.s6 = as_float(0u);
        span.s7 = as_float(LANES_ANY(~open) ? 0u : BLOCK_ALL_OPEN);
        vstore8(span, 0, (__global float*)&to.blocks[block]);
    }
    *total = counts;
    *bounds = all;
}
#endif

// `opens`, one of FACING_* (points.h): what becomes of points that do not face away. `has_blocks`: blocks is to be
// written. `shared`: BOUNDS_WORDS for each frame. The frames' bounds and the counters are zeroed before.
__attribute__((always_inline)) static void decide_facing(
    PointsLayout layout, LightFrame light_frame, uint opens, uint has_footprints, uint way, uint has_blocks,
    ulong first_float, uint triangle_count, __global const float* positions, __global const float* footprints,
    __global const uint* receivers, __global const float* vertices, FacingCache answers, __global float* visibility,
    volatile __global uint* frame_bounds, __global BlockBounds* blocks, __global uint* undecided,
    __global FrameCounters* counters, __local uint* shared, __local uint* group_counts) {
    uint words = frame_count_of(light_frame) * BOUNDS_WORDS;
    // One atomic per work-group, not per item: many on one address take longer than the pass.
    if (get_local_id(0) == 0) group_counts[0] = group_counts[1] = 0u;
    for (uint i = (uint)get_local_id(0); i < words; i += (uint)get_local_size(0)) shared[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);

    FacingBuffers to = {positions, footprints, receivers, vertices + first_float, answers, visibility,
                        blocks,    undecided,  shared};
    FacingCounts counts = {(LaneInt)(0), (LaneInt)(0), 0u};
    RunningBounds bounds;
    start_bounds(&bounds, 0u);
    ItemRange items = item_range(block_count(layout));
#if GN_LANES == 1
    if (way == ASKS_THE_UNSURE && all_unsure_are_listed(undecided)) items = item_range(undecided[0]);
#endif
    if (way == ASKS_EACH)
        face_asked(layout, light_frame, opens, has_footprints, has_blocks, triangle_count, &to, &bounds, &counts,
                   items);
    else if (has_footprints)
        face_looked_up_around(layout, light_frame, opens, has_blocks, triangle_count, &to, &bounds, &counts, items);
#if GN_LANES > 1
    else if (way == LOOKS_UP_AS_USUAL)
        face_picture_directional(layout, light_frame, triangle_count, &to, &bounds, &counts, items);
#else
    else if (way != LOOKS_UP)
        face_points(layout, light_frame, opens, 0u, way, has_blocks, triangle_count, to, &bounds, &counts, items);
#endif
    else
        face_looked_up(layout, light_frame, opens, has_blocks, triangle_count, &to, &bounds, &counts, items);
    flush_bounds(light_frame, &bounds, shared);
    atomic_add(&group_counts[0], (uint)-LANES_SUM(counts.minus_absent));
    atomic_add(&group_counts[1], (uint)-LANES_SUM(counts.minus_away));
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = (uint)get_local_id(0); i < words; i += (uint)get_local_size(0)) {
        uint word = shared[i];
        if (word == 0u) continue;
        if (i % BOUNDS_WORDS == 2 * BOUNDED_VALUES)
            atomic_add(&frame_bounds[i], word);
        else if (word > GN_RELAXED_LOAD(&frame_bounds[i]))
            atomic_max(&frame_bounds[i], word);
    }
    if (get_local_id(0) == 0) {
        if (group_counts[0] != 0) atomic_add(&counters->absent, group_counts[0]);
        if (group_counts[1] != 0) atomic_add(&counters->facing_away, group_counts[1]);
    }
    if (counts.exact != 0) atomic_add(&counters->facing_exact, counts.exact);
}

#define FACING_KERNEL(name, has_footprints_here, way)                                                                 \
    __kernel void name(PointsLayout layout, LightFrame light_frame, uint opens, uint has_footprints, uint has_blocks, \
                       ulong first_float, uint triangle_count, __global const float* positions,                       \
                       __global const float* footprints, __global const uint* receivers,                              \
                       __global const float* vertices, FacingCache answers, __global float* visibility,               \
                       volatile __global uint* frame_bounds, __global BlockBounds* blocks, __global uint* undecided,  \
                       __global FrameCounters* counters, __local uint* shared) {                                      \
        __local uint group_counts[2];                                                                                 \
        decide_facing(layout, light_frame, opens, has_footprints_here, way, has_blocks, first_float, triangle_count,  \
                      positions, footprints, receivers, vertices, answers, visibility, frame_bounds, blocks,          \
                      undecided, counters, shared, group_counts);                                                     \
    }

// What the exact predicate and footprints need of a GPU's registers would slow down the look-up as well; and PoCL
// compiles of a program only the kernels that are launched.
FACING_KERNEL(facing, has_footprints, ASKS_EACH)
FACING_KERNEL(facing_looked_up, false, LOOKS_UP)
FACING_KERNEL(facing_looked_up_around, true, LOOKS_UP)
#if GN_LANES > 1
FACING_KERNEL(facing_picture_directional, false, LOOKS_UP_AS_USUAL)
#else
FACING_KERNEL(facing_filter, false, ASKS_FLOATS)
FACING_KERNEL(facing_exact_fallback, false, ASKS_THE_UNSURE)
#endif
