// SPDX-License-Identifier: MIT
// Stage triangle_setup: which triangles matter to a projection, a float filter for each, and the tiles of bins they are
// in (kernels/occluders/triangle_setup.h).
#pragma once

#include <algorithm>

#include "api/inputs.hpp"
#include "kernels/occluders/bin_lists.h"
#include "kernels/occluders/triangle_setup.h"

namespace gnomon {

/// Adds what one frame counted.
void add_counters(FrameCounters& total, const FrameCounters& frame);

/// A list that kernels fill as far as it goes, counting what they would have written.
class GrowingList {
public:
    explicit GrowingList(std::size_t entry_bytes) : entry_bytes_(entry_bytes) {}
    /// Room for `entries`; contents are lost if it has to grow.
    void reserve(cl::Session& session, std::uint64_t entries);
    /// True if `wanted` entries had room; else grows to a quarter more, so that a slowly changing scene does not grow
    /// every frame. Throws OutOfDeviceMemory, naming `what`, if they cannot be counted in 32 bits.
    bool fitted(cl::Session& session, std::uint64_t wanted, const char* what);

    const cl::Buffer& buffer() const { return buffer_; }
    std::uint32_t capacity() const { return capacity_; }

private:
    std::size_t entry_bytes_;
    cl::Buffer buffer_;
    std::uint32_t capacity_ = 0;
};

/// Where pairs of a triangle and a bin are listed, and the bins' pairs counted (bins.hpp).
struct PairBuffers {
    cl_uint capacity;
    const cl::Buffer& pairs;
    const cl::Buffer& bin_counts;
};

class TriangleSetup {
public:
    /// Fills bounds() and the list of the map's candidates, and their counts in `counters`. `clusters` are those listed
    /// (clusters.hpp), or null: all triangles. `pyramid` (receiver_depth_pyramid) may be null: then nothing is dropped
    /// for being too far.
    void run_bounds(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
                    const cl::Buffer* clusters, const cl::Buffer* pyramid, const cl::Buffer& counters);
    /// Fills records() and map_tiles() for the map's candidates, by the same pyramid.
    void run_map_tiles(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
                       const cl::Buffer& pyramid, const cl::Buffer& counters);
    /// Fills records() and tiles() for all that is not wholly below `heights` (a pyramid as well, or null). With
    /// `pairs` a CPU lists those of small triangles at once, and makes tiles of the others alone.
    void run_tiles(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
                   const cl::Buffer* heights, const PairBuffers* pairs, const cl::Buffer& counters);
    /// True if everything fitted; else grows, and the run must be repeated.
    bool fitted(cl::Session& session, const FrameCounters& counted);

    /// Of bounds and records.
    std::uint32_t capacity() const { return bounds_.capacity(); }
    const cl::Buffer& bounds() const { return bounds_.buffer(); }
    const cl::Buffer& records() const { return records_.buffer(); }
    const GrowingList& map_tiles() const { return map_tiles_; }
    const GrowingList& tiles() const { return tiles_; }

    /// Room for this many records at first; tests start with 1. 0: as ever.
    static constexpr std::uint32_t initial_capacity = 1u << 18;
    void limit_initial_capacity(std::uint32_t capacity) {
        first_capacity_ = capacity != 0 ? capacity : initial_capacity;
    }

private:
    void run_tiles_for(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
                       const cl::Buffer* heights, const GrowingList& tiles, cl_uint for_map, const PairBuffers* pairs,
                       const cl::Buffer& counters);

    GrowingList bounds_{sizeof(TriangleBounds)}, records_{sizeof(TriangleRecord)}, map_candidates_{sizeof(cl_uint)},
        map_tiles_{2 * sizeof(cl_uint)}, tiles_{2 * sizeof(cl_uint)};
    std::uint32_t first_capacity_ = initial_capacity;
};

}  // namespace gnomon
