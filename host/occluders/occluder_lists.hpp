// SPDX-License-Identifier: MIT
// The stages from triangles to lists, for one frame of a light: two-pass occlusion culling. A camera's lists take the
// same stages, without the map and the depths. This stage alone knows their order:
//
//   clusters          where they are kept: culled against the depths of all open points
//   triangle_setup    triangles, the same: bounds of the survivors
//   conservative_map  drawn from the survivors that may cover a whole texel; decides the points below it
//   receiver_depth_pyramid   the depths of the points that the map leaves open
//   triangle_setup    survivors culled against these depths: records, tiles and (on a CPU) pairs
//   bins              pairs of triangle and bin: a list for each bin
#pragma once

#include "occluders/bins.hpp"
#include "occluders/clusters.hpp"
#include "occluders/conservative_map.hpp"
#include "receivers/receiver_depth_pyramid.hpp"

namespace gnomon {

struct ListSettings {
    bool draws_map = true;
    bool judges_map = false;  ///< a map that would cover few texels is left empty and not used
    CoverTest cover_test = CoverTest::tight;
    bool orders_runs = true;  ///< on a GPU: each run of a list has its highest triangle first (bin_lists.h)
};

/// The projection that lists are made for: a frame of a light, or a camera.
struct ListInputs {
    ProjectionInput projection;
    std::uint32_t bin_count;
    const LightFrame* light_frame = nullptr;  ///< null: a camera's projection, with no map and no depths
    ReceiverDepthPyramid* depths = nullptr;   ///< has run for this projection; runs once more, after the map
    ListSettings settings{};
};

class OccluderLists {
public:
    /// Returns the drawn map, or null.
    const cl::Buffer* run(cl::Session& session, Statistics& statistics, const ListInputs& in,
                          const TriangleInputs& triangles, const cl::Buffer& counters);
    /// The lists of one frame of a light.
    const cl::Buffer* run(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                          const cl::Buffer& projection, const TriangleInputs& triangles, const ListSettings& settings,
                          ReceiverDepthPyramid& depths, const cl::Buffer& counters) {
        return run(session, statistics,
                   {.projection{projection, light_frame.perspective == 0},
                    .bin_count = light_frame.bins_x * light_frame.bins_y,
                    .light_frame = &light_frame,
                    .depths = &depths,
                    .settings = settings},
                   triangles, counters);
    }
    /// True if all lists fitted; else they have grown, and the run must be repeated.
    bool fitted(cl::Session& session, const FrameCounters& counted);

    void limit_initial_capacity(std::uint32_t capacity) {
        setup_.limit_initial_capacity(capacity);
        bins_.limit_initial_capacity(capacity);
    }

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
