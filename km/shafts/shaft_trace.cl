// SPDX-License-Identifier: MIT
// The trace of shafts (shaft.h): for each block of points and each bundle of lights, the tree's triangles, near ones
// first, until no pair is open. A pair that the filter leaves undecided is queued; shaft_exact decides it.
#include "exact/decide_pair.clh"
#include "shafts/point_shaft.clh"

// Nodes and leaves that the shaft of a block may visit: some five for each of its points on a CPU, as many as their own
// shafts would. After that each open point has its own; on a GPU in a launch of its own, point_shaft_trace, so that no
// group takes much longer than the others.
#if GN_LANES > 1
#define BLOCK_VISITS 200u
#else
#define BLOCK_VISITS 96u
#endif

// What one work-item, or group, works on.
typedef struct ShaftWork {
    PointBlock points;
    LaneInt receivers;
    LaneInt open;   // the lights of the bundle that are not yet dark
    float3 normal;  // of the surface, nearly, coordinates at most 1; zero if there is none
    size_t block;
    uint bundle;
} ShaftWork;

// A triangle of a leaf that may block rays of the block.
typedef struct LeafTriangle {
    __global const float* leaf;
    uint i, id;
    bool is_masked;
    LaneTriangles in_lanes;  // the same in all lanes
} LeafTriangle;

static void queue_pairs_of_lane(const ShaftWork* work, int lane, uint undecided, const LeafTriangle* triangle,
                                const ShaftScene* scene, Reservation* mine) {
    uint point = (uint)(work->block * SHAFT_WIDTH) + SHAFT_LANE(lane);
    ShaftTriangle t = shaft_triangle(triangle->leaf, triangle->i);
    queue_pairs((ShaftPairs){point, work->bundle, triangle->id, undecided}, &t, lane_point(work->points, lane), scene,
                mine);
}

// From so many points on, the triangle is first tested against the cones of 16 points at once.
#define POINTS_WORTH_CONES 8u

#if GN_LANES > 1
// A bundle of so many lights or fewer: each light is tested for all points of the block at once.
#define FEW_LIGHTS 8u

GN_INLINE_ON_CPU void test_few_lights(ShaftWork* work, __global const LightBundle* bundle, const LeafTriangle* triangle,
                                      LaneInt lanes, const ShaftScene* scene, Reservation* mine) {
    ShaftEdges edges = edges_of(&triangle->in_lanes, work->points);
    for (uint l = 0; l < bundle->light_count; ++l) {
        LaneInt open = lanes & -((work->open >> (int)l) & 1);
        if (!LANES_ANY(open)) continue;
        ShaftDecision decision = decide_light(&edges, light_direction(bundle, l));
        if (!triangle->is_masked) work->open &= ~(decision.blocked & open & (int)(1u << l));
        LaneInt undecided = open & ~decision.missed;
        if (!triangle->is_masked) undecided &= ~decision.blocked;
        for (uint bits = lane_bits(undecided); bits != 0u;)
            queue_pairs_of_lane(work, take_lane(&bits), 1u << l, triangle, scene, mine);
    }
}
#endif

// The open lights of one point of the block that a triangle blocks, by its edges as that point sees them.
GN_INLINE_ON_CPU uint lights_blocked(const ShaftWork* work, __global const LightBundle* bundle, int lane, uint open,
                                     const PointEdges* edges, const LeafTriangle* triangle, const ShaftScene* scene,
                                     Reservation* mine) {
    LightDecision decision = decide_lights(edges, bundle, open);
    if (triangle->is_masked) decision = (LightDecision){0u, decision.dark | decision.undecided};
    if (decision.undecided != 0u) queue_pairs_of_lane(work, lane, decision.undecided, triangle, scene, mine);
    return decision.dark;
}

// Tests a triangle against all open pairs of the block and the bundle. `lanes`: the points whose rays it may meet.
GN_INLINE_ON_CPU void test_triangle(ShaftWork* work, __global const LightBundle* bundle,
                                    __global const LightCone* cone_of_open, const LeafTriangle* triangle, LaneInt lanes,
                                    const ShaftScene* scene, Reservation* mine) {
#if GN_LANES > 1
    if (bundle->light_count <= FEW_LIGHTS) {
        test_few_lights(work, bundle, triangle, lanes, scene, mine);
        return;
    }
#endif
    ShaftEdges e = edges_of(&triangle->in_lanes, work->points);
    uint bits = lane_bits(lanes);
    if (GN_LANES == 1 || popcount(bits) >= POINTS_WORTH_CONES) {
        ShaftDecision cone = decide_cone(&e, cone_of_open);
        if (triangle->is_masked) cone.blocked = (LaneInt)(0);
        work->open &= ~(cone.blocked & lanes);
        bits = lane_bits(lanes & ~(cone.blocked | cone.missed));
        if (bits == 0u) return;
    }
#if GN_LANES > 1
    EDGE_ROWS_OF_LEAF(rows);
    PUT_EDGES(rows, e);
    uint open[GN_LANES];
    vstore16(as_uint16(work->open), 0, open);
    LaneInt dark = (LaneInt)(0);  // lane by lane a CPU would wait for its stores
    while (bits != 0u) {
        int lane = take_lane(&bits);
        PointEdges edges = EDGES_AT(rows, lane);
        uint blocked = lights_blocked(work, bundle, lane, open[lane], &edges, triangle, scene, mine);
        dark |= LANE_COMPARE(LANE_INDEX, ==, (LaneInt)(lane)) & (int)blocked;
    }
    work->open &= ~dark;
#else
    PointEdges edges = {(float3)(e.ab.x, e.ab.y, e.ab.z), (float3)(e.bc.x, e.bc.y, e.bc.z),
                        (float3)(e.ca.x, e.ca.y, e.ca.z), e.bound, e.sided != 0};
    work->open &= ~(int)lights_blocked(work, bundle, 0, (uint)work->open, &edges, triangle, scene, mine);
#endif
}

// Tests the triangles of a leaf that the shaft may meet.
GN_INLINE_ON_CPU void test_leaf(ShaftWork* work, __global const LightBundle* bundle, const BlockShaft* shaft, uint leaf,
                                const ShaftScene* scene, Reservation* mine SHARED_PARAMETER) {
    LeafTriangle triangle;
    triangle.leaf = scene->leaves + (size_t)leaf * (SHAFT_LEAF_ROWS * SHAFT_WIDTH);
    triangle.is_masked = false;
    __global const uint* ids = scene->ids + (size_t)leaf * SHAFT_WIDTH;
    ShaftHits hits = triangles_in_shaft(triangle.leaf, &shaft->all);
    SHARE_LEAST(hits);
    uint bits = SHAFT_BITS(hits.some);
    if (bits == 0u) return;
    PUT_TRIANGLES(triangle_rows, triangle.leaf);
    while (bits != 0u) {
        triangle.i = take_lowest_bit(&bits);
        triangle.id = ids[triangle.i];
#ifdef GN_CUT_OUTS
        triangle.is_masked = (triangle.id & SHAFT_MASKED) != 0u;
        triangle.id &= ~SHAFT_MASKED;
#endif
        LaneInt lanes =
            LANE_COMPARE(work->open, !=, (LaneInt)(0)) & LANE_COMPARE(work->receivers, !=, (LaneInt)((int)triangle.id));
#pragma unroll
        for (uint k = 0; k < 6u; ++k)
            lanes &= LANE_COMPARE((LaneFloat)(LEAST_OF(hits, k, triangle.i)), <=, shaft->point_limits[k]);
        if (lane_bits(lanes) == 0u) continue;
        triangle.in_lanes = TRIANGLE_AT(triangle_rows, triangle.leaf, triangle.i);
        test_triangle(work, bundle, shaft->all.cone, &triangle, lanes, scene, mine);
    }
}

#if GN_LANES > 1
#define ANY_OPEN(work) LANES_ANY((work)->open)
#else
#define ANY_OPEN(work) (group_bits((work)->open != 0, shared) != 0u)
#endif

static BlockShaft shaft_of_open(const ShaftWork* work, uint lights, const ShaftScene* scene,
                                __global const LightBundle* bundle SHARED_PARAMETER) {
    return shaft_of_points(&work->points, LANE_COMPARE(work->open, !=, (LaneInt)(0)), work->normal, scene->rounding,
                           cone_of(bundle, lights) SHARED);
}

// Walks the block's shaft. False if it gave up after so many nodes and leaves.
GN_INLINE_ON_CPU bool walk_shaft(ShaftWork* work, uint most_visits, __global const LightBundle* bundle,
                                 const ShaftScene* scene, uint* blocking, Reservation* mine SHARED_PARAMETER) {
    BlockShaft shaft = shaft_of_open(work, SHAFT_ANY_BIT(work->open), scene, bundle SHARED);
    SHAFT_BEGIN_STACK(stack);
    uint top = 1u, visits = 0u, open_points = SHAFT_BITS(LANE_COMPARE(work->open, !=, (LaneInt)(0)));
    SHAFT_PUSH_BLOCKING(stack, top, blocking);
    while (top != 0u) {
        uint code = stack[--top];
        if (visits++ == most_visits) return false;
        if ((code & SHAFT_LEAF) == 0u) {
            top = push_children_in_shaft(stack, top, code, &shaft.all, scene SHARED);
            continue;
        }
        test_leaf(work, bundle, &shaft, code & ~SHAFT_LEAF, scene, mine SHARED);
        uint still_open = SHAFT_BITS(LANE_COMPARE(work->open, !=, (LaneInt)(0)));
        // Also a leaf after the one that blocked: it is near, and to note the blocking ones alone takes as long.
        if (still_open != open_points) note_blocking(blocking, code);
        if (still_open == 0u) return true;
        // A shaft of fewer points, or of the lights in one part of the bundle, is thinner.
        uint lights = SHAFT_ANY_BIT(work->open);
        if (2u * popcount(still_open) > popcount(open_points) && cone_of(bundle, lights) == shaft.all.cone) continue;
        open_points = still_open;
        shaft = shaft_of_open(work, lights, scene, bundle SHARED);
    }
    return true;
}

#if GN_LANES > 1
// So many blocks that give up, one after the other, are enough to know that the next will; one in so many is tried.
#define BLOCKS_TO_LEARN 4u

// Decides a block: neighbouring blocks are alike, and where some gave up, most go by points at once.
GN_INLINE_ON_CPU void trace_block(ShaftWork* work, __global const LightBundle* bundle,
                                  __global const float* surface_normals, const ShaftScene* scene, uint* gave_up,
                                  uint* blocking, Reservation* mine) {
    if (*gave_up < BLOCKS_TO_LEARN || work->block % BLOCKS_TO_LEARN == 0u) {
        bool ended = walk_shaft(work, BLOCK_VISITS, bundle, scene, blocking, mine);
        *gave_up = ended ? 0u : *gave_up + 1u;
        if (ended) return;
    }
    for (uint bits = lane_bits(LANE_COMPARE(work->open, !=, (LaneInt)(0))); bits != 0u;) {
        int lane = take_lane(&bits);
        uint i = (uint)(work->block * SHAFT_WIDTH) + (uint)lane;
        PointWork point = {lane_point(work->points, lane), (uint)LANE_OF_INT(work->open, lane),
                           (uint)LANE_OF_INT(work->receivers, lane), i, work->bundle};
        PointPlane plane = {vload3(i, surface_normals), false, 0.0f};
        trace_point_shaft(&point, plane, bundle, scene, blocking, mine);
        LANE_OF_INT(work->open, lane) = (int)point.open;
    }
}
#else
// One task in so many is always tried. Where too many of these gave up, the others go by points at once.
#define TASKS_A_TRY 16u
#define TRIES_TO_LEARN 256u

// Whether so many blocks of this launch give up that all walks take more than the others save. (A terrain's vertices:
// half of them, 803 M pairs/s by points, 613 by blocks; all other scenes: 3 to 20 %, and blocks are faster.)
static bool are_blocks_too_large(__global ShaftCounters* counters) {
    uint tried = GN_RELAXED_LOAD((volatile __global uint*)&counters->tried);
    return tried >= TRIES_TO_LEARN && GN_RELAXED_LOAD((volatile __global uint*)&counters->gave_up) > tried / 5u * 2u;
}

// Decides a block, or leaves its task to point_shaft_trace.
static void trace_block(ShaftWork* work, uint task, __global const LightBundle* bundle, const ShaftScene* scene,
                        uint* blocking, Reservation* mine SHARED_PARAMETER) {
    bool is_first = get_local_id(0) == 0, is_try = task % TASKS_A_TRY == 0u;
    uint most_visits = BLOCK_VISITS;
    if (group_bits(is_first && !is_try && are_blocks_too_large(scene->counters), shared) != 0u) most_visits = 0u;
    bool ended = walk_shaft(work, most_visits, bundle, scene, blocking, mine SHARED);
    if (is_first && is_try) {
        atomic_inc(&scene->counters->tried);
        if (!ended) atomic_inc(&scene->counters->gave_up);
    }
    if (is_first && !ended) TASKS_LEFT(scene->counters)[atomic_inc(&scene->counters->left_to_points)] = task;
}
#endif

// The points of a block, in the order of the lanes, and their open lights.
static ShaftWork load_work(const ShaftParams params, size_t block, uint bundle, __global const float* positions,
                           __global const uint* receivers, __global const float* surface_normals,
                           __global const uint* masks) {
    ShaftWork work;
    work.block = block;
    work.bundle = bundle;
    size_t first = block * SHAFT_WIDTH;
#if GN_LANES > 1
    LaneInt valid = valid_lanes(params.points, block);
    work.points = load_block(positions, params.points, block);
    work.receivers = (LaneInt)(-1);
    __global const uint* mask = masks + bundle * (size_t)params.mask_stride + first;
    work.open = as_int16(vload16(0, mask));
    if (params.points.has_receivers != 0u)
        work.receivers = as_int16(vload16(0, receivers + params.points.first / 3u + first));
#else
    uint i = (uint)first + get_local_id(0);
    bool is_valid = i < params.points.count;
    LaneInt valid = is_valid ? -1 : 0;
    float3 p = load_point(positions, params.points, is_valid ? i : 0u);
    work.points = (PointBlock){p.x, p.y, p.z};
    work.open = (int)masks[bundle * (size_t)params.mask_stride + i];
    work.receivers = params.points.has_receivers != 0u && is_valid ? (int)receivers[params.points.first / 3u + i] : -1;
#endif
    work.open &= valid & present_lanes(work.points);
    // Of the block's middle point.
    work.normal = vload3(params.points.first / 3u + min((uint)first + SHAFT_WIDTH / 2u, params.points.count - 1u),
                         surface_normals);
    return work;
}

__kernel void shaft_trace(const ShaftParams params, __global const LightBundle* bundles, __global const float* nodes,
                          __global const float* leaves, __global const uint* ids, __global const float* positions,
                          __global const uint* receivers, __global const float* surface_normals, __global uint* masks,
                          __global ShaftPairs* queue, __global ShaftCounters* counters, __local uint* shared) {
    ShaftScene scene = {nodes, leaves, ids, queue, params.queue_capacity, params.rounding, counters};
    Reservation mine = no_reservation();
    uint blocks = (params.points.count + SHAFT_WIDTH - 1u) / SHAFT_WIDTH, blocking[BLOCKING_LEAVES] = {0u};
#if GN_LANES > 1
    __global const float* normals = surface_normals + params.points.first;
    uint gave_up = 0u;
#endif
    SHAFT_FOR_EACH(task, (size_t)blocks * params.bundle_count) {
        uint bundle = (uint)(task / blocks);
        ShaftWork work = load_work(params, task % blocks, bundle, positions, receivers, surface_normals, masks);
        LaneInt before = work.open;
        if (!ANY_OPEN(&work)) continue;
#if GN_LANES > 1
        trace_block(&work, &bundles[bundle], normals, &scene, &gave_up, blocking, &mine);
#else
        trace_block(&work, (uint)task, &bundles[bundle], &scene, blocking, &mine SHARED);
#endif
        LaneInt dark = before & ~work.open;
        __global uint* mask = masks + bundle * (size_t)params.mask_stride + work.block * SHAFT_WIDTH;
#if GN_LANES > 1
        vstore16(vload16(0, mask) & ~as_uint16(dark), 0, mask);
#else
        mask[get_local_id(0)] &= ~(uint)dark;
#endif
    }
    close_queue(&mine, &scene);
}

// Decides the queued pairs on the triangles' own vertices. Several entries may name one point and bundle.
__kernel void shaft_exact(const ShaftParams params, __global const LightBundle* bundles, __global const float* vertices,
                          __global const float* positions, __global const ShaftPairs* queue,
                          volatile __global uint* masks, __global ShaftCounters* counters) {
    Triangles triangles = triangles_of(vertices, params.triangles);
    uint by_level[3] = {0, 0, 0};
    GN_FOR_EACH(i, min(counters->queued, params.queue_capacity)) {
        ShaftPairs pairs = queue[i];
        if (pairs.lights == 0u) continue;
        volatile __global uint* mask = &masks[pairs.bundle * (size_t)params.mask_stride + pairs.point];
        float3 p = load_point(positions, params.points, pairs.point);
        uint dark = 0u;
        for (uint lights = pairs.lights & GN_RELAXED_LOAD(mask); lights != 0u;) {
            uint l = take_lowest_bit(&lights);
            float4 light = (float4)(light_direction(&bundles[pairs.bundle], l), 0.0f);
            int level;
            if (decide_pair(triangles, pairs.triangle, p, light, &level)) dark |= 1u << l;
            ++by_level[level];
        }
        if (dark != 0u) atomic_and(mask, ~dark);
    }
    for (uint level = 0; level < 3u; ++level)
        if (by_level[level] != 0u) atomic_add(&counters->by_level[level], by_level[level]);
}
