// SPDX-License-Identifier: MIT
// The one check of what callers of the oracle hand in.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <stdexcept>

namespace reference {

inline void check_arguments(std::span<const float> triangles, std::span<const float> points,
                            std::span<const std::uint32_t> receivers, const std::array<float, 4>& light) {
    if (triangles.size() % 9 != 0) throw std::invalid_argument("the triangles' size is no multiple of 9 floats");
    if (points.size() % 3 != 0) throw std::invalid_argument("the points' size is no multiple of 3 floats");
    if (!receivers.empty() && receivers.size() != points.size() / 3)
        throw std::invalid_argument("there must be one receiver per point, or none at all");
    for (const float x : light)
        if (!std::isfinite(x)) throw std::invalid_argument("the light must be finite numbers");
}

}  // namespace reference
