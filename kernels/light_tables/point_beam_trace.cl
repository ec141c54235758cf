// SPDX-License-Identifier: MIT
// Traces point beams (point_beam.clh) only: those of all points, or of the points of the tasks that beam_trace left.
#include "beams/point_beam.clh"

// planes: the points' surface normals or, if bundles are sectors, for each mask the distance along the ground within
// which the rays to its lights meet nothing.
static PointPlane plane_of(const BeamParams params, __global const LightBundle* bundle, __global const float* planes,
                           size_t point, size_t mask) {
    if (params.are_sectors == 0u) return (PointPlane){vload3(point, planes), false, 0.0f};
    float3 ground = vload3(0, bundle->ground);
    bool is_sector = ground.x != 0.0f || ground.y != 0.0f || ground.z != 0.0f;
    return (PointPlane){ground, is_sector, is_sector ? planes[mask] : 0.0f};
}

// The points among `count` neighbours that have open lights, as bits.
static uint points_with_open(__global const uint* masks, uint count SHARED_PARAMETER) {
#if GN_LANES > 1
    LaneInt open = LANE_COMPARE(LANE_INDEX, <, (LaneInt)((int)count)) & LANE_COMPARE(BEAM_LOAD_IDS(masks), !=, 0);
#else
    int open = get_local_id(0) < count && BEAM_LOAD_IDS(masks) != 0;
#endif
    return BEAM_BITS(open);
}

__kernel void point_beam_trace(const BeamParams params, __global const LightBundle* bundles,
                               __global const float* nodes, __global LeafFloat* leaves, __global const uint* ids,
                               __global const float* positions, __global const uint* receivers,
                               __global const float* planes, __global uint* masks, __global BeamPairs* queue,
                               __global BeamCounters* counters, __local uint* shared GN_SHARES) {
    BeamScene scene = {nodes, leaves + FIRST_OF_SLOT, ids, queue, params.queue_capacity, params.rounding, counters};
    Reservation mine = no_reservation();
    uint first = params.points.first / 3u, blocks = (params.points.count + BVH_WIDTH - 1u) / BVH_WIDTH;
    uint blocking[BLOCKING_LEAVES] = {0u};
    bool is_listed = params.listed_tasks != 0u;
    size_t tasks = is_listed ? params.listed_tasks : (size_t)blocks * params.bundle_count;
    uint parts = params.parts_of_task, most = BVH_WIDTH / parts;
    BEAM_FOR_EACH(i, tasks * parts) {
        size_t task = is_listed ? TASKS_LEFT(counters)[i / parts] : i / parts;
        uint bundle = (uint)(task / blocks);
        uint start = (uint)(task % blocks) * BVH_WIDTH + (uint)(i % parts) * most;
        if (start >= params.points.count) continue;
        __global uint* of_task = &masks[bundle * (size_t)params.mask_stride + start];
        for (uint open = points_with_open(of_task, min(most, params.points.count - start) SHARED); open != 0u;) {
            uint point = start + take_lowest_bit(&open);
            __global uint* mask = of_task + (point - start);
            PointWork work = {load_point(positions, params.points, point), *mask, GN_NO_ID, point, bundle, 0u};
            if (!is_present(work.p)) continue;
            if (params.points.has_receivers != 0u) work.receiver = receivers[first + point];
            PointPlane plane = plane_of(params, &bundles[bundle], planes, first + point, mask - masks);
            trace_point_beam(&work, plane, &bundles[bundle], &scene, blocking, &mine SHARED);
#if GN_LANES == 1
            barrier(CLK_GLOBAL_MEM_FENCE);  // all items have read the mask
            if (get_local_id(0) != 0) continue;
#endif
            *mask = work.open;
        }
    }
    close_queue(&mine, &scene);
    GN_END_SHARES;
}
