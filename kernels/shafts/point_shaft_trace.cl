// SPDX-License-Identifier: MIT
// The trace of point shafts (shaft.h): the shadow rays from one point to a bundle of lights. Where triangles are small
// beside the distance of neighbouring points, a block's shaft meets many that each block few of its rays; a point shaft
// meets only what lies near its rays. Lanes are first a node's children, then a leaf's triangles, then lights.
#include "shafts/shaft_walk.clh"

// The same for all lanes.
typedef struct PointWork {
    float3 p;
    uint open;  // the lights of the bundle that are not yet dark
    uint receiver;
    uint point, bundle;
} PointWork;

// Triangles that a shaft tests for single lights before it is divided.
#ifndef TESTS_WORTH_PARTS
#define TESTS_WORTH_PARTS 16u
#endif
#define LIGHT_PART_LEVELS 3u

// PointEdges of a leaf's triangles, row by row.
#define PUT_POINT_BLOCK(rows, k, v)                          \
    PUT_ROW(rows, k, (v).x), PUT_ROW(rows, (k) + 1u, (v).y); \
    PUT_ROW(rows, (k) + 2u, (v).z)
#define FLOAT3_AT(rows, k, i)                                                       \
    (float3)((rows)[(k)*SHAFT_WIDTH + (i)], (rows)[((k) + 1u) * SHAFT_WIDTH + (i)], \
             (rows)[((k) + 2u) * SHAFT_WIDTH + (i)])
#define FLOAT_AT(rows, k, i) (rows)[(k)*SHAFT_WIDTH + (i)]
#define EDGES_AT(rows, i)                                                                              \
    (PointEdges) {                                                                                     \
        FLOAT3_AT(rows, 0u, i), FLOAT3_AT(rows, 3u, i), FLOAT3_AT(rows, 6u, i), FLOAT_AT(rows, 9u, i), \
            as_int(FLOAT_AT(rows, 10u, i)) != 0                                                        \
    }
#if GN_LANES > 1
#define EDGE_ROWS_OF_LEAF(rows) float rows[POINT_EDGE_ROWS * SHAFT_WIDTH_ON_CPU]
#define PUT_ROW(rows, k, v) vstore16(v, k, rows)
#define EDGE_ROWS_ARE_PUT
#else
#define EDGE_ROWS_OF_LEAF(rows) __local float* rows = (__local float*)(shared + POINT_EDGES)
#define PUT_ROW(rows, k, v) (rows)[(k)*SHAFT_WIDTH + get_local_id(0)] = (v)
#define EDGE_ROWS_ARE_PUT barrier(CLK_LOCAL_MEM_FENCE)
#endif

static void queue_pairs_of_point(const PointWork* work, uint undecided, __global const float* leaf, uint i,
                                 uint triangle, const ShaftScene* scene, Reservation* mine) {
    ShaftTriangle t = shaft_triangle(leaf, i);
    queue_pairs((ShaftPairs){work->point, work->bundle, triangle & ~SHAFT_MASKED, undecided}, &t, work->p, scene, mine);
}

// Tests the triangles of a leaf. Returns how many of them are tested for single lights.
GN_INLINE_ON_CPU uint test_leaf(PointWork* work, __global const LightBundle* bundle, const Shaft* shaft, uint leaf,
                                const ShaftScene* scene, Reservation* mine SHARED_PARAMETER) {
    __global const float* corners = scene->leaves + (size_t)leaf * (SHAFT_LEAF_ROWS * SHAFT_WIDTH);
    __global const uint* ids = scene->ids + (size_t)leaf * SHAFT_WIDTH;
    LaneTriangles t = triangles_of_leaf(corners);
    ShaftEdges e = edges_of(&t, same_in_lanes(work->p));
    ShaftDecision cone = decide_cone(&e, shaft->cone);
    LaneInt id = SHAFT_LOAD_IDS(ids), some = ~cone.missed & LANE_COMPARE(t.a.x, ==, t.a.x);
#ifdef GN_CUT_OUTS
    LaneInt are_masked = LANE_COMPARE(id, <, (LaneInt)(0));
    id &= (int)~SHAFT_MASKED;
    cone.blocked &= ~are_masked;
#endif
    some &= LANE_COMPARE(id, !=, (LaneInt)((int)work->receiver));
    uint bits = SHAFT_BITS(some);
    if (bits == 0u) return 0u;
    if (SHAFT_BITS(some & cone.blocked) != 0u) {
        work->open = 0u;
        return 0u;
    }
    uint tests = popcount(bits);
    EDGE_ROWS_OF_LEAF(rows);
    PUT_POINT_BLOCK(rows, 0u, e.ab);
    PUT_POINT_BLOCK(rows, 3u, e.bc);
    PUT_POINT_BLOCK(rows, 6u, e.ca);
    PUT_ROW(rows, 9u, e.bound);
    PUT_ROW(rows, 10u, LANES_AS_FLOAT(e.sided));
    EDGE_ROWS_ARE_PUT;
#if GN_LANES > 1
    while (bits != 0u && work->open != 0u) {
        uint i = take_lowest_bit(&bits);
        PointEdges edges = EDGES_AT(rows, i);
        LightDecision decision = decide_lights(&edges, bundle, work->open);
#ifdef GN_CUT_OUTS
        if ((ids[i] & SHAFT_MASKED) != 0u) decision = (LightDecision){0u, decision.dark | decision.undecided};
#endif
        work->open &= ~decision.dark;
        if (decision.undecided != 0u) queue_pairs_of_point(work, decision.undecided, corners, i, ids[i], scene, mine);
    }
#else
    uint light = get_local_id(0);
    bool is_open = (work->open >> light & 1u) != 0u;
    float3 d = light_direction(bundle, light);
    while (bits != 0u && is_open) {
        uint i = take_lowest_bit(&bits);
        PointEdges edges = EDGES_AT(rows, i);
        ShaftDecision decision = decide_light_of_point(&edges, d);
#ifdef GN_CUT_OUTS
        if ((ids[i] & SHAFT_MASKED) != 0u) decision.blocked = 0;
#endif
        if (decision.blocked != 0)
            is_open = false;
        else if (decision.missed == 0)
            queue_pairs_of_point(work, 1u << light, corners, i, ids[i], scene, mine);
    }
    work->open = group_bits(is_open ? -1 : 0, shared);
#endif
    return tests;
}

// Walks the shaft to the open lights. False where it met many triangles that are not decided for all lights at once,
// and has parts. *blocking: a leaf whose triangles block rays of the shaft; first, that of the last shaft, since
// neighbouring points are often in the same shadow.
GN_INLINE_ON_CPU bool walk_point_shaft(PointWork* work, float3 normal, __global const LightBundle* bundle,
                                       const ShaftScene* scene, uint* blocking, Reservation* mine SHARED_PARAMETER) {
    Shaft shaft = shaft_of_point(work->p, normal, scene->rounding, cone_of(bundle, work->open));
    SHAFT_BEGIN_STACK(stack);
    uint top = 1u, tests = 0u;
    if (*blocking != 0u) SHAFT_PUSH(stack, top, *blocking);
    while (top != 0u && work->open != 0u) {
        uint code = stack[--top], before = work->open;
        if ((code & SHAFT_LEAF) == 0u) {
            top = push_children_in_shaft(stack, top, code, &shaft, scene SHARED);
            continue;
        }
        tests += test_leaf(work, bundle, &shaft, code & ~SHAFT_LEAF, scene, mine SHARED);
        if (work->open != before) {
            *blocking = code;
            // A shaft to the lights in one part of the bundle is thinner.
            __global const LightCone* cone = cone_of(bundle, work->open);
            if (cone != shaft.cone) shaft = shaft_of_point(work->p, normal, scene->rounding, cone);
        }
        if (tests > TESTS_WORTH_PARTS && lower_lights(work->open) != 0u) return false;
    }
    return true;
}

// Shafts to parts of the bundle take the place of one that meets many triangles, of which each blocks few of its rays.
GN_INLINE_ON_CPU void trace_point_shaft(PointWork* work, float3 normal, __global const LightBundle* bundle,
                                        const ShaftScene* scene, uint* blocking, Reservation* mine SHARED_PARAMETER) {
    uint waiting[LIGHT_PART_LEVELS], count = 0u, lit = 0u;
    for (;;) {
        if (!walk_point_shaft(work, normal, bundle, scene, blocking, mine SHARED)) {
            uint lower = lower_lights(work->open);
            waiting[count++] = work->open & ~lower;
            work->open = lower;
            continue;
        }
        lit |= work->open;
        if (count == 0u) break;
        work->open = waiting[--count];
    }
    work->open = lit;
}

__kernel void point_shaft_trace(const ShaftParams params, __global const LightBundle* bundles,
                                __global const float* nodes, __global const float* leaves, __global const uint* ids,
                                __global const float* positions, __global const uint* receivers,
                                __global const float* surface_normals, __global uint* masks, __global ShaftPairs* queue,
                                __global ShaftCounters* counters, __local uint* shared) {
    ShaftScene scene = {nodes, leaves, ids, queue, params.queue_capacity, params.rounding, counters};
    Reservation mine = no_reservation();
    uint first = params.points.first / 3u, blocks = (params.points.count + SHAFT_WIDTH - 1u) / SHAFT_WIDTH;
    SHAFT_FOR_EACH(task, (size_t)blocks * params.bundle_count) {
        uint bundle = (uint)(task / blocks), point = (uint)(task % blocks) * SHAFT_WIDTH, blocking = 0u;
        for (uint end = min(point + SHAFT_WIDTH, params.points.count); point < end; ++point) {
            __global uint* mask = &masks[bundle * (size_t)params.mask_stride + point];
            PointWork work = {load_point(positions, params.points, point), *mask, GN_NO_ID, point, bundle};
            if (work.open == 0u || !is_present(work.p)) continue;
            if (params.points.has_receivers != 0u) work.receiver = receivers[first + point];
            trace_point_shaft(&work, vload3(first + point, surface_normals), &bundles[bundle], &scene, &blocking,
                              &mine SHARED);
#if GN_LANES == 1
            barrier(CLK_GLOBAL_MEM_FENCE);  // all items have read the mask
            if (get_local_id(0) != 0) continue;
#endif
            *mask = work.open;
        }
    }
    close_queue(&mine, &scene);
}
