// SPDX-License-Identifier: MIT
// Stage ray_trace: a run over many lights by single shadow rays, one light after the other
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

    struct Times {
        double turn_ms, trace_ms;
    };
    /// Of one light.
    Times timed(std::uint32_t light);

private:
    void turn_tree(std::uint32_t light);
    void trace(const PointPart& part, std::uint32_t light);

    const TreeRun& run_;
    cl::Session& session_;
    Statistics& statistics_;
    LightMasks masks_;
    LightTree tree_;
};

/// The time that a run may take, as measured on some lights and, on a CPU, some points: on one light where that is more
/// than twice `limit_ms`.
double estimated_rays_ms(const TreeRun& run, double limit_ms, Statistics& statistics);

}  // namespace gnomon
