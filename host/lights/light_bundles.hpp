// SPDX-License-Identifier: MIT
// Bundles of neighbouring directional lights, each with a cone that contains their directions
// (kernels/lights/light_bundle.h).
#pragma once

#include <gnomon.hpp>
#include <optional>
#include <vector>

#include "kernels/lights/light_bundle.h"

namespace gnomon {

struct LightBundles {
    std::vector<LightBundle> bundles;
    std::vector<std::uint32_t> lights;  ///< MOST_BUNDLE_LIGHTS per bundle: the index of each slot's light, or no_light
};

/// Divides lights into bundles of at most `most` lights. No value if a light is a point light, or its direction cannot
/// be scaled exactly.
std::optional<LightBundles> make_light_bundles(std::span<const Light> lights, std::uint32_t most);

/// The same, of lights of nearly one azimuth around an axis, the lowest first: as many as a sector has
/// (kernels/horizons/horizons.h). Lights near the axis, or behind the plane at right angles to it, follow in bundles of
/// their own.
std::optional<LightBundles> make_sector_bundles(std::span<const Light> lights, std::uint32_t most, std::uint32_t axis);

/// The same, full and without cones, in the order of such bundles; without these, in the lights' order.
std::optional<LightBundles> make_plain_bundles(std::span<const Light> lights, const LightBundles* in_order = nullptr);

}  // namespace gnomon
