// SPDX-License-Identifier: MIT
#include "lists/morton.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace gnomon {
namespace {

float float_of_key(std::uint32_t key) {
    return std::bit_cast<float>((key & 0x80000000u) != 0 ? key & 0x7FFFFFFFu : ~key);
}

}  // namespace

float CoordinateBounds::largest() const {
    double largest = 0;
    for (std::size_t c = 0; c < 3; ++c) largest = std::max({largest, std::abs(low[c]), std::abs(high[c])});
    return static_cast<float>(largest);
}

std::optional<CoordinateBounds> bounds_of_keys(std::span<const std::uint32_t> keys) {
    if (keys[0] == GN_NO_ID) return {};
    CoordinateBounds bounds{};
    for (std::size_t c = 0; c < 3; ++c) {
        bounds.low[c] = float_of_key(keys[c]);
        bounds.high[c] = float_of_key(keys[3 + c]);
    }
    return bounds;
}

MortonGrid morton_grid(const std::array<double, 3>& low, const std::array<double, 3>& high, unsigned bits) {
    MortonGrid grid{};
    double extent = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        grid.origin[c] = static_cast<float>(low[c] / 2);
        extent = std::max(extent, (high[c] - low[c]) / 2);
    }
    const double scale = (1u << bits) / extent;
    grid.scale = scale < std::numeric_limits<float>::max() ? static_cast<float>(scale) : 0.0f;
    return grid;
}

}  // namespace gnomon
