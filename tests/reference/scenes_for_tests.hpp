// SPDX-License-Identifier: MIT
// Small random scenes, each hard for one reason, the same on every machine (own generator, no std distribution).
// Points lie where decisions are tight: on vertices, edges and planes of the scene as well as in free space.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

#include "predicates.hpp"
#include "visibility.hpp"

namespace reference {

struct TestScene {
    std::string name;
    std::vector<float> triangles;
    std::vector<float> points;
    std::vector<std::uint32_t> receivers;
    std::vector<std::array<float, 4>> lights;  ///< at least one directional and one positional
    Float3 eye{}, target{};
    bool has_view = true;  ///< float32 positions of a view make sense at this scale

    /// For GoogleTest's messages.
    friend std::ostream& operator<<(std::ostream& out, const TestScene& scene) { return out << scene.name; }
};

/// Random numbers by a linear congruential generator (Knuth's constants), high bits only.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) { next(); }
    std::uint32_t next() {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<std::uint32_t>(state_ >> 32);
    }
    std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(std::uint64_t{next()} * count >> 32); }
    float between(float low, float high) { return static_cast<float>(low + (double(high) - low) * next() * 0x1p-32); }

private:
    std::uint64_t state_;
};

/// Coordinate maker: called per coordinate.
template <typename Coordinate>
TestScene random_scene(const std::string& name, std::uint64_t seed, std::size_t triangle_count, std::size_t point_count,
                       Coordinate coordinate) {
    Random random(seed);
    const auto vector = [&] {
        Float3 v;
        for (float& x : v) x = coordinate(random);
        return v;
    };
    TestScene scene;
    scene.name = name;
    for (std::size_t i = 0; i < 3 * triangle_count; ++i)
        for (const float x : vector()) scene.triangles.push_back(x);
    for (std::size_t i = 0; i < point_count; ++i) {
        const std::uint32_t receiver = random.below(static_cast<std::uint32_t>(triangle_count));
        const Triangle t = triangle_at(scene.triangles, receiver);
        Float3 point = vector();
        const float share = random.between(0, 1);
        const std::uint32_t kind = random.below(4);  // free, a vertex, near an edge, near the triangle
        if (kind == 1) point = t[0];
        for (int k = 0; k < 3; ++k) {
            if (kind == 2) point[k] = t[0][k] / 2 + t[1][k] / 2;
            if (kind == 3) point[k] = t[0][k] / 2 + (t[1][k] * share + t[2][k] * (1 - share)) / 2;
            scene.points.push_back(point[k]);
        }
        scene.receivers.push_back(random.below(4) == 0 ? NO_RECEIVER : receiver);
    }
    const Float3 direction = vector(), position = vector();
    scene.lights = {{direction[0], direction[1], direction[2], 0},
                    {position[0], position[1], position[2], 1},
                    {0, coordinate(random), 0, 0},
                    {scene.triangles[3], scene.triangles[4], scene.triangles[5], 1}};  // at a vertex
    scene.eye = vector();
    scene.target = {scene.triangles[0], scene.triangles[1], scene.triangles[2]};
    return scene;
}

/// Another `variant`: other scenes of the same kinds. `more_points`: that many times the points.
inline std::vector<TestScene> all_test_scenes(std::uint64_t variant = 0, std::size_t more_points = 1) {
    std::vector<TestScene> scenes;
    const auto add = [&](const std::string& name, std::uint64_t seed, std::size_t triangles, std::size_t points,
                         auto coordinate) {
        scenes.push_back(random_scene(name, 100 * variant + seed, triangles, more_points * points, coordinate));
    };
    add("soup", 1, 120, 240, [](Random& r) { return r.between(-1, 1); });
    // Exact ties everywhere: shared vertices, edges, planes, edge-on rays, zero areas.
    add("lattice", 2, 120, 240, [](Random& r) { return float(r.below(5)) - 2; });
    add("coarse lattice", 3, 60, 240, [](Random& r) { return float(r.below(3)) - 1; });
    add("far from the origin", 4, 120, 240, [](Random& r) { return 1e6f + float(r.below(32)) * 0.0625f; });
    add("millimetres in kilometres", 5, 120, 240,
        [](Random& r) { return r.below(4) == 0 ? r.between(-1e3f, 1e3f) : r.between(-1e-3f, 1e-3f); });
    // In a plane up to single ulps: every sign is a small difference of large products.
    add("nearly flat", 6, 120, 240,
        [i = 0](Random& r) mutable { return i++ % 3 == 1 ? 1.0f + 0x1p-23f * float(r.below(3)) : r.between(-1, 1); });
    add("denormals", 7, 60, 160, [](Random& r) { return std::ldexp(float(r.below(9)) - 4, -149); });
    add("huge", 8, 60, 160, [](Random& r) { return r.between(-3.4e38f, 3.4e38f); });
    add("all of float's range", 9, 60, 160,
        [](Random& r) { return std::ldexp(r.between(-1, 1), int(r.below(277)) - 149); });
    for (TestScene& scene : scenes)
        if (scene.name == "denormals" || scene.name == "huge" || scene.name == "all of float's range")
            scene.has_view = false;
    return scenes;
}

}  // namespace reference
