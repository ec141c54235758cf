// SPDX-License-Identifier: MIT
// Stage bins: per bin of a projection, the list of triangles that may matter there (kernels/bins.cl).
#pragma once

#include "scan.hpp"
#include "triangle_setup.hpp"

namespace gnomon {

class Bins {
public:
    /// Fills offsets() (bin_count + 1) and references(), and `references` of `counters`. `farthest` (izb) may be null:
    /// then no bin is empty and nothing is too far.
    void run(cl::Session& session, const cl::Buffer& projection, std::uint32_t bin_count, const TriangleSetup& setup,
             const cl::Buffer* farthest, const cl::Buffer& counters);
    /// True if all references fitted; else grows, and the run must be repeated. After a run whose records did not fit
    /// the references are guessed from the survivors, so that both lists grow at once.
    bool fitted(cl::Session& session, const FrameCounters& counted, bool records_fitted);

    std::uint32_t capacity() const { return capacity_; }
    const cl::Buffer& offsets() const { return offsets_; }
    const cl::Buffer& references() const { return references_; }

    static constexpr std::uint32_t initial_capacity = 1u << 20;
    void limit_initial_capacity(std::uint32_t capacity) { first_capacity_ = capacity; }

private:
    void grow(cl::Session& session, std::uint64_t wanted);
    void pass(cl::Session& session, const cl::Buffer& projection, const TriangleSetup& setup,
              const cl::Buffer* farthest, const cl::Buffer& counters, std::uint32_t fill);

    Scan scan_;
    cl::Buffer cursors_, offsets_, references_;
    std::uint32_t capacity_ = 0, first_capacity_ = initial_capacity;
};

}  // namespace gnomon
