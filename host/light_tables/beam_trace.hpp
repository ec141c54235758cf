// SPDX-License-Identifier: MIT
// Stage beam_trace: a run over many lights by beams (kernels/beams/beam.h). Parts of the sorted points pass through
// facing (light_sides), the trace, the exact predicate and the sums, each part with all bundles of lights.
#pragma once

#include "horizons/sweeps.hpp"
#include "light_tables/light_masks.hpp"

namespace gnomon {

/// The shadow rays that are decided together:
///   block   16 points (32 on a GPU) x up to 32 lights; a block whose beam meets too many triangles continues as
///   points,
///           or on a CPU as packets where these take less time
///   point   1 point x up to 32 lights
///   packet  on a CPU: 64 points x 1 light
enum class BeamShape { block, point, packet };

/// What decides some pairs before beams do; null: nothing.
struct DecidedBefore {
    const BuiltHeightField* field = nullptr;  ///< by its horizons, for make_sector_bundles()
    Sweeps* sweeps = nullptr;                 ///< which swept the same bundles
};

class BeamPasses {
public:
    /// `bundles`: make_light_bundles() of the run's lights; for packets make_plain_bundles().
    BeamPasses(const BvhRun& run, const LightBundles& bundles, BeamShape shape, Statistics& statistics,
               const DecidedBefore& before = {});

    /// Takes other bundles, of the same kind of lights.
    void set_bundles(const LightBundles& bundles);

    void run();
    /// A run of some of the lights: adds what their bundles have, of which the first has the number `first_bundle`.
    /// `done`, `share`: of the whole run, what was done before and what this is.
    void run_into(LightSums& sums, std::uint32_t first_bundle, double done, double share);
    /// Makes the masks of all points, and returns the time that they took.
    double timed_ms();

private:
    void reserve_masks(const LightBundles& bundles);
    void decide(const PointPart& part);
    void launch(const PointPart& part);
    void launch(const BeamParams& params, std::size_t tasks, const char* kernel);

    const BvhRun& run_;
    cl::Session& session_;
    BeamShape shape_;
    Statistics& statistics_;
    LightMasks masks_;
    std::optional<Horizons> horizons_;
    Sweeps* sweeps_;
};

}  // namespace gnomon
