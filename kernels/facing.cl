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
// Which way a receiver faces is the same for all points on it. Where there are many more points than triangles, none of
// them doubtful, triangles_away asks each triangle once, in order, and a point looks its receiver's answer up: a byte
// in place of nine floats from anywhere.
//
// Of footprints (footprint.h) the same is asked: what holds for a receiver holds for all samples on it, which the
// camera has made. Those that no frame takes in as a whole are mixed at once; the bounds are those of all places in the
// others.
#include "footprint.h"
#include "receivers.h"
#include "triangle_setup.h"

// ---- Bounds of the frames -------------------------------------------------------------------------------------------

// From the values of footprints' centres to the least and greatest in the footprints; of these the frame takes in all.
static void widen_values(LightFrame frame, PointBlock centres, const FootprintBlock* f, LaneFloat* lows,
                         LaneFloat* highs) {
    PointBlock reach = footprint_reach(f);
    LaneFloat reach_x = along(reach, frame.axis_x), reach_y = along(reach, frame.axis_y);
    LaneFloat reach_z = along(reach, frame.axis_z);
    if (frame.perspective) {
        PointBlock d = {centres.x - frame.light[0], centres.y - frame.light[1], centres.z - frame.light[2]};
        LaneFloat w = along(d, frame.axis_z) * frame.sign_z, near = w - reach_z, far = w + reach_z;
        LaneFloat x = along(d, frame.axis_x), y = along(d, frame.axis_y);
        lows[0] = fmin((x - reach_x) / near, (x - reach_x) / far);
        highs[0] = fmax((x + reach_x) / near, (x + reach_x) / far);
        lows[1] = fmin((y - reach_y) / near, (y - reach_y) / far);
        highs[1] = fmax((y + reach_y) / near, (y + reach_y) / far);
        lows[4] = near;
        highs[4] = far;
    } else {
        LaneFloat across_x = fabs(along(f->u, frame.axis_x) - frame.shear_x * along(f->u, frame.axis_z)) +
                             fabs(along(f->v, frame.axis_x) - frame.shear_x * along(f->v, frame.axis_z)) +
                             f->spread * (1.0f + fabs(frame.shear_x));
        LaneFloat across_y = fabs(along(f->u, frame.axis_y) - frame.shear_y * along(f->u, frame.axis_z)) +
                             fabs(along(f->v, frame.axis_y) - frame.shear_y * along(f->v, frame.axis_z)) +
                             f->spread * (1.0f + fabs(frame.shear_y));
        lows[0] -= across_x;
        highs[0] += across_x;
        lows[1] -= across_y;
        highs[1] += across_y;
        lows[4] -= reach.z;
        highs[4] += reach.z;
    }
    lows[2] -= reach.x;
    highs[2] += reach.x;
    lows[3] -= reach.y;
    highs[3] += reach.y;
}

// A work-item's bounds of the frame that its last points were in.
typedef struct RunningBounds {
    uint frame;
    LaneFloat lowest[BOUNDED_VALUES], highest[BOUNDED_VALUES];
    LaneInt minus_count;
} RunningBounds;

static void start_bounds(RunningBounds* bounds, uint frame) {
    bounds->frame = frame;
    bounds->minus_count = (LaneInt)(0);
    for (int i = 0; i < BOUNDED_VALUES; ++i) {
        bounds->lowest[i] = (LaneFloat)(INFINITY);
        bounds->highest[i] = (LaneFloat)(-INFINITY);
    }
}

// Into the work-group's bounds of all frames. Most values are inside already: a look saves the atomic.
static void raise_to(volatile __local uint* highest, LaneFloat values) {
    uint key = order_to_key(LANES_MAXIMUM(lanes_in_order(values)));
    if (key > GN_LOOK(highest)) atomic_max(highest, key);
}
static void flush_bounds(const RunningBounds* bounds, __local uint* shared) {
    uint count = (uint)-LANES_SUM(bounds->minus_count);
    if (count == 0u) return;
    __local uint* words = shared + bounds->frame * BOUNDS_WORDS;
    for (int i = 0; i < BOUNDED_VALUES; ++i) {
        raise_to(&words[i], bounds->highest[i]);
        raise_to(&words[BOUNDED_VALUES + i], -bounds->lowest[i]);
    }
    atomic_add(&words[2 * BOUNDED_VALUES], count);
}

// `footprints` is null where points are points.
static void include_points(RunningBounds* bounds, LightFrame light_frame, PointBlock points,
                           const FootprintBlock* footprints, LaneInt lanes, __local uint* shared) {
    LaneInt frames = frames_of(light_frame, points);
    while (LANES_ANY(lanes)) {
        int frame = LANE_OF_INT(frames, first_lane(lanes));
        LaneInt same = lanes & LANE_COMPARE(frames, ==, (LaneInt)(frame));
        lanes &= ~same;
        if (bounds->frame != (uint)frame) {
            flush_bounds(bounds, shared);
            start_bounds(bounds, (uint)frame);
        }
        LaneFloat lows[BOUNDED_VALUES], highs[BOUNDED_VALUES];
        bounded_values(face_of(light_frame, (uint)frame), points, lows);
        for (int i = 0; i < BOUNDED_VALUES; ++i) highs[i] = lows[i];
        if (footprints) widen_values(face_of(light_frame, (uint)frame), points, footprints, lows, highs);
        for (int i = 0; i < BOUNDED_VALUES; ++i) {
            LaneInt lower = same & LANE_COMPARE(lows[i], <, bounds->lowest[i]);
            LaneInt higher = same & LANE_COMPARE(highs[i], >, bounds->highest[i]);
            bounds->lowest[i] = LANES_SELECT(bounds->lowest[i], lows[i], lower);
            bounds->highest[i] = LANES_SELECT(bounds->highest[i], highs[i], higher);
        }
        bounds->minus_count += same;
    }
}

static float4 light_of(LightFrame light_frame) {
    return (float4)(light_frame.light[0], light_frame.light[1], light_frame.light[2], light_frame.light[3]);
}

// Of each triangle 1 if points on it face away, else 0; in whole blocks.
__kernel void triangles_away(PointsLayout layout, LightFrame light_frame, ulong first_float, uint triangle_count,
                             __global const float* vertices, __global LaneUchar* away,
                             __global FrameCounters* counters) {
    uint exact = 0;
    GN_FOR_EACH(block, (triangle_count + GN_LANES - 1u) / GN_LANES) {
        uint first = (uint)block * GN_LANES;
        TriangleBlock t = load_triangles(vertices + first_float, first, triangle_count);
        LaneInt asked = LANE_COMPARE((LaneInt)((int)min(triangle_count - first, (uint)GN_LANES)), >, LANE_INDEX);
        ReceiverAnswer answer = answer_of_triangles(&t, asked, 0, layout, light_of(light_frame), &exact);
        away[block] = LANES_TO_UCHAR(-answer.faces_away);
    }
    if (exact != 0) atomic_add(&counters->facing_exact, exact);
}

// Which of the lanes `asked`, whose ids name triangles, triangles_away has found to face away.
static LaneInt look_up_away(__global const uchar* triangles_are_away, LaneInt ids, LaneInt asked) {
    LaneInt at = LANES_SELECT((LaneInt)(0), ids, asked);
    return asked & -LANES_GATHER(triangles_are_away, at);
}

// `opens`, one of FACING_* (points.h): what becomes of points that do not face away. `asked_before`: triangles_are_away
// has been filled, and no point is doubtful. `shared`: BOUNDS_WORDS for each frame. The frames' bounds and the counters
// are zeroed before.
__attribute__((always_inline)) static void decide_facing(
    PointsLayout layout, LightFrame light_frame, uint opens, uint has_footprints, bool asked_before, ulong first_float,
    uint triangle_count, __global const float* positions, __global const float* footprints,
    __global const uint* receivers, __global const float* vertices, __global const uchar* triangles_are_away,
    __global float* visibility, volatile __global uint* frame_bounds, __global FrameCounters* counters,
    __local uint* shared, __local uint* group_counts) {
    uint words = frame_count_of(light_frame) * BOUNDS_WORDS;
    // One atomic per work-group, not per item: many on one address take longer than the pass.
    if (get_local_id(0) == 0) group_counts[0] = group_counts[1] = 0u;
    for (uint i = (uint)get_local_id(0); i < words; i += (uint)get_local_size(0)) shared[i] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);

    uint exact = 0;
    LaneInt minus_absent = (LaneInt)(0), minus_away = (LaneInt)(0);
    RunningBounds bounds;
    start_bounds(&bounds, 0u);
    GN_FOR_EACH(block, block_count(layout)) {
        LaneInt valid = valid_lanes(layout, block);
        PointBlock points = load_block(positions, layout, block);
        LaneInt open = valid & present_lanes(points);
        minus_absent += valid & ~open;
        if (!LANES_ANY(open)) {
            store_lanes((LaneFloat)(1.0f), visibility, layout, block);
            continue;
        }
        LaneInt away = (LaneInt)(0), doubtful = (LaneInt)(0);
        if (layout.has_receivers) {
            LaneInt ids = load_lane_ids(receivers, layout, block), asked = open & lanes_below(ids, triangle_count);
            if (asked_before) {
                away = look_up_away(triangles_are_away, ids, asked);
            } else if (LANES_ANY(asked)) {
                bool doubts = !has_footprints && !layout.is_lifted;
                ReceiverAnswer answer = ask_receivers(ids, asked, &points, layout, light_of(light_frame), doubts,
                                                      vertices + first_float, &exact);
                away = answer.faces_away;
                doubtful = answer.doubtful;
            }
        }
        minus_away += away;
        if (opens == FACING_DECIDES) open = (LaneInt)(0);
        open &= ~away & LANE_COMPARE(frames_of(light_frame, points), !=, (LaneInt)((int)LAMP_FRAMES));
        LaneFloat result = LANES_SELECT((LaneFloat)(1.0f), (LaneFloat)(0.0f), away);
        FootprintBlock around;
        if (has_footprints) {
            around = load_footprints(footprints, layout, block);
            LaneInt present = valid & present_lanes(points);
            open &= in_one_frame(light_frame, points, &around);
            result = LANES_SELECT(result, (LaneFloat)(VISIBILITY_MIXED), present & ~away);
        }
        result = LANES_SELECT(result, (LaneFloat)(VISIBILITY_OPEN), open);
        result = LANES_SELECT(result, (LaneFloat)(VISIBILITY_DOUBTFUL), open & doubtful);
        store_lanes(result, visibility, layout, block);
        if (opens == FACING_BOUNDS && LANES_ANY(open))
            include_points(&bounds, light_frame, points, has_footprints ? &around : 0, open, shared);
    }
    flush_bounds(&bounds, shared);
    atomic_add(&group_counts[0], (uint)-LANES_SUM(minus_absent));
    atomic_add(&group_counts[1], (uint)-LANES_SUM(minus_away));
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = (uint)get_local_id(0); i < words; i += (uint)get_local_size(0)) {
        uint word = shared[i];
        if (word == 0u) continue;
        if (i % BOUNDS_WORDS == 2 * BOUNDED_VALUES)
            atomic_add(&frame_bounds[i], word);
        else if (word > GN_LOOK(&frame_bounds[i]))
            atomic_max(&frame_bounds[i], word);
    }
    if (get_local_id(0) == 0) {
        if (group_counts[0] != 0) atomic_add(&counters->absent, group_counts[0]);
        if (group_counts[1] != 0) atomic_add(&counters->facing_away, group_counts[1]);
    }
    if (exact != 0) atomic_add(&counters->facing_exact, exact);
}

#define FACING_KERNEL(name, has_footprints_here, asked_before)                                                    \
    __kernel void name(PointsLayout layout, LightFrame light_frame, uint opens, uint has_footprints,              \
                       ulong first_float, uint triangle_count, __global const float* positions,                   \
                       __global const float* footprints, __global const uint* receivers,                          \
                       __global const float* vertices, __global const uchar* triangles_are_away,                  \
                       __global float* visibility, volatile __global uint* frame_bounds,                          \
                       __global FrameCounters* counters, __local uint* shared) {                                  \
        __local uint group_counts[2];                                                                             \
        decide_facing(layout, light_frame, opens, has_footprints_here, asked_before, first_float, triangle_count, \
                      positions, footprints, receivers, vertices, triangles_are_away, visibility, frame_bounds,   \
                      counters, shared, group_counts);                                                            \
    }

// Two kernels: what the exact predicate and footprints need of a GPU's registers would slow down the look-up as well.
FACING_KERNEL(facing, has_footprints, false)
FACING_KERNEL(facing_looked_up, false, true)
