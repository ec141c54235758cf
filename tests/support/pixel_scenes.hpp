// SPDX-License-Identifier: MIT
// Scenes with much inside a pixel: occluders and receivers that are smaller, edges through samples and pixels' borders.
#pragma once

#include "camera_scenes.hpp"

namespace support {

/// A floor of two triangles, seen from above so that a pixel is one unit wide on it, and in general from the side.
inline CameraScene floor_scene(const std::string& name, Floats above, const Float3& eye) {
    add(above, {-64, -64, 0}, {64, -64, 0}, {64, 64, 0});
    add(above, {-64, -64, 0}, {64, 64, 0}, {-64, 64, 0});
    return {name,      std::move(above),         eye, {eye[0] * 0.5f, eye[1] * 0.5f, 0},
            {0, 1, 0}, CameraScene::LATTICE_FOV, 32,  32};
}

/// Triangles smaller than a pixel, from far above the floor to just above it.
inline Floats dust(std::size_t count, std::uint32_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const double size = std::exp2(random.between(-7, 1)), height = std::exp2(random.between(-18, 3));
        const double x = random.between(-12, 12), y = random.between(-12, 12);
        const auto corner = [&] {
            return Float3{float(x + size * random.between(-1, 1)), float(y + size * random.between(-1, 1)),
                          float(height * random.between(1, 1.5))};
        };
        const Float3 a = corner(), b = corner(), c = corner();
        add(triangles, a, b, c);
    }
    return triangles;
}

/// Squares whose shadows' edges run through samples and pixels' borders: positions in 64ths of a pixel, at whole
/// heights.
inline Floats squares_on_samples(std::size_t count, std::uint32_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const float x = std::floor(random.between(-12, 12) * 64) / 64.0f,
                    y = std::floor(random.between(-12, 12) * 64) / 64.0f;
        const float z = std::floor(random.between(1, 4)), wide = std::floor(random.between(1, 128)) / 64.0f;
        add(triangles, {x, y, z}, {x + wide, y, z}, {x + wide, y + wide, z});
        add(triangles, {x, y, z}, {x + wide, y + wide, z}, {x, y + wide, z});
    }
    return triangles;
}

/// Slanted receivers of a pixel or two without neighbours, each with a small triangle that shadows a part of its lower
/// end.
inline Floats islands(std::size_t count, std::uint32_t seed) {
    Random random(seed);
    Floats triangles;
    for (std::size_t i = 0; i < count; ++i) {
        const float x = random.between(-12, 12), y = random.between(-12, 12), z = random.between(0, 4);
        const float wide = random.between(0.5f, 3), rise = random.between(-2, 2), speck = random.between(0.01f, 0.3f);
        const auto at = [&](float u, float v, float up) {
            return Float3{x + u * wide, y + v * wide, z + u * rise + up};
        };
        add(triangles, at(0, 0, 0), at(1, 0, 0), at(1, 1, 0));
        add(triangles, at(0, 0, 0), at(1, 1, 0), at(0, 1, 0));
        const float u = rise > 0 ? 0.02f : 0.98f - speck, v = random.between(0, 1);
        add(triangles, at(u, v, 0.001f), at(u + speck, v, 0.001f), at(u, v + speck, 0.001f));
    }
    return triangles;
}

/// All of these, seen from above so that edges run exactly through corners and samples, and from aside.
inline std::vector<CameraScene> hard_pixel_scenes() {
    const Float3 above = {0.5f, 0.5f, 32}, aside = {-20, 5, 14};
    std::vector<CameraScene> hard;
    for (const Float3& eye : {above, aside}) {
        hard.push_back(floor_scene("islands", islands(60, 6), eye));
        hard.back().triangles.resize(hard.back().triangles.size() - 18);  // no floor
        hard.push_back(floor_scene("dust", dust(150, 7), eye));
        hard.push_back(floor_scene("squares", squares_on_samples(40, 8), eye));
        Floats twice = squares_on_samples(20, 10);
        twice.resize(2 * twice.size());  // two triangles on the same side of each edge
        std::copy_n(twice.begin(), twice.size() / 2, twice.begin() + std::ptrdiff_t(twice.size() / 2));
        hard.push_back(floor_scene("squares twice", twice, eye));
        hard.push_back(floor_scene("needles", placed(needle_fan(97, 1), 10, {0, 0, 3}), eye));
        hard.push_back(floor_scene("slivers", placed(slivers(40, 1e-6f, 9), 10, {0, 0, 1}), eye));
    }
    return hard;
}

}  // namespace support
