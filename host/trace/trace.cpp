// SPDX-License-Identifier: MIT
#include "trace/trace.hpp"

#include <algorithm>

namespace gnomon {
namespace {

// How many points each item of a GPU's work-group takes in a round. More points let the items share out the lists
// better, but every multiprocessor should have several groups: on an H200 2048 were the fastest under a prepared light.
// One frame of a point light has few points, and long rounds only wait.
std::size_t points_each(const cl::Session& session, const LightFrame& light_frame, cl_uint frame_count,
                        std::size_t count) {
    if (session.is_cpu()) return 1;  // no rounds
    constexpr std::size_t groups_each = 8;
    const std::size_t most = frame_count < frame_count_of(light_frame) ? 512 : 2048;
    // Rounded up: a surplus group would begin when all others have ended.
    const std::size_t groups = session.compute_units() * groups_each;
    const std::size_t each = (count / groups + session.work_group_size()) / session.work_group_size();
    return std::clamp<std::size_t>(each, 1, std::max<std::size_t>(most / session.work_group_size(), 1));
}

}  // namespace

TraceParams Trace::params(const TraceInputs& inputs) const {
    return {.triangles = inputs.triangles,
            .light_frame = inputs.light_frame,
            .layout = inputs.points.layout,
            .tables = inputs.lists.tables,
            .first_frame = inputs.first_frame,
            .frame_count = inputs.frame_count,
            .has_map = inputs.map != nullptr,
            .has_block_bounds = 0,
            .queue_capacity = queue_.capacity(),
            .round_points = 0,
            .padding = 0};
}

void Trace::run(cl::Session& session, Task task, const TraceInputs& inputs, const cl::Buffer* table) {
    const PointInputs& points = inputs.points;
    const ListBuffers& lists = inputs.lists;
    reserve_queue(session, points);
    const std::size_t each = points_each(session, inputs.light_frame, inputs.frame_count, points.layout.count);
    TraceParams params = this->params(inputs);
    params.has_block_bounds = task == Task::trace && table != nullptr;
    params.round_points = static_cast<cl_uint>(each * session.work_group_size());
    const std::size_t blocks = points.layout.count / session.lanes() + 1;
    const cl::Range range = session.is_cpu() ? cl::Range::shares(blocks) : session.uneven_items(blocks, each);
    const auto launch_with = [&](const auto& last) {
        session.launch(variant(session, task, inputs.light_frame.perspective == 0, inputs.triangles.has_cut_outs),
                       range, params, inputs.projections, points.positions, points.receivers, inputs.triangles.vertices,
                       inputs.map != nullptr ? *inputs.map : queue(), lists.ranges, lists.entries, lists.records,
                       lists.bounds, inputs.visibility, queue(), inputs.counters, last);
    };
    if (session.lanes() == 1)
        launch_with(cl::LocalBytes{params.round_points * sizeof(cl_uint)});
    else
        launch_with(table != nullptr ? *table : lists.ranges);
}

void Trace::decide_queue(cl::Session& session, const TraceInputs& inputs) const {
    session.launch(inputs.triangles.kernel("trace/exact_trace.cl", "exact_trace"),
                   session.block_shares(queue_.capacity()), params(inputs), inputs.points.positions,
                   inputs.triangles.vertices, queue(), inputs.visibility, inputs.counters);
}

// Room for the pairs of most pictures (the built-in one has 65,400 of 2 million points): the kernel for a queue
// overflow takes a second or two to compile.
void Trace::reserve_queue(cl::Session& session, const PointInputs& points) {
    if (capacity() != 0) return;
    queue_.reserve(session,
                   first_capacity_ != 0 ? first_capacity_ : std::max(initial_capacity, points.layout.count / 8));
}

bool Trace::fitted(cl::Session& session, const PointInputs& points, const FrameCounters& counted) {
    if (counted.uncertain <= capacity()) return true;
    const std::uint64_t wanted = counted.uncertain + std::uint64_t(counted.uncertain) / 4;
    queue_.reserve(session, std::min<std::uint64_t>(wanted, std::max(points.layout.count, initial_capacity)));
    return false;
}

}  // namespace gnomon
