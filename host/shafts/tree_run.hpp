// SPDX-License-Identifier: MIT
// Chooses how a run over many lights goes through the tree over the triangles.
#pragma once

#include <functional>
#include <optional>

#include "horizons/height_field.hpp"
#include "shafts/light_masks.hpp"

namespace gnomon {

/// The ways to decide many lights, as the setting many-lights names them.
enum class ManyLightsWay { automatic, one_by_one, shafts, point_shafts, rays, horizons };

/// The time of one light by the technique's own run, in ms.
using OneLightMs = std::function<double()>;
/// The height field that the triangles are, or null.
using HeightFieldOfRun = std::function<const BuiltHeightField*()>;

/// Decides a run through the tree, and returns how. `automatic` takes the fastest way, by rule or as measured on a
/// sample: `one_by_one`, and no output is written, if the tree would take longer than one light at a time, by rule, or
/// than `one_light_ms`, if there is such a function, for each light. No value, and no output, if the tree cannot serve
/// this run (point lights among directional ones, a direction that cannot be scaled, coordinates out of the filter's
/// range, for `horizons` point lights or no height field). `may_fall_back`: where there is no room for horizons, shafts
/// take their place. Adds its stages and counts to `statistics`.
std::optional<ManyLightsWay> run_through_tree(const TreeRun& run, ManyLightsWay way, bool may_fall_back,
                                              std::uint32_t bundle_lights, const HeightFieldOfRun& height_field,
                                              const OneLightMs& one_light_ms, Statistics& statistics);

}  // namespace gnomon
