// SPDX-License-Identifier: MIT
// Height fields, and triangles that are nearly some.
#pragma once

#include <functional>

#include "light_scene.hpp"

namespace support {

/// A sheet of columns x rows cells over x and z, with its heights along y.
struct Terrain {
    std::size_t columns = 24, rows = 17;
    float spacing = 1;
    Float3 corner{};
    std::function<float(std::size_t, std::size_t)> height;  ///< of a grid's vertex
    float jitter = 0;                                       ///< of vertices that are not at the border, in spacings
    std::uint64_t seed = 1;

    Floats triangles() const {
        Random random(seed);
        Floats vertices, made;
        for (std::size_t j = 0; j <= rows; ++j)
            for (std::size_t i = 0; i <= columns; ++i) {
                const bool is_inner = i != 0 && j != 0 && i != columns && j != rows;
                const float x = float(i) + (is_inner ? random.between(-jitter, jitter) : 0);
                const float z = float(j) + (is_inner ? random.between(-jitter, jitter) : 0);
                add(vertices, {corner[0] + spacing * x, corner[1] + height(i, j), corner[2] + spacing * z});
            }
        const auto at = [&](std::size_t i, std::size_t j) { return vertex(vertices, j * (columns + 1) + i); };
        for (std::size_t j = 0; j < rows; ++j)
            for (std::size_t i = 0; i < columns; ++i) {
                const Float3 a = at(i, j), b = at(i, j + 1), c = at(i + 1, j + 1), d = at(i + 1, j);
                const bool is_turned = jitter != 0 && random.below(2) == 0;
                add(made, a, b, is_turned ? d : c);
                add(made, is_turned ? b : a, c, d);
            }
        return made;
    }
};

/// Hills and steps with heights that are multiples of a quarter: lights along lattice directions graze edges exactly.
inline Terrain lattice_terrain(std::uint64_t seed) {
    Terrain terrain;
    terrain.height = [seed](std::size_t i, std::size_t j) {
        Random random(seed + 1000 * i + j);
        return float(random.below(12)) / 4 + (i / 5 % 2 == 1 ? 2.0f : 0.0f);
    };
    return terrain;
}

inline Terrain rough_terrain(std::uint64_t seed, float jitter) {
    Terrain terrain;
    terrain.jitter = jitter;
    terrain.seed = seed;
    terrain.columns = 40, terrain.rows = 33;
    terrain.spacing = 2.1f;
    terrain.corner = {-31, 113.7f, 7.3f};
    terrain.height = [seed](std::size_t i, std::size_t j) {
        Random random(seed + 1000 * i + j);
        return 6 * std::sin(float(i) * 0.31f) * std::cos(float(j) * 0.23f) + random.between(0, 1.5f);
    };
    return terrain;
}

/// The same with axes in turn: y is then the given one.
inline Floats turned_up(Floats floats, int axis) {
    for (std::size_t i = 0; i + 2 < floats.size(); i += 3) {
        const Float3 v{floats[i], floats[i + 1], floats[i + 2]};
        for (int c = 0; c < 3; ++c) floats[i + (axis + 2 + c) % 3] = v[c];
    }
    return floats;
}

/// Each triangle's second and third corner exchanged.
inline Floats turned_over(Floats triangles) {
    for (std::size_t t = 0; t + 8 < triangles.size(); t += 9)
        for (int c = 0; c < 3; ++c) std::swap(triangles[t + 3 + c], triangles[t + 6 + c]);
    return triangles;
}

inline Floats without_triangle(Floats triangles, std::size_t t) {
    triangles.erase(triangles.begin() + std::ptrdiff_t(9 * t), triangles.begin() + std::ptrdiff_t(9 * t + 9));
    return triangles;
}

}  // namespace support
