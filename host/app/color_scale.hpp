// SPDX-License-Identifier: MIT
// Values as colours, with a legend in the picture.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gnomon::app {

struct ColorScale {
    double least = 0, most = 1;
    std::string unit;

    /// sRGB of viridis, a scale of even steps for all eyes (van der Walt and Smith, 2015), by polynomials of degree 6
    /// (Zucker, CC0). Values beyond the ends get the ends' colours.
    std::array<std::uint8_t, 3> color(double value) const;
};

/// RGBA, 4 bytes per pixel: the colour of each value; NaN is dark grey.
std::vector<std::uint8_t> colored(const ColorScale& scale, std::span<const double> values);

/// Draws the scale with its numbers into the lower left corner, if it fits.
void draw_legend(const ColorScale& scale, std::uint32_t width, std::uint32_t height, std::vector<std::uint8_t>& rgba);

}  // namespace gnomon::app
