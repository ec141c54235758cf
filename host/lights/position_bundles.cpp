// SPDX-License-Identifier: MIT
// Bundles of point lights.
#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <numeric>

#include "lights/light_bundles.hpp"
#include "lists/morton.hpp"
#include "query/vectors.hpp"

namespace gnomon {
namespace {

using Positions = std::vector<glm::dvec3>;

// ---- Order ----------------------------------------------------------------------------------------------------------

int longest_axis(std::span<const std::uint32_t> part, const Positions& positions) {
    CoordinateBounds box;
    for (const std::uint32_t i : part) box.add(positions[i]);
    return largest_axis(box.size());
}

// Halves a part across its longest side, then each half, down to bundles and then to the slots of each cone.
void halve(std::span<std::uint32_t> part, const Positions& positions) {
    if (part.size() < 2) return;
    const int axis = longest_axis(part, positions);
    const std::size_t left = part.size() > MAX_BUNDLE_LIGHTS
                                 ? (part.size() / 2 + MAX_BUNDLE_LIGHTS - 1) / MAX_BUNDLE_LIGHTS * MAX_BUNDLE_LIGHTS
                                 : std::bit_ceil(part.size()) / 2;
    std::ranges::nth_element(part, part.begin() + std::ptrdiff_t(left), {},
                             [&](std::uint32_t i) { return std::pair(positions[i][axis], i); });
    halve(part.first(left), positions);
    halve(part.subspan(left), positions);
}

// ---- Box ------------------------------------------------------------------------------------------------------------

struct Axes {
    glm::dvec3 along, across, depth;
};

// The direction in which the offsets spread most: their covariance, applied to the axis of largest variance.
glm::dvec3 widest_direction(const Positions& offsets) {
    glm::dmat3 covariance(0);
    for (const glm::dvec3& offset : offsets) covariance += outerProduct(offset, offset);
    glm::dvec3 direction{};
    direction[largest_axis({covariance[0][0], covariance[1][1], covariance[2][2]})] = 1;
    constexpr int steps = 16;
    for (int step = 0; step < steps; ++step) {
        glm::dvec3 next = covariance * direction;
        if (!make_unit(next)) break;
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
bool contains(const LightCone& box, const glm::dvec3& position) {
    const glm::dvec3 across = loaded(box.across), along = loaded(box.along), depth = loaded(box.planes[0]);
    const glm::dvec3 offset = position - loaded(box.middle);
    const double det = determinant(across, along, depth);
    const double at[] = {determinant(offset, along, depth) / det, determinant(across, offset, depth) / det,
                         determinant(across, along, offset) / det};
    return std::ranges::all_of(at, [](double share) { return std::abs(share) < 1 - 1e-6; });
}

// The second box contains them at the latest, since `more` is then far above the rounding of all coordinates.
void fit_box(LightCone& box, std::span<const std::uint32_t> part, const Positions& positions) {
    glm::dvec3 mean{};
    for (const std::uint32_t i : part) mean += positions[i] * (1.0 / double(part.size()));
    Positions offsets;
    double largest = 0;
    for (const std::uint32_t i : part) {
        offsets.push_back(positions[i] - mean);
        largest = std::max(largest, largest_coordinate(positions[i]));
    }
    const Axes axes = axes_of(offsets);
    // The offsets, along `across`, `along` and `depth`.
    CoordinateBounds reach;
    for (const glm::dvec3& offset : offsets)
        reach.add({dot(offset, axes.across), dot(offset, axes.along), dot(offset, axes.depth)});
    const glm::dvec3 centre = (reach.low + reach.high) / 2.0, half = reach.size() / 2.0 * (1 + 1e-5);
    const glm::dvec3 middle = mean + axes.across * centre.x + axes.along * centre.y + axes.depth * centre.z;
    for (double more = 4e-7 * largest + 1e-30; more <= largest + 1e-20; more *= 4) {
        store(box.middle, middle);
        store(box.across, axes.across * (half.x + more));
        store(box.along, axes.along * (half.y + more));
        store(box.planes[0], axes.depth * (half.z + more));
        if (std::ranges::all_of(part, [&](std::uint32_t i) { return contains(box, positions[i]); })) return;
    }
    throw Error("no box contains these point lights");
}

}  // namespace

float largest_position(std::span<const Light> lights) {
    float largest = 0;
    for (const Light& light : lights)
        if (!light.is_directional())
            largest = std::max(largest, static_cast<float>(largest_coordinate(loaded(light.xyzw.data()))));
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
