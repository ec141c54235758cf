// SPDX-License-Identifier: MIT
// Stage beam_trace: a run over many lights by beams (kernels/beams/beam.h). Parts of the sorted points pass through
// facing (light_sides), the trace, the exact predicate and the sums, each part with all bundles of lights.
#pragma once

#include "light_tables/light_masks.hpp"

namespace gnomon {

/// The shadow rays that are decided together:
///   block   16 points (32 on a GPU) x up to 32 lights; a block whose beam meets too many triangles continues as
///   points,
///           or on a CPU as packets where these take less time
///   point   1 point x up to 32 lights
///   packet  on a CPU: 64 points x 1 light
enum class BeamShape { block, point, packet };

class BeamPasses {
public:
    /// `bundles`: make_light_bundles() of the run's lights; for packets make_plain_bundles().
    /// `field`: the horizon of this height field decides first, for make_sector_bundles(); null: there is none.
    BeamPasses(const BvhRun& run, const LightBundles& bundles, BeamShape shape, Statistics& statistics,
               const BuiltHeightField* field = nullptr);

    void run();
    /// Makes the masks of all points, and returns the time that they took.
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
