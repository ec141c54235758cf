// SPDX-License-Identifier: MIT
// Stage bins: per bin of a projection, the list of triangles that may matter there (kernels/occluders/bins.cl).
#pragma once

#include "kernels/occluders/bins.h"
#include "occluders/triangle_setup.hpp"

namespace gnomon {

class Bins {
public:
    /// Fills ranges(), entries() and pairs() from the setup's bounds, by its records and tiles, and the counts of
    /// `counters`. `heights` (a pyramid: receiver_depth_pyramid) may be null: then no bin is empty and nothing is too
    /// far.
    void run(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
             std::uint32_t bin_count, TriangleSetup& setup, const cl::Buffer* heights, const cl::Buffer& counters);
    /// True if all lists fitted; else grows, and the run must be repeated. After a run whose tiles did not fit the
    /// pairs are guessed, so that all lists grow at once.
    bool fitted(cl::Session& session, const FrameCounters& counted, bool setup_fitted);

    std::uint32_t pair_capacity() const { return pairs_.capacity(); }
    const cl::Buffer& pairs() const { return pairs_.buffer(); }
    const cl::Buffer& ranges() const { return ranges_; }
    const cl::Buffer& entries() const { return entries_.buffer(); }

    /// The lists start with four entries per triangle, but from least_capacity (few triangles may be in all bins) to
    /// initial_capacity; tests start with 1. 0: as ever.
    static constexpr std::uint32_t initial_capacity = 1u << 20, least_capacity = 1u << 16;
    void limit_initial_capacity(std::uint32_t capacity) {
        first_capacity_ = capacity != 0 ? capacity : initial_capacity;
    }

private:
    cl::Buffer counts_, ranges_;
    cl::Buffer listed_;  ///< on a GPU: the entries before those of a run are put in order
    GrowingList pairs_{sizeof(Pair)}, entries_{BIN_ENTRY_BYTES};
    std::uint32_t first_capacity_ = initial_capacity;
};

}  // namespace gnomon
