// SPDX-License-Identifier: MIT
// Points where decisions are tight: on the rays from a light through vertices, edges and insides of triangles, to the
// last ulp and an ulp beside; and lights of every kind around a scene of the unit cube.
#pragma once

#include <cmath>

#include "scene_makers.hpp"

namespace support {

/// v moved by -1, 0 or 1 ulp per coordinate.
inline Float3 nudged(Random& random, Float3 v) {
    for (float& x : v) {
        const std::uint32_t kind = random.below(3);
        if (kind == 1) x = std::nextafter(x, INFINITY);
        if (kind == 2) x = std::nextafter(x, -INFINITY);
    }
    return v;
}

/// A position on the triangle: a vertex, on an edge, or inside.
inline std::array<double, 3> place_on(Random& random, const Floats& triangles, std::size_t triangle) {
    const Float3 v[3] = {vertex(triangles, 3 * triangle), vertex(triangles, 3 * triangle + 1),
                         vertex(triangles, 3 * triangle + 2)};
    double weight[3] = {1, 0, 0};
    const std::uint32_t kind = random.below(8);
    if (kind > 0) {
        weight[1] = random.between(0, 1);
        weight[2] = kind > 5 ? random.between(0, 1) * (1 - weight[1]) : 0;
        weight[0] = 1 - weight[1] - weight[2];
    }
    const std::uint32_t first = random.below(3);
    std::array<double, 3> place{};
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c) place[c] += weight[i] * double(v[(first + i) % 3][c]);
    return place;
}

/// `count` points on the lines from the light through positions on random triangles, rounded to the last ulp: most
/// points are behind the triangle, some before or on it. `reach`: the largest distance from the triangle.
inline Floats points_behind(const Floats& triangles, const Light& light, std::size_t count, double reach,
                            std::uint64_t seed) {
    Random random(seed);
    Floats points;
    for (std::size_t i = 0; i < count; ++i) {
        const auto place = place_on(random, triangles, random.below(std::uint32_t(triangles.size() / 9)));
        const double largest = std::max({std::fabs(light[0]), std::fabs(light[1]), std::fabs(light[2])});
        // Mostly away from the light; sometimes towards it, sometimes on the triangle.
        const std::uint32_t kind = random.below(8);
        const double t = kind == 0 ? 0 : reach * (kind == 1 ? -1 : 1) * random.between(0, 1);
        Float3 p;
        for (int c = 0; c < 3; ++c)
            p[c] = float(light[3] == 0 ? place[c] - t * light[c] / largest
                                       : place[c] + (place[c] - light[c]) * (kind == 1 ? t / (4 * reach) : t));
        add(points, random.below(2) == 0 ? p : nudged(random, p));
    }
    return points;
}

inline Light moved(const Light& light, double scale, const std::array<double, 3>& offset) {
    if (light[3] == 0) return light;
    return {float(light[0] * scale + offset[0]), float(light[1] * scale + offset[1]),
            float(light[2] * scale + offset[2]), 1};
}

/// Lights around and inside [-1, 1]^3; the inner ones have triangles on all six sides and across every face's W = 0.
inline std::vector<std::pair<std::string, Light>> lights_of_every_kind() {
    return {{"sun", along(0.3f, -1, 0.2f)},
            {"sun along -y", along(0, -1, 0)},
            {"sun along +x", along(5, 0, 0)},
            {"sun along a diagonal", along(-1, -1, -1)},
            {"grazing sun", along(1, -1e-4f, 3e-5f)},
            {"point light above", at(0.1f, 3, -0.2f)},
            {"point light inside", at(0.05f, -0.1f, 0.2f)}};
}

}  // namespace support
