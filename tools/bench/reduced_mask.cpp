// SPDX-License-Identifier: MIT
#include "reduced_mask.hpp"

#include <algorithm>
#include <cmath>

#include <gnomon.hpp>

namespace gnomon::bench {

namespace {

constexpr std::uint32_t max_columns = 640;

int of_255(double share) { return static_cast<int>(std::lround(255 * std::clamp(share, 0.0, 1.0))); }

// Away from zero, so that the smallest error still differs from none.
int error_of_255(double error) {
    const double steps = 255 * std::clamp(error, -1.0, 1.0);
    return static_cast<int>(error > 0 ? std::ceil(steps) : std::floor(steps));
}

}  // namespace

ReducedMask reduced_mask(std::span<const float> mask, std::span<const float> truth,
                         std::span<const std::uint32_t> receivers, std::uint32_t width, std::uint32_t height) {
    struct Block {
        double visibility = 0, worst = 0;
        std::size_t points = 0;
    };
    const std::uint32_t side = (width + max_columns - 1) / max_columns;
    ReducedMask reduced{(width + side - 1) / side, (height + side - 1) / side, {}, {}};
    std::vector<Block> blocks(std::size_t(reduced.width) * reduced.height);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::size_t i = std::size_t(y) * width + x;
            Block& block = blocks[std::size_t(y / side) * reduced.width + x / side];
            const double visibility = std::isnan(mask[i]) ? 1.0 - double(truth[i]) : double(mask[i]);
            const double error = visibility - double(truth[i]);
            if (std::abs(error) > std::abs(block.worst)) block.worst = error;
            if (receivers[i] == no_receiver) continue;
            block.visibility += visibility;
            ++block.points;
        }
    for (const Block& block : blocks) {
        reduced.mask.push_back(block.points == 0 ? -1 : of_255(block.visibility / double(block.points)));
        reduced.error.push_back(error_of_255(block.worst));
    }
    return reduced;
}

}  // namespace gnomon::bench
