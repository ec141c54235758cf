// SPDX-License-Identifier: MIT
// A parallelogram that shines. What of its light reaches each pixel: shading/received_light.hpp.
#pragma once

#include <cstdint>

#include <gnomon.hpp>

#include "query/vectors.hpp"

namespace gnomon::app {

inline constexpr std::uint32_t default_area_samples = 64;

/// It shines on the side to which edge_a x edge_b points, equally bright from everywhere, with a radiance of 1
/// W/(m^2 sr). No triangle of the scene belongs to it: it neither shades nor is seen.
struct AreaLight {
    Float3 corner{}, edge_a{}, edge_b{};

    Float3 centre() const;
    /// edge_a x edge_b, as long as its area.
    glm::dvec3 area_vector() const;
    /// Throws Error if it has no area.
    void require_area() const;
};

}  // namespace gnomon::app
