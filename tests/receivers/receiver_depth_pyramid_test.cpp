// SPDX-License-Identifier: MIT
// Stage receiver_depth_pyramid: per bin a height that none of its points is below (the lowest of the heights of its
// points or its neighbours' points), and a pyramid of minima over the bins.
#include <gtest/gtest.h>

#include <limits>

#include "support/light_scenes.hpp"

namespace {

using namespace support;
using Keys = std::vector<std::uint32_t>;

/// The minimum height of each bin's points.
template <typename Include>
Keys expected_bins(const FrameOutput& out, Include include) {
    Keys bins(std::size_t(out.frame.bins_x) * out.frame.bins_y, NO_KEY);
    for (const ListedPoint& p : out.points)
        if (include(p)) bins[p.bin] = std::min(bins[p.bin], key_of_float(p.z));
    return bins;
}

/// The minimum of each bin and its neighbours, where heights of a point light's blocks may be lower by roundings.
Keys expected_least(const FrameOutput& out, const Keys& bins) {
    const std::uint32_t width = out.frame.bins_x, height = out.frame.bins_y;
    Keys least(bins.size(), NO_KEY);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            for (std::uint32_t j = y == 0 ? 0 : y - 1; j <= std::min(y + 1, height - 1); ++j)
                for (std::uint32_t i = x == 0 ? 0 : x - 1; i <= std::min(x + 1, width - 1); ++i)
                    least[y * width + x] = std::min(least[y * width + x], bins[j * width + i]);
    if (out.frame.perspective != 0)
        for (std::uint32_t& key : least)
            if (key != NO_KEY) key = key_of_float(float_of_key(key) * (1 - 40 * 0x1p-24f));
    return least;
}

/// The minimum of up to 2 x 2 cells, level by level, above these bins.
Keys expected_pyramid(const FrameOutput& out, Keys level) {
    std::uint32_t width = out.frame.bins_x, height = out.frame.bins_y;
    Keys pyramid = level;
    while (width > 1 || height > 1) {
        const std::uint32_t half_width = (width + 1) / 2, half_height = (height + 1) / 2;
        Keys coarser(std::size_t(half_width) * half_height, NO_KEY);
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                std::uint32_t& cell = coarser[(y / 2) * half_width + x / 2];
                cell = std::min(cell, level[y * width + x]);
            }
        pyramid.insert(pyramid.end(), coarser.begin(), coarser.end());
        level = coarser;
        width = half_width;
        height = half_height;
    }
    return pyramid;
}

struct Tally {
    std::uint64_t exact = 0, lower = 0;  ///< bins
};

/// No bin's height is above any of its points. If a block of points touches several bins, its minimum may count for all
/// these bins, but for no bin farther away.
void expect_heights(const FrameOutput& out, Tally& tally) {
    const Keys bins = expected_bins(out, [](const ListedPoint&) { return true; });
    const Keys least = expected_least(out, bins), found(out.pyramid.begin(), out.pyramid.begin() + long(bins.size()));
    for (std::size_t bin = 0; bin < bins.size(); ++bin) {
        EXPECT_LE(found[bin], bins[bin]) << "bin " << bin;
        EXPECT_GE(found[bin], least[bin]) << "bin " << bin;
        if (bins[bin] != NO_KEY) ++(found[bin] == bins[bin] ? tally.exact : tally.lower);
    }
    EXPECT_EQ(out.pyramid, expected_pyramid(out, found));
}

constexpr gnomon::FrameGrid GRIDS[] = {{64, 3}, {1, 0}, {16, 0}, {100, 3}, {17, 1}};

std::vector<LightScene> scenes() {
    std::vector<LightScene> all = reference_scenes();
    const Floats triangles = soup(10, 0.1f, 71);
    for (const auto& [name, light] : lights_of_every_kind())
        all.push_back({name, triangles, random_points(700, -2, 2, 72), light});
    return all;
}

/// Points in the order of a picture's, so that blocks of them span one bin, or a few, or many.
LightScene neighbours(const std::string& name, const Light& light, float step) {
    LightScene scene{name, soup(10, 0.1f, 71), {}, light};
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 160; ++x)
            add(scene.points, {step * float(x), step * float((x * 7 + y * 3) % 5), step * float(y)});
    return scene;
}

// Not vacuous: 700 points fill most bins with several each, and the odd grids have odd levels. Neighbours give the
// exact height of thousands of bins, and where blocks span several bins a CPU's heights are lower than necessary.
TEST(ReceiverDepthPyramid, EqualsReference) {
    const gnomon::Device device = device_with();
    std::vector<LightScene> all = scenes();
    for (const auto& [name, light] : lights_of_every_kind())
        for (const float step : {0.003f, 0.1f}) all.push_back(neighbours(name, light, step));
    Tally tally;
    for (const LightScene& scene : all)
        for (const gnomon::FrameGrid grid : GRIDS) {
            SCOPED_TRACE(scene.name + ", grid of " + std::to_string(grid.size));
            StageSettings settings;
            settings.grid = grid;
            for (const FrameOutput& out : run_light_stages(device, scene, settings)) expect_heights(out, tally);
        }
    EXPECT_GT(tally.exact, 5000u);
    if (session_of(device).is_cpu()) {
        EXPECT_GT(tally.lower, 50u);
    } else {
        EXPECT_EQ(tally.lower, 0u);
    }
}

LightScene comparison_scene() {
    return {"comparison", soup(10, 0.1f, 71), random_points(5000, -2, 2, 73), along(0.3f, -1, 0.2f)};
}

// Not vacuous: 5000 points, about 80 per bin, and each of them may be the lowest.
TEST(ReceiverDepthPyramid, OrderFree) {
    const gnomon::Device device = device_with();
    const LightScene scene = comparison_scene();
    LightScene shuffled = scene;
    const auto order = shuffled_order(scene.points.size() / 3, 74);
    for (std::size_t i = 0; i < scene.points.size(); ++i) shuffled.points[i] = scene.points[3 * order[i / 3] + i % 3];
    EXPECT_EQ(run_light_stages(device, scene)[0].pyramid, run_light_stages(device, shuffled)[0].pyramid);
}

TEST(ReceiverDepthPyramid, ShapeFree) {
    const LightScene scene = comparison_scene();
    const Keys plain = run_light_stages(device_with(), scene)[0].pyramid;
    for (const std::uint32_t group : FEW_WORK_GROUP_SIZES)
        EXPECT_EQ(run_light_stages(device_with(group), scene)[0].pyramid, plain) << "work-groups of " << group;
}

// Points that are absent, at the light, or all at one height.
TEST(ReceiverDepthPyramid, SurvivesDegenerates) {
    const gnomon::Device device = device_with();
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    Tally tally;
    for (const auto& [name, light] : lights_of_every_kind()) {
        SCOPED_TRACE(name);
        LightScene scene{name, soup(3, 1, 75), {nan, 0, 0, 0, -inf, 0, light[0], light[1], light[2]}, light};
        for (int i = 0; i < 50; ++i) add(scene.points, {0.01f * float(i), -3, -0.02f * float(i)});
        for (const FrameOutput& out : run_light_stages(device, scene)) expect_heights(out, tally);
    }
}

// The points that may shadow themselves alone, and the points still open after a map. Not vacuous: the receivers
// separate half of the points from the light, and the map raises hundreds of bins.
TEST(ReceiverDepthPyramid, WhatTheMapLeaves) {
    const gnomon::Device device = device_with();
    std::uint64_t self_shadowing = 0, raised = 0;
    for (const auto& [name, light] : lights_of_every_kind()) {
        SCOPED_TRACE(name);
        const Floats triangles = soup(20, 1.5f, 76);
        LightScene scene{name, triangles, random_points(2000, -2, 2, 77), light};
        Random random(78);
        for (int i = 0; i < 2000; ++i) scene.receivers.push_back(random.below(24));
        StageSettings settings;
        for (const FrameOutput& out : run_light_stages(device, scene, settings)) {
            const Keys expected_self_shadow =
                expected_bins(out, [&](const ListedPoint& p) { return may_self_shadow(out.visibility_before[p.id]); });
            EXPECT_EQ(out.self_shadow_depths, expected_self_shadow);
            EXPECT_EQ(out.depth_after_map,
                      Keys(out.pyramid.begin(), out.pyramid.begin() + long(out.self_shadow_depths.size())));
            self_shadowing += std::count_if(out.self_shadow_depths.begin(), out.self_shadow_depths.end(),
                                            [](auto key) { return key != NO_KEY; });
        }
        settings.with_map = true;
        for (const FrameOutput& out : run_light_stages(device, scene, settings)) {
            // No point that the map leaves open lies below.
            for (const ListedPoint& p : out.points) EXPECT_GE(key_of_float(p.z), out.depth_after_map[p.bin]);
            for (std::size_t bin = 0; bin < out.self_shadow_depths.size(); ++bin) {
                EXPECT_GE(out.depth_after_map[bin], std::min(out.pyramid[bin], out.self_shadow_depths[bin]));
                raised += out.depth_after_map[bin] > out.pyramid[bin];
            }
        }
    }
    EXPECT_GT(self_shadowing, 500u);
    EXPECT_GT(raised, 100u);
}

// Not vacuous: the first grid's pyramid is 16 times as large as the second's, so canaries are right behind the second.
TEST(ReceiverDepthPyramid, WritesOnlyItsOwn) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    const LightScene scene = comparison_scene();
    const UploadedScene inputs(device, scene);
    LightStages stages;
    for (const gnomon::FrameGrid grid : {gnomon::FrameGrid{128, 2}, {64, 3}}) {
        FrameOutput out{};
        out.frame = light_frames(inputs.light, grid)[0];
        StageSettings settings;
        settings.grid = grid;
        if (grid.size == 64)
            for (const auto* keys :
                 {&stages.receiver_depth_pyramid.pyramid(), &stages.receiver_depth_pyramid.self_shadow_depths(),
                  &stages.receiver_depth_pyramid.depth_after_map()})
                put_canaries(session, *keys);
        stages.light_frame.run(session, out.frame, inputs.facing.frame_bounds());
        stages.receiver_depth_pyramid.run(session, out.frame, 0, 1, inputs.point_inputs(),
                                          stages.light_frame.projections(), inputs.facing.blocks(),
                                          inputs.visibility.get());
        const gnomon::cl::Buffer map(session, std::size_t(grid.size) * grid.size * sizeof(std::uint32_t));
        session.fill(map, 0, map.bytes());
        stages.receiver_depth_pyramid.run_depth_after_map(session, out.frame, 1, stages.light_frame.projections(),
                                                          &map);
    }
    const std::size_t bins = 8 * 8, cells = bins + 16 + 4 + 1, key = sizeof(std::uint32_t);
    expect_canaries(session, stages.receiver_depth_pyramid.pyramid(), cells * key, "pyramid");
    expect_canaries(session, stages.receiver_depth_pyramid.self_shadow_depths(), bins * key,
                    "depths of points that may shadow themselves");
    expect_canaries(session, stages.receiver_depth_pyramid.depth_after_map(), cells * key, "heights of open points");
}

// All six frames of a point light at once: the same as each by itself.
TEST(ReceiverDepthPyramid, TakesFramesTogether) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    for (const gnomon::FrameGrid grid : GRIDS) {
        LightScene scene = comparison_scene();
        scene.light = at(0.1f, 0.2f, -0.3f);
        const UploadedScene inputs(device, scene);
        const gnomon::LightFrame frame = gnomon::make_light_frame(inputs.light, grid);
        LightStages stages;
        stages.light_frame.run(session, frame, inputs.facing.frame_bounds());
        stages.receiver_depth_pyramid.run(session, frame, 0, POINT_LIGHT_FRAMES, inputs.point_inputs(),
                                          stages.light_frame.projections(), nullptr, inputs.visibility.get());
        StageSettings settings;
        settings.grid = grid;
        const auto single = run_light_stages(device, scene, settings);
        ASSERT_EQ(single.size(), std::size_t(POINT_LIGHT_FRAMES));
        // Level by level, inside a level frame by frame.
        Keys expected_keys;
        std::size_t first = 0;
        for (std::uint32_t w = frame.bins_x, h = frame.bins_y;; w = (w + 1) / 2, h = (h + 1) / 2) {
            for (const FrameOutput& out : single)
                expected_keys.insert(expected_keys.end(), out.pyramid.begin() + long(first),
                                     out.pyramid.begin() + long(first + std::size_t(w) * h));
            first += std::size_t(w) * h;
            if (w == 1 && h == 1) break;
        }
        EXPECT_EQ(
            downloaded<std::uint32_t>(session, stages.receiver_depth_pyramid.pyramid().get(), expected_keys.size()),
            expected_keys);
    }
}

}  // namespace
