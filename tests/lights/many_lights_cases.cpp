// SPDX-License-Identifier: MIT
// Many lights in scenes where single answers are known: closed forms, closed solids, borders and holes of a terrain,
// lights in planes; and what must not change a bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "support/device.hpp"
#include "support/light_scenes.hpp"

namespace {

using namespace support;
using gnomon::Lights;

constexpr gnomon::LightsWanted EVERYTHING{true, true, true, true, true};
constexpr const char* WAYS[] = {"one-by-one", "beams", "point-beams", "rays", "auto"};

gnomon::LightsOnHost run(const gnomon::Device& device, const LightScene& scene, const Lights& lights,
                         const std::string& way, gnomon::RunOptions options = {}) {
    if (scene.eye) options.facing = gnomon::Facing::eye(*scene.eye);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->set("many-lights", way);
    return gnomon::run_light_table_to_host(*technique, gnomon::Triangles::upload(device, scene.triangles),
                                           upload_points(device, scene), lights, EVERYTHING, options);
}

bool is_lit(const gnomon::LightsOnHost& answers, std::size_t lights, std::size_t point, std::size_t light) {
    return (answers.bits.at(point * ((lights + 31) / 32) + light / 32) >> (light % 32) & 1u) != 0;
}

/// Every bit by every way that takes these lights against the oracle. Returns the share of lit pairs.
double expect_truth(const gnomon::Device& device, LightScene scene, const Lights& lights) {
    std::vector<std::vector<float>> truth;
    std::size_t lit = 0;
    const std::size_t points = scene.points.size() / 3, count = lights.count();
    for (const gnomon::Light& light : lights.lights()) {
        scene.light = light.xyzw;
        truth.push_back(truth_of(scene));
    }
    for (const std::string way : WAYS) {
        SCOPED_TRACE(scene.name + ", " + way);
        if ((way == "beams" || way == "point-beams" || way == "rays") &&
            !std::ranges::all_of(lights.lights(), &gnomon::Light::is_directional))
            continue;
        const auto answers = run(device, scene, lights, way);
        lit = 0;
        for (std::size_t p = 0; p < points; ++p)
            for (std::size_t l = 0; l < count; ++l) {
                EXPECT_EQ(is_lit(answers, count, p, l), truth[l][p] != 0) << "point " << p << ", light " << l;
                lit += truth[l][p] != 0;
                if (testing::Test::HasFailure()) return 0;
            }
    }
    return double(lit) / double(points * count);
}

void add_quad(Floats& to, const Float3& a, const Float3& b, const Float3& c, const Float3& d) {
    for (const Float3& p : {a, b, c, a, c, d}) append(to, {p[0], p[1], p[2]});
}

/// A closed box with its outside counter-clockwise.
void add_box(Floats& to, const Float3& low, const Float3& high) {
    const auto at = [&](int x, int y, int z) {
        return Float3{x ? high[0] : low[0], y ? high[1] : low[1], z ? high[2] : low[2]};
    };
    add_quad(to, at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0));
    add_quad(to, at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
    add_quad(to, at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
    add_quad(to, at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0));
    add_quad(to, at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0));
    add_quad(to, at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
}

/// Directions on a lattice around the vertical: many in planes of axis-parallel faces and through lattice edges.
Lights lattice_lights(int reach, bool from_below) {
    std::vector<gnomon::Light> lights;
    for (int x = -reach; x <= reach; ++x)
        for (int z = -reach; z <= reach; ++z)
            for (int y = from_below ? -2 : 1; y <= 2; ++y)
                if (x != 0 || y != 0 || z != 0)
                    lights.push_back(gnomon::Light::directional({float(x), float(-y), float(z)}));
    return Lights(lights);
}

// A tower of radius 1 and height 4, 5 to the side of a point on the floor. A ray at angle a beside the axis enters it
// after 5 cos a - sqrt(1 - 25 sin^2 a), where |sin a| <= 1/5, and is blocked unless it is higher than 4 there: exact
// up to the tower's 720 sides, whose middles lie 1e-5 within the circle. No light is so near to a limit.
TEST(ManyLightsCases, ACylindersShadowHasItsClosedForm) {
    constexpr int sides = 720;
    constexpr double distance = 5, height = 4;
    LightScene scene{"cylinder", {}, {0, 0, 0}, {}};
    const auto rim = [&](int i, float y) {
        const double angle = 2 * std::numbers::pi * i / sides;
        return Float3{float(distance + std::cos(angle)), y, float(std::sin(angle))};
    };
    for (int i = 0; i < sides; ++i) {
        add_quad(scene.triangles, rim(i, -1), rim(i + 1, -1), rim(i + 1, height), rim(i, height));
        const Float3 top{float(distance), float(height), 0}, a = rim(i, height), b = rim(i + 1, height);
        append(scene.triangles, {top[0], top[1], top[2], a[0], a[1], a[2], b[0], b[1], b[2]});
    }
    std::vector<gnomon::Light> lights;
    std::vector<bool> expected;
    std::size_t blocked = 0;
    for (int azimuth = 0; azimuth < 360; ++azimuth)
        for (const double slope : {0.0317, 0.31, 0.79, 0.93, 0.991, 1.009, 1.71}) {
            const double a = (azimuth - 180 + 0.37) * std::numbers::pi / 180;
            lights.push_back(gnomon::Light::directional({float(-std::cos(a)), float(-slope), float(-std::sin(a))}));
            const double s = distance * std::sin(a);
            bool hits = std::cos(a) > 0 && std::fabs(s) < 1;
            if (hits) hits = slope * (distance * std::cos(a) - std::sqrt(1 - s * s)) < height;
            expected.push_back(!hits);
            blocked += hits;
        }
    const gnomon::Device device = device_with();
    for (const char* way : WAYS) {
        const auto answers = run(device, scene, Lights(lights), way);
        for (std::size_t l = 0; l < lights.size(); ++l)
            EXPECT_EQ(is_lit(answers, lights.size(), 0, l), expected[l]) << way << ", light " << l;
        EXPECT_EQ(answers.counts[0], lights.size() - blocked);
    }
    EXPECT_GT(blocked, 60u);
}

TEST(ManyLightsCases, LightsInPlanesOfTrianglesAndTwice) {
    LightScene scene{"fins", {}, {}, {}};
    for (int i = 0; i < 6; ++i) {
        const float x = float(i);
        add_quad(scene.triangles, {x, 0, 0}, {x, 0, 6}, {x, 3, 6}, {x, 3, 0});            // in planes of constant x
        add_quad(scene.triangles, {0, x, 8}, {6, x, 8}, {6, x, 10}, {0, x, 10});          // of constant y
        add_quad(scene.triangles, {0, 0, x}, {6, 0, x}, {6, -3, x - 3}, {0, -3, x - 3});  // tilted by a diagonal
    }
    for (int i = 0; i < 400; ++i)
        append(scene.points, {float(i % 13) / 2, float(i / 13 % 9) / 2 - 2, float(i % 29) / 2 - 2});
    const gnomon::Device device = device_with();
    const double lit = expect_truth(device, scene, lattice_lights(2, true));
    EXPECT_GT(lit, 0.1);
    EXPECT_LT(lit, 0.9);
    // The same lights twice, in another order: the same bits twice.
    const Lights once = lattice_lights(1, true);
    std::vector<gnomon::Light> both(once.lights().rbegin(), once.lights().rend());
    both.insert(both.end(), once.lights().begin(), once.lights().end());
    for (const char* way : WAYS) {
        const auto answers = run(device, scene, Lights(both), way);
        const std::size_t m = once.count();
        for (std::size_t p = 0; p < scene.points.size() / 3; ++p)
            for (std::size_t l = 0; l < m; ++l)
                ASSERT_EQ(is_lit(answers, 2 * m, p, l), is_lit(answers, 2 * m, p, 2 * m - 1 - l));
    }
}

TEST(ManyLightsCases, WeightsOfZeroAndOfBothSigns) {
    const gnomon::Device device = device_with();
    const LightScene scene{"nothing in the way", {5, 5, 5, 6, 5, 5, 5, 6, 5}, {0, 0, 0}, {}};
    const std::vector<gnomon::Light> lights(33, gnomon::Light::directional({0, -1, 0}));
    for (const char* way : WAYS) {
        EXPECT_EQ(run(device, scene, Lights(lights, std::vector<float>(33, 0.0f)), way).sums[0], 0);
        std::vector<float> weights(33, -0.0f);
        weights[3] = 1e30f;
        weights[7] = -1e30f;
        weights[32] = -1e-30f;  // rounded to nothing beside the others
        const Lights mixed(lights, weights);
        EXPECT_EQ(run(device, scene, mixed, way).sums[0], 0);
        EXPECT_EQ(run(device, scene, mixed, way).counts[0], 33u);
        EXPECT_GT(mixed.largest_rounding(), 0);
    }
}

// Points on a floor's top and on a box, by their receivers: lights from below are dark where the front is the side, and
// pass the receiver alone where no side is given.
TEST(ManyLightsCases, SunsBelowTheHorizon) {
    LightScene scene{"floor", {}, {}, {}};
    add_quad(scene.triangles, {-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9});
    for (int i = 0; i < 40; ++i) {
        append(scene.points, {float(i % 7) - 3, 0, float(i % 5) - 6.5f});
        const bool is_second = scene.points[3 * i] > scene.points[3 * i + 2];
        scene.receivers.push_back(is_second ? 1u : 0u);
    }
    const Lights lights = lattice_lights(2, true);
    const gnomon::Device device = device_with();
    const gnomon::RunOptions front{.facing = gnomon::Facing::winding()};
    for (const char* way : WAYS) {
        const auto answers = run(device, scene, lights, way, front), sideless = run(device, scene, lights, way);
        for (std::size_t p = 0; p < 40; ++p)
            for (std::size_t l = 0; l < lights.count(); ++l) {
                ASSERT_EQ(is_lit(answers, lights.count(), p, l), lights.lights()[l].xyzw[1] > 0) << way << l;
                ASSERT_TRUE(is_lit(sideless, lights.count(), p, l));
            }
    }
}

// A box with points inside, outside and on its faces. A point on a face whose receiver it is sees out through that face
// alone; from inside, every other face is an exit that blocks.
TEST(ManyLightsCases, PointsInClosedSolidsWithTheExitAsTheirReceiver) {
    LightScene scene{"box", {}, {}, {}};
    add_box(scene.triangles, {0, 0, 0}, {4, 4, 4});
    add_box(scene.triangles, {1, 1, 1}, {2, 2, 2});
    add_box(scene.triangles, {6, 0, 0}, {7, 9, 1});
    for (int i = 0; i < 240; ++i) {
        append(scene.points, {float(i % 5) + 0.25f, float(i % 11) / 2 - 0.5f, float(i % 7) - 0.75f});
        scene.receivers.push_back(i % 3 == 0 ? gnomon::no_receiver : std::uint32_t(i % 36));
    }
    // Just below the roof, with the roof's two triangles as receivers, and without.
    for (int i = 0; i < 60; ++i) {
        append(scene.points, {3.25f, 3.875f, float(i % 13) / 4 + 0.5f});
        scene.receivers.push_back(i % 3 == 0 ? gnomon::no_receiver : std::uint32_t(6 + i % 3 - 1));
    }
    const double lit = expect_truth(device_with(), scene, lattice_lights(2, true));
    EXPECT_GT(lit, 0.05);
    EXPECT_LT(lit, 0.95);
    const auto up = run(device_with(), scene, Lights({gnomon::Light::directional({0, -1, 0})}), "auto");
    std::size_t through_the_exit = 0;
    for (std::size_t p = 240; p < 300; ++p) {
        if (scene.receivers[p] == gnomon::no_receiver) {
            EXPECT_EQ(up.counts[p], 0u);
        }
        through_the_exit += up.counts[p];
    }
    EXPECT_GT(through_the_exit, 10u);
}

TEST(ManyLightsCases, ALampInsideASolidLightsNothingOutside) {
    LightScene scene{"lamp in a box", {}, {}, {}};
    add_box(scene.triangles, {0, 0, 0}, {4, 4, 4});
    add_box(scene.triangles, {-9, -3, -9}, {9, -2, 9});
    for (int i = 0; i < 300; ++i)
        append(scene.points, {float(i % 17) - 6.5f, float(i % 13) - 4.25f, float(i % 11) - 3.25f});
    const Lights inside = gnomon::area_light({1, 1, 1}, {2, 0, 0}, {0, 0, 2}, 33);
    const gnomon::Device device = device_with();
    const double lit = expect_truth(device, scene, inside);
    EXPECT_GT(lit, 0.01);
    const auto answers = run(device, scene, inside, "auto");
    for (std::size_t p = 0; p < 300; ++p) {
        bool is_within = true;
        for (int c = 0; c < 3; ++c) is_within = is_within && scene.points[3 * p + c] > 0 && scene.points[3 * p + c] < 4;
        EXPECT_EQ(answers.counts[p], is_within ? 33u : 0u) << p;
    }
}

// A field of heights with holes. At its border and beside holes rays leave under the sheet, and may be lit.
TEST(ManyLightsCases, ATerrainsBorderAndHoles) {
    constexpr int side = 24;
    LightScene scene{"terrain", {}, {}, {}};
    Random random(5);
    std::vector<float> heights((side + 1) * (side + 1));
    for (float& height : heights) height = float(random.below(17)) / 8;
    const auto at = [&](int x, int z) { return Float3{float(x), heights[std::size_t(z * (side + 1) + x)], float(z)}; };
    for (int z = 0; z < side; ++z)
        for (int x = 0; x < side; ++x) {
            if ((x + 3 * z) % 11 == 0) continue;  // a hole
            add_quad(scene.triangles, at(x, z), at(x, z + 1), at(x + 1, z + 1), at(x + 1, z));
        }
    for (int z = 0; z <= side; z += 2)
        for (int x = 0; x <= side; ++x) append(scene.points, {at(x, z)[0], at(x, z)[1], at(x, z)[2]});
    const gnomon::Device device = device_with();
    std::vector<gnomon::Light> suns;
    for (int i = 0; i < 45; ++i)
        suns.push_back(gnomon::Light::directional(
            {float(random.below(17)) - 8, -float(random.below(9)) / 4, float(random.below(17)) - 8.5f}));
    const double lit = expect_truth(device, scene, Lights(suns));
    EXPECT_GT(lit, 0.2);
    EXPECT_LT(lit, 0.95);
    // From the middle of the border outwards, down along a slope: nothing is under the sheet there.
    const LightScene corner{"corner", scene.triangles, {float(side), at(side, 0)[1], 0}, {}};
    for (const char* way : WAYS)
        EXPECT_EQ(run(device, corner, Lights({gnomon::Light::directional({-1, 2, 0.5f})}), way).counts[0], 1u) << way;
}

// The order of points, work-group sizes and memory limits change no bit and no sum, by any way and by all kernels.
TEST(ManyLightsCases, NeitherOrderNorShapeChangesABitExhaustive) {
    LightScene scene{"blocks", lattice_blocks(6, 3, 4), {}, {}};
    for (int i = 0; i < 1500; ++i)
        append(scene.points, {float(i % 31) / 5, float(i % 23) / 5 + 0.125f, float(i % 29) / 5});
    Lights lights = lattice_lights(2, false);
    std::vector<float> weights;
    for (std::size_t i = 0; i < lights.count(); ++i) weights.push_back(float(i) * 0.37f - 5);
    lights = Lights({lights.lights().begin(), lights.lights().end()}, weights);
    const auto usual = run(device_with(), scene, lights, "one-by-one");
    std::vector<std::size_t> order(1500);
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::mt19937 engine(3);
    std::shuffle(order.begin(), order.end(), engine);
    LightScene shuffled{scene.name, scene.triangles, {}, {}};
    for (const std::size_t i : order)
        append(shuffled.points, {scene.points[3 * i], scene.points[3 * i + 1], scene.points[3 * i + 2]});
    struct Kind {
        std::uint32_t work_group_size;
        std::uint64_t memory_limit_bytes;
        bool gpu_kernels;
    };
    for (const Kind& kind : {Kind{0, 0, false}, Kind{1, 0, false}, Kind{64, 0, true}, Kind{5, 0, true},
                             Kind{0, 6 << 20, false}, Kind{32, 9 << 20, true}}) {
        gnomon::DeviceOptions options;
        options.work_group_size = kind.work_group_size;
        options.memory_limit_bytes = kind.memory_limit_bytes;
        options.gpu_kernels = kind.gpu_kernels;
        const gnomon::Device device({}, options);
        for (const char* way : WAYS) {
            SCOPED_TRACE(std::string(way) + ", groups of " + std::to_string(kind.work_group_size));
            const auto answers = run(device, shuffled, lights, way);
            for (std::size_t p = 0; p < order.size(); ++p) {
                ASSERT_EQ(answers.sums[p], usual.sums[order[p]]);
                ASSERT_EQ(answers.counts[p], usual.counts[order[p]]);
                ASSERT_EQ(answers.first_lit[p], usual.first_lit[order[p]]);
                ASSERT_EQ(answers.last_lit[p], usual.last_lit[order[p]]);
            }
        }
    }
}

}  // namespace
