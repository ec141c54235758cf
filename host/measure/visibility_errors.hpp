// SPDX-License-Identifier: MIT
// How wrong one visibility is, measured against exact truth: the figures that the gallery and the benchmark print.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::measure {

/// Errors of `visibility` in [0, 1] against `truth`. Pixels are points; the sky counts as lit in both. A visibility
/// that is no number counts as wrong as can be.
struct VisibilityErrors {
    std::uint64_t points = 0;
    std::uint64_t wrongly_lit = 0;                     ///< visibility above truth by at least `wrong_from`
    std::uint64_t wrongly_shadowed = 0;                ///< visibility below truth by at least `wrong_from`
    double mean_absolute = 0;                          ///< mean |visibility - truth|
    double worst_tile = 0;                             ///< the largest mean |visibility - truth| of a 32 x 32 tile
    std::uint32_t worst_tile_x = 0, worst_tile_y = 0;  ///< its first pixel
    std::uint64_t penumbra_points = 0;                 ///< where the truth is strictly between 0 and 1
    double penumbra_mean_absolute = 0;                 ///< mean |visibility - truth| of these alone; 0 without any
    double ssim = 1;  ///< mean structural similarity (Wang et al. 2004) over 8 x 8 windows, 1: the same picture

    std::uint64_t wrong() const { return wrongly_lit + wrongly_shadowed; }
    double wrong_share() const { return points == 0 ? 0.0 : double(wrong()) / double(points); }
};

/// A filtered value is wrong from here on: it would round to the other side of a hard shadow.
inline constexpr float wrong_from = 0.5f;
inline constexpr std::uint32_t tile_side = 32;

/// Compares two pictures of width * height values, row by row. Throws InvalidArgument if a size does not fit.
VisibilityErrors visibility_errors(std::span<const float> visibility, std::span<const float> truth, std::uint32_t width,
                                   std::uint32_t height);

/// RGB bytes: the truth in dim grey, too bright pixels in orange, too dark pixels in blue, both the stronger the larger
/// the error (two colours that colour-blind people can distinguish).
std::vector<std::uint8_t> difference_picture(std::span<const float> visibility, std::span<const float> truth);

}  // namespace gnomon::measure
