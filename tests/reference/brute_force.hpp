// SPDX-License-Identifier: MIT
// The nearest triangle along a pixel's ray, from its definition alone; the counterpart of shadowed_by_brute_force().
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "predicates.hpp"

namespace reference {

struct NearestByBruteForce {
    std::vector<std::uint32_t> ids;  ///< all triangles met at exactly the nearest parameter
    Quotient parameter;
};

/// Nothing if the ray meets no triangle after its origin. `ray` goes through a pixel.
std::optional<NearestByBruteForce> nearest_by_brute_force(std::span<const float> triangles, const Ray& ray);

}  // namespace reference
