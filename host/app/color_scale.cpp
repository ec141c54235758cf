// SPDX-License-Identifier: MIT
#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cmath>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

#include "color_scale.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr std::uint32_t bar_width = 240, bar_height = 10, margin = 12, line_height = 12, max_ticks = 6;
constexpr Rgb no_value = {48, 48, 48}, plate = {24, 24, 24}, ink = {240, 240, 240};

/// Draws in units of `scale` pixels.
class Canvas {
public:
    Canvas(std::uint32_t width, std::uint32_t height, std::uint32_t scale, std::vector<std::uint8_t>& rgba)
        : width_(width), height_(height), scale_(scale), rgba_(rgba) {}

    /// From unit (left, top) to before (right, bottom).
    void fill(double left, double top, double right, double bottom, const Rgb& color) {
        const auto pixel = [&](double units, std::uint32_t most) {
            return std::uint32_t(std::clamp(std::lround(units * scale_), 0L, long(most)));
        };
        for (std::uint32_t y = pixel(top, height_); y < pixel(bottom, height_); ++y)
            for (std::uint32_t x = pixel(left, width_); x < pixel(right, width_); ++x)
                std::ranges::copy(color, &rgba_[4 * (std::size_t(y) * width_ + x)]);
    }
    void text(double left, double top, std::string text) {
        struct Corner {
            float x, y, z;
            std::uint8_t color[4];
        };
        std::vector<Corner> corners(64 * text.size());
        const int quads =
            stb_easy_font_print(0, 0, text.data(), nullptr, corners.data(), int(corners.size() * sizeof(Corner)));
        for (int q = 0; q < quads; ++q) {
            const Corner &from = corners[std::size_t(4 * q)], &to = corners[std::size_t(4 * q + 2)];
            fill(left + from.x, top + from.y, left + to.x, top + to.y, ink);
        }
    }

private:
    std::uint32_t width_, height_, scale_;
    std::vector<std::uint8_t>& rgba_;
};

/// 1, 2 or 5 times a power of ten: the least that needs no more than max_ticks steps.
double tick_step(double range) {
    if (!(range > 0)) return 0;
    const double power = std::pow(10, std::floor(std::log10(range / max_ticks)));
    for (const double digit : {1.0, 2.0, 5.0})
        if (digit * power * max_ticks >= range) return digit * power;
    return 10 * power;
}

double text_width(std::string text) { return stb_easy_font_width(text.data()); }

}  // namespace

Rgb ColorScale::color(double value) const {
    static constexpr double terms[7][3] = {{0.2777273272234177, 0.005407344544966578, 0.3340998053353061},
                                           {0.1050930431085774, 1.404613529898575, 1.384590162594685},
                                           {-0.3308618287255563, 0.214847559468213, 0.09509516302823659},
                                           {-4.634230498983486, -5.799100973351585, -19.33244095627987},
                                           {6.228269936347081, 14.17993336680509, 56.69055260068105},
                                           {4.776384997670288, -13.74514537774601, -65.35303263337234},
                                           {-5.435455855934631, 4.645852612178535, 26.3124352495832}};
    const double t = most > least ? std::clamp((value - least) / (most - least), 0.0, 1.0) : 0;
    Rgb rgb{};
    for (std::size_t c = 0; c < 3; ++c) {
        double v = 0;
        for (std::size_t k = 7; k-- > 0;) v = v * t + terms[k][c];
        rgb[c] = std::uint8_t(std::lround(255 * std::clamp(v, 0.0, 1.0)));
    }
    return rgb;
}

std::vector<std::uint8_t> colored(const ColorScale& scale, std::span<const double> values) {
    std::vector<std::uint8_t> rgba(4 * values.size(), 255);
    for (std::size_t i = 0; i < values.size(); ++i)
        std::ranges::copy(std::isnan(values[i]) ? no_value : scale.color(values[i]), &rgba[4 * i]);
    return rgba;
}

void draw_legend(const ColorScale& scale, std::uint32_t width, std::uint32_t height, std::vector<std::uint8_t>& rgba) {
    const std::uint32_t units = std::max(1u, height / 480);
    const double tall = bar_height + 2.0 * line_height + margin, wide = bar_width + 2.0 * margin;
    if (width < units * (wide + 2 * margin) || height < units * (tall + 2 * margin)) return;
    Canvas canvas(width, height, units, rgba);
    const double left = margin, top = double(height) / units - margin - tall, bar = left + margin;
    canvas.fill(left, top, left + wide, top + tall, plate);
    canvas.text(bar, top + margin / 2.0, scale.unit);
    const double bar_top = top + line_height + margin / 2.0;
    for (std::uint32_t x = 0; x < bar_width; ++x)
        canvas.fill(bar + x, bar_top, bar + x + 1, bar_top + bar_height,
                    scale.color(scale.least + (scale.most - scale.least) * (x + 0.5) / bar_width));
    const double step = tick_step(scale.most - scale.least);
    for (double at = 0; step > 0 && at <= (scale.most - scale.least) * 1.0001; at += step) {
        const std::string number = fmt::format("{:.4g}", scale.least + at);
        const double middle = at / (scale.most - scale.least) * bar_width;
        canvas.text(bar + std::min(middle, bar_width - text_width(number)), bar_top + bar_height + 2, number);
        canvas.fill(bar + middle, bar_top + bar_height - 2, bar + middle + 1, bar_top + bar_height, ink);
    }
}

}  // namespace gnomon::app
