// SPDX-License-Identifier: MIT
// Traces beams (beam.h): for each block of points and each bundle of lights, walks the BVH, near boxes first, until
// no pair is open. A pair that the filter leaves undecided is queued; beam_exact decides it.
#include "beams/point_beam.clh"
#include "exact/decide_pair.clh"
#if GN_LANES > 1
#include "packets/ray_packets.clh"
#endif

// A triangle of a leaf that may block rays of the block.
typedef struct LeafTriangle {
    __global const float* leaf;
    uint i, id;
    bool is_masked;
    LaneTriangles in_lanes;  // the same in all lanes
} LeafTriangle;

static void queue_pairs_of_lane(const BeamWork* work, int lane, uint undecided, const LeafTriangle* triangle,
                                const BeamScene* scene, Reservation* mine) {
    uint point = (uint)(work->block * BVH_WIDTH) + BEAM_LANE(lane);
    BeamTriangle t = beam_triangle(triangle->leaf, triangle->i);
    queue_pairs((BeamPairs){point, work->bundle, triangle->id, undecided}, &t, lane_point(work->points, lane), scene,
                mine);
}

// A triangle that may meet the rays of this many points is first tested against the cone, for all points at once.
#define POINTS_WORTH_CONES 8u

#if GN_LANES > 1
// In a bundle of at most this many lights, each light is tested for all points of the block at once.
#define FEW_LIGHTS 8u

GN_INLINE_ON_CPU void test_few_lights(BeamWork* work, __global const LightBundle* bundle, const LeafTriangle* triangle,
                                      float reach, LaneInt lanes, const BeamScene* scene, Reservation* mine) {
    BeamEdges edges = edges_of(&triangle->in_lanes, work->points, reach);
    for (uint l = 0; l < bundle->light_count; ++l) {
        LaneInt open = lanes & -((work->open >> (int)l) & 1);
        if (!LANES_ANY(open)) continue;
        BeamDecision decision = decide_light(&edges, lanes_to_light(light_direction(bundle, l), work->points));
        if (!triangle->is_masked) work->open &= ~(decision.blocked & open & (int)(1u << l));
        LaneInt undecided = open & ~decision.missed;
        if (!triangle->is_masked) undecided &= ~decision.blocked;
        for (uint bits = lane_bits(undecided); bits != 0u;)
            queue_pairs_of_lane(work, take_lane(&bits), 1u << l, triangle, scene, mine);
    }
}
#endif

// The open lights of one point of the block that a triangle certainly blocks; undecided pairs are queued.
GN_INLINE_ON_CPU uint lights_blocked(const BeamWork* work, __global const LightBundle* bundle, int lane, uint open,
                                     const PointEdges* edges, const LeafTriangle* triangle, const BeamScene* scene,
                                     Reservation* mine) {
    LightDecision decision = decide_lights(edges, lane_point(work->points, lane), bundle, open);
    if (triangle->is_masked) decision = (LightDecision){0u, decision.dark | decision.undecided};
    if (decision.undecided != 0u) queue_pairs_of_lane(work, lane, decision.undecided, triangle, scene, mine);
    return decision.dark;
}

// Tests a triangle against all open pairs of the block and the bundle. `lanes`: the points whose rays it may meet.
GN_INLINE_ON_CPU void test_triangle(BeamWork* work, __global const LightBundle* bundle, const Beam* beam,
                                    const LeafTriangle* triangle, LaneInt lanes, const BeamScene* scene,
                                    Reservation* mine) {
#if GN_LANES > 1
    if (bundle->light_count <= FEW_LIGHTS) {
        test_few_lights(work, bundle, triangle, REACH_OF(beam), lanes, scene, mine);
        return;
    }
#endif
    BeamEdges e = edges_of(&triangle->in_lanes, work->points, REACH_OF(beam));
    uint bits = lane_bits(lanes);
    if (GN_LANES == 1 || popcount(bits) >= POINTS_WORTH_CONES) {
        BeamDecision cone = decide_cone(&e, work->points, beam->cone);
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

// Tests the triangles of a leaf that the beam may meet.
GN_INLINE_ON_CPU void test_leaf(BeamWork* work, __global const LightBundle* bundle, const BlockBeam* beam, uint leaf,
                                const BeamScene* scene, Reservation* mine SHARED_PARAMETER) {
    LeafTriangle triangle;
    BvhLeaf of = leaf_of(scene, leaf);
    triangle.leaf = of.corners;
    triangle.is_masked = false;
    __global const uint* ids = of.ids;
    BeamHits hits = triangles_in_beam(triangle.leaf, &beam->all);
    SHARE_MINIMA(hits);
    uint bits = BEAM_BITS(hits.some);
    if (bits == 0u) return;
    STORE_TRIANGLES(triangle_rows, triangle.leaf);
    while (bits != 0u) {
        triangle.i = take_lowest_bit(&bits);
        triangle.id = ids[triangle.i];
#ifdef GN_CUT_OUTS
        triangle.is_masked = (triangle.id & BVH_MASKED) != 0u;
        triangle.id &= ~BVH_MASKED;
#endif
        LaneInt lanes =
            LANE_COMPARE(work->open, !=, (LaneInt)(0)) & LANE_COMPARE(work->receivers, !=, (LaneInt)((int)triangle.id));
#pragma unroll
        for (uint k = 0; k < 6u; ++k)
            lanes &= LANE_COMPARE((LaneFloat)(MIN_OF(hits, k, triangle.i)), <=, beam->point_limits[k]);
        if (lane_bits(lanes) == 0u) continue;
        triangle.in_lanes = TRIANGLE_AT(triangle_rows, triangle.leaf, triangle.i);
        test_triangle(work, bundle, &beam->all, &triangle, lanes, scene, mine);
    }
}

#if GN_LANES > 1
#define ANY_OPEN(work) LANES_ANY((work)->open)
#else
#define ANY_OPEN(work) (group_bits((work)->open != 0, shared) != 0u)
#endif

static BlockBeam beam_of_open(const BeamWork* work, uint lights, const BeamScene* scene,
                              __global const LightBundle* bundle SHARED_PARAMETER) {
    return beam_of_points(&work->points, LANE_COMPARE(work->open, !=, (LaneInt)(0)), work->normal, scene->rounding,
                          cone_of(bundle, lights) SHARED);
}

// Walks the block's beam. Returns false if the walk gave up after max_visits nodes and leaves, or the beam is wide.
GN_NOINLINE_ON_CPU bool walk_beam(BeamWork* work, uint max_visits, uint* visits, __global const LightBundle* bundle,
                                  const BeamScene* scene, uint* blocking, Reservation* mine SHARED_PARAMETER) {
    BlockBeam beam = beam_of_open(work, BEAM_ANY_BIT(work->open), scene, bundle SHARED);
    if (IS_WIDE(&beam.all)) return false;
    BEAM_BEGIN_STACK(stack);
    uint top = 1u, points_before = BEAM_BITS(LANE_COMPARE(work->open, !=, (LaneInt)(0)));
    BEAM_PUSH_BLOCKING(stack, top, blocking);
    while (top != 0u) {
        uint code = stack[--top];
        if ((*visits)++ == max_visits) return false;
        if ((code & BVH_LEAF) == 0u) {
            top = push_children_in_beam(stack, top, code, &beam.all, scene SHARED);
            continue;
        }
        test_leaf(work, bundle, &beam, code & ~BVH_LEAF, scene, mine SHARED);
        uint still_open = BEAM_BITS(LANE_COMPARE(work->open, !=, (LaneInt)(0)));
        // Leaves after the one that blocked are noted as well: they are near, and leaving them out takes as long.
        if (still_open != points_before) note_blocking(blocking, code);
        if (still_open == 0u) return true;
        // A beam around fewer points, or to the lights in one part of the bundle, is thinner.
        uint lights = BEAM_ANY_BIT(work->open);
        if (2u * popcount(still_open) > popcount(points_before) && cone_of(bundle, lights) == beam.all.cone) continue;
        points_before = still_open;
        beam = beam_of_open(work, lights, scene, bundle SHARED);
    }
    return true;
}

#if GN_LANES > 1
// The time of a visit by a block's beam, in visits by a point beam or a packet.
#define BLOCK_VISIT 2.0f
// While beams of blocks lose, still try 1 block in BLOCKS_A_TRY.
#define BLOCKS_A_TRY 4u
// Among the blocks that are traced separately, by points or packets, 1 in APARTS_A_TRY uses the method with the worse
// average, to keep its average fresh.
#define APARTS_A_TRY 128u

// Averages that a work-item keeps over the blocks before: neighbouring blocks are alike.
typedef struct BlockMemory {
    float visits_of_point, visits_of_packet;  // visits by one point beam; by one packet
    float gain;                               // the visits that a block's beam saves
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

static uint open_points(const BeamWork* work) {
    return popcount(lane_bits(LANE_COMPARE(work->open, !=, (LaneInt)(0))));
}

// The visits that a block's open pairs are expected to take by point beams, and by packets.
static float visits_by_points(const BeamWork* work, const BlockMemory* memory) {
    return memory->visits_of_point * (float)open_points(work);
}
static float visits_by_packets(const BeamWork* work, const BlockMemory* memory) {
    return memory->visits_of_packet * (float)popcount(BEAM_ANY_BIT(work->open));
}

// Traces a block's open points by point beams. Returns the number of nodes and leaves that they visit.
GN_NOINLINE_ON_CPU uint trace_points(BeamWork* work, __global const LightBundle* bundle,
                                     __global const float* surface_normals, const BeamScene* scene, uint* blocking,
                                     Reservation* mine) {
    uint visits = 0u;
    for (uint bits = lane_bits(LANE_COMPARE(work->open, !=, (LaneInt)(0))); bits != 0u;) {
        int lane = take_lane(&bits);
        uint i = (uint)(work->block * BVH_WIDTH) + (uint)lane;
        PointWork point = {lane_point(work->points, lane),
                           (uint)LANE_OF_INT(work->open, lane),
                           (uint)LANE_OF_INT(work->receivers, lane),
                           i,
                           work->bundle,
                           0u};
        PointPlane plane = {vload3(i, surface_normals), false, 0.0f};
        trace_point_beam(&point, plane, bundle, scene, blocking, mine);
        LANE_OF_INT(work->open, lane) = (int)point.open;
        visits += point.visits;
    }
    return visits;
}

// Traces the block as one beam; gives up once that has cost as much as tracing its points or lights separately is
// expected to. Returns false if it gave up, or if BLOCKS_A_TRY leaves the block out.
GN_INLINE_ON_CPU bool try_block(BeamWork* work, __global const LightBundle* bundle, const BeamScene* scene,
                                BlockMemory* memory, Reservation* mine) {
    if (memory->gain < 0.0f && work->block % BLOCKS_A_TRY != 0u) return false;
    float before = fmin(visits_by_points(work, memory), visits_by_packets(work, memory));
    uint most = (uint)clamp(before / BLOCK_VISIT, 4.0f, 400.0f), visits = 0u;
    bool ended = walk_beam(work, most, &visits, bundle, scene, memory->blocking, mine);
    float after = ended ? 0.0f : fmin(visits_by_points(work, memory), visits_by_packets(work, memory));
    note(&memory->gain, before - after - BLOCK_VISIT * (float)visits);
    return ended;
}

// Decides a block by its beam or by point beams. Returns false if it leaves the block to packets, which took fewer
// visits for earlier blocks.
GN_INLINE_ON_CPU bool trace_block(BeamWork* work, __global const LightBundle* bundle,
                                  __global const float* surface_normals, const BeamScene* scene, BlockMemory* memory,
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

GN_INLINE_ON_CPU void trace_blocks_left(BeamWork* left, uint count, __global const LightBundle* bundle,
                                        const BeamScene* scene, BlockMemory* memory, Reservation* mine) {
    float packets = 0.0f;
    for (uint k = 0; k < count; ++k) packets += (float)popcount(BEAM_ANY_BIT(left[k].open));
    note(&memory->visits_of_packet, (float)trace_packets(left, count, bundle, scene, &memory->packets, mine) / packets);
}
#else
// The number of nodes and leaves that a block's beam may visit. After that each open point has a beam of its own, in
// a second launch, point_beam_trace, so that no group takes much longer than the others.
#define BLOCK_VISITS 96u
// 1 task in TASKS_A_TRY is always tried. If too many tries give up, the other tasks go straight to point beams.
#define TASKS_A_TRY 16u
#define TRIES_TO_LEARN 256u

// True if blocks of this launch give up so often that all walks together cost more than the successful ones save. (On a
// terrain's vertices half of the blocks give up: 803 M pairs/s by points, 613 by blocks. In all other scenes 3 to 20 %
// give up, and blocks are faster.)
static bool are_blocks_too_large(__global BeamCounters* counters) {
    uint tried = GN_RELAXED_LOAD((volatile __global uint*)&counters->tried);
    return tried >= TRIES_TO_LEARN && GN_RELAXED_LOAD((volatile __global uint*)&counters->gave_up) > tried / 5u * 2u;
}

// Decides a block, or leaves its task to point_beam_trace.
static void trace_block(BeamWork* work, uint task, __global const LightBundle* bundle, const BeamScene* scene,
                        uint* blocking, Reservation* mine SHARED_PARAMETER) {
    bool is_first = get_local_id(0) == 0, is_try = task % TASKS_A_TRY == 0u;
    uint max_visits = BLOCK_VISITS, visits = 0u;
    if (group_bits(is_first && !is_try && are_blocks_too_large(scene->counters), shared) != 0u) max_visits = 0u;
    bool ended = walk_beam(work, max_visits, &visits, bundle, scene, blocking, mine SHARED);
    if (is_first && is_try) {
        atomic_inc(&scene->counters->tried);
        if (!ended) atomic_inc(&scene->counters->gave_up);
    }
    if (is_first && !ended) TASKS_LEFT(scene->counters)[atomic_inc(&scene->counters->left_to_points)] = task;
}
#endif

// Loads the points of a block, in the order of the lanes, and their open lights.
static BeamWork load_work(const BeamParams params, size_t block, uint bundle, __global const float* positions,
                          __global const uint* receivers, __global const float* surface_normals,
                          __global const uint* masks) {
    BeamWork work;
    work.block = block;
    work.bundle = bundle;
    size_t first = block * BVH_WIDTH;
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
    work.normal =
        vload3(params.points.first / 3u + min((uint)first + BVH_WIDTH / 2u, params.points.count - 1u), surface_normals);
    return work;
}

// Clears the dark lights in the masks of a block.
static void store_dark(const BeamParams params, const BeamWork* work, __global uint* masks) {
    LaneInt dark = work->given & ~work->open;
    __global uint* mask = masks + work->bundle * (size_t)params.mask_stride + work->block * BVH_WIDTH;
#if GN_LANES > 1
    vstore16(vload16(0, mask) & ~as_uint16(dark), 0, mask);
#else
    mask[get_local_id(0)] &= ~(uint)dark;
#endif
}

// On a CPU a work-item takes PACKET_BLOCKS neighbouring blocks at a time, which share packets if left to these.
__kernel void beam_trace(const BeamParams params, __global const LightBundle* bundles, __global const float* nodes,
                         __global LeafFloat* leaves, __global const uint* ids, __global const float* positions,
                         __global const uint* receivers, __global const float* surface_normals, __global uint* masks,
                         __global BeamPairs* queue, __global BeamCounters* counters, __local uint* shared GN_SHARES) {
    BeamScene scene = {nodes, leaves + FIRST_OF_SLOT, ids, queue, params.queue_capacity, params.rounding, counters};
    Reservation mine = no_reservation();
    uint blocks = (params.points.count + BVH_WIDTH - 1u) / BVH_WIDTH;
#if GN_LANES > 1
    uint groups = (blocks + PACKET_BLOCKS - 1u) / PACKET_BLOCKS;
    __global const float* normals = surface_normals + params.points.first;
    BlockMemory memory;
    begin_memory(&memory);
    BEAM_FOR_EACH(task, (size_t)groups * params.bundle_count) {
        uint index = (uint)(task / groups), block = (uint)(task % groups) * PACKET_BLOCKS, left_count = 0u;
        __global const LightBundle* bundle = &bundles[index];
        BeamWork left[PACKET_BLOCKS];
        for (uint end = min(block + PACKET_BLOCKS, blocks); block < end; ++block) {
            BeamWork work = load_work(params, block, index, positions, receivers, surface_normals, masks);
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
    BEAM_FOR_EACH(task, (size_t)blocks * params.bundle_count) {
        uint bundle = (uint)(task / blocks);
        BeamWork work = load_work(params, task % blocks, bundle, positions, receivers, surface_normals, masks);
        if (!ANY_OPEN(&work)) continue;
        trace_block(&work, (uint)task, &bundles[bundle], &scene, blocking, &mine SHARED);
        store_dark(params, &work, masks);
    }
#endif
    close_queue(&mine, &scene);
    GN_END_SHARES;
}

// The lights' fourth homogeneous coordinate.
#ifdef GN_POINT_LIGHTS
#define LIGHT_W 1.0f
#else
#define LIGHT_W 0.0f
#endif

// Decides the queued pairs by the exact predicate on the triangles' own vertices. Several entries may name one point
// and bundle.
__kernel void beam_exact(const BeamParams params, __global const LightBundle* bundles, __global const float* vertices,
                         __global const float* positions, __global const BeamPairs* queue,
                         volatile __global uint* masks, __global BeamCounters* counters) {
    Triangles triangles = triangles_of(vertices, params.triangles);
    uint by_level[3] = {0, 0, 0};
    GN_FOR_EACH(i, min(counters->queued, params.queue_capacity)) {
        BeamPairs pairs = queue[i];
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
