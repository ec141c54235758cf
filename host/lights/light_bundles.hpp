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
    std::vector<std::uint32_t> lights;  ///< MAX_BUNDLE_LIGHTS per bundle: the index of each slot's light, or no_light
    bool are_positions = false;

    void add(const LightBundle& bundle, std::span<const std::uint32_t> of_slots);
    std::size_t light_count() const;
};

/// True if all lights are directional, with directions that can be scaled exactly, or all are point lights.
bool can_be_bundled(std::span<const Light> lights);

/// Divides lights into bundles of at most `most` lights. No value unless they can be bundled.
std::optional<LightBundles> make_light_bundles(std::span<const Light> lights, std::uint32_t most);

/// The same, of point lights alone.
LightBundles make_position_bundles(std::span<const Light> lights, std::uint32_t most);

/// As make_light_bundles(), but each bundle is a sector (kernels/horizons/horizons.h): directional lights of nearly one
/// azimuth around an axis, the lowest first. Lights near the axis, or below the plane perpendicular to it, follow in
/// bundles of their own.
std::optional<LightBundles> make_sector_bundles(std::span<const Light> lights, std::uint32_t most, std::uint32_t axis);

/// The bundles of packets. Directional lights: the same lights in the same order, in full bundles without cones. Point
/// lights: the same bundles.
LightBundles make_plain_bundles(const LightBundles& coned);

/// The tables of bundles of lights that can be bundled, each made when it is first read.
class BundleTables {
public:
    /// The lights must live as long as the tables. `most`: the largest number of lights in a bundle.
    BundleTables(std::span<const Light> lights, std::uint32_t most) : lights_(lights), most_(most) {}

    const LightBundles& coned() {
        return made(coned_, [&] { return *make_light_bundles(lights_, most_); });
    }
    const LightBundles& plain() {
        return made(plain_, [&] { return make_plain_bundles(coned()); });
    }
    /// Every call must name the same axis.
    const LightBundles& sectors(std::uint32_t axis) {
        return made(sectors_, [&] { return *make_sector_bundles(lights_, most_, axis); });
    }

private:
    template <typename Make>
    static const LightBundles& made(std::optional<LightBundles>& table, Make&& make) {
        if (!table) table = make();
        return *table;
    }

    std::span<const Light> lights_;
    std::uint32_t most_;
    std::optional<LightBundles> coned_, plain_, sectors_;
};

/// The lights of a bundle that cone `k` of its cone tree contains. Cone 0 contains all; cone k contains one half of the
/// lights of cone (k - 1) / 2.
std::span<const std::uint32_t> lights_of_cone(std::span<const std::uint32_t> bundle, std::size_t cone);

/// The largest magnitude of a point light's coordinate; 0 if there is none.
float largest_position(std::span<const Light> lights);

}  // namespace gnomon
