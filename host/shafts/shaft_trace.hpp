// SPDX-License-Identifier: MIT
// Stage shaft_trace: a run over many lights by shafts (kernels/shafts/shaft.h).
#pragma once

#include "lights/many_lights.hpp"
#include "shafts/shaft_tree.hpp"

namespace gnomon {

/// Which shadow rays are decided together: of a block of points to a bundle of lights, or of one point (a point shaft).
enum class ShaftShape { block, point };

struct ShaftRun : LightsRun {
    const SortedPoints& sorted;
    const BuiltShaftTree& tree;
    std::uint32_t bundle_lights;
    std::optional<ShaftShape> shape{};     ///< if not given, whatever takes less time, measured part by part
    std::optional<double> one_light_ms{};  ///< if given, the run is refused where one light at a time takes less time
};
/// False, and no output is written, if shafts cannot decide these lights (a point light among them, or coordinates out
/// of the filter's range), or would take longer than one light at a time. Adds its stages and counts to `statistics`.
bool run_shafts(const ShaftRun& run, Statistics& statistics);

}  // namespace gnomon
