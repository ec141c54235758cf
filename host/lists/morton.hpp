// SPDX-License-Identifier: MIT
// The grid of Morton codes over a box (kernels/lists/morton.h).
#pragma once

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>

#include "kernels/lists/morton.h"

namespace gnomon {

/// A box or a rectangle, empty until a position or another one is added.
template <typename Position>
struct BoundsOf {
    Position low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

    void add(const BoundsOf& other) { low = min(low, other.low), high = max(high, other.high); }
    void add(const Position& position) { add(BoundsOf{position, position}); }
    bool is_empty() const { return !(low.x <= high.x); }
    Position size() const { return high - low; }
    /// The largest magnitude of a coordinate.
    float largest() const {
        const Position magnitudes = max(abs(low), abs(high));
        double largest = 0;
        for (int c = 0; c < Position::length(); ++c) largest = std::max(largest, magnitudes[c]);
        return static_cast<float>(largest);
    }
};
using Rectangle = BoundsOf<glm::dvec2>;
using CoordinateBounds = BoundsOf<glm::dvec3>;

/// The box of three minima and three maxima, which kernels store as keys of floats (float_to_key). No value if the
/// first key is still GN_NO_ID: the kernel found no position.
std::optional<CoordinateBounds> bounds_of_keys(std::span<const std::uint32_t> keys);

/// 2^bits cells per axis over the box; one cell if all of it is one position.
MortonGrid morton_grid(const CoordinateBounds& box, unsigned bits);

}  // namespace gnomon
