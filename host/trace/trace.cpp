// SPDX-License-Identifier: MIT
#include "trace/trace.hpp"

#include <algorithm>

namespace gnomon {
namespace {

// How many points each item of a GPU's work-group takes in a round: the more, the better they share out the lists; but
// every multiprocessor should have several groups. Measured on an H200, Sponza, 512, 1024 and 2048 points in a round:
// .143, .137 and .122 ms at 1920x1080 under a prepared light, .298, .253 and .251 at 3840x2160. A lamp's frame by
// itself has few of the points, and long rounds only wait for them (six frames 1.00 ms with 2048, .86 without rounds).
std::size_t points_each(const cl::Session& session, const LightFrame& light_frame, cl_uint frame_count,
                        std::size_t count) {
    if (session.is_cpu()) return 1;  // no rounds
    constexpr std::size_t groups_each = 8;
    const std::size_t most = frame_count < frame_count_of(light_frame) ? 512 : 2048;
    // Rounded up: a group too many would begin when all others have ended.
    const std::size_t groups = session.compute_units() * groups_each;
    const std::size_t each = (count / groups + session.work_group_size()) / session.work_group_size();
    return std::clamp<std::size_t>(each, 1, std::max<std::size_t>(most / session.work_group_size(), 1));
}

}  // namespace

template <typename... More>
void Trace::launch(cl::Session& session, Task task, const TraceInputs& inputs, const More&... more) {
    const PointInputs& points = inputs.points;
    const ListBuffers& lists = inputs.lists;
    if (capacity_ == 0) reserve(session, first_capacity(points));
    const cl_uint has_map = inputs.map != nullptr;
    const std::size_t each = points_each(session, inputs.light_frame, inputs.frame_count, points.layout.count);
    const std::size_t round = each * session.work_group_size();
    session.launch(variant(session, task, inputs.light_frame.perspective == 0),
                   session.uneven_items(points.layout.count / session.lanes() + 1, each), inputs.light_frame,
                   inputs.first_frame, inputs.frame_count, points.layout, inputs.projections, has_map, capacity_,
                   inputs.triangles.first_float, points.positions, points.receivers, inputs.triangles.vertices,
                   inputs.map != nullptr ? *inputs.map : queue_, lists.ranges, lists.entries, lists.records,
                   lists.bounds, inputs.visibility, queue_, inputs.counters, cl_uint(round),
                   cl::LocalBytes{round * sizeof(cl_uint)}, more...);
}

void Trace::run(cl::Session& session, const TraceInputs& inputs, const cl::Buffer* blocks) {
    launch(session, Task::trace, inputs, cl_uint(blocks != nullptr), blocks != nullptr ? *blocks : inputs.projections);
}

void Trace::run_queue_overflow(cl::Session& session, const TraceInputs& inputs) {
    launch(session, Task::trace_queue_overflow, inputs);
}

void Trace::run_prepared(cl::Session& session, const TraceInputs& inputs, const ReceiverBuffers& receivers,
                         bool plane_side) {
    launch(session, plane_side ? Task::trace_prepared_plane_side : Task::trace_prepared, inputs, inputs.triangles.count,
           receivers.domains, receivers.planes, receivers.largest_coordinate, receivers.lit, receivers.slots);
}

void Trace::run_prepared_cached_facing(cl::Session& session, const TraceInputs& inputs, const cl::Buffer& domains,
                                       const cl::Buffer& answers) {
    launch(session, Task::trace_prepared_cached_facing, inputs, inputs.triangles.count, domains, answers);
}

void Trace::run_triangles(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
                          const PointInputs& points, const Izb& izb, const Bins& bins, const TriangleSetup& setup,
                          cl_mem visibility, const cl::Buffer& counters) {
    if (capacity_ == 0) reserve(session, first_capacity(points));
    session.launch("techniques/trace_triangles.cl", "trace_triangles", cl::Range::items(bins.pair_capacity()),
                   light_frame, points.layout, capacity_, triangles.first_float, points.positions, points.receivers,
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
