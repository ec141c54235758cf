// SPDX-License-Identifier: MIT
// Bundles of point lights.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "lights/light_bundles.hpp"
#include "query/vectors.hpp"

namespace gnomon {
namespace {

using Positions = std::vector<Double3>;

// ---- Order ----------------------------------------------------------------------------------------------------------

std::size_t longest_axis(std::span<const std::uint32_t> part, const Positions& positions) {
    Double3 extent{};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto [low, high] = std::ranges::minmax(part, {}, [&](std::uint32_t i) { return positions[i][c]; });
        extent[c] = positions[high][c] - positions[low][c];
    }
    return static_cast<std::size_t>(std::ranges::max_element(extent) - extent.begin());
}

// Halves a part across its longest side, then each half, down to bundles and then to the slots of each cone.
void halve(std::span<std::uint32_t> part, const Positions& positions) {
    if (part.size() < 2) return;
    const std::size_t axis = longest_axis(part, positions);
    const std::size_t left = part.size() > MOST_BUNDLE_LIGHTS
                                 ? (part.size() / 2 + MOST_BUNDLE_LIGHTS - 1) / MOST_BUNDLE_LIGHTS * MOST_BUNDLE_LIGHTS
                                 : std::bit_ceil(part.size()) / 2;
    std::ranges::nth_element(part, part.begin() + std::ptrdiff_t(left), {},
                             [&](std::uint32_t i) { return std::pair(positions[i][axis], i); });
    halve(part.first(left), positions);
    halve(part.subspan(left), positions);
}

// ---- Box ------------------------------------------------------------------------------------------------------------

struct Axes {
    Double3 along, across, depth;
};

// The direction in which the offsets spread most: their covariance, applied to the axis of largest variance.
Double3 widest_direction(const Positions& offsets) {
    Double3 rows[3] = {};
    for (const Double3& offset : offsets)
        for (std::size_t c = 0; c < 3; ++c) rows[c] = sum(rows[c], scaled(offset, offset[c]));
    std::size_t start = 0;
    for (std::size_t c = 1; c < 3; ++c)
        if (rows[c][c] > rows[start][start]) start = c;
    Double3 direction{};
    direction[start] = 1;
    constexpr int steps = 16;
    for (int step = 0; step < steps; ++step) {
        Double3 next{dot(rows[0], direction), dot(rows[1], direction), dot(rows[2], direction)};
        if (!normalize(next)) break;
        direction = next;
    }
    return direction;
}

Axes axes_of(const Positions& offsets) {
    Axes axes{};
    axes.along = widest_direction(offsets);
    axes.across = widest_across(axes.along, offsets);
    axes.depth = cross(axes.along, axes.across);
    return axes;
}

// S = middle + u across + v along + w depth with |u|, |v|, |w| <= 1.
bool contains(const LightCone& box, const Double3& position) {
    const Double3 across = loaded(box.across), along = loaded(box.along), depth = loaded(box.planes[0]);
    const Double3 offset = sum(position, scaled(loaded(box.middle), -1));
    const double det = determinant(across, along, depth);
    const double at[] = {determinant(offset, along, depth) / det, determinant(across, offset, depth) / det,
                         determinant(across, along, offset) / det};
    return std::ranges::all_of(at, [](double share) { return std::abs(share) < 1 - 1e-6; });
}

// The second box contains them at the latest, since `more` is then far above the rounding of all coordinates.
void fit_box(LightCone& box, std::span<const std::uint32_t> part, const Positions& positions) {
    Double3 mean{};
    for (const std::uint32_t i : part) mean = sum(mean, scaled(positions[i], 1.0 / double(part.size())));
    Positions offsets;
    double largest = 0;
    for (const std::uint32_t i : part) {
        offsets.push_back(sum(positions[i], scaled(mean, -1)));
        for (const double c : positions[i]) largest = std::max(largest, std::abs(c));
    }
    const Axes axes = axes_of(offsets);
    const Double3* const along[] = {&axes.across, &axes.along, &axes.depth};
    Double3 middle = mean, half{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::ranges::minmax(offsets, {}, [&](const Double3& o) { return dot(o, *along[k]); });
        const double from = dot(low, *along[k]), to = dot(high, *along[k]);
        middle = sum(middle, scaled(*along[k], (from + to) / 2));
        half[k] = (to - from) / 2 * (1 + 1e-5);
    }
    for (double more = 4e-7 * largest + 1e-30; more <= largest + 1e-20; more *= 4) {
        store(box.middle, middle);
        store(box.across, scaled(axes.across, half[0] + more));
        store(box.along, scaled(axes.along, half[1] + more));
        store(box.planes[0], scaled(axes.depth, half[2] + more));
        if (std::ranges::all_of(part, [&](std::uint32_t i) { return contains(box, positions[i]); })) return;
    }
    throw Error("no box contains these point lights");
}

}  // namespace

float largest_position(std::span<const Light> lights) {
    float largest = 0;
    for (const Light& light : lights)
        for (std::size_t c = 0; c < 3 && !light.is_directional(); ++c)
            largest = std::max(largest, std::abs(light.xyzw[c]));
    return largest;
}

LightBundles make_position_bundles(std::span<const Light> lights, std::uint32_t most) {
    Positions positions;
    for (const Light& light : lights) positions.push_back(loaded(light.xyzw.data()));
    std::vector<std::uint32_t> order(lights.size());
    std::iota(order.begin(), order.end(), 0u);
    halve(order, positions);
    LightBundles made;
    made.are_positions = true;
    for (std::size_t first = 0; first < order.size(); first += most) {
        const auto part =
            std::span<const std::uint32_t>(order).subspan(first, std::min<std::size_t>(most, order.size() - first));
        LightBundle bundle{};
        bundle.light_count = static_cast<std::uint32_t>(part.size());
        for (std::size_t l = 0; l < part.size(); ++l)
            for (std::size_t c = 0; c < 3; ++c) bundle.directions[c][l] = lights[part[l]].xyzw[c];
        for (std::size_t k = 0; k < LIGHT_CONES; ++k) {
            const auto of_cone = lights_of_cone(part, k);
            if (!of_cone.empty()) fit_box(bundle.cones[k], of_cone, positions);
        }
        made.add(bundle, part);
    }
    return made;
}

}  // namespace gnomon
