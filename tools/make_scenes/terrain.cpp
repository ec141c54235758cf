// SPDX-License-Identifier: MIT
// A fractal height field over a square of 2,100 m: value noise of ten octaves from 700 m down, each half as wide as the
// one before and .47 as high. The grid's spacing follows from the number of triangles: 1.05 m for eight million. Hills
// do not depend on the spacing, so a finer grid of the same seed shows the same ground.
#include <cmath>

#include "recipes.hpp"

namespace gnomon::make_scenes {

namespace {

constexpr double side = 2100, widest = 700, highest = 170, gain = 0.47;
constexpr int octaves = 10;

/// A height in [-1, 1) for a whole place of an octave, from a hash of whole numbers.
double height_at(std::uint64_t seed, int octave, std::int64_t x, std::int64_t z) {
    const std::uint64_t place =
        static_cast<std::uint64_t>(x + (1 << 20)) << 32 | static_cast<std::uint64_t>(z + (1 << 20));
    Random hash(Random(seed * octaves + static_cast<std::uint64_t>(octave)).next() ^ place);
    return 2 * hash.unit() - 1;
}

double smooth(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

double noise(std::uint64_t seed, int octave, double x, double z) {
    const double left = std::floor(x), near = std::floor(z);
    const auto i = static_cast<std::int64_t>(left), j = static_cast<std::int64_t>(near);
    const double u = smooth(x - left), v = smooth(z - near);
    const double a = height_at(seed, octave, i, j), b = height_at(seed, octave, i + 1, j);
    const double c = height_at(seed, octave, i, j + 1), d = height_at(seed, octave, i + 1, j + 1);
    const double front = a + u * (b - a), back = c + u * (d - c);
    return front + v * (back - front);
}

double ground(std::uint64_t seed, double x, double z) {
    double height = 0, width = widest, scale = highest;
    for (int octave = 0; octave < octaves; ++octave) {
        height += scale * noise(seed, octave, x / width, z / width);
        width /= 2;
        scale *= gain;
    }
    return height;
}

}  // namespace

Scene make_terrain(const Request& request) {
    // The most columns whose square is not above the wanted number of cells, then as many rows as come nearest.
    const std::uint64_t cells = request.triangles / 2;
    auto columns = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(cells)));
    const std::uint64_t rows = (cells + columns / 2) / columns;
    Scene scene;
    Part& rock = scene.part("rock", {0.46, 0.43, 0.36});
    for (std::uint64_t j = 0; j <= rows; ++j) {
        for (std::uint64_t i = 0; i <= columns; ++i) {
            const double x = side * (static_cast<double>(i) / static_cast<double>(columns) - 0.5);
            const double z = side * (static_cast<double>(j) / static_cast<double>(rows) - 0.5);
            rock.vertex({x, ground(request.seed, x, z), z});
        }
    }
    for (std::uint64_t j = 0; j < rows; ++j) {
        for (std::uint64_t i = 0; i < columns; ++i) {
            const auto corner = static_cast<std::uint32_t>(j * (columns + 1) + i);
            const auto below = static_cast<std::uint32_t>(corner + columns + 1);
            rock.quad(corner, below, below + 1, corner + 1);
        }
    }
    const auto above = [&](double x, double z, double height) {
        return Vec3{x, ground(request.seed, x, z) + height, z};
    };
    scene.camera("v0", {0.75 * side, 0.45 * side, 0.9 * side}, {0, -60, 0}, 45);
    scene.camera("v1", above(0.2 * side, 0.25 * side, 25), above(-0.1 * side, -0.2 * side, 0), 60);
    scene.directional("sun", {-0.5, -1, -0.35});
    scene.directional("low", {0.85, -0.25, -0.5});
    return scene;
}

}  // namespace gnomon::make_scenes
