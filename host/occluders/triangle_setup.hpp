// SPDX-License-Identifier: MIT
// Stage triangle_setup: the triangles that survive the cull of a projection, a float filter for each, and their tiles
// of bins (kernels/occluders/triangle_setup.h).
#pragma once

#include "kernels/occluders/bin_lists.h"
#include "kernels/occluders/triangle_setup.h"
#include "query/inputs.hpp"

namespace gnomon {

/// Adds the counts of one frame.
void add_counters(FrameCounters& total, const FrameCounters& frame);

/// A list that kernels fill up to its capacity; they count all entries, also those that had no room.
class GrowingList {
public:
    explicit GrowingList(std::size_t entry_bytes) : entry_bytes_(entry_bytes) {}
    /// Makes room for `entries`; contents are lost if the list has to grow.
    void reserve(cl::Session& session, std::uint64_t entries);
    /// True if `wanted` entries had room; else grows to a quarter more, so that a slowly changing scene does not grow
    /// every frame. Throws OutOfDeviceMemory, naming `what`, if the number of entries exceeds 32 bits.
    bool fitted(cl::Session& session, std::uint64_t wanted, const char* what);

    const cl::Buffer& buffer() const { return buffer_; }
    std::uint32_t capacity() const { return capacity_; }

private:
    std::size_t entry_bytes_;
    cl::Buffer buffer_;
    std::uint32_t capacity_ = 0;
};

/// The list of pairs of a triangle and a bin, and the counts of the bins' pairs (bins.hpp).
struct PairBuffers {
    cl_uint capacity, count_rows;
    const cl::Buffer& pairs;
    const cl::Buffer& bin_counts;
};

class TriangleSetup {
public:
    /// Fills bounds() and the list of the map's candidates, and counts in `counters`. `clusters`: the listed clusters;
    /// null: all triangles. `pyramid` (receiver_depth_pyramid) may be null: then the depth drops no triangle.
    void run_bounds(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
                    const cl::Buffer* clusters, const cl::Buffer* pyramid, const cl::Buffer& counters);
    /// Fills records() and map_tiles() for the map's candidates, by the same pyramid.
    void run_map_tiles(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
                       const cl::Buffer& pyramid, const cl::Buffer& counters) {
        run_tiles_for(session, projection, triangles, &pyramid, true, nullptr, counters);
    }
    /// Fills records() and tiles() for the triangles that are not wholly below `pyramid` (or null). With `pairs` a CPU
    /// appends the pairs in place of tiles.
    void run_tiles(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
                   const cl::Buffer* pyramid, const PairBuffers* pairs, const cl::Buffer& counters) {
        run_tiles_for(session, projection, triangles, pyramid, false, pairs, counters);
    }
    /// True if all lists fitted; else grows them, and the run must be repeated.
    bool fitted(cl::Session& session, const FrameCounters& counted);

    /// The capacity of bounds and records.
    std::uint32_t capacity() const { return bounds_.capacity(); }
    const cl::Buffer& bounds() const { return bounds_.buffer(); }
    const cl::Buffer& records() const { return records_.buffer(); }
    const GrowingList& map_tiles() const { return map_tiles_; }
    const GrowingList& tiles() const { return tiles_; }

    /// The number of records that have room at first. Tests start with 1; 0 restores the default.
    static constexpr std::uint32_t initial_capacity = 1u << 18, min_tiles = 1u << 12;
    void limit_initial_capacity(std::uint32_t capacity) {
        first_capacity_ = capacity != 0 ? capacity : initial_capacity;
    }

private:
    void run_tiles_for(cl::Session& session, const ProjectionInput& projection, const TriangleInputs& triangles,
                       const cl::Buffer* pyramid, bool for_map, const PairBuffers* pairs, const cl::Buffer& counters);

    GrowingList bounds_{sizeof(TriangleBounds)}, records_{sizeof(TriangleRecord)}, map_candidates_{sizeof(cl_uint)},
        map_tiles_{2 * sizeof(cl_uint)}, tiles_{2 * sizeof(cl_uint)};
    std::uint32_t first_capacity_ = initial_capacity;
};

}  // namespace gnomon
