// SPDX-License-Identifier: MIT
// Bundles of neighbouring lights: directional ones, each with a cone that contains their directions, or point lights,
// each with a box that contains their positions (kernels/lights/light_bundle.h).
#pragma once

#include <gnomon.hpp>
#include <optional>
#include <span>
#include <vector>

#include "kernels/lights/light_bundle.h"

namespace gnomon {

struct LightBundles {
    std::vector<LightBundle> bundles;
    std::vector<std::uint32_t> lights;  ///< MOST_BUNDLE_LIGHTS per bundle: the index of each slot's light, or no_light
    bool are_positions = false;

    void add(const LightBundle& bundle, std::span<const std::uint32_t> of_slots);
};

/// Divides lights into bundles of at most `most` lights. No value if some are directional and some are not, or a
/// direction cannot be scaled exactly.
std::optional<LightBundles> make_light_bundles(std::span<const Light> lights, std::uint32_t most);

/// The same, of point lights alone.
std::optional<LightBundles> make_position_bundles(std::span<const Light> lights, std::uint32_t most);

/// The same, of directional lights of nearly one azimuth around an axis, the lowest first: as many as a sector has
/// (kernels/horizons/horizons.h). Lights near the axis, or behind the plane at right angles to it, follow in bundles of
/// their own.
std::optional<LightBundles> make_sector_bundles(std::span<const Light> lights, std::uint32_t most, std::uint32_t axis);

/// For packets. Of directional lights: full and without cones, in the order of these bundles; without these, in the
/// lights' order. Of point lights: these bundles or, without them, make_position_bundles().
std::optional<LightBundles> make_plain_bundles(std::span<const Light> lights, const LightBundles* in_order = nullptr);

/// Of a bundle's lights, those of this cone: the first has all of them, cone k one half of those of cone (k - 1) / 2.
std::span<const std::uint32_t> lights_of_cone(std::span<const std::uint32_t> bundle, std::size_t cone);

/// The largest magnitude of a point light's coordinate; 0 if there is none.
float largest_position(std::span<const Light> lights);

}  // namespace gnomon
