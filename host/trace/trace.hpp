// SPDX-License-Identifier: MIT
// Stage trace: open points against the map and their bins' triangles by the float filter; the pairs that it leaves
// undecided are queued (kernels/trace/trace.cl).
#pragma once

#include "api/variants.hpp"
#include "kernels/trace/trace.h"
#include "occluders/bins.hpp"
#include "receivers/light_frame.hpp"

namespace gnomon {

/// The lists of bins, and the records that their entries name.
struct ListBuffers {
    const cl::Buffer &ranges, &entries, &records, &bounds;
    PreparedTables tables{};  ///< of a prepared light, in the buffer of the ranges
};
inline ListBuffers list_buffers(const Bins& bins, const TriangleSetup& setup) {
    return {bins.ranges(), bins.entries(), setup.records(), setup.bounds()};
}

/// The lists and the map of a trace, in the frames from `first_frame` on. The frames' projections, bins and maps lie
/// one behind the other.
struct TraceInputs {
    const LightFrame& light_frame;
    cl_uint first_frame, frame_count;
    const TriangleInputs& triangles;
    const PointInputs& points;
    const cl::Buffer& projections;
    const cl::Buffer* map;  ///< null: no coarse test
    ListBuffers lists;
    cl_mem visibility;
    const cl::Buffer& counters;
};

class Trace {
public:
    /// Queues undecided pairs; a point with pairs that find no room stays open. `blocks`: bounds from facing, valid for
    /// a single frame and only while no stage has decided a point since. May be null.
    void run(cl::Session& session, const TraceInputs& inputs, const cl::Buffer* blocks);
    /// Decides the points that run() or run_prepared() left open, in place.
    void run_queue_overflow(cl::Session& session, const TraceInputs& inputs);
    /// As run(), under a prepared light, for all its frames: decides facing too, and counts fallback points. If there
    /// are no fallback points, all points are decided. `task`: prepared_trace_task() or Task::trace_prepared.
    /// `facing_cache`: for the task that reads a cache, else null.
    void run_prepared(cl::Session& session, Task task, const TraceInputs& inputs, const cl::Buffer* facing_cache);
    /// True if all undecided pairs fitted. Else run_queue_overflow() is needed; later runs have more room, at most one
    /// pair per point or initial_capacity.
    bool fitted(cl::Session& session, const PointInputs& points, const FrameCounters& counted);

    /// Capacity of the queue before its first use.
    void reserve_queue(cl::Session& session, const PointInputs& points);
    TraceParams params(const TraceInputs& inputs) const;
    std::uint32_t capacity() const { return capacity_; }
    const cl::Buffer& queue() const { return queue_; }

    static constexpr std::uint32_t initial_capacity = 1u << 16;
    void limit_initial_capacity(std::uint32_t capacity) { first_capacity_ = capacity; }

private:
    void launch(cl::Session& session, Task task, const TraceInputs& inputs, const cl::Buffer* table);
    void reserve(cl::Session& session, std::uint32_t capacity);

    cl::Buffer queue_;
    std::uint32_t capacity_ = 0, first_capacity_ = 0;
};

}  // namespace gnomon
