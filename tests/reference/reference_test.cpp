// SPDX-License-Identifier: MIT
// Tests of the reference itself: every clause of the visibility contract by hand, then the fast oracle against the
// brute force (other formulas, no tree, no filter), then the camera's truth. Built at two optimisation levels.
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <limits>

#include "brute_force.hpp"
#include "scenes_for_tests.hpp"
#include "view.hpp"

namespace {

using namespace reference;

using Light = std::array<float, 4>;
constexpr Light FROM_ABOVE{0, 1, 0, 0};
const float NOT_A_NUMBER = std::numeric_limits<float>::quiet_NaN();
const float INFINITE = std::numeric_limits<float>::infinity();

/// One triangle in the plane y = 1 with its right angle over the origin and legs of length 2.
const std::vector<float> ROOF{0, 1, 0, 2, 1, 0, 0, 1, 2};

/// Both ways to decide must say the same; returns it.
bool in_shadow(const std::vector<float>& triangles, const Float3& point, const Light& light = FROM_ABOVE,
               std::uint32_t receiver = NO_RECEIVER, const std::optional<Float3>& eye = std::nullopt) {
    const std::vector<std::uint32_t> receivers{receiver};
    const auto fast = shadowed(triangles, point, receivers, light, eye);
    const auto slow = shadowed_by_brute_force(triangles, point, receivers, light, eye);
    EXPECT_EQ(fast, slow);
    return fast.at(0) != 0;
}

std::vector<float> reversed(const std::vector<float>& triangle) {
    return {triangle[6], triangle[7], triangle[8], triangle[3], triangle[4],
            triangle[5], triangle[0], triangle[1], triangle[2]};
}

TEST(Contract, InsideBlocksOutsideDoesNot) {
    EXPECT_TRUE(in_shadow(ROOF, {0.5f, 0, 0.5f}));
    EXPECT_FALSE(in_shadow(ROOF, {1.5f, 0, 1.5f}));
    EXPECT_FALSE(in_shadow({}, {0, 0, 0}));
}

TEST(Contract, EdgesBlock) {
    EXPECT_TRUE(in_shadow(ROOF, {1, 0, 0}));
    EXPECT_TRUE(in_shadow(ROOF, {0, 0, 1}));
    EXPECT_TRUE(in_shadow(ROOF, {1, 0, 1}));
    EXPECT_FALSE(in_shadow(ROOF, {1, 0, -1e-45f}));  // the smallest step off the edge
    EXPECT_FALSE(in_shadow(ROOF, {1, 0, std::nextafter(1.0f, 2.0f)}));
}

TEST(Contract, VerticesBlock) {
    EXPECT_TRUE(in_shadow(ROOF, {0, 0, 0}));
    EXPECT_TRUE(in_shadow(ROOF, {2, 0, 0}));
    EXPECT_TRUE(in_shadow(ROOF, {0, 0, 2}));
    EXPECT_FALSE(in_shadow(ROOF, {std::nextafter(2.0f, 3.0f), 0, 0}));
}

TEST(Contract, BothWindingsBlock) {
    for (const Float3& point : {Float3{0.5f, 0, 0.5f}, Float3{1, 0, 0}, Float3{2, 0, 0}, Float3{3, 0, 3}})
        EXPECT_EQ(in_shadow(ROOF, point), in_shadow(reversed(ROOF), point));
}

TEST(Contract, EdgeOnDoesNotBlock) {
    EXPECT_FALSE(in_shadow(ROOF, {-1, 1, 0.5f}, {1, 0, 0, 0}));
    EXPECT_FALSE(in_shadow(ROOF, {-1, 1, 0.5f}, {5, 1, 0.5f, 1}));
    // A ray tilted by the least amount crosses the plane inside the triangle.
    EXPECT_TRUE(in_shadow(ROOF, {-1, std::nextafter(1.0f, 0.0f), 0.5f}, {3, std::nextafter(1.0f, 2.0f), 0.5f, 1}));
}

TEST(Contract, ZeroAreaDoesNotBlock) {
    EXPECT_FALSE(in_shadow({0, 1, 0, 2, 1, 0, 1, 1, 0}, {1, 0, 0}));
    EXPECT_FALSE(in_shadow({0, 1, 0, 0, 1, 0, 0, 1, 0}, {0, 0, 0}));
    // Three collinear points on a slanted line, and the least area beside it.
    EXPECT_FALSE(in_shadow({0, 1, 0, 3, 2, 3, 1.5f, 1.5f, 1.5f}, {1.5f, 0, 1.5f}));
    EXPECT_TRUE(in_shadow({0, 1, 0, 3, 2, 3, 1.5f, 1.5f, std::nextafter(1.5f, 2.0f)}, {1.5f, 0, 1.5f}));
}

TEST(Contract, PointOnThePlaneIsNotBlocked) {
    EXPECT_FALSE(in_shadow(ROOF, {0.5f, 1, 0.5f}));
    EXPECT_TRUE(in_shadow(ROOF, {0.5f, std::nextafter(1.0f, 0.0f), 0.5f}));
    EXPECT_FALSE(in_shadow(ROOF, {0.5f, std::nextafter(1.0f, 2.0f), 0.5f}));
    EXPECT_FALSE(in_shadow(ROOF, {0, 1, 0}));  // on a vertex
}

TEST(Contract, BehindDoesNotBlock) {
    EXPECT_FALSE(in_shadow(ROOF, {0.5f, 2, 0.5f}));
    EXPECT_TRUE(in_shadow(ROOF, {0.5f, 2, 0.5f}, {0, -1, 0, 0}));
    EXPECT_FALSE(in_shadow(ROOF, {0.5f, 2, 0.5f}, {0.5f, 3, 0.5f, 1}));
}

TEST(Contract, ReceiverDoesNotBlockButItsTwinDoes) {
    EXPECT_FALSE(in_shadow(ROOF, {0.5f, 0, 0.5f}, FROM_ABOVE, 0));
    std::vector<float> twins = ROOF;
    twins.insert(twins.end(), ROOF.begin(), ROOF.end());
    EXPECT_TRUE(in_shadow(twins, {0.5f, 0, 0.5f}, FROM_ABOVE, 0));
    EXPECT_TRUE(in_shadow(ROOF, {0.5f, 0, 0.5f}, FROM_ABOVE, 7));  // a receiver that is no triangle excludes nothing
}

TEST(Contract, PositionalBlocksStrictlyBetween) {
    const Float3 point{0.5f, 0, 0.5f};
    EXPECT_TRUE(in_shadow(ROOF, point, {0.5f, 2, 0.5f, 1}));
    EXPECT_FALSE(in_shadow(ROOF, point, {0.5f, 1, 0.5f, 1}));  // the occluder passes through the light
    EXPECT_TRUE(in_shadow(ROOF, point, {0.5f, std::nextafter(1.0f, 2.0f), 0.5f, 1}));
    EXPECT_FALSE(in_shadow(ROOF, point, {0.5f, std::nextafter(1.0f, 0.0f), 0.5f, 1}));
    EXPECT_FALSE(in_shadow(ROOF, point, {0.5f, 0.5f, 0.5f, 1}));  // the occluder is beyond the light
    EXPECT_FALSE(in_shadow(ROOF, point, {0.5f, 0, 0.5f, 1}));     // the light is at the point
    EXPECT_TRUE(in_shadow(ROOF, {1, 0, 0}, {1, 2, 0, 1}));        // an edge
    EXPECT_TRUE(in_shadow(ROOF, {-1, 0, 0}, {1, 2, 0, 1}));       // a vertex, from the side
}

TEST(Contract, NotFiniteTrianglesAreLeftOut) {
    for (const float bad : {NOT_A_NUMBER, INFINITE, -INFINITE})
        for (std::size_t i = 0; i < 9; ++i) {
            std::vector<float> triangles = ROOF;
            triangles[i] = bad;
            EXPECT_FALSE(in_shadow(triangles, {0.5f, 0, 0.5f})) << i;
            triangles.insert(triangles.end(), ROOF.begin(), ROOF.end());
            EXPECT_TRUE(in_shadow(triangles, {0.5f, 0, 0.5f}, FROM_ABOVE, 0)) << "ids stay: the good one is 1";
            EXPECT_FALSE(in_shadow(triangles, {0.5f, 0, 0.5f}, FROM_ABOVE, 1));
        }
}

TEST(Contract, NotFinitePointsAreLit) {
    EXPECT_FALSE(in_shadow(ROOF, {0.5f, NOT_A_NUMBER, 0.5f}));
    EXPECT_FALSE(in_shadow(ROOF, {0.5f, -INFINITE, 0.5f}));
    EXPECT_FALSE(in_shadow(ROOF, {INFINITE, 0, 0.5f}, FROM_ABOVE, 0, Float3{0, -5, 0})) << "even if facing away";
}

TEST(Contract, FacingAwayIsInShadow) {
    const Float3 above{0, 5, 0}, below{0, -5, 0}, in_plane{7, 1, 3};
    const Float3 on_roof{0.5f, 1, 0.5f};
    for (const auto& roof : {ROOF, reversed(ROOF)}) {
        EXPECT_FALSE(in_shadow(roof, on_roof, FROM_ABOVE, 0, above));
        EXPECT_TRUE(in_shadow(roof, on_roof, FROM_ABOVE, 0, below));
        EXPECT_TRUE(in_shadow(roof, on_roof, FROM_ABOVE, 0, in_plane));
        EXPECT_TRUE(in_shadow(roof, on_roof, {1, 0, 0, 0}, 0, above)) << "light in the plane";
        EXPECT_FALSE(in_shadow(roof, on_roof, {1, 1e-45f, 0, 0}, 0, above));
        EXPECT_TRUE(in_shadow(roof, on_roof, {1, -1e-45f, 0, 0}, 0, above));
        EXPECT_FALSE(in_shadow(roof, on_roof, {9, 2, 9, 1}, 0, above));
        EXPECT_TRUE(in_shadow(roof, on_roof, {9, 1, 9, 1}, 0, above));
        EXPECT_TRUE(in_shadow(roof, on_roof, {9, 0, 9, 1}, 0, above));
        EXPECT_FALSE(in_shadow(roof, on_roof, {9, 0, 9, 1}, 0, below));
    }
    EXPECT_TRUE(in_shadow({0, 1, 0, 2, 1, 0, 1, 1, 0}, {1, 1, 0}, FROM_ABOVE, 0, above)) << "no area, no side";
    EXPECT_FALSE(in_shadow(ROOF, on_roof, FROM_ABOVE, NO_RECEIVER, below)) << "no receiver, no plane";
    EXPECT_FALSE(in_shadow({NOT_A_NUMBER, 1, 0, 2, 1, 0, 1, 1, 0}, {1, 1, 0}, FROM_ABOVE, 0, below)) << "left out";
}

TEST(Contract, FarEndsOfFloat) {
    const float least = std::numeric_limits<float>::denorm_min(), most = std::numeric_limits<float>::max();
    // A roof one denormal step above the floor, with legs of 4 steps.
    const std::vector<float> tiny{0, least, 0, 4 * least, least, 0, 0, least, 4 * least};
    EXPECT_TRUE(in_shadow(tiny, {least, 0, least}));
    EXPECT_TRUE(in_shadow(tiny, {2 * least, 0, 2 * least})) << "on the slanted edge";
    EXPECT_FALSE(in_shadow(tiny, {2 * least, 0, 3 * least}));
    EXPECT_TRUE(in_shadow(tiny, {2 * least, 0, 2 * least}, {0, most, 0, 0}));
    // A roof over everything, seen along float's longest diagonal.
    const std::vector<float> huge{-most, 1, -most, most, 1, -most, -most, 1, most};
    EXPECT_TRUE(in_shadow(huge, {0, 0, 0})) << "on the slanted edge";
    EXPECT_FALSE(in_shadow(huge, {least, 0, 0}));
    EXPECT_TRUE(in_shadow(huge, {-least, 0, 0}));
    EXPECT_TRUE(in_shadow(huge, {-most, -most, -most}, {0, most, -1, 1}));
    EXPECT_FALSE(in_shadow(huge, {0, 1, 0}));
}

/// The light is off the plane through point and edge by 2^-60, far below what the filter can tell beside terms of 1.
TEST(Contract, LightFinerThanEverythingElse) {
    const std::vector<float> roof{-1, 1, -1, 1, 1, 1, 1, 1, -1};
    EXPECT_TRUE(in_shadow(roof, {0, 0, 0}, {0, 2, 0, 1}));
    EXPECT_TRUE(in_shadow(roof, {0, 0, 0}, {0x1p-60f, 2, 0, 1}));
    EXPECT_FALSE(in_shadow(roof, {0, 0, 0}, {-0x1p-60f, 2, 0, 1}));
    EXPECT_TRUE(in_shadow(roof, {0, 0, 0}, {0x1p-60f, 2, 0, 0}));
    EXPECT_FALSE(in_shadow(roof, {0, 0, 0}, {-0x1p-60f, 2, 0, 0}));
}

TEST(Contract, TiesFarFromTheOrigin) {
    const float far = 1e6f, step = std::nextafter(far, 2e6f) - far;
    const std::vector<float> roof{far, far, far, far + 8 * step, far, far, far, far, far + 8 * step};
    EXPECT_TRUE(in_shadow(roof, {far + 4 * step, far - 1, far + 4 * step})) << "on the slanted edge";
    EXPECT_FALSE(in_shadow(roof, {far + 5 * step, far - 1, far + 4 * step}));
    EXPECT_TRUE(in_shadow(roof, {far + 3 * step, far - step, far + 4 * step}));
}

/// A lattice floor of unit squares, two triangles each: rays through its lattice and half-lattice points all hit edges
/// or vertices, and none may leak.
TEST(Contract, ClosedMeshNeverLeaks) {
    std::vector<float> floor;
    for (int x = -4; x < 4; ++x)
        for (int z = -4; z < 4; ++z) {
            const float x0 = float(x), x1 = x0 + 1, z0 = float(z), z1 = z0 + 1;
            floor.insert(floor.end(), {x0, 0, z0, x1, 0, z0, x0, 0, z1});
            floor.insert(floor.end(), {x1, 0, z1, x0, 0, z1, x1, 0, z0});
        }
    std::vector<float> points;
    for (int x = -8; x <= 8; ++x)
        for (int z = -8; z <= 8; ++z) points.insert(points.end(), {float(x) / 2 - 1, -1, float(z) / 2});
    const Light slanted{1, 1, 0, 0};
    const auto fast = shadowed(floor, points, {}, slanted);
    EXPECT_EQ(fast, std::vector<std::uint8_t>(points.size() / 3, 1));
    EXPECT_EQ(fast, shadowed_by_brute_force(floor, points, {}, slanted));
}

TEST(Oracle, RefusesSizesThatDoNotMatch) {
    const std::vector<float> eight(8), three(3);
    const std::vector<std::uint32_t> two(2);
    EXPECT_THROW(shadowed(eight, three, {}, FROM_ABOVE), std::invalid_argument);
    EXPECT_THROW(shadowed(ROOF, eight, {}, FROM_ABOVE), std::invalid_argument);
    EXPECT_THROW(shadowed(ROOF, three, two, FROM_ABOVE), std::invalid_argument);
    EXPECT_THROW(shadowed(ROOF, three, {}, {0, NOT_A_NUMBER, 0, 0}), std::invalid_argument);
}

TEST(Oracle, CountsEveryPointOnce) {
    const std::vector<float> points{0.5f, 0, 0.5f, 3, 0, 3, NOT_A_NUMBER, 0, 0, 0.5f, 1, 0.5f};
    const std::vector<std::uint32_t> receivers{NO_RECEIVER, NO_RECEIVER, NO_RECEIVER, 0};
    VisibilityCounts counts;
    const auto result = shadowed(ROOF, points, receivers, FROM_ABOVE, Float3{0, -5, 0}, &counts);
    EXPECT_EQ(result, (std::vector<std::uint8_t>{1, 0, 0, 1}));
    EXPECT_EQ(counts.shadowed, 1u);
    EXPECT_EQ(counts.lit, 1u);
    EXPECT_EQ(counts.absent, 1u);
    EXPECT_EQ(counts.facing_away, 1u);
}

class RandomScenes : public testing::TestWithParam<TestScene> {};

TEST_P(RandomScenes, OracleIsTheBruteForce) {
    const TestScene& scene = GetParam();
    for (const Light& light : scene.lights) {
        const auto fast = shadowed(scene.triangles, scene.points, scene.receivers, light, scene.eye);
        EXPECT_EQ(fast, shadowed_by_brute_force(scene.triangles, scene.points, scene.receivers, light, scene.eye));
        const auto without_eye = shadowed(scene.triangles, scene.points, scene.receivers, light);
        EXPECT_EQ(without_eye, shadowed_by_brute_force(scene.triangles, scene.points, scene.receivers, light));
    }
}

TEST_P(RandomScenes, ShadowedAndLitBothOccur) {
    const TestScene& scene = GetParam();
    VisibilityCounts counts, sum;
    for (const Light& light : scene.lights) {
        shadowed(scene.triangles, scene.points, scene.receivers, light, scene.eye, &counts);
        sum += counts;
    }
    EXPECT_GT(sum.lit, 10u);
    EXPECT_GT(sum.shadowed, 10u);
    EXPECT_GT(sum.facing_away, 10u);
}

TEST_P(RandomScenes, NearestTriangleIsTheBruteForces) {
    const TestScene& scene = GetParam();
    const Bvh bvh(scene.triangles);
    Random random(77);
    int hits = 0;
    for (int i = 0; i < 60; ++i) {
        // Towards a vertex, exactly where the coordinates allow it, or anywhere.
        std::array<std::int64_t, 3> direction;
        const std::size_t vertex = 3 * random.below(static_cast<std::uint32_t>(scene.triangles.size() / 3));
        int largest = FINEST_EXPONENT;
        for (std::size_t k = 0; k < 3; ++k)
            largest = std::max(largest, std::ilogb(double(scene.triangles[vertex + k]) - scene.eye[k]));
        for (std::size_t k = 0; k < 3; ++k)
            direction[k] =
                i % 2 ? std::int64_t{random.next()} * 0x40000000 - 0x2000000000000000
                      : std::llrint(std::ldexp(double(scene.triangles[vertex + k]) - scene.eye[k], 59 - largest));
        const Ray ray = Ray::through_pixel(scene.eye, direction);
        Effort effort;
        const auto fast = nearest_triangle(bvh, ray, effort);
        const auto slow = nearest_by_brute_force(scene.triangles, ray);
        ASSERT_EQ(fast.has_value(), slow.has_value());
        if (!fast) continue;
        ++hits;
        EXPECT_EQ(*fast, slow->ids.front()) << "the lowest id of the nearest ones";
    }
    EXPECT_GT(hits, 5);
}

TEST_P(RandomScenes, ParameterBoundsHoldTheExactParameter) {
    const TestScene& scene = GetParam();
    Random random(78);
    int ahead = 0;
    for (std::size_t id = 0; id < scene.triangles.size() / 9; ++id) {
        const Triangle triangle = triangle_at(scene.triangles, id);
        // Nearly along an edge from a point nearly in the plane: numerator and denominator both cancel.
        const Float3 origin = point_at(scene.points, random.below(static_cast<std::uint32_t>(scene.points.size() / 3)));
        std::array<std::int64_t, 3> direction;
        int largest = FINEST_EXPONENT;
        for (std::size_t k = 0; k < 3; ++k)
            largest = std::max(largest, std::ilogb(double(triangle[1][k]) - triangle[0][k]));
        for (std::size_t k = 0; k < 3; ++k)
            direction[k] = std::llrint(std::ldexp(double(triangle[1][k]) - triangle[0][k], 59 - largest)) +
                           std::int64_t(random.below(1u << (random.below(31) + 1)));
        const Ray ray = Ray::through_pixel(origin, direction);
        const Quotient exact = exact_parameter(ray, triangle);
        if (exact.denominator.is_zero() || exact.numerator.sign() < 0) continue;
        ++ahead;
        const ParameterBounds bounds = parameter_bounds(ray, triangle);
        EXPECT_LE(bounds.earliest, exact.value());
        EXPECT_GE(bounds.latest, exact.value());
    }
    EXPECT_GT(ahead, 10);
}

class ViewsOfRandomScenes : public testing::TestWithParam<TestScene> {};

TEST_P(ViewsOfRandomScenes, KeepEveryPromise) {
    const TestScene& scene = GetParam();
    const PinholeCamera camera{scene.eye, scene.target, {0, 1, 0}, 60, 40, 30};
    const View view = make_view(scene.triangles, camera, scene.lights[0]);
    const ViewReport report = judge_view(scene.triangles, camera, scene.lights[0], view.claim());
    EXPECT_EQ(report.wrong(), 0u);
    EXPECT_EQ(report.camera_ambiguous, 0u);
    EXPECT_LT(report.sky, report.pixels);
    EXPECT_LT(report.largest_distance_ulp, 3.0L) << "half an ulp per axis and a step or two";
}

std::vector<TestScene> scenes_with_a_view() {
    std::vector<TestScene> scenes = all_test_scenes();
    std::erase_if(scenes, [](const TestScene& scene) { return !scene.has_view; });
    return scenes;
}

std::string name_of(const testing::TestParamInfo<TestScene>& instance) {
    std::string name = instance.param.name;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(All, RandomScenes, testing::ValuesIn(all_test_scenes()), name_of);
INSTANTIATE_TEST_SUITE_P(All, ViewsOfRandomScenes, testing::ValuesIn(scenes_with_a_view()), name_of);

TEST(Bvh, CoincidentTrianglesAndManyOfThem) {
    std::vector<float> many;
    for (int i = 0; i < 1000; ++i) many.insert(many.end(), ROOF.begin(), ROOF.end());
    const Float3 point{0.5f, 0, 0.5f};
    EXPECT_EQ(shadowed(many, point, {}, FROM_ABOVE).at(0), 1);
    // Each twice as far as the one before: the heuristic's worst case for depth.
    std::vector<float> doubling;
    for (int i = -140; i < 120; ++i) {
        const float x = std::ldexp(1.0f, i);
        for (int copy = 0; copy < 8; ++copy) doubling.insert(doubling.end(), {x, 1, 0, x * 1.25f, 1, 0, x, 1, x});
    }
    std::vector<float> below, beside;
    for (int i = -140; i < 120; ++i) {
        below.insert(below.end(), {std::ldexp(1.0f, i), 0, 0});
        beside.insert(beside.end(), {std::ldexp(1.5f, i), 0, 0});
    }
    EXPECT_EQ(shadowed(doubling, below, {}, FROM_ABOVE), std::vector<std::uint8_t>(260, 1));
    EXPECT_EQ(shadowed(doubling, beside, {}, FROM_ABOVE), std::vector<std::uint8_t>(260, 0));
}

/// Rays that meet a triangle's box in one corner alone, where a vertex is: on one axis the ray enters exactly when it
/// leaves on another, and only the slack of the box test keeps the box.
TEST(Bvh, BoxesMetInOneCornerAreKept) {
    Random random(5);
    for (int i = 0; i < 2000; ++i) {
        Float3 direction, vertex;
        const float steps = float(1 + random.below(2000));
        for (int k = 0; k < 3; ++k) {
            direction[k] = float(1 + random.below(4000));
            vertex[k] = steps * direction[k];  // below 2^24: exact
        }
        const std::vector<float> triangle{vertex[0],     vertex[1],     vertex[2],  //
                                          vertex[0] + 1, vertex[1] - 1, vertex[2],  //
                                          vertex[0] + 1, vertex[1] - 2, vertex[2] + 1};
        const Light light{direction[0], direction[1], direction[2], 0};
        ASSERT_TRUE(in_shadow(triangle, {0, 0, 0}, light)) << steps << ": " << direction[0] << ' ' << direction[1];
    }
}

TEST(Exact, QuotientsBecomeLongDouble) {
    EXPECT_EQ((Quotient{Integer(3), Integer(4), 0}.value()), 0.75L);
    EXPECT_EQ((Quotient{Integer(-3), Integer(4), -10}.value()), -0.75L / 1024);
    EXPECT_EQ((Quotient{Integer(0), Integer(4), 5}.value()), 0.0L);
    EXPECT_EQ((Quotient{Integer(5) << 900, Integer(1) << 901, 0}.value()), 2.5L);
    EXPECT_NEAR(double(Quotient{Integer(1), Integer(3), 0}.value()), 1.0 / 3, 1e-17);
}

// ---- The camera ----------------------------------------------------------------------------------------------------

TEST(Camera, RowsStartOnTopAndColumnsLeft) {
    // Looking along -Z with up +Y, right is +X.
    const PixelRays rays({{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90, 4, 2});
    const Ray top_left = rays.through(centre_of(0, 0)), bottom_right = rays.through(centre_of(3, 1));
    // t = 1, aspect 2: x = (1/4 - 1) * 2 = -1.5, y = 0.5, z = -1.
    EXPECT_NEAR(top_left.direction[0] / -top_left.direction[2], -1.5, 1e-15);
    EXPECT_NEAR(top_left.direction[1] / -top_left.direction[2], 0.5, 1e-15);
    EXPECT_NEAR(bottom_right.direction[0] / -bottom_right.direction[2], 1.5, 1e-15);
    EXPECT_NEAR(bottom_right.direction[1] / -bottom_right.direction[2], -0.5, 1e-15);
}

TEST(Camera, RefusesCamerasWithoutAView) {
    EXPECT_THROW(PixelRays({{1, 2, 3}, {1, 2, 3}, {0, 1, 0}, 50, 4, 4}), std::invalid_argument);
    EXPECT_THROW(PixelRays({{0, 0, 0}, {0, 2, 0}, {0, 1, 0}, 50, 4, 4}), std::invalid_argument);
    EXPECT_THROW(PixelRays({{0, 0, 0}, {0, 0, -1}, {0, 0, 0}, 50, 4, 4}), std::invalid_argument);
    EXPECT_THROW(PixelRays({{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 180, 4, 4}), std::invalid_argument);
    EXPECT_THROW(PixelRays({{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 50, 0, 4}), std::invalid_argument);
}

/// One pixel that looks down at a wall z = -8 from the origin; the pixel's centre is the view's.
class OnePixel : public testing::Test {
protected:
    CameraVerdict judge(std::uint32_t receiver, const Float3& point, double tolerance = DEFAULT_RAY_TOLERANCE) const {
        const Bvh bvh(triangles);
        Effort effort;
        return judge_position(bvh, triangles, PixelRays(camera, tolerance), centre_of(0, 0), receiver, point, effort);
    }

    PinholeCamera camera{{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 60, 1, 1};
    std::vector<float> triangles{-4, -4, -8, 4, -4, -8, 0, 4, -8};
    const float ulp = 0x1p-20f;  // of 8
};

TEST_F(OnePixel, TrueClaimIsKept) {
    const CameraVerdict verdict = judge(0, {0, 0, -8});
    EXPECT_TRUE(verdict.is_nearest && verdict.is_on_side && verdict.is_close && !verdict.is_ambiguous);
    EXPECT_NEAR(double(verdict.distance_ulp), 0, 1e-9);
}

TEST_F(OnePixel, DistanceIsSixteenUlpAndNoMore) {
    EXPECT_TRUE(judge(0, {0, 0, -8 + 16 * ulp / 2}).is_close)
        << "ulp below 8 are half as large; this is 8 of P's largest";
    EXPECT_TRUE(judge(0, {16 * ulp, 0, -8}).is_close);
    EXPECT_FALSE(judge(0, {16 * ulp + ulp / 64, 0, -8}).is_close);
    EXPECT_NEAR(double(judge(0, {0, 40 * ulp, -8}).distance_ulp), 40, 1e-6);
}

TEST_F(OnePixel, PointMustNotBeUnderItsPlane) {
    EXPECT_TRUE(judge(0, {0, 0, -8}).is_on_side);
    EXPECT_TRUE(judge(0, {0, 0, std::nextafter(-8.0f, 0.0f)}).is_on_side);
    EXPECT_FALSE(judge(0, {0, 0, std::nextafter(-8.0f, -9.0f)}).is_on_side);
    triangles = reversed(triangles);
    EXPECT_TRUE(judge(0, {0, 0, std::nextafter(-8.0f, 0.0f)}).is_on_side);
    EXPECT_FALSE(judge(0, {0, 0, std::nextafter(-8.0f, -9.0f)}).is_on_side);
}

TEST_F(OnePixel, SkyIsClaimedOnlyWhereNothingIsMet) {
    EXPECT_FALSE(judge(NO_RECEIVER, {0, 0, 0}).is_nearest);
    triangles = {-4, -4, 8, 4, -4, 8, 0, 4, 8};  // behind the eye
    EXPECT_TRUE(judge(NO_RECEIVER, {0, 0, 0}).is_nearest);
    EXPECT_FALSE(judge(0, {0, 0, 8}).is_nearest);
}

TEST_F(OnePixel, EdgeOnIsNeverMet) {
    triangles = {0, -4, -8, 0, 4, -8, 0, 0, -2};  // in the plane x = 0, which holds the ray
    EXPECT_TRUE(judge(NO_RECEIVER, {0, 0, 0}, 0).is_nearest);
    EXPECT_FALSE(judge(0, {0, 0, -2}, 0).is_nearest);
}

TEST_F(OnePixel, OtherReceiverMustBeWithinSixteenUlpOfDepth) {
    const auto add_wall = [&](float z) { triangles.insert(triangles.end(), {-4, -4, z, 4, -4, z, 0, 4, z}); };
    add_wall(-8 - 16 * ulp);
    add_wall(-8 - 17 * ulp);
    EXPECT_TRUE(judge(0, {0, 0, -8}).is_nearest);
    EXPECT_TRUE(judge(1, {0, 0, -8 - 16 * ulp}).is_nearest);
    EXPECT_FALSE(judge(2, {0, 0, -8 - 17 * ulp}).is_nearest);
    EXPECT_FALSE(judge(9, {0, 0, -8}).is_nearest) << "no such triangle";
    triangles.insert(triangles.end(), {1, -4, -8, 4, -4, -8, 4, 4, -8});  // as near, but beside the ray
    EXPECT_FALSE(judge(3, {0, 0, -8}).is_nearest);
}

TEST_F(OnePixel, EdgeWithinTheToleranceIsAmbiguousAndBeyondItWrong) {
    triangles = {0, -4, -8, 4, -4, -8, 0, 4, -8};  // the ray goes exactly through the edge x = 0: closed, so it is met
    EXPECT_TRUE(judge(0, {0, 0, -8}).is_nearest);
    EXPECT_FALSE(judge(0, {0, 0, -8}).is_ambiguous);
    EXPECT_TRUE(judge(NO_RECEIVER, {0, 0, 0}).is_nearest) << "a ray an ulp of double to the left misses";
    EXPECT_TRUE(judge(NO_RECEIVER, {0, 0, 0}).is_ambiguous);
    EXPECT_FALSE(judge(NO_RECEIVER, {0, 0, 0}, 0).is_nearest);
    const float beside = 0x1p-30f;
    triangles = {beside, -4, -8, 4, -4, -8, beside, 4, -8};
    EXPECT_FALSE(judge(0, {0, 0, -8}).is_nearest);
    EXPECT_TRUE(judge(0, {0, 0, -8}, 0x1p-32).is_ambiguous);
    // Two triangles that share the edge under the ray leave no room for the sky, tilted or not.
    triangles = {0, -4, -8, 4, -4, -8, 0, 4, -8, 0, -4, -8, 0, 4, -8, -4, -4, -8};
    EXPECT_FALSE(judge(NO_RECEIVER, {0, 0, 0}).is_nearest);
    EXPECT_TRUE(judge(1, {0, 0, -8}).is_nearest);
}

// ---- The judge of whole views ---------------------------------------------------------------------------------------

class Judge : public testing::Test {
protected:
    std::vector<float> triangles{-9, 0, -9, 9, 0, -9, -9, 0, 9, 9, 0, 9, -9, 0, 9, 9, 0, -9,  // a floor
                                 -3, 2, -3, 3, 2, -3, 0,  2, 3};                              // a roof over it
    PinholeCamera camera{{3, 4, 8}, {0, 1, 0}, {0, 1, 0}, 60, 32, 24};
    Light light{0.25f, 1, 0.125f, 0};
    View view = make_view(triangles, camera, light);

    ViewReport report() const { return judge_view(triangles, camera, light, view.claim()); }
    std::size_t pixel_on(std::uint32_t receiver) const {
        for (std::size_t i = 0; i < view.receiver.size(); ++i)
            if (view.receiver[i] == receiver) return i;
        throw std::logic_error("no pixel sees it");
    }
};

TEST_F(Judge, RightViewHasNothingWrong) {
    const ViewReport right = report();
    EXPECT_EQ(right.wrong(), 0u);
    EXPECT_EQ(right.pixels, 32u * 24);
    EXPECT_EQ(right.camera_pixels, right.pixels);
    EXPECT_GT(right.sky, 20u);
    EXPECT_GT(right.visibility.lit, 100u);
    EXPECT_GT(right.visibility.shadowed, 10u);
    EXPECT_EQ(right.sky + right.visibility.lit + right.visibility.shadowed + right.visibility.facing_away,
              right.pixels);
}

TEST_F(Judge, FindsEveryFlippedVisibility) {
    for (std::size_t i = 0; i < view.visibility.size(); i += 37) {
        view.visibility[i] = 1 - view.visibility[i];
        const ViewReport wrong = report();
        const Faults& faults = view.receiver[i] == NO_RECEIVER ? wrong.wrong_sky : wrong.wrong_visibility;
        EXPECT_EQ(wrong.wrong(), 1u);
        EXPECT_EQ(faults.first, std::vector<std::size_t>{i});
        view.visibility[i] = 1 - view.visibility[i];
    }
    view.visibility[pixel_on(0)] = 0.5f;
    EXPECT_EQ(report().wrong_visibility.count, 1u);
}

TEST_F(Judge, FindsWrongNormals) {
    const std::size_t pixel = pixel_on(0);
    float* normal = &view.normal[3 * pixel];
    ASSERT_EQ(Float3({normal[0], normal[1], normal[2]}), Float3({0, 1, 0}));
    normal[1] = -1;  // away from the eye
    EXPECT_EQ(report().wrong_normal.first, std::vector<std::size_t>{pixel});
    normal[1] = 1.00001f;  // not of unit length
    EXPECT_EQ(report().wrong_normal.count, 1u);
    normal[1] = 1;
    normal[0] = 2e-5f;  // not perpendicular
    EXPECT_EQ(report().wrong_normal.count, 1u);
    normal[0] = 0;
    EXPECT_EQ(report().wrong(), 0u);
}

TEST_F(Judge, FindsWrongSky) {
    const std::size_t sky = pixel_on(NO_RECEIVER);
    view.position[3 * sky + 1] = 1;
    EXPECT_EQ(report().wrong_sky.first, std::vector<std::size_t>{sky});
}

TEST_F(Judge, SamplesAboutAsManyAsAsked) {
    const ViewReport sampled = judge_view(triangles, camera, light, view.claim(), {DEFAULT_RAY_TOLERANCE, 200, 3});
    EXPECT_GT(sampled.camera_pixels, 150u);
    EXPECT_LT(sampled.camera_pixels, 250u);
    EXPECT_EQ(sampled.wrong(), 0u);
}

TEST_F(Judge, RefusesSizesThatDoNotMatch) {
    view.visibility.pop_back();
    EXPECT_THROW(report(), std::invalid_argument);
}

}  // namespace
