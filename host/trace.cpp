// SPDX-License-Identifier: MIT
#include "trace.hpp"

#include <algorithm>

namespace gnomon {
namespace {

// Measured on an H200 at 2K and 4K: of 1, 3, 4, 6 and 16 points for each work-item, and of as many groups as the device
// can hold, 3 or 4 are best nearly everywhere; 16 take up to 1.4 times as long.
constexpr std::size_t points_each = 3;

}  // namespace

template <typename... More>
void Trace::launch(cl::Session& session, const char* file, const char* name, const LightFrame& light_frame,
                   cl_uint first_frame, cl_uint frame_count, const TriangleInputs& triangles, const PointInputs& points,
                   const cl::Buffer& projections, const cl::Buffer* map, const ListBuffers& lists, cl_mem visibility,
                   const cl::Buffer& counters, const More&... more) {
    if (capacity_ == 0) reserve(session, first_capacity(points));
    const cl_uint has_map = map != nullptr;
    session.launch(file, name, session.uneven_items(points.layout.count / session.lanes() + 1, points_each),
                   light_frame, first_frame, frame_count, points.layout, projections, has_map, capacity_,
                   triangles.first_float, points.positions, points.receivers, triangles.vertices,
                   map != nullptr ? *map : queue_, lists.ranges, lists.entries, lists.records, lists.bounds, visibility,
                   queue_, counters, more...);
}

void Trace::run(cl::Session& session, const LightFrame& light_frame, cl_uint first_frame, cl_uint frame_count,
                const TriangleInputs& triangles, const PointInputs& points, const cl::Buffer& projections,
                const cl::Buffer* map, const ListBuffers& lists, const cl::Buffer* blocks, cl_mem visibility,
                const cl::Buffer& counters) {
    launch(session, "trace.cl", "trace", light_frame, first_frame, frame_count, triangles, points, projections, map,
           lists, visibility, counters, cl_uint(blocks != nullptr), blocks != nullptr ? *blocks : projections);
}

void Trace::run_again(cl::Session& session, const LightFrame& light_frame, cl_uint first_frame, cl_uint frame_count,
                      const TriangleInputs& triangles, const PointInputs& points, const cl::Buffer& projections,
                      const cl::Buffer* map, const ListBuffers& lists, cl_mem visibility, const cl::Buffer& counters) {
    launch(session, "trace_again.cl", "trace_again", light_frame, first_frame, frame_count, triangles, points,
           projections, map, lists, visibility, counters);
}

void Trace::run_prepared(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
                         const PointInputs& points, const cl::Buffer& projections, const cl::Buffer* map,
                         const ListBuffers& lists, const ReceiverBuffers& receivers, cl_mem visibility,
                         const cl::Buffer& counters, bool by_planes) {
    launch(session, by_planes ? "prepared_trace_by_planes.cl" : "prepared_trace.cl",
           by_planes ? "prepared_trace_by_planes" : "prepared_trace", light_frame, 0, frame_count_of(light_frame),
           triangles, points, projections, map, lists, visibility, counters, triangles.count, receivers.domains,
           receivers.planes, receivers.largest_coordinate);
}

void Trace::run_prepared_blocks(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
                                const PointInputs& points, const cl::Buffer& projections, const cl::Buffer* map,
                                const ListBuffers& lists, const cl::Buffer& domains, const cl::Buffer& blocks,
                                const cl::Buffer& bounds, cl_mem visibility, const cl::Buffer& counters) {
    launch(session, "prepared_trace_of_blocks.cl", "prepared_trace_of_blocks", light_frame, 0, 1, triangles, points,
           projections, map, lists, visibility, counters, cl_uint(1), blocks, domains, bounds);
}

void Trace::run_triangles(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
                          const PointInputs& points, const Izb& izb, const Bins& bins, const TriangleSetup& setup,
                          cl_mem visibility, const cl::Buffer& counters) {
    if (capacity_ == 0) reserve(session, first_capacity(points));
    session.launch("trace_triangles.cl", "trace_triangles", cl::Range::items(bins.pair_capacity()), light_frame,
                   points.layout, capacity_, triangles.first_float, points.positions, points.receivers,
                   triangles.vertices, izb.x(), izb.y(), izb.z(), izb.order(), izb.offsets(), bins.pairs(),
                   setup.records(), setup.bounds(), visibility, queue_, counters);
}

// Room for the pairs of most pictures (the built-in one has 65,400 of 2 million points): a second look is a kernel of
// its own, which takes a second or two to compile.
std::uint32_t Trace::first_capacity(const PointInputs& points) const {
    return first_capacity_ != 0 ? first_capacity_ : std::max(initial_capacity, points.layout.count / 8);
}

void Trace::reserve(cl::Session& session, std::uint32_t capacity) {
    capacity_ = 0;  // stays so if the next line throws
    capacity = std::max(capacity, 1u);
    queue_.reserve(session, std::size_t(capacity) * 2 * sizeof(cl_uint));
    capacity_ = capacity;
}

bool Trace::fitted(cl::Session& session, const PointInputs& points, const FrameCounters& counted) {
    if (counted.uncertain <= capacity_) return true;
    const std::uint64_t wanted = counted.uncertain + std::uint64_t(counted.uncertain) / 4;
    const std::uint32_t most = std::max({points.layout.count, capacity_, initial_capacity});
    reserve(session, static_cast<std::uint32_t>(std::min<std::uint64_t>(wanted, most)));
    return false;
}

}  // namespace gnomon
