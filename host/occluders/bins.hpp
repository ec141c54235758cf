// SPDX-License-Identifier: MIT
// Stage bins: per bin of a projection, the list of triangles that may block a point (kernels/occluders/bins.cl).
#pragma once

#include "occluders/triangle_setup.hpp"

namespace gnomon {

class Bins {
public:
    /// Makes room for the lists of this many bins, and zeroes their counts where items share them. The setup may append
    /// pairs before run().
    PairBuffers begin(cl::Session& session, std::uint32_t bin_count, const TriangleSetup& setup);
    /// Fills pairs(), ranges() and entries() from the bounds, records and tiles of the setup. `pyramid`
    /// (receiver_depth_pyramid) may be null: then the depth excludes no bin. Without `orders_runs` no walk may end a
    /// run early.
    void run(cl::Session& session, const ProjectionInput& projection, const TriangleSetup& setup,
             const cl::Buffer* pyramid, bool orders_runs, const cl::Buffer& counters);
    /// True if all lists fitted; else grows them, and the run must be repeated. After a run whose tiles did not fit,
    /// the number of pairs is guessed, so that all lists grow at once.
    bool fitted(cl::Session& session, const FrameCounters& counted, bool setup_fitted);

    std::uint32_t pair_capacity() const { return pairs_.capacity(); }
    const cl::Buffer& pairs() const { return pairs_.buffer(); }
    std::uint32_t entry_capacity() const { return entries_.capacity(); }
    const cl::Buffer& ranges() const { return ranges_; }
    const cl::Buffer& entries() const { return entries_.buffer(); }

    /// The lists start with four entries per triangle, but at least min_capacity (few triangles may be in all bins)
    /// and at most initial_capacity. Tests start with 1; 0 restores the default.
    static constexpr std::uint32_t initial_capacity = 1u << 20, min_capacity = 1u << 16;
    void limit_initial_capacity(std::uint32_t capacity) {
        first_capacity_ = capacity != 0 ? capacity : initial_capacity;
    }

private:
    cl::Buffer counts_, ranges_;
    cl::Buffer unordered_;  ///< on a GPU: the entries before the entries of each run are sorted
    GrowingList pairs_{sizeof(Pair)}, entries_{BIN_ENTRY_BYTES};
    std::uint32_t first_capacity_ = initial_capacity, bin_count_ = 0;
    std::uint32_t count_rows_ = 1;  ///< a CPU's items count in rows of their own while these are no more than
    static constexpr std::size_t max_own_counts = std::size_t{1} << 22;
};

}  // namespace gnomon
