// SPDX-License-Identifier: MIT
// Technique virtual-shadow-map: bit for bit a whole shadow map where points ask for one level, near the truth where a
// camera chooses levels, and small.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "kernels/rivals/shadow_map/lookup.h"
#include "rivals/shadow_map/depth_pass.hpp"
#include "rivals/shadow_map/map_projection.hpp"
#include "support/floor_view.hpp"

namespace {

using namespace support;
using gnomon::Light;

constexpr std::uint32_t width = 160, height = 120;

/// A floor (triangles 0 and 1), slabs above, and sheets under the floor that reach under all of it: they shade nothing,
/// but each meets every page.
Floats floor_slabs_and_sheets() {
    Floats triangles;
    add(triangles, {-6, 0, -6}, {-6, 0, 6}, {6, 0, 6});
    add(triangles, {-6, 0, -6}, {6, 0, 6}, {6, 0, -6});
    Random random(21);
    for (int i = 0; i < 40; ++i) {
        const float x = random.between(-3, 2), z = random.between(-3, 2), y = random.between(0.2f, 1);
        const float w = random.between(0.05f, 0.6f), d = random.between(0.05f, 0.6f);
        add(triangles, {x, y, z}, {x + w, y, z}, {x + w, y, z + d});
        add(triangles, {x + w, y, z + d}, {x, y, z + d}, {x, y, z});
    }
    for (int i = 1; i <= 40; ++i)
        add(triangles, {-40, -0.5f - float(i) / 16, -40}, {40, -0.5f - float(i) / 16, -40},
            {0, -0.5f - float(i) / 16, 80});
    return triangles;
}

const Light sun = Light::directional({-0.3f, -1, -0.2f}), point_light = Light::point({0.3f, 3, 0.2f});

/// What a camera sees of the scene, with the camera known or not.
class VirtualMap : public testing::Test {
protected:
    static Answer answer(const gnomon::Device& device, const Light& light, bool with_camera,
                         const std::string& technique, const Settings& settings = {}) {
        const auto triangles = gnomon::Triangles::upload(device, floor_slabs_and_sheets());
        const auto camera = gnomon::Camera::look_at({0, 1, 4}, {0, 0, 0}, {0, 1, 0}, 60);
        const gnomon::View view = gnomon::look(device, triangles, camera, width, height);
        const auto bare = gnomon::Points::wrap(device, view.points.positions(), view.points.layout(),
                                               view.points.count(), view.points.receivers());
        return support::answer(device, *technique_with(device, settings, technique), triangles,
                               with_camera ? view.points : bare, light);
    }
    Answer answer(const Light& light, bool with_camera, const std::string& technique,
                  const Settings& settings = {}) const {
        return answer(device_, light, with_camera, technique, settings);
    }

    gnomon::Device device_;
};

// Without a camera all points ask for one level. On the finest, each finds in its page what the whole map of that size
// holds.
TEST_F(VirtualMap, FinestLevelIsTheShadowMapOfItsSize) {
    for (const Light& light : {sun, point_light})
        for (const char* size : {"128", "512", "2048"}) {
            SCOPED_TRACE(size);
            const Answer whole = answer(light, false, "shadow-map", {{"size", size}});
            const Answer pages = answer(light, false, "virtual-shadow-map", {{"size", size}});
            EXPECT_EQ(pages.visibility, whole.visibility);
            EXPECT_EQ(pages.count("points_outside"), 0u);
            EXPECT_GT(std::count(whole.visibility.begin(), whole.visibility.end(), 0.0f), 400);
            EXPECT_LE(pages.count("map_texels"), whole.count("map_texels"));
        }
}

/// The hard lookup of a whole map whose views were fitted for `size`, but have size >> level texels per side.
std::vector<float> whole_level(const gnomon::Device& device, const gnomon::Triangles& triangles,
                               const gnomon::Points& points, const Light& light, std::uint32_t size,
                               std::uint32_t level) {
    gnomon::cl::Session& session = session_of(device);
    const auto visibility = uploaded(session, std::vector<float>(points.count(), 1.0f));
    const gnomon::FitInputs inputs{gnomon::triangle_inputs(triangles), gnomon::point_inputs(points), visibility.get(),
                                   light, std::nullopt};
    gnomon::MapViews map_views;
    gnomon::ViewFit fit;
    fit.run(session, inputs, size, map_views);
    const std::uint32_t side = size >> level;
    auto views = downloaded<gnomon::MapView>(session, map_views.views.get(), map_views.set.view_count);
    for (std::uint32_t i = 0; i < views.size(); ++i)
        if (views[i].width != 0) {
            views[i].width = views[i].height = views[i].row_stride = side;
            views[i].first_texel = i * side * side;
        }
    session.write(map_views.views.get(), views.data(), views.size() * sizeof(gnomon::MapView));
    map_views.set.texels_per_view = side * side;
    map_views.set.texels = map_views.set.view_count * side * side;
    gnomon::fill_centres(session, map_views);
    gnomon::DepthMap depths;
    gnomon::DepthBias bias;
    bias.slope = 1.5f;
    bias.slope_limit = 0.05f;
    depths.run(session, inputs.triangles, map_views, bias, false);
    gnomon::LookupPlan plan{};
    plan.first_float = inputs.triangles.first_float;
    plan.lookup = LOOKUP_HARD;
    plan.store.receiver_bias = 1e-4f;
    session.launch("rivals/shadow_map/lookup.cl", "map_lookup", gnomon::cl::Range::items(points.count()), plan,
                   map_views.set, inputs.points.layout, inputs.points.positions, inputs.points.receivers,
                   inputs.triangles.vertices, map_views.views, map_views.tables, depths.keys(), depths.keys(),
                   depths.keys(), visibility);
    return downloaded<float>(session, visibility.get(), points.count());
}

// So it is on every level, with a whole map of the level's texels over the same rectangle. On the finest the sheets
// make more pairs than the first list has room for.
TEST_F(VirtualMap, CoarserLevelsAreCoarserMaps) {
    const auto triangles = gnomon::Triangles::upload(device_, floor_slabs_and_sheets());
    Floats positions;
    Random random(5);
    for (int i = 0; i < 20000; ++i) append(positions, {random.between(-4, 4), 0, random.between(-4, 4)});
    const auto points = gnomon::Points::upload(device_, positions);
    for (const Light& light : {sun, point_light})
        for (const std::uint32_t level : {0u, 1u, 3u, 4u, 7u}) {
            const gnomon::Visibility visibility(device_, points.count());
            const auto technique = gnomon::make_technique("virtual-shadow-map", device_);
            technique->set("size", "2048");
            technique->set("level", std::to_string(level));
            technique->run(triangles, points, light, visibility);
            const std::vector<float> mask = visibility.read();
            // 2048 texels have five levels: the coarsest is one page.
            EXPECT_EQ(mask, whole_level(device_, triangles, points, light, 2048, std::min(level, 4u))) << level;
            EXPECT_GT(std::count(mask.begin(), mask.end(), 0.0f), 400);
            EXPECT_GT(std::count(mask.begin(), mask.end(), 1.0f), 400);
        }
}

// As fine as pixels ask for, the error is that of shadow edges within a pixel; coarser texels cost error.
TEST_F(VirtualMap, ErrorFallsWithDetailAndSizeTowardsTheTruth) {
    for (const Light& light : {sun, point_light}) {
        const std::vector<float> truth = answer(light, true, "frustum-traced").visibility;
        const auto error = [&](const char* technique, const Settings& settings) {
            return mean_error(truth, answer(light, true, technique, settings).visibility);
        };
        const double rough = error("virtual-shadow-map", {{"detail", "0.125"}});
        const double plain = error("virtual-shadow-map", {{"detail", "1"}});
        const double fine = error("virtual-shadow-map", {{"detail", "8"}});
        // The coarsest level, one page for all, is not much coarser than the point light's pixels.
        EXPECT_LT(plain, rough / 1.5);
        EXPECT_LT(fine, plain / 2);
        const double coarse = error("virtual-shadow-map", {{"detail", "8"}, {"size", "128"}});
        const double middle = error("virtual-shadow-map", {{"detail", "8"}, {"size", "1024"}});
        EXPECT_LT(middle, coarse / 2.5);
        EXPECT_LT(fine, middle);
        // Where every point asks for more than there is, the map is the shadow map.
        EXPECT_EQ(error("virtual-shadow-map", {{"detail", "100"}, {"size", "256"}}),
                  error("shadow-map", {{"size", "256"}}));
    }
}

TEST_F(VirtualMap, HoldsWhatIsAskedForAndLittleElse) {
    for (const Light& light : {sun, point_light}) {
        const gnomon::Statistics s = answer(light, true, "virtual-shadow-map").statistics;
        EXPECT_EQ(s.count("points_outside"), 0u);
        EXPECT_GT(s.count("pages_requested"), 10u);
        EXPECT_LE(s.count("pages_requested"), width * height);
        EXPECT_GT(s.count("pages_drawn"), 10u);
        EXPECT_LE(s.count("pages_drawn"), s.count("pages_requested"));
        EXPECT_EQ(s.count("virtual_texels"), s.count("map_views") * 16384 * 16384);
        EXPECT_EQ(s.count("map_texels"), s.count("pages_requested") * 128 * 128);
        EXPECT_LT(s.device_memory_bytes, s.count("virtual_texels") * 4 / 20);
    }
}

TEST_F(VirtualMap, GivesTheSameBitsForEveryWorkGroupSizeExhaustive) {
    for (const Light& light : {sun, point_light}) {
        const Answer expected = answer(light, true, "virtual-shadow-map");
        for (const std::uint32_t size : {1u, 7u, 33u, 64u}) {
            const Answer got = answer(device_with(size), light, true, "virtual-shadow-map");
            EXPECT_EQ(got.visibility, expected.visibility) << size;
            EXPECT_EQ(got.count("pages_requested"), expected.count("pages_requested"));
            EXPECT_EQ(got.count("pages_drawn"), expected.count("pages_drawn"));
        }
    }
}

TEST_F(VirtualMap, RunsOnNothingAndRefusesBadSettings) {
    const auto none = gnomon::Triangles::upload(device_, {});
    const auto points = gnomon::Points::upload(device_, Floats{0, 0, 0, NAN, 0, 0});
    const gnomon::Visibility visibility(device_, 2);
    const auto technique = gnomon::make_technique("virtual-shadow-map", device_);
    technique->run(none, points, sun, visibility);
    EXPECT_EQ(visibility.read(), (std::vector<float>{1, 1}));
    for (const auto& [name, value] : Settings{{"size", "1000"},
                                              {"size", "32768"},
                                              {"detail", "0"},
                                              {"detail", "nan"},
                                              {"level", "8"},
                                              {"slope-bias", "-1"},
                                              {"taps", "3"}})
        EXPECT_THROW(technique->set(name, value), gnomon::InvalidArgument) << name;
}

// Several lights share one pool of pages: each point gets the bits, and each light the counts, that it has alone.
TEST_F(VirtualMap, LightsInOnePoolAreAsEachAlone) {
    const auto triangles = gnomon::Triangles::upload(device_, floor_slabs_and_sheets());
    const auto camera = gnomon::Camera::look_at({0, 1, 4}, {0, 0, 0}, {0, 1, 0}, 60);
    const gnomon::View view = gnomon::look(device_, triangles, camera, width, height);
    // The second light comes from below the floor: nothing that is seen faces it.
    const std::vector<Light> lights{point_light, Light::directional({0, 1, 0}), sun, Light::directional({1, -0.3f, 0})};
    const auto technique = gnomon::make_technique("virtual-shadow-map", device_);
    technique->set("size", "4096");
    std::vector<gnomon::Visibility> together;
    for (std::size_t i = 0; i < lights.size(); ++i) together.emplace_back(device_, view.points.count());
    // Twice: what an earlier run of more or fewer lights leaves behind must not matter.
    technique->run_each_light(triangles, view.points, std::span(lights).first(2), std::span(together).first(2));
    const auto statistics = technique->run_each_light(triangles, view.points, lights, together);
    ASSERT_EQ(statistics.size(), lights.size());
    for (std::size_t i = 0; i < lights.size(); ++i) {
        SCOPED_TRACE(i);
        const Answer alone = answer(lights[i], true, "virtual-shadow-map", {{"size", "4096"}});
        EXPECT_EQ(together[i].read(), alone.visibility);
        EXPECT_EQ(statistics[i].counts, alone.statistics.counts);
    }
    EXPECT_EQ(statistics[1].count("pages_requested"), 0u);
    for (const std::size_t i : {0u, 2u, 3u}) EXPECT_GT(statistics[i].count("pages_drawn"), 0u);
    EXPECT_NE(together[2].read(), together[3].read());
}

// The colours of docs/techniques.md, finest level first; pages are lighter and darker in turn.
constexpr int level_colors[8][3] = {{230, 77, 64},  {242, 191, 51}, {102, 191, 77},  {64, 179, 204},
                                    {77, 102, 230}, {166, 89, 204}, {230, 128, 179}, {153, 128, 102}};

/// -1: the sky, -2: no page.
int level_of(const std::uint8_t* rgba, bool& is_dark) {
    if (rgba[0] == 64 && rgba[1] == 64 && rgba[2] == 64) return -1;
    if (rgba[0] + rgba[1] + rgba[2] == 0) return -2;
    for (int level = 0; level < 8; ++level)
        for (const double shade : {1.0, 0.75}) {
            bool is_same = true;
            for (int c = 0; c < 3; ++c) is_same &= std::fabs(rgba[c] - shade * level_colors[level][c]) < 1.5;
            is_dark = shade != 1;
            if (is_same) return level;
        }
    ADD_FAILURE() << "a colour of no level: " << int(rgba[0]) << " " << int(rgba[1]) << " " << int(rgba[2]);
    return -3;
}

// Half the detail asks for texels twice as wide: every pixel's page lies one level up, as long as there is one. Without
// a camera all lie on the level that is set.
TEST_F(VirtualMap, PageDiagnosticShowsTheLevels) {
    const auto triangles = gnomon::Triangles::upload(device_, floor_slabs_and_sheets());
    const auto camera = gnomon::Camera::look_at({0, 1, 4}, {0, 0, 0}, {0, 1, 0}, 60);
    const gnomon::View view = gnomon::look(device_, triangles, camera, width, height);
    const auto drawn = [&](const gnomon::Points& points, const Settings& settings) {
        return technique_with(device_, settings, "virtual-shadow-map")->diagnose("page", triangles, points, sun);
    };
    const auto fine = drawn(view.points, {{"size", "4096"}}),
               coarse = drawn(view.points, {{"size", "4096"}, {"detail", "0.5"}});
    ASSERT_EQ(fine.size(), 4 * view.points.count());
    const gnomon::PointsOnHost host = view.points.read(device_);
    std::array<std::size_t, 8> levels{};
    std::array<std::size_t, 2> pages{};
    for (std::size_t i = 0; i < view.points.count(); ++i) {
        bool is_dark = false, unused = false;
        const int level = level_of(&fine[4 * i], is_dark);
        EXPECT_EQ(level == -1, host.receiver[i] == gnomon::no_receiver);
        EXPECT_EQ(level_of(&coarse[4 * i], unused), level < 0 ? level : std::min(level + 1, 5));
        if (level < 0) continue;
        ++levels[std::size_t(level)];
        ++pages[is_dark];
    }
    EXPECT_GE(std::count_if(levels.begin(), levels.end(), [](std::size_t n) { return n > 100; }), 2);
    EXPECT_GT(std::min(pages[0], pages[1]), 100u);

    const auto bare = gnomon::Points::wrap(device_, view.points.positions(), view.points.layout(), view.points.count(),
                                           view.points.receivers());
    const auto second = drawn(bare, {{"level", "2"}});
    for (std::size_t i = 0; i < view.points.count(); ++i) {
        bool unused = false;
        const int level = level_of(&second[4 * i], unused);
        EXPECT_EQ(level, host.receiver[i] == gnomon::no_receiver ? -1 : 2);
    }
}

}  // namespace
