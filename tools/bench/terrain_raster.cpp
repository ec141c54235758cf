// SPDX-License-Identifier: MIT
#include "terrain_raster.hpp"

#include <algorithm>
#include <limits>

namespace gnomon::bench {
namespace {

// All values of a coordinate, each once, from the lowest to the highest.
std::vector<float> values_along(std::span<const float> vertices, std::size_t axis) {
    std::vector<float> values;
    for (std::size_t i = axis; i < vertices.size(); i += 3) values.push_back(vertices[i]);
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

std::size_t place_of(float value, const std::vector<float>& values) {
    return static_cast<std::size_t>(std::ranges::lower_bound(values, value) - values.begin());
}

}  // namespace

std::vector<float> with_z_up(std::span<const float> with_y_up) {
    std::vector<float> turned(with_y_up.size());
    for (std::size_t i = 0; i < with_y_up.size(); i += 3) {
        turned[i] = with_y_up[i];
        turned[i + 1] = -with_y_up[i + 2];
        turned[i + 2] = with_y_up[i + 1];
    }
    return turned;
}

Lights with_z_up(const Lights& with_y_up) {
    std::vector<Light> turned;
    for (const Light& light : with_y_up.lights()) {
        const auto [x, y, z, w] = light.xyzw;
        turned.push_back({{x, -z, y, w}});
    }
    return Lights(std::move(turned), {with_y_up.weights().begin(), with_y_up.weights().end()});
}

Triangles raster_of_terrain(const Device& device, std::span<const float> triangles) {
    const std::vector<float> x = values_along(triangles, 0), z = values_along(triangles, 2);
    std::vector<float> heights(x.size() * z.size(), std::numeric_limits<float>::quiet_NaN());
    if (triangles.size() != 18 * (x.size() - 1) * (z.size() - 1))
        throw InvalidArgument("the scene is no terrain of make_scenes: two triangles for each square of a raster");
    for (std::size_t i = 0; i < triangles.size(); i += 3)
        heights[place_of(triangles[i + 2], z) * x.size() + place_of(triangles[i], x)] = triangles[i + 1];
    std::vector<float> y(z.size());
    std::ranges::transform(z, y.begin(), std::negate());
    return Triangles::raster(device, {.x = x, .y = y, .heights = heights, .joins_first_corner = true});
}

}  // namespace gnomon::bench
