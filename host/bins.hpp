// SPDX-License-Identifier: MIT
// Stage bins: per bin of a projection, the list of triangles that may matter there (kernels/bins.cl).
#pragma once

#include "scan.hpp"
#include "triangle_setup.hpp"

namespace gnomon {

class Bins {
public:
    /// Makes the pyramid of heights() from the farthest open point of each bin (izb).
    void run_heights(cl::Session& session, std::uint32_t bins_x, std::uint32_t bins_y, const cl::Buffer& farthest);
    /// Fills offsets() (bin_count + 1) and references() from the setup's tiles, and the counts of `counters`. Without
    /// `with_heights` no bin is empty and nothing is too far.
    void run(cl::Session& session, const cl::Buffer& projection, std::uint32_t bin_count, const TriangleSetup& setup,
             bool with_heights, const cl::Buffer& counters);
    /// True if all references fitted; else grows, and the run must be repeated. After a run whose tiles did not fit
    /// the references are guessed, so that all lists grow at once.
    bool fitted(cl::Session& session, const FrameCounters& counted, bool setup_fitted);

    std::uint32_t capacity() const { return references_.capacity(); }
    const cl::Buffer& heights() const { return heights_; }
    const cl::Buffer& offsets() const { return offsets_; }
    const cl::Buffer& references() const { return references_.buffer(); }

    static constexpr std::uint32_t initial_capacity = 1u << 20;
    void limit_initial_capacity(std::uint32_t capacity) { first_capacity_ = capacity; }

private:
    Scan scan_;
    cl::Buffer heights_, counts_, offsets_;
    GrowingList pairs_{3 * sizeof(cl_uint)}, references_{sizeof(cl_uint)};
    std::uint32_t first_capacity_ = initial_capacity;
};

}  // namespace gnomon
