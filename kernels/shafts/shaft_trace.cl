// SPDX-License-Identifier: MIT
// Traces shafts (shaft.h): for each block of points and each bundle of lights, walks the BVH, near boxes first, until
// no pair is open. A pair that the filter leaves undecided is queued; shaft_exact decides it.
#include "exact/decide_pair.clh"
#include "shafts/point_shaft.clh"
#if GN_LANES > 1
#include "shafts/ray_packets.clh"
#endif

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

// A triangle that may meet the rays of this many points is first tested against the cone, for all points at once.
#define POINTS_WORTH_CONES 8u

#if GN_LANES > 1
// In a bundle of at most this many lights, each light is tested for all points of the block at once.
#define FEW_LIGHTS 8u

GN_INLINE_ON_CPU void test_few_lights(ShaftWork* work, __global const LightBundle* bundle, const LeafTriangle* triangle,
                                      float reach, LaneInt lanes, const ShaftScene* scene, Reservation* mine) {
    ShaftEdges edges = edges_of(&triangle->in_lanes, work->points, reach);
    for (uint l = 0; l < bundle->light_count; ++l) {
        LaneInt open = lanes & -((work->open >> (int)l) & 1);
        if (!LANES_ANY(open)) continue;
        ShaftDecision decision = decide_light(&edges, lanes_to_light(light_direction(bundle, l), work->points));
        if (!triangle->is_masked) work->open &= ~(decision.blocked & open & (int)(1u << l));
        LaneInt undecided = open & ~decision.missed;
        if (!triangle->is_masked) undecided &= ~decision.blocked;
        for (uint bits = lane_bits(undecided); bits != 0u;)
            queue_pairs_of_lane(work, take_lane(&bits), 1u << l, triangle, scene, mine);
    }
}
#endif

// The open lights of one point of the block that a triangle certainly blocks; undecided pairs are queued.
GN_INLINE_ON_CPU uint lights_blocked(const ShaftWork* work, __global const LightBundle* bundle, int lane, uint open,
                                     const PointEdges* edges, const LeafTriangle* triangle, const ShaftScene* scene,
                                     Reservation* mine) {
    LightDecision decision = decide_lights(edges, lane_point(work->points, lane), bundle, open);
    if (triangle->is_masked) decision = (LightDecision){0u, decision.dark | decision.undecided};
    if (decision.undecided != 0u) queue_pairs_of_lane(work, lane, decision.undecided, triangle, scene, mine);
    return decision.dark;
}

// Tests a triangle against all open pairs of the block and the bundle. `lanes`: the points whose rays it may meet.
GN_INLINE_ON_CPU void test_triangle(ShaftWork* work, __global const LightBundle* bundle, const Shaft* shaft,
                                    const LeafTriangle* triangle, LaneInt lanes, const ShaftScene* scene,
                                    Reservation* mine) {
#if GN_LANES > 1
    if (bundle->light_count <= FEW_LIGHTS) {
        test_few_lights(work, bundle, triangle, REACH_OF(shaft), lanes, scene, mine);
        return;
    }
#endif
    ShaftEdges e = edges_of(&triangle->in_lanes, work->points, REACH_OF(shaft));
    uint bits = lane_bits(lanes);
    if (GN_LANES == 1 || popcount(bits) >= POINTS_WORTH_CONES) {
        ShaftDecision cone = decide_cone(&e, work->points, shaft->cone);
        if (triangle->is_masked) cone.blocked = (LaneInt)(0);
        work->open &= ~(cone.blocked & lanes);
        bits = lane_bits(lanes & ~(cone.blocked | cone.missed));
        if (bits == 0u) return;
    }
#if GN_LANES > 1
    EDGE_ROWS_OF_LEAF(rows);
    STORE_EDGES(rows, e);
    uint open[GN_LANES];
    vstore16(as_uint16(work->open), 0, open);
    LaneInt dark = (LaneInt)(0);  // a CPU would wait for stores to single lanes
    while (bits != 0u) {
        int lane = take_lane(&bits);
        PointEdges edges = LOAD_EDGES(rows, lane);
        uint blocked = lights_blocked(work, bundle, lane, open[lane], &edges, triangle, scene, mine);
        dark |= LANE_COMPARE(LANE_INDEX, ==, (LaneInt)(lane)) & (int)blocked;
    }
    work->open &= ~dark;
#else
    PointEdges edges = {(float3)(e.ab.x, e.ab.y, e.ab.z), (float3)(e.bc.x, e.bc.y, e.bc.z),
                        (float3)(e.ca.x, e.ca.y, e.ca.z), e.bound, e.sided != 0};
#ifdef GN_POINT_LIGHTS
    edges.normal = (float3)(e.normal.x, e.normal.y, e.normal.z);
    edges.side = e.side;
#endif
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
    SHARE_MINIMA(hits);
    uint bits = SHAFT_BITS(hits.some);
    if (bits == 0u) return;
    STORE_TRIANGLES(triangle_rows, triangle.leaf);
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
            lanes &= LANE_COMPARE((LaneFloat)(MIN_OF(hits, k, triangle.i)), <=, shaft->point_limits[k]);
        if (lane_bits(lanes) == 0u) continue;
        triangle.in_lanes = TRIANGLE_AT(triangle_rows, triangle.leaf, triangle.i);
        test_triangle(work, bundle, &shaft->all, &triangle, lanes, scene, mine);
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

// Walks the block's shaft. Returns false if the walk gave up after max_visits nodes and leaves, or the shaft is wide.
GN_NOINLINE_ON_CPU bool walk_shaft(ShaftWork* work, uint max_visits, uint* visits, __global const LightBundle* bundle,
                                   const ShaftScene* scene, uint* blocking, Reservation* mine SHARED_PARAMETER) {
    BlockShaft shaft = shaft_of_open(work, SHAFT_ANY_BIT(work->open), scene, bundle SHARED);
    if (IS_WIDE(&shaft.all)) return false;
    SHAFT_BEGIN_STACK(stack);
    uint top = 1u, points_before = SHAFT_BITS(LANE_COMPARE(work->open, !=, (LaneInt)(0)));
    SHAFT_PUSH_BLOCKING(stack, top, blocking);
    while (top != 0u) {
        uint code = stack[--top];
        if ((*visits)++ == max_visits) return false;
        if ((code & SHAFT_LEAF) == 0u) {
            top = push_children_in_shaft(stack, top, code, &shaft.all, scene SHARED);
            continue;
        }
        test_leaf(work, bundle, &shaft, code & ~SHAFT_LEAF, scene, mine SHARED);
        uint still_open = SHAFT_BITS(LANE_COMPARE(work->open, !=, (LaneInt)(0)));
        // Leaves after the one that blocked are noted as well: they are near, and leaving them out takes as long.
        if (still_open != points_before) note_blocking(blocking, code);
        if (still_open == 0u) return true;
        // A shaft around fewer points, or to the lights in one part of the bundle, is thinner.
        uint lights = SHAFT_ANY_BIT(work->open);
        if (2u * popcount(still_open) > popcount(points_before) && cone_of(bundle, lights) == shaft.all.cone) continue;
        points_before = still_open;
        shaft = shaft_of_open(work, lights, scene, bundle SHARED);
    }
    return true;
}

#if GN_LANES > 1
// The time of a visit by a block's shaft, in visits by a point shaft or a packet.
#define BLOCK_VISIT 2.0f
// While shafts of blocks lose, still try 1 block in BLOCKS_A_TRY.
#define BLOCKS_A_TRY 4u
// Among the blocks that are traced separately, by points or packets, 1 in APARTS_A_TRY uses the method with the worse
// average, to keep its average fresh.
#define APARTS_A_TRY 128u

// Averages that a work-item keeps over the blocks before: neighbouring blocks are alike.
typedef struct BlockMemory {
    float visits_of_point, visits_of_packet;  // visits by one point shaft; by one packet
    float gain;                               // the visits that a block's shaft saves
    uint blocks_apart;
    uint blocking[BLOCKING_LEAVES];
    PacketMemory packets;
} BlockMemory;

static void begin_memory(BlockMemory* memory) {
    memory->visits_of_point = memory->visits_of_packet = 16.0f;
    memory->gain = 0.0f;
    memory->blocks_apart = 0u;
    for (uint k = 0; k < BLOCKING_LEAVES; ++k) memory->blocking[k] = 0u;
    forget_blocking(&memory->packets);
}

static void note(float* average, float value) { *average += (value - *average) * 0.125f; }

static uint open_points(const ShaftWork* work) {
    return popcount(lane_bits(LANE_COMPARE(work->open, !=, (LaneInt)(0))));
}

// The visits that a block's open pairs are expected to take by point shafts, and by packets.
static float visits_by_points(const ShaftWork* work, const BlockMemory* memory) {
    return memory->visits_of_point * (float)open_points(work);
}
static float visits_by_packets(const ShaftWork* work, const BlockMemory* memory) {
    return memory->visits_of_packet * (float)popcount(SHAFT_ANY_BIT(work->open));
}

// Traces a block's open points by point shafts. Returns the number of nodes and leaves that they visit.
GN_NOINLINE_ON_CPU uint trace_points(ShaftWork* work, __global const LightBundle* bundle,
                                     __global const float* surface_normals, const ShaftScene* scene, uint* blocking,
                                     Reservation* mine) {
    uint visits = 0u;
    for (uint bits = lane_bits(LANE_COMPARE(work->open, !=, (LaneInt)(0))); bits != 0u;) {
        int lane = take_lane(&bits);
        uint i = (uint)(work->block * SHAFT_WIDTH) + (uint)lane;
        PointWork point = {lane_point(work->points, lane),
                           (uint)LANE_OF_INT(work->open, lane),
                           (uint)LANE_OF_INT(work->receivers, lane),
                           i,
                           work->bundle,
                           0u};
        PointPlane plane = {vload3(i, surface_normals), false, 0.0f};
        trace_point_shaft(&point, plane, bundle, scene, blocking, mine);
        LANE_OF_INT(work->open, lane) = (int)point.open;
        visits += point.visits;
    }
    return visits;
}

// Traces the block as one shaft; gives up once that has cost as much as tracing its points or lights separately is
// expected to. Returns false if it gave up, or if BLOCKS_A_TRY leaves the block out.
GN_INLINE_ON_CPU bool try_block(ShaftWork* work, __global const LightBundle* bundle, const ShaftScene* scene,
                                BlockMemory* memory, Reservation* mine) {
    if (memory->gain < 0.0f && work->block % BLOCKS_A_TRY != 0u) return false;
    float before = fmin(visits_by_points(work, memory), visits_by_packets(work, memory));
    uint most = (uint)clamp(before / BLOCK_VISIT, 4.0f, 400.0f), visits = 0u;
    bool ended = walk_shaft(work, most, &visits, bundle, scene, memory->blocking, mine);
    float after = ended ? 0.0f : fmin(visits_by_points(work, memory), visits_by_packets(work, memory));
    note(&memory->gain, before - after - BLOCK_VISIT * (float)visits);
    return ended;
}

// Decides a block by its shaft or by point shafts. Returns false if it leaves the block to packets, which took fewer
// visits for earlier blocks.
GN_INLINE_ON_CPU bool trace_block(ShaftWork* work, __global const LightBundle* bundle,
                                  __global const float* surface_normals, const ShaftScene* scene, BlockMemory* memory,
                                  Reservation* mine) {
    if (try_block(work, bundle, scene, memory, mine)) return true;
    bool by_packets = visits_by_packets(work, memory) < visits_by_points(work, memory);
    bool is_try = ++memory->blocks_apart % APARTS_A_TRY == 0u;
    if (by_packets != is_try) return false;
    float points = (float)open_points(work);
    note(&memory->visits_of_point,
         (float)trace_points(work, bundle, surface_normals, scene, memory->blocking, mine) / points);
    return true;
}

GN_INLINE_ON_CPU void trace_blocks_left(ShaftWork* left, uint count, __global const LightBundle* bundle,
                                        const ShaftScene* scene, BlockMemory* memory, Reservation* mine) {
    float packets = 0.0f;
    for (uint k = 0; k < count; ++k) packets += (float)popcount(SHAFT_ANY_BIT(left[k].open));
    note(&memory->visits_of_packet, (float)trace_packets(left, count, bundle, scene, &memory->packets, mine) / packets);
}
#else
// The number of nodes and leaves that a block's shaft may visit. After that each open point has a shaft of its own, in
// a second launch, point_shaft_trace, so that no group takes much longer than the others.
#define BLOCK_VISITS 96u
// 1 task in TASKS_A_TRY is always tried. If too many tries give up, the other tasks go straight to point shafts.
#define TASKS_A_TRY 16u
#define TRIES_TO_LEARN 256u

// True if blocks of this launch give up so often that all walks together cost more than the successful ones save. (On a
// terrain's vertices half of the blocks give up: 803 M pairs/s by points, 613 by blocks. In all other scenes 3 to 20 %
// give up, and blocks are faster.)
static bool are_blocks_too_large(__global ShaftCounters* counters) {
    uint tried = GN_RELAXED_LOAD((volatile __global uint*)&counters->tried);
    return tried >= TRIES_TO_LEARN && GN_RELAXED_LOAD((volatile __global uint*)&counters->gave_up) > tried / 5u * 2u;
}

// Decides a block, or leaves its task to point_shaft_trace.
static void trace_block(ShaftWork* work, uint task, __global const LightBundle* bundle, const ShaftScene* scene,
                        uint* blocking, Reservation* mine SHARED_PARAMETER) {
    bool is_first = get_local_id(0) == 0, is_try = task % TASKS_A_TRY == 0u;
    uint max_visits = BLOCK_VISITS, visits = 0u;
    if (group_bits(is_first && !is_try && are_blocks_too_large(scene->counters), shared) != 0u) max_visits = 0u;
    bool ended = walk_shaft(work, max_visits, &visits, bundle, scene, blocking, mine SHARED);
    if (is_first && is_try) {
        atomic_inc(&scene->counters->tried);
        if (!ended) atomic_inc(&scene->counters->gave_up);
    }
    if (is_first && !ended) TASKS_LEFT(scene->counters)[atomic_inc(&scene->counters->left_to_points)] = task;
}
#endif

// Loads the points of a block, in the order of the lanes, and their open lights.
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
    work.given = work.open &= valid & present_lanes(work.points);
    // The normal at the block's middle point.
    work.normal = vload3(params.points.first / 3u + min((uint)first + SHAFT_WIDTH / 2u, params.points.count - 1u),
                         surface_normals);
    return work;
}

// Clears the dark lights in the masks of a block.
static void store_dark(const ShaftParams params, const ShaftWork* work, __global uint* masks) {
    LaneInt dark = work->given & ~work->open;
    __global uint* mask = masks + work->bundle * (size_t)params.mask_stride + work->block * SHAFT_WIDTH;
#if GN_LANES > 1
    vstore16(vload16(0, mask) & ~as_uint16(dark), 0, mask);
#else
    mask[get_local_id(0)] &= ~(uint)dark;
#endif
}

// On a CPU a work-item takes PACKET_BLOCKS neighbouring blocks at a time, which share packets if left to these.
__kernel void shaft_trace(const ShaftParams params, __global const LightBundle* bundles, __global const float* nodes,
                          __global const float* leaves, __global const uint* ids, __global const float* positions,
                          __global const uint* receivers, __global const float* surface_normals, __global uint* masks,
                          __global ShaftPairs* queue, __global ShaftCounters* counters, __local uint* shared) {
    ShaftScene scene = {nodes, leaves, ids, queue, params.queue_capacity, params.rounding, counters};
    Reservation mine = no_reservation();
    uint blocks = (params.points.count + SHAFT_WIDTH - 1u) / SHAFT_WIDTH;
#if GN_LANES > 1
    uint groups = (blocks + PACKET_BLOCKS - 1u) / PACKET_BLOCKS;
    __global const float* normals = surface_normals + params.points.first;
    BlockMemory memory;
    begin_memory(&memory);
    GN_FOR_EACH(task, (size_t)groups * params.bundle_count) {
        uint index = (uint)(task / groups), block = (uint)(task % groups) * PACKET_BLOCKS, left_count = 0u;
        __global const LightBundle* bundle = &bundles[index];
        ShaftWork left[PACKET_BLOCKS];
        for (uint end = min(block + PACKET_BLOCKS, blocks); block < end; ++block) {
            ShaftWork work = load_work(params, block, index, positions, receivers, surface_normals, masks);
            if (!ANY_OPEN(&work)) continue;
            if (params.are_packets == 0u && trace_block(&work, bundle, normals, &scene, &memory, &mine))
                store_dark(params, &work, masks);
            else
                left[left_count++] = work;
        }
        if (left_count != 0u) trace_blocks_left(left, left_count, bundle, &scene, &memory, &mine);
        for (uint k = 0; k < left_count; ++k) store_dark(params, &left[k], masks);
    }
#else
    uint blocking[BLOCKING_LEAVES] = {0u};
    SHAFT_FOR_EACH(task, (size_t)blocks * params.bundle_count) {
        uint bundle = (uint)(task / blocks);
        ShaftWork work = load_work(params, task % blocks, bundle, positions, receivers, surface_normals, masks);
        if (!ANY_OPEN(&work)) continue;
        trace_block(&work, (uint)task, &bundles[bundle], &scene, blocking, &mine SHARED);
        store_dark(params, &work, masks);
    }
#endif
    close_queue(&mine, &scene);
}

// The lights' fourth homogeneous coordinate.
#ifdef GN_POINT_LIGHTS
#define LIGHT_W 1.0f
#else
#define LIGHT_W 0.0f
#endif

// Decides the queued pairs by the exact predicate on the triangles' own vertices. Several entries may name one point
// and bundle.
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
            float4 light = (float4)(light_direction(&bundles[pairs.bundle], l), LIGHT_W);
            int level;
            if (decide_pair(triangles, pairs.triangle, p, light, &level)) dark |= 1u << l;
            ++by_level[level];
        }
        if (dark != 0u) atomic_and(mask, ~dark);
    }
    for (uint level = 0; level < 3u; ++level)
        if (by_level[level] != 0u) atomic_add(&counters->by_level[level], by_level[level]);
}
