// SPDX-License-Identifier: MIT
#include "lists/morton.hpp"

#include <algorithm>
#include <bit>

namespace gnomon {
namespace {

float float_of_key(std::uint32_t key) {
    return std::bit_cast<float>((key & 0x80000000u) != 0 ? key & 0x7FFFFFFFu : ~key);
}

}  // namespace

std::optional<CoordinateBounds> bounds_of_keys(std::span<const std::uint32_t> keys) {
    if (keys[0] == GN_NO_ID) return {};
    const auto position = [&](std::size_t first) {
        return glm::dvec3(float_of_key(keys[first]), float_of_key(keys[first + 1]), float_of_key(keys[first + 2]));
    };
    return CoordinateBounds{position(0), position(3)};
}

MortonGrid morton_grid(const CoordinateBounds& box, unsigned bits) {
    MortonGrid grid{};
    for (int c = 0; c < 3; ++c) grid.origin[c] = static_cast<float>(box.low[c] / 2);
    const glm::dvec3 extents = box.size() / 2.0;
    const double scale = (1u << bits) / std::max({extents.x, extents.y, extents.z});
    grid.scale = scale < std::numeric_limits<float>::max() ? static_cast<float>(scale) : 0.0f;
    return grid;
}

}  // namespace gnomon
