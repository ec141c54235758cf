// SPDX-License-Identifier: MIT
// Stage beam_trace: a run over many lights by beams (kernels/beams/beam.h). Parts of the sorted points pass through
// facing (light_sides), the trace, the exact predicate and the sums, each part with all bundles of lights.
#pragma once

#include "light_tables/light_masks.hpp"

namespace gnomon {

/// Which shadow rays are decided together:
///   block   of 16 points (32 on a GPU) to a bundle, as long as their beam does not meet too much; else they go on as
///           points, or on a CPU as packets where these take less
///   point   of each point to a bundle
///   packet  on a CPU: of four blocks to one light
enum class BeamShape { block, point, packet };

class BeamPasses {
public:
    /// `bundles`: make_light_bundles() of the run's lights; for packets make_plain_bundles().
    /// `field`: the horizon of this height field decides first, for make_sector_bundles(); null: there is none.
    BeamPasses(const BvhRun& run, const LightBundles& bundles, BeamShape shape, Statistics& statistics,
               const BuiltHeightField* field = nullptr);

    void run();
    /// How long the masks of all points take.
    double timed_ms();

private:
    void decide(const PointPart& part);
    void launch(const PointPart& part);
    void launch(const BeamParams& params, std::size_t tasks, const char* kernel);

    const BvhRun& run_;
    cl::Session& session_;
    BeamShape shape_;
    Statistics& statistics_;
    LightMasks masks_;
    std::optional<Horizons> horizons_;
};

}  // namespace gnomon
