// SPDX-License-Identifier: MIT
#include "height_steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "in_parts.hpp"
#include "kernels/sight/sight_lines.h"

namespace gnomon::python {
namespace {

/// Heights side by side: loops over them become vector instructions.
constexpr std::size_t width = 16;

template <typename Height>
HeightRange range_of_part(std::span<const Height> heights) {
    std::array<Height, width> low, high;
    low.fill(std::numeric_limits<Height>::infinity());
    high.fill(-std::numeric_limits<Height>::infinity());
    const auto add = [&](const Height* at, std::size_t count) {
        for (std::size_t k = 0; k < count; ++k) {
            const bool is_there = std::abs(at[k]) <= std::numeric_limits<Height>::max();
            const Height for_low = is_there ? at[k] : low[k], for_high = is_there ? at[k] : high[k];
            low[k] = for_low < low[k] ? for_low : low[k];
            high[k] = for_high > high[k] ? for_high : high[k];
        }
    };
    std::size_t i = 0;
    for (; i + width <= heights.size(); i += width) add(&heights[i], width);
    add(heights.data() + i, heights.size() - i);
    return {double(std::ranges::min(low)), double(std::ranges::max(high))};
}

/// Of up to `width` heights of a row. `moved` keeps the largest distance of each place.
template <typename Height>
void round_piece(const Height* heights, std::size_t count, double base, const double* drops, double steps_of_metre,
                 double step, std::int32_t* steps, bool* absent, std::array<double, width>& moved) {
    for (std::size_t k = 0; k < count; ++k) {
        const bool is_there = std::abs(heights[k]) <= std::numeric_limits<Height>::max();
        const double bent = (is_there ? double(heights[k]) - base : 0.0) - (is_there ? drops[k] : 0.0);
        const double sought = bent * steps_of_metre + 0.5;
        const auto cut = std::int32_t(sought);
        const std::int32_t whole = cut - std::int32_t(double(cut) > sought);
        const double by = std::abs(double(whole) * step - bent);
        moved[k] = by > moved[k] ? by : moved[k];
        steps[k] = is_there ? whole : NO_HEIGHT;
        absent[k] = !is_there;
    }
}

}  // namespace

template <typename Height>
HeightRange range_of(std::span<const Height> heights) {
    std::array<HeightRange, most_parts> found{};
    const std::size_t parts = in_parts(heights.size(), 1 << 16, [&](std::size_t first, std::size_t end, std::size_t i) {
        found[i] = range_of_part(heights.subspan(first, end - first));
    });
    HeightRange range = found[0];
    for (std::size_t i = 1; i < parts; ++i)
        range = {std::min(range.low, found[i].low), std::max(range.high, found[i].high)};
    return range;
}

template <typename Height>
double round_heights(std::span<const Height> heights, const Rounding& rounding, std::span<std::int32_t> steps,
                     std::span<bool> absent) {
    const std::size_t columns = rounding.across.size(), rows = rounding.along.size();
    const double step = std::ldexp(1.0, rounding.exponent), steps_of_metre = std::ldexp(1.0, -rounding.exponent);
    std::array<double, most_parts> largest{};
    in_parts(rows, std::max<std::size_t>((1 << 16) / columns, 1),
             [&](std::size_t first, std::size_t end, std::size_t i) {
                 std::array<double, width> moved{}, drops{};
                 for (std::size_t row = first; row < end; ++row)
                     for (std::size_t column = 0; column < columns; column += width) {
                         const std::size_t at = row * columns + column, count = std::min(width, columns - column);
                         for (std::size_t k = 0; k < count; ++k)
                             drops[k] = rounding.per_square * (rounding.across[column + k] + rounding.along[row]);
                         const auto round = [&](std::size_t n) {
                             round_piece(&heights[at], n, rounding.base, drops.data(), steps_of_metre, step, &steps[at],
                                         &absent[at], moved);
                         };
                         if (count == width)
                             round(width);
                         else
                             round(count);
                     }
                 largest[i] = std::ranges::max(moved);
             });
    return std::ranges::max(largest);
}

template HeightRange range_of(std::span<const float>);
template HeightRange range_of(std::span<const double>);
template double round_heights(std::span<const float>, const Rounding&, std::span<std::int32_t>, std::span<bool>);
template double round_heights(std::span<const double>, const Rounding&, std::span<std::int32_t>, std::span<bool>);

}  // namespace gnomon::python
