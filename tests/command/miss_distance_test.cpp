// SPDX-License-Identifier: MIT
// By how much a shadow ray misses a triangle: distances that whole numbers give by Pythagoras.
#include "host/app/miss_distance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace {

using gnomon::Float3, gnomon::Light, gnomon::TriangleSigns;

struct Case {
    const char* what;
    std::array<float, 9> vertices;
    Float3 point;
    Light light;
    double distance;
};

// The triangle lies 4 above the ground, its edge from (0,4,0) to (0,4,8), its corner at (-8,4,0).
constexpr std::array<float, 9> roof{0, 4, 0, 0, 4, 8, -8, 4, 0};

TEST(MissDistance, IsThatOfPythagoras) {
    const Light above = Light::directional({0, -1, 0});
    for (const Case& c : {
             Case{"beside an edge", roof, {3, 0, 2}, above, 3},
             Case{"beside a corner, 3 and 4 away", roof, {3, 0, 12}, above, 5},
             Case{"beside a slanting edge", roof, {-8, 0, 8}, above, std::sqrt(32.0)},
             Case{"a slanting ray", roof, {0, 0, 4}, Light::directional({-3, -4, 0}), 2.4},
             Case{"behind the ray's start", roof, {-2, 7, 2}, above, 3},
             Case{"behind the ray's start and beside", roof, {3, 8, 2}, above, 5},
             Case{"beyond the lamp", roof, {-2, 0, 2}, Light::point({-2, 1, 2}), 3},
             Case{"beyond the lamp and beside", roof, {3, -9, 2}, Light::point({3, 0, 2}), 5},
             Case{"the lamp's ray passes", roof, {5, 0, 2}, Light::point({5, 9, 2}), 5},
             Case{"edge-on", {0, 4, 0, 0, 4, 8, 0, 9, 0}, {1, 0, 2}, above, 1},
             Case{"a triangle that is a point", {0, 4, 0, 0, 4, 0, 0, 4, 0}, {3, 0, 4}, above, 5},
             Case{"parallel to the ray", {0, 4, 0, 0, 8, 0, 0, 6, 0}, {3, 0, 4}, above, 5},
             Case{"starts on it", roof, {-2, 4, 2}, above, 0},
         }) {
        TriangleSigns triangle;
        triangle.vertices = c.vertices;
        const double found = gnomon::app::miss_distance(triangle, c.point, c.light);
        EXPECT_NEAR(found, c.distance, 4e-16 * 16) << c.what;
        // Any corner may be the first one, in either winding.
        for (const auto& order : {std::array{3, 6, 0}, std::array{6, 3, 0}, std::array{3, 0, 6}}) {
            for (int corner = 0; corner < 3; ++corner)
                std::copy_n(&c.vertices[std::size_t(order[std::size_t(corner)])], 3,
                            &triangle.vertices[std::size_t(3 * corner)]);
            EXPECT_NEAR(gnomon::app::miss_distance(triangle, c.point, c.light), c.distance, 4e-16 * 16) << c.what;
        }
    }
}

}  // namespace
