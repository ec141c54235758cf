// SPDX-License-Identifier: MIT
// Stage trace: open points against the map and their bins' triangles by the float filter; the pairs that it leaves
// undecided are queued (kernels/trace/trace.cl).
#pragma once

#include "kernels/trace/trace.h"
#include "occluders/bins.hpp"
#include "query/variants.hpp"
#include "receivers/light_frames.hpp"

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

inline TraceInputs trace_inputs(const FramedInputs& in, cl_uint frame, const cl::Buffer& projection,
                                const cl::Buffer* map, const ListBuffers& lists, const cl::Buffer& counters) {
    return {in.light_frame, frame, 1, in.triangles, in.points, projection, map, lists, in.visibility, counters};
}

class Trace {
public:
    /// Runs a task of the trace, which queues undecided pairs; a point with pairs that find no room stays open.
    ///   Task::trace                 one frame. `table`: bounds of blocks from facing, valid only while no stage has
    ///                               decided a point since
    ///   Task::trace_queue_overflow  decides the points that another task left open, in place
    ///   prepared_trace_task()       all frames of a prepared light: decides facing too, and counts fallback points; if
    ///                               there are none, all points are decided. `table`: the cache of cached facing
    /// `table` is null where the task reads none.
    void run(cl::Session& session, Task task, const TraceInputs& inputs, const cl::Buffer* table);
    /// Stage exact_trace: the exact predicate decides the queued pairs (kernels/trace/exact_trace.cl).
    void decide_queue(cl::Session& session, const TraceInputs& inputs) const;
    /// True if all undecided pairs fitted. Else Task::trace_queue_overflow has to run; later runs have more room, at
    /// most one pair per point or initial_capacity.
    bool fitted(cl::Session& session, const PointInputs& points, const FrameCounters& counted);

    /// Capacity of the queue before its first use.
    void reserve_queue(cl::Session& session, const PointInputs& points);
    TraceParams params(const TraceInputs& inputs) const;
    std::uint32_t capacity() const { return queue_.capacity(); }
    const cl::Buffer& queue() const { return queue_.buffer(); }

    static constexpr std::uint32_t initial_capacity = 1u << 16;
    void limit_initial_capacity(std::uint32_t capacity) { first_capacity_ = capacity; }

private:
    GrowingList queue_{2 * sizeof(cl_uint)};
    std::uint32_t first_capacity_ = 0;
};

}  // namespace gnomon
