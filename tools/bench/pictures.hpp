// SPDX-License-Identifier: MIT
// Masks, and where they are wrong, as small PNG pictures in data URIs.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace gnomon::bench {

/// Pictures are reduced by whole factors to at most this width.
inline constexpr std::uint32_t widest_picture = 640;

/// Visibility as grey; sky is pale blue.
std::string mask_picture(std::span<const float> mask, std::span<const std::uint32_t> receivers, std::uint32_t width,
                         std::uint32_t height);

/// measure::difference_picture, reduced without losing an error: of the points that fall into one pixel the most wrong
/// one is shown.
std::string difference_picture(std::span<const float> mask, std::span<const float> truth, std::uint32_t width,
                               std::uint32_t height);

}  // namespace gnomon::bench
