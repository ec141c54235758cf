// SPDX-License-Identifier: MIT
// Truth of soft shadows: an area light is many point lights, each of them decided exactly.
#pragma once

#include <gnomon.hpp>

#include "query/vectors.hpp"
#include "scene_makers.hpp"

namespace support {

/// The middles of samples x samples equal parts of a horizontal square with sides of length `side`.
inline std::vector<gnomon::Light> square_light(const Float3& center, float side, int samples) {
    std::vector<gnomon::Light> lights;
    const auto offset = [&](int i) { return side * ((float(i) + 0.5f) / float(samples) - 0.5f); };
    for (int i = 0; i < samples * samples; ++i)
        lights.push_back(
            gnomon::Light::point({center[0] + offset(i % samples), center[1], center[2] + offset(i / samples)}));
    return lights;
}

/// The same square infinitely far above: light straight down; `tangent` is its width as it appears from the ground.
inline std::vector<gnomon::Light> square_sun(float tangent, int samples) {
    std::vector<gnomon::Light> lights = square_light({0, 1, 0}, tangent, samples);
    for (gnomon::Light& light : lights) light.xyzw[3] = 0;
    return lights;
}

/// The same across any direction of light.
inline std::vector<gnomon::Light> tilted_square_sun(const glm::dvec3& travel, double tangent, int samples) {
    const glm::dvec3 direction = normalize(travel), across = normalize(cross(travel, {1, 0, 0})),
                     along = cross(direction, across);
    std::vector<gnomon::Light> lights;
    for (int i = 0; i < samples * samples; ++i) {
        const double a = tangent * ((i % samples + 0.5) / samples - 0.5),
                     b = tangent * ((i / samples + 0.5) / samples - 0.5);
        lights.push_back(gnomon::Light::directional(gnomon::array_of(direction + a * across + b * along)));
    }
    return lights;
}

/// The part of the lights that reaches each point.
inline std::vector<double> area_visibility(const gnomon::Device& device, const gnomon::Triangles& triangles,
                                           const gnomon::Points& points, const std::vector<gnomon::Light>& lights) {
    const auto exact = gnomon::make_technique("frustum-traced", device);
    const gnomon::Visibility visibility(device, points.count());
    std::vector<double> mean(points.count(), 0);
    for (const gnomon::Light& light : lights) {
        exact->run(triangles, points, light, visibility);
        const std::vector<float> lit = visibility.read();
        for (std::size_t p = 0; p < mean.size(); ++p) mean[p] += lit[p] / double(lights.size());
    }
    return mean;
}

}  // namespace support
