// SPDX-License-Identifier: MIT
// A parallelogram that shines: what of its light reaches each pixel.
#pragma once

#include <cstdint>
#include <vector>

#include <gnomon.hpp>

namespace gnomon::app {

inline constexpr std::uint32_t default_area_samples = 64;

/// It shines on the side to which edge_a x edge_b points, equally bright from everywhere, with a radiance of 1
/// W/(m^2 sr). No triangle of the scene belongs to it: it neither shades nor is seen.
struct AreaLight {
    Float3 corner{}, edge_a{}, edge_b{};

    Float3 centre() const;
    /// Throws Error if it has no area.
    void require_area() const;
};

/// Per pixel, in double arithmetic and rounded once. n samples of the light, each at a distance r along the unit vector
/// l from the point: f = max(0, -l . the light's normal) / r^2, c = max(0, l . point's normal); V is 1 where the sample
/// reaches the point, and 0 else. Sums go over the samples in their order. The sky has 1, 0 and 0.
struct ReceivedLight {
    std::vector<float> share;       ///< sum of V f c over the sum of f c; 0 where that is 0: no light to shadow
    std::vector<float> irradiance;  ///< area / n times the sum of V f c, in W/m^2
    std::vector<float> brightness;  ///< share times area / n times the sum of f: for shade(), which has the cosine
};
/// `lights`: its samples by area_light(). `bits`: those of LightsOutputs for the view's points.
ReceivedLight received_light(const AreaLight& source, const Lights& lights, const ViewOnHost& view,
                             const std::vector<std::uint32_t>& bits);

}  // namespace gnomon::app
