// SPDX-License-Identifier: MIT
// Stage triangle_setup: which triangles matter to a projection, and a float filter for each (kernels/triangle_setup.h).
#pragma once

#include "../kernels/triangle_setup.h"
#include "inputs.hpp"

namespace gnomon {

class TriangleSetup {
public:
    /// Fills records(), ids(), record_bins(), large() and map_small(), and their counts in `counters`. `pyramid`
    /// (farthest_height) may be null: then nothing is dropped for being too far.
    void run(cl::Session& session, const cl::Buffer& projection, const TriangleInputs& triangles,
             const cl::Buffer* pyramid, const cl::Buffer& counters);
    /// True if all survivors fitted; else grows, and the run must be repeated.
    bool fitted(cl::Session& session, const FrameCounters& counted);

    std::uint32_t capacity() const { return capacity_; }
    const cl::Buffer& records() const { return records_; }
    const cl::Buffer& ids() const { return ids_; }
    const cl::Buffer& record_bins() const { return record_bins_; }
    const cl::Buffer& large() const { return large_; }
    const cl::Buffer& map_small() const { return map_small_; }

    /// Room for this many records at first; tests start with 1.
    static constexpr std::uint32_t initial_capacity = 1u << 18;
    void limit_initial_capacity(std::uint32_t capacity) { first_capacity_ = capacity; }

private:
    void reserve(cl::Session& session, std::uint32_t capacity);

    cl::Buffer records_, ids_, record_bins_, large_, map_small_;
    std::uint32_t capacity_ = 0, first_capacity_ = initial_capacity;
};

}  // namespace gnomon
