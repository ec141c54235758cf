// SPDX-License-Identifier: MIT
// The stages from triangles to lists, of one frame: clusters, triangle_setup, conservative_map, bins. What they drop is
// decided by farthest_height.
#pragma once

#include "bins.hpp"
#include "clusters.hpp"
#include "conservative_map.hpp"
#include "farthest_height.hpp"

namespace gnomon {

/// How lists are made.
struct ListSettings {
    bool draws_map = true;
    bool judges_map = false;  ///< a map that would cover little is left empty and not looked at
    CoverTest cover_test = CoverTest::tight;
};

class TriangleLists {
public:
    /// `farthest_height` has run for this projection, and is told of the map. Returns the map, null if none is drawn.
    const cl::Buffer* run(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                          const cl::Buffer& projection, const TriangleInputs& triangles, const ListSettings& settings,
                          FarthestHeight& farthest_height, const cl::Buffer& counters);
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
