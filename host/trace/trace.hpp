// SPDX-License-Identifier: MIT
// Stage trace: open points against the map and their bins' triangles by the float filter; what it cannot decide is
// queued (kernels/trace/trace.cl).
#pragma once

#include "api/variants.hpp"
#include "occluders/bins.hpp"
#include "techniques/izb.hpp"

namespace gnomon {

/// The lists that points are held against, and the records that their entries name.
struct ListBuffers {
    const cl::Buffer &ranges, &entries, &records, &bounds;
};
/// What a prepared light keeps for facing (kernels/prepared/prepared_facing.clh).
struct ReceiverBuffers {
    const cl::Buffer &domains, &planes, &largest_coordinate, &lit, &slots;
};
inline ListBuffers list_buffers(const Bins& bins, const TriangleSetup& setup) {
    return {bins.ranges(), bins.entries(), setup.records(), setup.bounds()};
}

/// What points are held against their lists with, in the frames from `first_frame` on, whose projections (and bins, and
/// maps) lie one behind the other.
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
    /// The first look: queues undecided pairs and leaves points open whose pairs find no room; the second, only needed
    /// then, decides theirs in place. `blocks` are what facing says of the points, of one frame alone, none of which
    /// has been decided since; it may be null.
    void run(cl::Session& session, const TraceInputs& inputs, const cl::Buffer* blocks);
    /// The second look.
    void run_queue_overflow(cl::Session& session, const TraceInputs& inputs);
    /// The first look under a prepared light, of all its frames: decides facing too. Counts strays; all points are
    /// decided if there are none. `plane_side`: of lifted points, and strays are also those whose facing the planes of
    /// their receivers leave undecided.
    void run_prepared(cl::Session& session, const TraceInputs& inputs, const ReceiverBuffers& receivers,
                      bool plane_side);
    /// The same of a direction on a CPU, of points that can look their receivers up in `answers` (Facing).
    void run_prepared_cached_facing(cl::Session& session, const TraceInputs& inputs, const cl::Buffer& domains,
                                    const cl::Buffer& answers);
    /// The other traversal, of one frame: triangles over the lists of points (kernels/techniques/trace_triangles.cl).
    /// Needs no second look.
    void run_triangles(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
                       const PointInputs& points, const Izb& izb, const Bins& bins, const TriangleSetup& setup,
                       cl_mem visibility, const cl::Buffer& counters);
    /// True if all undecided pairs fitted. Else a second look is needed; later runs have more room, at most
    /// one pair per point or initial_capacity.
    bool fitted(cl::Session& session, const PointInputs& points, const FrameCounters& counted);

    std::uint32_t capacity() const { return capacity_; }
    const cl::Buffer& queue() const { return queue_; }

    static constexpr std::uint32_t initial_capacity = 1u << 16;
    void limit_initial_capacity(std::uint32_t capacity) { first_capacity_ = capacity; }

private:
    template <typename... More>
    void launch(cl::Session& session, Task task, const TraceInputs& inputs, const More&... more);
    void reserve(cl::Session& session, std::uint32_t capacity);

    std::uint32_t first_capacity(const PointInputs& points) const;

    cl::Buffer queue_;
    std::uint32_t capacity_ = 0, first_capacity_ = 0;
};

}  // namespace gnomon
