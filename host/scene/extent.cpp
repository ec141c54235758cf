// SPDX-License-Identifier: MIT
#include "extent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "affine.hpp"

namespace gnomon::scene {
namespace {

/// Of the scene's extent, as Python's Scene has it: a move that is smaller cannot be seen.
constexpr double visible_share = 0x1p-16;

}  // namespace

Extent::Extent(const Scene& scene) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    glm::dvec3 least(infinity), most(-infinity);
    for (std::size_t i = 0; i < scene.triangle_count(); ++i)
        if (const float* t = &scene.triangles[9 * i]; scene.is_finite(i))
            for (int k = 0; k < 9; k += 3) least = min(least, loaded(t + k)), most = max(most, loaded(t + k));
    const glm::dvec3 sides = most - least;
    largest_side_ = std::max({sides.x, sides.y, sides.z, 0.0});
    if (largest_side_ > 0) middle_ = array_of<double>((least + most) / 2.0);
}

double Extent::visible_move(const std::array<double, 3>& place) const {
    double move = 0, distance = largest_side_;
    for (std::size_t k = 0; k < 3; ++k) {
        move = std::max(move, std::fabs(double(float(place[k])) - place[k]));
        distance = std::max(distance, std::fabs(place[k] - middle_[k]));
    }
    // What is far away moves the shadows of the scene by less: by the ratio of the scene to the distance.
    const bool is_visible = largest_side_ > 0 && move * (largest_side_ / distance) > visible_share * largest_side_;
    return is_visible && std::isfinite(move) ? move : 0;
}

}  // namespace gnomon::scene
