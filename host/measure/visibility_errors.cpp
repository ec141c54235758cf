// SPDX-License-Identifier: MIT
#include "measure/visibility_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gnomon.hpp>

namespace gnomon::measure {
namespace {

/// Part of a picture, cut off at its right and lower side.
struct Window {
    std::uint32_t x0, y0, x1, y1;
};

template <typename Visit>
void for_each_window(std::uint32_t width, std::uint32_t height, std::uint32_t side, Visit&& visit) {
    for (std::uint32_t y = 0; y < height; y += side)
        for (std::uint32_t x = 0; x < width; x += side)
            visit(Window{x, y, std::min(width, x + side), std::min(height, y + side)});
}

/// A technique's value as the error measures use it: a value that is no number counts as wrong as can be.
double answer(float visibility, float truth) { return std::isnan(visibility) ? 1.0 - double(truth) : visibility; }

double mean_absolute_in(const Window& window, std::span<const float> a, std::span<const float> b, std::uint32_t width) {
    double sum = 0;
    for (std::uint32_t y = window.y0; y < window.y1; ++y)
        for (std::uint32_t x = window.x0; x < window.x1; ++x) {
            const std::size_t i = std::size_t(y) * width + x;
            sum += std::fabs(answer(a[i], b[i]) - double(b[i]));
        }
    return sum / (double(window.x1 - window.x0) * double(window.y1 - window.y0));
}

/// Wang, Bovik, Sheikh and Simoncelli 2004, eq. 13, with their constants for a range of 1.
double ssim_in(const Window& window, std::span<const float> a, std::span<const float> b, std::uint32_t width) {
    constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    double sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0, sum_ab = 0;
    for (std::uint32_t y = window.y0; y < window.y1; ++y)
        for (std::uint32_t x = window.x0; x < window.x1; ++x) {
            const std::size_t i = std::size_t(y) * width + x;
            const double u = answer(a[i], b[i]), v = b[i];
            sum_a += u;
            sum_b += v;
            sum_aa += u * u;
            sum_bb += v * v;
            sum_ab += u * v;
        }
    const double n = double(window.x1 - window.x0) * double(window.y1 - window.y0);
    const double mean_a = sum_a / n, mean_b = sum_b / n;
    const double variance_a = sum_aa / n - mean_a * mean_a, variance_b = sum_bb / n - mean_b * mean_b;
    const double covariance = sum_ab / n - mean_a * mean_b;
    return (2 * mean_a * mean_b + c1) * (2 * covariance + c2) /
           ((mean_a * mean_a + mean_b * mean_b + c1) * (variance_a + variance_b + c2));
}

using Rgb = std::array<float, 3>;

/// `from` towards `to`, 0 to 1.
std::uint8_t mixed(float from, float to, float share) {
    return static_cast<std::uint8_t>(std::lround(255.0f * (from + (to - from) * std::clamp(share, 0.0f, 1.0f))));
}

}  // namespace

VisibilityErrors visibility_errors(std::span<const float> visibility, std::span<const float> truth, std::uint32_t width,
                                   std::uint32_t height) {
    const std::size_t count = std::size_t(width) * height;
    if (visibility.size() != count || truth.size() != count)
        throw InvalidArgument("the pictures to compare have " + std::to_string(visibility.size()) + " and " +
                              std::to_string(truth.size()) + " pixels, not " + std::to_string(count));
    VisibilityErrors errors;
    errors.points = count;
    double sum = 0, penumbra_sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double difference = answer(visibility[i], truth[i]) - double(truth[i]);
        errors.wrongly_lit += difference >= double(wrong_from);
        errors.wrongly_shadowed += difference <= -double(wrong_from);
        sum += std::fabs(difference);
        if (!(truth[i] > 0 && truth[i] < 1)) continue;
        ++errors.penumbra_points;
        penumbra_sum += std::fabs(difference);
    }
    if (count == 0) return errors;
    if (errors.penumbra_points != 0) errors.penumbra_mean_absolute = penumbra_sum / double(errors.penumbra_points);
    errors.mean_absolute = sum / double(count);
    for_each_window(width, height, tile_side, [&](const Window& tile) {
        const double mean = mean_absolute_in(tile, visibility, truth, width);
        if (mean <= errors.worst_tile) return;
        errors.worst_tile = mean;
        errors.worst_tile_x = tile.x0;
        errors.worst_tile_y = tile.y0;
    });
    double ssim_sum = 0;
    std::size_t windows = 0;
    for_each_window(width, height, 8, [&](const Window& window) {
        ssim_sum += ssim_in(window, visibility, truth, width);
        ++windows;
    });
    errors.ssim = ssim_sum / double(windows);
    return errors;
}

std::vector<std::uint8_t> difference_picture(std::span<const float> visibility, std::span<const float> truth) {
    constexpr Rgb too_bright{1.0f, 0.55f, 0.0f}, too_dark{0.1f, 0.45f, 1.0f};
    std::vector<std::uint8_t> rgb;
    rgb.reserve(3 * truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const float difference = static_cast<float>(answer(visibility[i], truth[i])) - truth[i];
        const Rgb& color = difference > 0 ? too_bright : too_dark;
        // The root, so that small errors can still be seen.
        const float share = std::sqrt(std::fabs(difference));
        const float grey = 0.12f + 0.23f * truth[i];
        for (const float channel : color) rgb.push_back(mixed(grey, channel, share));
    }
    return rgb;
}

}  // namespace gnomon::measure
