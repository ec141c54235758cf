// SPDX-License-Identifier: MIT
// Stage shaft_trace: a run over many lights by shafts (kernels/shafts/shaft.h). Parts of the sorted points pass through
// facing (light_sides), the trace (shaft_trace or point_shaft_trace), the exact predicate and the sums, each part with
// all bundles of lights.
#pragma once

#include "shafts/light_masks.hpp"

namespace gnomon {

/// Which shadow rays are decided together: of a block of points to a bundle of lights, or of one point (a point shaft).
enum class ShaftShape { block, point };

class ShaftPasses {
public:
    /// `bundles`: make_light_bundles() of the run's lights. `shape`: if not given, whatever takes less time, measured
    /// on samples of every few parts.
    ShaftPasses(const TreeRun& run, const LightBundles& bundles, std::optional<ShaftShape> shape,
                Statistics& statistics);

    struct Estimate {
        double ms;
        std::optional<ShaftShape> shape;  ///< where one choice is enough for all points
    };
    /// The time that run() may take. On a CPU a rough estimate, of a small sample, where it is more than twice
    /// `limit_ms`.
    Estimate estimate(double limit_ms);
    void run();

private:
    struct Faster {
        ShaftShape shape;
        double ms;
        bool is_clear;
    };
    Faster faster_shape(const PointPart& part, std::size_t share);
    double timed(ShaftShape shape, double limit_ms);
    void decide(const PointPart& part, ShaftShape shape);
    void launch(const PointPart& part, ShaftShape shape);

    const TreeRun& run_;
    const LightBundles& light_bundles_;
    cl::Session& session_;
    Statistics& statistics_;
    std::optional<ShaftShape> shape_;
    LightMasks masks_;
    std::uint64_t points_in_point_shafts_ = 0;
};

}  // namespace gnomon
