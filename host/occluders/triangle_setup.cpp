// SPDX-License-Identifier: MIT
#include "occluders/triangle_setup.hpp"

#include <algorithm>

#include "kernels/lists/append.h"
#include "occluders/clusters.hpp"
#include "query/variants.hpp"

namespace gnomon {

void add_counters(FrameCounters& total, const FrameCounters& frame) {
    // The struct has only 32-bit counters.
    auto* sums = reinterpret_cast<uint*>(&total);
    const auto* terms = reinterpret_cast<const uint*>(&frame);
    for (std::size_t i = 0; i < sizeof(FrameCounters) / sizeof(uint); ++i) sums[i] += terms[i];
}

void GrowingList::reserve(cl::Session& session, std::uint64_t entries) {
    if (entries <= capacity_) return;
    capacity_ = 0;  // stays so if the next line throws
    buffer_.reserve(session, entries * entry_bytes_);
    capacity_ = static_cast<std::uint32_t>(entries);
}

bool GrowingList::fitted(cl::Session& session, std::uint64_t wanted, const char* what) {
    if (wanted <= capacity_) return true;
    if (wanted >= APPEND_OVERFLOW)
        throw OutOfDeviceMemory(std::string("listing more than 2^32 ") + what, CL_MEM_OBJECT_ALLOCATION_FAILURE,
                                "set a smaller map-size");
    reserve(session, std::min<std::uint64_t>(wanted + wanted / 4, APPEND_OVERFLOW));
    return false;
}

void TriangleSetup::run_bounds(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
                               const cl::Buffer* clusters, const cl::Buffer* pyramid, const cl::Buffer& counters) {
    // A work-item of a CPU may leave most of a block unused.
    const std::size_t unused =
        session.is_cpu() ? session.compute_units() * session.work_group_size() * APPEND_BLOCK_ON_CPU : 0;
    const std::uint64_t likely = std::min<std::uint64_t>(triangles.count + unused + 1, first_capacity_);
    bounds_.reserve(session, likely);
    // The same capacity as for bounds, also if an earlier run failed between these lists; one tile for each triangle,
    // and room for few triangles in many tiles, in whatever order the work-items take them.
    for (GrowingList* list : {&records_, &map_candidates_}) list->reserve(session, capacity());
    for (GrowingList* list : {&map_tiles_, &tiles_})
        list->reserve(session, std::max(capacity(), std::min(first_capacity_, min_tiles)));
    const OrderedTriangles ordered = ordered_triangles(triangles);
    TriangleSetupParams params{};
    params.triangles = ordered;
    params.capacity = capacity();
    params.has_clusters = clusters != nullptr;
    params.has_pyramid = pyramid != nullptr;
    if (projection.camera) {
        params.samples_per_pixel = projection.camera->samples_per_pixel;
        params.first_sample = projection.camera->first_sample;
    }
    session.launch(variant(session, Task::make_triangle_bounds, projection.is_directional, triangles.has_cut_outs),
                   session.block_shares(triangles.count), params, projection.buffer, ordered.vertices,
                   clusters ? *clusters : bounds(), pyramid ? *pyramid : bounds(), bounds(), map_candidates_.buffer(),
                   counters, cl::LocalBytes{session.work_group_size() * BOUNDS_AT_ONCE * sizeof(TriangleBounds)});
}

void TriangleSetup::run_tiles_for(cl::Session& session, const ProjectionInput& projection,
                                  const TriangleInputs& triangles, const cl::Buffer* pyramid, bool for_map,
                                  const PairBuffers* pairs, const cl::Buffer& counters) {
    const OrderedTriangles ordered = ordered_triangles(triangles);
    const GrowingList& tiles = for_map ? map_tiles_ : tiles_;
    const cl::Buffer& selection = for_map ? map_candidates_.buffer() : ordered.numbers ? *ordered.numbers : bounds();
    TriangleSetupParams params{};
    params.triangles = ordered;
    params.capacity = capacity();
    params.tile_capacity = tiles.capacity();
    params.pair_capacity = pairs ? pairs->capacity : 0;
    params.has_numbers = ordered.numbers != nullptr;
    params.has_pyramid = pyramid != nullptr;
    params.for_map = for_map;
    params.count_rows = pairs ? pairs->count_rows : 0;
    if (projection.camera) {
        params.picture = projection.camera->picture;
        params.samples_per_pixel = projection.camera->samples_per_pixel;
    }
    const std::size_t items = session.is_cpu() ? params.count_rows : 0;  // each clears its row of counts
    const Task task = projection.camera ? Task::make_camera_tiles : Task::make_triangle_tiles;
    session.launch(variant(session, task, projection.is_directional, triangles.has_cut_outs),
                   cl::Range::shares(std::max<std::size_t>(capacity(), items)), params, projection.buffer,
                   ordered.vertices, selection, pyramid ? *pyramid : bounds(), bounds(), records(), tiles.buffer(),
                   pairs ? pairs->bin_counts : bounds(), pairs ? pairs->pairs : bounds(), counters,
                   cl::LocalBytes{session.work_group_size() * (sizeof(cl_uint4) + 2 * sizeof(cl_uint))});
}

bool TriangleSetup::fitted(cl::Session& session, const FrameCounters& counted) {
    const std::uint32_t slots = std::max(counted.slots, counted.map_slots);
    const bool bounds = bounds_.fitted(session, slots, "triangles");
    if (!bounds) {
        records_.reserve(session, capacity());
        map_candidates_.reserve(session, capacity());
    }
    // If some triangles had no room, the number of tiles is guessed, so that all lists grow at once.
    const std::uint32_t tiles = bounds ? counted.tiles : std::max(counted.tiles, slots);
    const bool map_fitted = map_tiles_.fitted(session, counted.map_tiles, "(triangle, tile) pairs");
    const bool tiles_fitted = tiles_.fitted(session, tiles, "(triangle, tile) pairs");
    return bounds && map_fitted && tiles_fitted;
}

}  // namespace gnomon
