// SPDX-License-Identifier: MIT
// The stages from triangles to lists, of one frame: clusters, triangle_setup, conservative_map, bins. What they drop is
// decided by receiver_depth_pyramid.
#pragma once

#include "occluders/bins.hpp"
#include "occluders/clusters.hpp"
#include "occluders/conservative_map.hpp"
#include "receivers/receiver_depth_pyramid.hpp"

namespace gnomon {

/// How lists are made.
struct ListSettings {
    bool draws_map = true;
    bool judges_map = false;  ///< a map that would cover little is left empty and not looked at
    CoverTest cover_test = CoverTest::tight;
};

class OccluderLists {
public:
    /// `receiver_depth_pyramid` has run for this projection, and is told of the map. Returns the map, null if none is
    /// drawn.
    const cl::Buffer* run(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                          const cl::Buffer& projection, const TriangleInputs& triangles, const ListSettings& settings,
                          ReceiverDepthPyramid& receiver_depth_pyramid, const cl::Buffer& counters);
    /// True if everything fitted; else lists have grown, and the run must be repeated.
    bool fitted(cl::Session& session, const FrameCounters& counted);

    void limit_initial_capacity(std::uint32_t capacity);

    const TriangleSetup& setup() const { return setup_; }
    const ConservativeMap& map() const { return map_; }
    const Bins& bins() const { return bins_; }

private:
    ClusterCull clusters_;
    TriangleSetup setup_;
    ConservativeMap map_;
    Bins bins_;
};

}  // namespace gnomon
