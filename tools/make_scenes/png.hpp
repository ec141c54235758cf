// SPDX-License-Identifier: MIT
// PNG files without compression: the same bytes whatever library is installed.
#pragma once

#include <cstdint>
#include <vector>

namespace gnomon::make_scenes {

/// 8-bit RGBA, 4 bytes per texel, row by row, at most 65,535 bytes with a byte for each row.
std::vector<std::uint8_t> png_of(std::uint32_t width, std::uint32_t height, const std::vector<std::uint8_t>& rgba);

}  // namespace gnomon::make_scenes
