// SPDX-License-Identifier: MIT
// Stage light_frame: the grid fitted to the points. Every point's computed grid position must lie inside the grid, so
// that the clamp of texel_index never acts, and within the stated errors of its real position.
#include <gtest/gtest.h>

#include <cstring>
#include <iostream>
#include <limits>
#include <set>

#include "support/expect_exact.hpp"
#include "support/light_scenes.hpp"
#include "support/truth.hpp"

namespace {

using namespace support;

/// Point clouds alone: the tests here need no triangles.
LightScene cloud(std::string name, Floats points, const Light& light) {
    LightScene scene{std::move(name), {}, std::move(points), light};
    add(scene.triangles, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
    return scene;
}

/// Per coordinate its own extent and offset: flat, long, far away, at both ends of float's range.
std::vector<LightScene> clouds() {
    std::vector<LightScene> scenes;
    Random random(61);
    const double extents[] = {0, 1e-30, 1e-18, 1e-6, 1, 1e5, 1e14};
    const double offsets[] = {0, 0, 1, -1e3, 1e7, 1e14};
    for (int round = 0; round < 60; ++round) {
        std::array<double, 3> extent, offset;
        for (int c = 0; c < 3; ++c) extent[c] = extents[random.below(7)], offset[c] = offsets[random.below(6)];
        Floats points;
        for (int i = 0; i < 200; ++i)
            for (int c = 0; c < 3; ++c) points.push_back(float(offset[c] + extent[c] * random.between(-1, 1)));
        for (const auto& [name, light] : lights_of_every_kind()) {
            // A point light among the points, on the scale of the largest extent.
            const double scale = std::max({extent[0], extent[1], extent[2]});
            scenes.push_back(
                cloud("cloud " + std::to_string(round) + ", " + name, points, moved(light, scale, offset)));
        }
    }
    // All on one ray towards the light, and in one plane through it: one or two grid axes have no extent at all.
    for (const auto& [name, light] : lights_of_every_kind()) {
        Floats line, plane;
        for (int i = 0; i < 200; ++i) {
            const float t = random.between(0, 100), s = random.between(-1, 1);
            Float3 on_line, in_plane;
            for (int c = 0; c < 3; ++c) {
                on_line[c] = 1e3f + light[c] * t;
                in_plane[c] = on_line[c] + s * (c == 0 ? 1.0f : 0.5f);
            }
            add(line, on_line);
            add(plane, in_plane);
        }
        scenes.push_back(cloud("line, " + name, line, light));
        scenes.push_back(cloud("plane, " + name, plane, light));
    }
    return scenes;
}

struct Largest {
    long double position = 0, height = 0;
    std::string position_where;
    double outermost = 1e30;  ///< least distance of a point to the border of its grid, in texels
};

void check_frame(const FrameOutput& out, const LightScene& scene, Largest& largest) {
    const gnomon::Projection& p = out.projection;
    EXPECT_EQ(p.active_points, out.points.size());
    if (p.indistinct != 0) {
        for (const ListedPoint& point : out.points) EXPECT_EQ(point.bin, 0u);
        return;
    }
    const reference::GridMap map = real_map(p);
    for (const ListedPoint& point : out.points) {
        const double border =
            std::min({double(point.x), double(point.y), p.width - double(point.x), p.height - double(point.y)});
        largest.outermost = std::min(largest.outermost, border);
        EXPECT_GT(border, 0) << "point " << point.id << " at " << point.x << ", " << point.y;
        const auto bin_x = std::uint32_t(point.x) >> p.bin_log2, bin_y = std::uint32_t(point.y) >> p.bin_log2;
        EXPECT_EQ(point.bin, bin_y * p.bins_x + bin_x);
        const reference::GridPosition real = map(reference::point_at(scene.points, point.id));
        for (const long double error : {point.x - real.x / real.w, point.y - real.y / real.w})
            if (std::fabs(error) / p.point_error > largest.position) {
                largest.position = std::fabs(error) / p.point_error;
                largest.position_where = scene.name;
            }
        const long double height_error = std::fabs(point.z - real.z),
                          allowed = p.perspective != 0 ? p.height_error * std::fabs(real.z)
                                                       : static_cast<long double>(p.height_error);
        if (height_error != 0) largest.height = std::max(largest.height, height_error / allowed);
    }
}

/// The points in a point light's frames: all present points, except those at the light.
std::set<std::uint32_t> expected_points(const LightScene& scene) {
    std::set<std::uint32_t> ids;
    for (std::uint32_t i = 0; i < scene.points.size() / 3; ++i) {
        const Float3 p = reference::point_at(scene.points, i);
        const bool at_light = scene.light[3] != 0 && p == Float3{scene.light[0], scene.light[1], scene.light[2]};
        if (reference::is_finite(p) && !at_light) ids.insert(i);
    }
    return ids;
}

void check(const gnomon::Device& device, const LightScene& scene, Largest& largest, gnomon::FrameGrid grid = {64, 3},
           LightStages* kept = nullptr) {
    SCOPED_TRACE(scene.name);
    StageSettings settings;
    settings.grid = grid;
    std::set<std::uint32_t> seen;
    for (const FrameOutput& out : run_light_stages(device, scene, settings, kept)) {
        check_frame(out, scene, largest);
        for (const ListedPoint& point : out.points) EXPECT_TRUE(seen.insert(point.id).second) << "listed twice";
    }
    EXPECT_EQ(seen, expected_points(scene));
}

// Not vacuous: some points come within a third of a texel of the border (the fit leaves a quarter), so a fit without
// its padding would push them out; and the errors reach a part of their bounds.
TEST(LightFrame, EqualsReference) {
    const gnomon::Device device = device_with();
    Largest largest;
    for (const LightScene& scene : clouds()) check(device, scene, largest);
    for (const LightScene& scene : light_scenes()) {
        LightScene points_only = scene;
        points_only.triangles.resize(9);
        check(device, points_only, largest);
    }
    std::cout << "largest error / bound: position " << double(largest.position) << " (" << largest.position_where
              << "), height " << double(largest.height) << "; outermost point " << largest.outermost
              << " texels from the border\n";
    EXPECT_LE(largest.position, 1);
    EXPECT_LE(largest.height, 1);
    EXPECT_LT(largest.outermost, 1.0 / 3);
}

// The largest grid there is: rounding is a greater part of a texel.
TEST(LightFrame, EqualsReferenceInLargeGridsExhaustive) {
    const gnomon::Device device = device_with();
    Largest largest;
    const std::vector<LightScene> all = clouds();
    LightStages stages;
    for (std::size_t i = 0; i < all.size(); i += 5) check(device, all[i], largest, {8192, 6}, &stages);
    EXPECT_LE(largest.position, 1);
    EXPECT_LE(largest.height, 1);
}

// One bin of one texel, one texel per bin, and bins that do not divide the grid.
TEST(LightFrame, EqualsReferenceInOddGrids) {
    const gnomon::Device device = device_with();
    Largest largest;
    const std::vector<LightScene> all = clouds();
    for (std::size_t i = 0; i < all.size(); i += 11)
        for (const gnomon::FrameGrid grid : {gnomon::FrameGrid{1, 0}, {1, 5}, {16, 0}, {100, 3}, {17, 4}})
            check(device, all[i], largest, grid);
    EXPECT_LE(largest.position, 1);
}

/// The projection made for these points.
gnomon::Projection fit(const gnomon::Device& device, const LightScene& scene, std::size_t frame) {
    const UploadedScene inputs(device, scene);
    gnomon::LightFrameFit stage;
    stage.run(session_of(device), gnomon::make_light_frame(inputs.light, {64, 3}), inputs.facing.frame_bounds());
    return downloaded<gnomon::Projection>(session_of(device), stage.projections().get(), frame + 1)[frame];
}

bool same(const gnomon::Projection& a, const gnomon::Projection& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

LightScene large_cloud() { return cloud("large cloud", random_points(20000, -3, 5, 62), at(0.5f, 1, 1)); }

// Not vacuous: 20000 points in all six frames; their order decides which work-item meets which.
TEST(LightFrame, OrderFree) {
    const gnomon::Device device = device_with();
    const LightScene scene = large_cloud();
    LightScene shuffled = scene;
    const auto order = shuffled_order(scene.points.size() / 3, 63);
    for (std::size_t i = 0; i < scene.points.size(); ++i) shuffled.points[i] = scene.points[3 * order[i / 3] + i % 3];
    for (std::size_t frame = 0; frame < 6; ++frame) {
        const gnomon::Projection plain = fit(device, scene, frame);
        EXPECT_GT(plain.active_points, 100u);
        EXPECT_TRUE(same(plain, fit(device, shuffled, frame))) << "frame " << frame;
    }
}

TEST(LightFrame, ShapeFree) {
    const LightScene scene = large_cloud();
    const gnomon::Device plain = device_with();
    for (const std::uint32_t group : WORK_GROUP_SIZES) {
        const gnomon::Device device = device_with(group);
        for (std::size_t frame = 0; frame < 6; ++frame)
            EXPECT_TRUE(same(fit(device, scene, frame), fit(plain, scene, frame)))
                << "work-groups of " << group << ", frame " << frame;
    }
}

// No points, one, all at one position, all absent, all but one absent, one at the light.
TEST(LightFrame, SurvivesDegenerates) {
    const gnomon::Device device = device_with();
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    Largest largest;
    for (const auto& [name, light] : lights_of_every_kind()) {
        check(device, cloud("none, " + name, {}, light), largest);
        for (const float x : {0.0f, 1.5f, 1e-30f, 1e-45f, -1e10f, 1e14f, 1e16f, 3.4e38f}) {
            check(device, cloud("one, " + name, {x, 2 * (x / 2), -x}, light), largest);
            check(device, cloud("equal, " + name, {x, x, -x, x, x, -x, x, x, -x}, light), largest);
        }
        const Floats absent = {nan, 0, 0, 0, inf, 0, 0, 0, -inf, nan, nan, nan};
        check(device, cloud("absent, " + name, absent, light), largest);
        Floats one_present = absent;
        add(one_present, {0.25f, 1, 2});
        check(device, cloud("one present, " + name, one_present, light), largest);
        check(device, cloud("at the light, " + name, {light[0], light[1], light[2], 0.25f, 1, 2}, light), largest);
    }
    EXPECT_LE(largest.position, 1);
    EXPECT_LE(largest.height, 1);
}

// If the grid cannot separate points, every test is exact, and still right. Not vacuous: the oracle finds lit and
// shadowed points, and each scene has a frame without a grid.
TEST(LightFrame, IndistinctFramesAreRight) {
    const gnomon::Device device = device_with();
    std::uint64_t gave_up = 0;
    AnswerTally tally;
    for (const double scale : {1e15, 1e16, 1e30, 1e38, 1e-16, 1e-30, 1e-40})
        for (const auto& [name, light] : lights_of_every_kind()) {
            if (light[3] == 0 && scale < 1) continue;  // a parallel grid takes any extent below
            const Floats triangles = placed(soup(30, 0.6f, 64), scale, {0, 0, 0});
            const LightScene scene =
                tie_scene(name, triangles, moved(light, scale, {0, 0, 0}), 150, scale > 1e37 ? 1 : 2, 65);
            SCOPED_TRACE(name + " in a world of 1e" + std::to_string(std::log10(scale)));
            std::vector<float> visibility(scene.points.size() / 3, 1.0f);
            for (const FrameOutput& out : run_light_stages(device, scene)) {
                gave_up += out.projection.indistinct;
                visibility = out.visibility;
                std::transform(visibility.begin(), visibility.end(), visibility.begin(), decided);
            }
            const std::vector<float> truth = truth_of(scene);
            expect_equal(visibility, truth, scene, "all frames");
            tally.add(truth);
        }
    EXPECT_GT(gave_up, 20u);
    EXPECT_GT(tally.shadowed, 500u);
    EXPECT_GT(tally.lit, 500u);
}

// Six frames in a buffer with room behind them.
TEST(LightFrame, WritesOnlyItsOwn) {
    const gnomon::Device device = device_with(16);
    gnomon::cl::Session& session = session_of(device);
    const LightScene scene = large_cloud();
    const UploadedScene inputs(device, scene);
    gnomon::cl::Buffer projections(session, POINT_LIGHT_FRAMES * sizeof(gnomon::Projection) + 64);
    put_canaries(session, projections);
    session.launch("receivers/light_frame.cl", "light_frame_fit", gnomon::cl::Range::groups(1),
                   gnomon::make_light_frame(inputs.light, {64, 3}), inputs.facing.frame_bounds(), projections);
    expect_canaries(session, projections, POINT_LIGHT_FRAMES * sizeof(gnomon::Projection), "projections");
    for (std::size_t frame = 0; frame < POINT_LIGHT_FRAMES; ++frame)
        EXPECT_TRUE(same(downloaded<gnomon::Projection>(session, projections.get(), POINT_LIGHT_FRAMES)[frame],
                         fit(device, scene, frame)));
}

}  // namespace
