// SPDX-License-Identifier: MIT
// The alpha, or the colours, of an image file in memory, by OpenImageIO.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::app {

struct AlphaImage {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> alpha;  ///< row by row; 255 where the image has no alpha
};

/// PNG, JPEG, WebP and what else this OpenImageIO reads; 16 bits are rounded to 8 once. Throws Error with the reason.
AlphaImage read_alpha(std::span<const unsigned char> bytes);

/// 8-bit sRGB with unassociated alpha, 4 bytes per texel.
struct RgbaImage {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
};

/// The same for colours and alpha; grey images have equal channels. Throws Error, too, if it would take more than
/// `max_bytes`.
RgbaImage read_colors(std::span<const unsigned char> bytes, std::uint64_t max_bytes);

}  // namespace gnomon::app
