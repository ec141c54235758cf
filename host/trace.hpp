// SPDX-License-Identifier: MIT
// Stage trace: listed points against listed triangles by the float filter; what it cannot decide is queued
// (kernels/trace.cl).
#pragma once

#include "bins.hpp"
#include "izb.hpp"

namespace gnomon {

class Trace {
public:
    void run(cl::Session& session, const LightFrame& frame, const PointInputs& points, const Izb& izb, const Bins& bins,
             const TriangleSetup& setup, cl_mem visibility, const cl::Buffer& counters);
    /// True if all uncertain pairs fitted; else grows, and the run must be repeated.
    bool fitted(cl::Session& session, const FrameCounters& counted);

    std::uint32_t capacity() const { return capacity_; }
    const cl::Buffer& queue() const { return queue_; }

    static constexpr std::uint32_t initial_capacity = 1u << 16;
    void limit_initial_capacity(std::uint32_t capacity) { first_capacity_ = capacity; }

private:
    cl::Buffer queue_;
    std::uint32_t capacity_ = 0, first_capacity_ = initial_capacity;
};

}  // namespace gnomon
