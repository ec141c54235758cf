// SPDX-License-Identifier: MIT
#include "lists/morton.hpp"

#include <algorithm>
#include <limits>

namespace gnomon {

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
