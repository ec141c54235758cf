// SPDX-License-Identifier: MIT
// Stage conservative_map, and the coarse test by it. A texel's height promises that ONE triangle covers the whole texel
// and lies above that height everywhere in it. Both promises are checked against the real triangles, and every point
// decided by the map is checked against the exact predicate. For all cover tests.
#include <gtest/gtest.h>

#include <cstring>
#include <iostream>

#include "support/light_scenes.hpp"
#include "support/truth.hpp"

namespace {

using namespace support;
using gnomon::CoverTest;

/// One texel's height compared with one triangle.
struct TexelTruth {
    bool covered;        ///< the closed triangle covers the closed texel
    long double lowest;  ///< the triangle's lowest height over it, or the lower one of CoverTest::slope
};

TexelTruth truth_of(const reference::GridTriangle& t, float orientation, CoverTest test, std::uint32_t x,
                    std::uint32_t y) {
    TexelTruth truth{true, INFINITY};
    for (int corner = 0; corner < 4; ++corner) {
        const long double cx = x + (corner & 1), cy = y + (corner >> 1);
        for (int i = 0; i < 3; ++i) truth.covered = truth.covered && orientation * t.edge(i, cx, cy) >= 0;
        if (truth.covered) truth.lowest = std::min(truth.lowest, t.height(cx, cy));
    }
    if (truth.covered && test == CoverTest::slope) {
        const long double across = t.height(x + 1.0L, y) - t.height(x, y),
                          down = t.height(x, y + 1.0L) - t.height(x, y);
        truth.lowest = t.height(x + 0.5L, y + 0.5L) - std::max(std::fabs(across), std::fabs(down));
    }
    return truth;
}

std::string_view name_of(CoverTest test) { return gnomon::cover_test_names[static_cast<std::size_t>(test)]; }

struct Tally {
    std::uint64_t drawn = 0, coverable = 0, decided = 0, shadowed = 0;
};

struct RealTriangle {
    reference::GridTriangle shape;
    float orientation;
};

std::vector<RealTriangle> real_triangles(const FrameOutput& out, const LightScene& scene) {
    const reference::GridMap map = real_map(out.projection);
    std::vector<RealTriangle> triangles;
    reference::Effort effort;
    const reference::Float3 xyz{scene.light[0], scene.light[1], scene.light[2]};
    for (std::size_t id = 0; id < scene.triangles.size() / 9; ++id) {
        const reference::Triangle t = reference::triangle_at(scene.triangles, id);
        if (!reference::is_finite(t)) continue;
        const int side = scene.light[3] == 0 ? reference::side_of_direction(xyz, t, effort)
                                             : reference::side_of_point(xyz, t, effort);
        // Triangles behind a point light are in front of no point, but cover no real texel either.
        if (side != 0) triangles.push_back({{map, t}, float(side) * out.projection.handedness});
    }
    return triangles;
}

void check_texels(const FrameOutput& out, const LightScene& scene, CoverTest test, Tally& tally) {
    const std::vector<RealTriangle> triangles = real_triangles(out, scene);
    for (std::uint32_t y = 0; y < out.frame.height; ++y)
        for (std::uint32_t x = 0; x < out.frame.width; ++x) {
            const std::uint32_t key = out.map[y * out.frame.width + x];
            bool is_true = false, is_coverable = false;
            for (const RealTriangle& t : triangles) {
                const TexelTruth truth = truth_of(t.shape, t.orientation, test, x, y);
                is_coverable = is_coverable || truth.covered;
                is_true = is_true || (truth.covered && key != 0 && truth.lowest >= float_of_key(key));
            }
            EXPECT_TRUE(key == 0 || is_true) << "texel " << x << ", " << y << " claims a height of "
                                             << float_of_key(key) << " that no triangle covers";
            tally.drawn += key != 0;
            tally.coverable += is_coverable;
        }
}

void check_points(const FrameOutput& out, const LightScene& scene, Tally& tally) {
    for (std::uint32_t id = 0; id < scene.points.size() / 3; ++id) {
        const bool decided = is_open(out.visibility_before[id]) && out.visibility_after_izb[id] == 0.0f;
        if (!decided) continue;
        ++tally.decided;
        const std::uint32_t receiver = scene.receivers.empty() ? reference::NO_RECEIVER : scene.receivers[id];
        bool blocked = false;
        for (std::uint32_t t = 0; t < scene.triangles.size() / 9 && !blocked; ++t) {
            const reference::Triangle triangle = reference::triangle_at(scene.triangles, t);
            blocked = t != receiver && reference::is_finite(triangle) &&
                      exact_pair(triangle, reference::point_at(scene.points, id), scene.light).blocks;
        }
        EXPECT_TRUE(blocked) << "the map put point " << id << " into shadow, and nothing blocks it";
    }
}

StageSettings settings_of(CoverTest test, gnomon::FrameGrid grid = {64, 3}) {
    StageSettings settings;
    settings.grid = grid;
    settings.with_map = true;
    settings.cover_test = test;
    return settings;
}

void check(const gnomon::Device& device, const LightScene& scene, const StageSettings& settings, Tally& tally) {
    SCOPED_TRACE(scene.name + ", " + std::string(name_of(settings.cover_test)));
    for (const FrameOutput& out : run_light_stages(device, scene, settings)) {
        if (out.projection.indistinct == 0) check_texels(out, scene, settings.cover_test, tally);
        check_points(out, scene, tally);
    }
}

/// Scenes with triangles that cover texels: large ones near and far, level and steep, around point lights, under
/// grazing light.
std::vector<LightScene> covering_scenes() {
    std::vector<LightScene> scenes;
    for (const auto& [name, light] : lights_of_every_kind())
        for (const float size : {0.5f, 4.0f, 1e5f}) {
            const Floats triangles = soup(14, size, 81);
            LightScene scene{name + ", triangles of " + std::to_string(size), triangles, {}, light};
            scene.points = points_behind(triangles, light, 300, 2, 82);
            append(scene.points, random_points(900, -1.5f, 1.5f, 83));
            scenes.push_back(scene);
        }
    for (const double far : {1e4, 1e6})
        for (const auto& [name, light] : lights_of_every_kind()) {
            const std::array<double, 3> offset = {far, far, -far};
            const Floats triangles = placed(soup(14, 2, 84), 1, offset);
            LightScene scene{name + ", at " + std::to_string(far), triangles, {}, moved(light, 1, offset)};
            scene.points = placed(random_points(600, -1.5f, 1.5f, 85), 1, offset);
            scenes.push_back(scene);
        }
    return scenes;
}

// Not vacuous: thousands of texels are drawn and thousands of points decided, and the map finds most of the texels
// that a triangle covers.
TEST(ConservativeMap, EqualsReference) {
    const gnomon::Device device = device_with();
    for (const CoverTest test : {CoverTest::tight, CoverTest::circle, CoverTest::slope}) {
        Tally tally;
        for (const LightScene& scene : covering_scenes()) check(device, scene, settings_of(test), tally);
        std::cout << name_of(test) << ": " << tally.drawn << " texels drawn of " << tally.coverable
                  << " covered in empty and listed bins, " << tally.decided << " points decided\n";
        EXPECT_GT(tally.drawn, 10000u);
        EXPECT_GT(tally.decided, 1000u);
    }
}

// Not vacuous: the scenes of ties have points beside edges' rays by an ulp.
TEST(ConservativeMap, EqualsReferenceInScenesOfTies) {
    const gnomon::Device device = device_with();
    Tally tally;
    const std::vector<LightScene> scenes = light_scenes();
    for (std::size_t i = 0; i < scenes.size(); i += 2)
        check(device, scenes[i], settings_of(i % 4 == 0 ? CoverTest::tight : CoverTest::circle, {32, 2}), tally);
    for (const LightScene& scene : reference_scenes())
        check(device, scene, settings_of(CoverTest::tight, {32, 2}), tally);
    EXPECT_GT(tally.decided, 500u);
}

// Slopes of edges shrink with the square of the distance to the point light, and squares of slopes underflow.
TEST(ConservativeMap, EqualsReferenceWhereProductsUnderflow) {
    const gnomon::Device device = device_with();
    Tally tally;
    for (const CoverTest test : {CoverTest::tight, CoverTest::circle})
        for (const LightScene& scene : underflow_scenes()) check(device, scene, settings_of(test, {32, 2}), tally);
    EXPECT_GT(tally.drawn, 100u);
}

// The tight test decides every point that Hertel's test decides, and more. Not vacuous: strictly more, in total.
TEST(ConservativeMap, TightContainsCircle) {
    const gnomon::Device device = device_with();
    std::uint64_t tight_texels = 0, circle_texels = 0;
    for (const LightScene& scene : covering_scenes()) {
        SCOPED_TRACE(scene.name);
        const auto tight = run_light_stages(device, scene, settings_of(CoverTest::tight));
        const auto circle = run_light_stages(device, scene, settings_of(CoverTest::circle));
        ASSERT_EQ(tight.size(), circle.size());
        for (std::size_t f = 0; f < tight.size(); ++f) {
            // Only a frame that both tests met in the same state can be compared.
            if (std::memcmp(&tight[f].projection, &circle[f].projection, sizeof(gnomon::Projection)) != 0) continue;
            for (std::size_t i = 0; i < tight[f].map.size(); ++i) {
                EXPECT_GE(tight[f].map[i], circle[f].map[i]) << "texel " << i;
                tight_texels += tight[f].map[i] != 0;
                circle_texels += circle[f].map[i] != 0;
            }
        }
    }
    EXPECT_GT(circle_texels, 5000u);
    EXPECT_GT(tight_texels, circle_texels);
}

LightScene comparison_scene() {
    Floats triangles = soup(200, 0.3f, 86);
    append(triangles, soup(10, 3, 87));
    return {"comparison", triangles, random_points(3000, -1, 1, 88), along(0.3f, -1, 0.2f)};
}

// Not vacuous: triangles overlap, so the highest triangle over a texel would depend on a wrong order.
TEST(ConservativeMap, OrderFree) {
    const gnomon::Device device = device_with();
    const LightScene scene = comparison_scene();
    LightScene shuffled = scene;
    const auto order = shuffled_order(scene.triangles.size() / 9, 89);
    for (std::size_t i = 0; i < scene.triangles.size(); ++i)
        shuffled.triangles[i] = scene.triangles[9 * order[i / 9] + i % 9];
    const auto plain = run_light_stages(device, scene, settings_of(CoverTest::tight)).at(0).map;
    EXPECT_EQ(run_light_stages(device, shuffled, settings_of(CoverTest::tight)).at(0).map, plain);
    LightScene reversed = scene;
    reversed.triangles = reversed_winding(scene.triangles);
    Tally tally;
    check(device, reversed, settings_of(CoverTest::tight), tally);
    EXPECT_GT(tally.decided, 100u);
}

// Grids of 256 x 256 bins make triangles of one tile and of hundreds.
TEST(ConservativeMap, ShapeFree) {
    LightScene scene = comparison_scene();
    // Few points, so that facing's items take a block each on any number of cores: the last bits of a frame's margins
    // depend on the blocks that one item takes together (host/receivers/facing.cpp), and thus on the work-group size.
    // The map is another stage.
    scene.points.resize(std::size_t(3) * 900);
    for (const gnomon::FrameGrid grid : {gnomon::FrameGrid{64, 3}, {256, 0}}) {
        const auto plain = run_light_stages(device_with(), scene, settings_of(CoverTest::tight, grid)).at(0);
        EXPECT_GT(plain.counters.map_texels, 100u);
        if (grid.size == 256) {
            EXPECT_GT(plain.counters.map_tiles, plain.counters.map_candidates + 1000u);
        }
        for (const std::uint32_t group : FEW_WORK_GROUP_SIZES)
            EXPECT_EQ(run_light_stages(device_with(group), scene, settings_of(CoverTest::tight, grid)).at(0).map,
                      plain.map)
                << "work-groups of " << group;
    }
}

// Not vacuous: the sheets cover the whole grid, one of them edge-on, of no area, not finite.
TEST(ConservativeMap, SurvivesDegenerates) {
    const gnomon::Device device = device_with();
    const float inf = std::numeric_limits<float>::infinity();
    Floats triangles;
    add(triangles, {-9, 1, -9}, {9, 1, -9}, {0, inf, 9});
    add(triangles, {-9, 1, -9}, {9, 1, 9}, {0, 1, 0});
    add(triangles, {-9, -9, 0}, {9, -9, 0}, {0, 9, 0});
    add(triangles, {-1e30f, 2, -1e30f}, {1e30f, 2, -1e30f}, {0, 2, 1e30f});
    add(triangles, {-9, 0, -9}, {9, 0, -9}, {0, 0, 9});  // the points' own plane: covers all, blocks none
    LightScene scene{"sheets", triangles, {}, along(0, -1, 0)};
    for (int i = 0; i < 30; ++i)
        for (int j = 0; j < 30; ++j) add(scene.points, {0.1f * float(i) - 1.5f, 0, 0.1f * float(j) - 1.5f});
    Tally tally;
    check(device, scene, settings_of(CoverTest::tight), tally);
    add(scene.triangles, {-9, 1e-6f, -9}, {9, 1e-6f, -9}, {0, 1e-6f, 9});
    check(device, scene, settings_of(CoverTest::tight), tally);
    scene.light = at(0, 0.5f, 0);
    check(device, scene, settings_of(CoverTest::tight), tally);
    EXPECT_GT(tally.drawn, 1000u);
}

// Not vacuous: the first map is four times as large, so canaries lie right behind the second.
TEST(ConservativeMap, WritesOnlyItsOwn) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    const LightScene scene = comparison_scene();
    LightStages stages;
    for (const gnomon::FrameGrid grid : {gnomon::FrameGrid{128, 3}, {64, 3}}) {
        const UploadedScene inputs(device, scene);  // again: the first frame has decided its points
        FrameOutput out{};
        out.frame = light_frames(inputs.light, grid)[0];
        if (grid.size == 64) put_canaries(session, stages.lists.map().map());
        while (!run_stages_once(session, stages, inputs, settings_of(CoverTest::tight, grid), out)) {
        }
    }
    expect_canaries(session, stages.lists.map().map(), 64 * 64 * sizeof(std::uint32_t), "map");
}

}  // namespace
