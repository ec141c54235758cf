// SPDX-License-Identifier: MIT
// A mask, and where it is wrong, in few pixels: tools/report.py draws both.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::bench {

struct ReducedMask {
    std::uint32_t width = 0, height = 0;
    std::vector<int> mask;   ///< the mean visibility of the points of a pixel, 0 to 255; -1 where all of it is sky
    std::vector<int> error;  ///< of the most wrong point: visibility less truth, -255 to 255; 0 only if all are right
};

/// Reduces both pictures by one whole factor, so that the result has at most 640 columns. A visibility that is no
/// number counts as wrong as can be.
ReducedMask reduced_mask(std::span<const float> mask, std::span<const float> truth,
                         std::span<const std::uint32_t> receivers, std::uint32_t width, std::uint32_t height);

}  // namespace gnomon::bench
