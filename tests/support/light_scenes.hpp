// SPDX-License-Identifier: MIT
// Scenes that test the stages of a light. Points lie exactly on the shadow rays through edges and vertices, on planes,
// and an ulp beside them; scenes are near, far, tiny, huge or grazing, or have triangles on all sides of a point
// light.
#pragma once

#include "light_stages.hpp"
#include "tie_points.hpp"

namespace support {

/// The scene's triangles and points behind them, for a light in the scene's own scale.
inline LightScene tie_scene(std::string name, const Floats& triangles, const Light& light, std::size_t points,
                            double reach, std::uint64_t seed) {
    return {std::move(name), triangles, points_behind(triangles, light, points, reach, seed), light};
}

inline std::vector<LightScene> light_scenes() {
    std::vector<LightScene> scenes;
    std::uint64_t seed = 1;
    struct Shapes {
        const char* name;
        Floats triangles;
    };
    const std::vector<Shapes> shapes = {
        {"soup", soup(40, 0.5f, 11)},     {"large soup", soup(12, 4, 12)},
        {"specks", soup(80, 0.004f, 13)}, {"slivers", slivers(30, 1e-5f, 14)},
        {"fan", needle_fan(37, 1)},       {"blocks", placed(lattice_blocks(6, 3, 15), 0.5, {-0.75, -0.75, -0.75})}};
    struct Place {
        const char* name;
        double scale;
        std::array<double, 3> offset;
    };
    const std::vector<Place> places = {{"", 1, {0, 0, 0}},
                                       {" at 1e3", 1, {1e3, -1e3, 1e3}},
                                       {" at 1e5", 1, {-1e5, 3e4, 1e5}},
                                       {" at 1e7", 10, {1e7, 1e7, -1e7}},
                                       {" of 1e-6", 1e-6, {0, 0, 0}},
                                       {" of 1e-12 at 1e-9", 1e-12, {1e-9, 0, 1e-9}},
                                       {" of 1e6", 1e6, {1e5, 0, 0}}};
    for (const auto& [light_name, light] : lights_of_every_kind())
        for (const Shapes& shape : shapes)
            for (const Place& place : places) {
                // At the origin every shape; elsewhere, one shape per light and position in turn.
                if (place.scale != 1 || place.offset[0] != 0)
                    if ((seed++ + scenes.size()) % 3 != 0) continue;
                scenes.push_back(tie_scene(std::string(shape.name) + place.name + ", " + light_name,
                                           placed(shape.triangles, place.scale, place.offset),
                                           moved(light, place.scale, place.offset), 160, 2 * place.scale, ++seed));
            }
    return scenes;
}

/// Triangles around a point light, from near to far, with vertices in the planes W = 0 of the cube's faces and an ulp
/// beside these planes. A triangle then covers a part of a face that reaches to infinity on one side, or no part.
inline std::vector<LightScene> point_light_plane_scenes() {
    std::vector<LightScene> scenes;
    const Light point_light = at(0.05f, -0.1f, 0.2f);
    for (const float size : {1e-4f, 0.01f, 0.1f, 1.0f, 30.0f}) {
        Random random(35);
        Floats triangles;
        for (int i = 0; i < 3 * 80; ++i) {
            Float3 v = random_vector(random, -size, size);
            for (int c = 0; c < 3; ++c) v[c] = random.below(3) == 0 ? point_light[c] : point_light[c] + v[c];
            add(triangles, random.below(2) == 0 ? v : nudged(random, v));
        }
        scenes.push_back(
            tie_scene("around a point light, " + std::to_string(size), triangles, point_light, 300, 2, 36));
        append(scenes.back().points, random_points(200, -1, 1, 37));
    }
    return scenes;
}

/// Huge triangles over a small neighbourhood of points.
inline std::vector<LightScene> huge_triangle_scenes() {
    std::vector<LightScene> scenes;
    for (const auto& [light_name, light] : lights_of_every_kind())
        for (const float size : {1e3f, 1e6f, 1e10f}) {
            Floats triangles = soup(20, 0.3f, 21);
            append(triangles, soup(10, size, 22));
            LightScene scene{"triangles of " + std::to_string(size) + ", " + light_name, triangles, {}, light};
            const Floats small(triangles.begin(), triangles.begin() + 20 * 9);
            scene.points = points_behind(small, light, 160, 2, 23);
            scenes.push_back(scene);
        }
    return scenes;
}

/// Scales at which products of floats underflow: heights of denormals over a floor of ordinary size, and a point light
/// with triangles at distances of 1e-15 to 1e-12.
inline std::vector<LightScene> underflow_scenes() {
    std::vector<LightScene> scenes;
    for (const double height : {1e-30, 1e-36, 1e-39, 1e-42, 1e-44}) {
        Floats triangles = soup(60, 0.5f, 31), points = random_points(300, -1, 1, 32);
        for (Floats* floats : {&triangles, &points})
            for (std::size_t i = 1; i < floats->size(); i += 3) (*floats)[i] = float((*floats)[i] * height);
        scenes.push_back({"heights of " + std::to_string(std::log10(height)), triangles, points, along(0, -1, 0)});
    }
    for (const double scale : {1e-9, 1e-11, 1e-12, 1e-13, 1e-14}) {
        const Light point_light = at(0, 0, 0);
        for (const float size : {1.0f, 0.2f, 0.02f}) {
            const Floats triangles = placed(soup(60, size, 33), scale, {0, 0, 0});
            scenes.push_back(tie_scene("point light in a world of 1e" + std::to_string(std::log10(scale)), triangles,
                                       point_light, 200, 2, 34));
        }
    }
    return scenes;
}

/// The oracle's own hard scenes (reference/scenes_for_tests.hpp), once for each of their lights.
inline std::vector<LightScene> reference_scenes() {
    std::vector<LightScene> scenes;
    for (const reference::TestScene& scene : reference::all_test_scenes())
        for (const Light& light : scene.lights)
            if (light[3] != 0 || light[0] != 0 || light[1] != 0 || light[2] != 0)
                scenes.push_back({scene.name, scene.triangles, scene.points, light, scene.receivers});
    return scenes;
}

}  // namespace support
