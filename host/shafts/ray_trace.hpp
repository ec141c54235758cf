// SPDX-License-Identifier: MIT
// Stage ray_trace: a GPU's run over many lights by single shadow rays, one light after the other
// (kernels/shafts/light_tree.h).
#pragma once

#include "shafts/light_masks.hpp"
#include "shafts/light_tree.hpp"

namespace gnomon {

class RayPasses {
public:
    /// `bundles`: make_plain_bundles() of the run's lights.
    RayPasses(const TreeRun& run, const LightBundles& bundles, Statistics& statistics);

    void run();

private:
    void trace(const PointPart& part, std::uint32_t slot);

    const TreeRun& run_;
    cl::Session& session_;
    Statistics& statistics_;
    LightMasks masks_;
    LightTree tree_;
};

}  // namespace gnomon
