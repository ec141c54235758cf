// SPDX-License-Identifier: MIT
// Stage shaft_trace: a run over many lights by shafts (kernels/shafts/shaft.h). Parts of the sorted points pass through
// facing (light_sides), the trace, the exact predicate and the sums, each part with all bundles of lights.
#pragma once

#include "shafts/light_masks.hpp"

namespace gnomon {

/// Which shadow rays are decided together: of a block of points to a bundle of lights, as long as its shaft does not
/// meet too much (else of each of its points, on a CPU of some blocks to each light where that takes less), of each
/// point by itself, or, on a CPU, of some blocks to each light by itself.
enum class ShaftShape { block, point, packet };

class ShaftPasses {
public:
    /// `bundles`: make_light_bundles() of the run's lights; for packets make_plain_bundles().
    /// `field`: the horizon of this height field decides first, for make_sector_bundles(); null: there is none.
    ShaftPasses(const TreeRun& run, const LightBundles& bundles, Statistics& statistics,
                const BuiltHeightField* field = nullptr);

    void run(ShaftShape shape);
    /// How long the masks of all points take.
    double timed_ms(ShaftShape shape);

private:
    void decide(const PointPart& part, ShaftShape shape);
    void launch(const PointPart& part, ShaftShape shape);
    void launch(const ShaftParams& params, std::size_t tasks, const char* kernel);

    const TreeRun& run_;
    cl::Session& session_;
    Statistics& statistics_;
    LightMasks masks_;
    std::optional<Horizons> horizons_;
};

/// The time that a run by blocks may take, as measured on a sample of the points.
double estimated_shafts_ms(const TreeRun& run, const LightBundles& bundles, Statistics& statistics);
/// The same by the horizon of a height field. For a CPU.
double estimated_horizons_ms(const TreeRun& run, const LightBundles& sectors, const BuiltHeightField& field,
                             Statistics& statistics);
/// The same by packets, as measured on a sample of points and bundles. For a CPU.
double estimated_packets_ms(const TreeRun& run, const LightBundles& plain, Statistics& statistics);

}  // namespace gnomon
