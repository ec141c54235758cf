// SPDX-License-Identifier: MIT
// Stage bins: a triangle that blocks a listed point is in the list of the point's bin. One-sided: a list may hold more.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <limits>

#include "support/light_scenes.hpp"
#include "support/truth.hpp"

namespace {

using namespace support;

struct Tally {
    std::uint64_t referenced = 0, possible = 0;
};

void check_frame(const FrameOutput& out, const LightScene& scene, Tally& tally) {
    for (const auto& list : out.references) {
        EXPECT_TRUE(std::adjacent_find(list.begin(), list.end()) == list.end()) << "a triangle twice in one bin";
        tally.referenced += list.size();
    }
    tally.possible += out.references.size() * (scene.triangles.size() / 9);
    for (const ListedPoint& p : out.points) {
        const auto& list = out.references[p.bin];
        for (std::uint32_t id = 0; id < scene.triangles.size() / 9; ++id) {
            if (std::binary_search(list.begin(), list.end(), id)) continue;
            const reference::Triangle t = reference::triangle_at(scene.triangles, id);
            if (!reference::is_finite(t)) continue;
            EXPECT_FALSE(exact_pair(t, reference::point_at(scene.points, p.id), scene.light).blocks)
                << "triangle " << id << " blocks point " << p.id << " and is not in the list of bin " << p.bin;
        }
    }
    for (const SetUpTriangle& t : out.triangles)
        for (std::uint32_t bin = 0; bin < out.references.size(); ++bin) {
            const auto& list = out.references[bin];
            if (!std::binary_search(list.begin(), list.end(), t.id)) continue;
            EXPECT_TRUE(t.bins.contains(bin % out.frame.bins_x, bin / out.frame.bins_x))
                << "triangle " << t.id << " is listed outside its own range, where its margins do not hold";
        }
}

void check(const gnomon::Device& device, const LightScene& scene, gnomon::FrameGrid grid, Tally& tally) {
    SCOPED_TRACE(scene.name + ", grid of " + std::to_string(grid.size));
    StageSettings settings;
    settings.grid = grid;
    for (const FrameOutput& out : run_light_stages(device, scene, settings)) check_frame(out, scene, tally);
}

// Not vacuous: fewer than a tenth of all (triangle, bin) pairs are referenced, so the omitted pairs matter.
TEST(Bins, EqualsReference) {
    const gnomon::Device device = device_with();
    Tally tally;
    for (const LightScene& scene : light_scenes()) check(device, scene, {64, 3}, tally);
    std::cout << tally.referenced << " of " << tally.possible << " pairs referenced\n";
    EXPECT_GT(tally.referenced, 1000u);
    EXPECT_LT(tally.referenced, tally.possible / 10);
}

TEST(Bins, EqualsReferenceInTheOraclesOwnScenes) {
    const gnomon::Device device = device_with();
    Tally tally;
    for (const LightScene& scene : reference_scenes()) check(device, scene, {32, 2}, tally);
    for (const LightScene& scene : huge_triangle_scenes()) check(device, scene, {100, 3}, tally);
    for (const LightScene& scene : underflow_scenes()) check(device, scene, {64, 3}, tally);
    for (const LightScene& scene : point_light_plane_scenes()) check(device, scene, {64, 3}, tally);
    EXPECT_GT(tally.referenced, 1000u);
}

LightScene comparison_scene() {
    Floats triangles = soup(300, 0.05f, 101);
    append(triangles, soup(40, 0.5f, 102));
    append(triangles, soup(6, 9, 103));
    return {"comparison", triangles, random_points(3000, -1, 1, 104), along(0.3f, -1, 0.2f)};
}

/// Few bins, many, and so many that all work-items walk one triangle.
constexpr gnomon::FrameGrid GRIDS[] = {{64, 3}, {100, 1}, {256, 0}};

FrameOutput run(const gnomon::Device& device, const LightScene& scene, gnomon::FrameGrid grid) {
    StageSettings settings;
    settings.grid = grid;
    return run_light_stages(device, scene, settings).at(0);
}

// Not vacuous: the scenes have triangles of one tile and of hundreds (checked), and hundreds of references or more.
TEST(Bins, ShapeFree) {
    const LightScene scene = comparison_scene();
    for (const gnomon::FrameGrid grid : GRIDS) {
        SCOPED_TRACE("grid of " + std::to_string(grid.size));
        const FrameOutput plain = run(device_with(), scene, grid);
        if (grid.size == 256) {
            EXPECT_GT(plain.counters.survivors, 100u);  // nearly all of one tile or two
            if (gnomon::session_of(device_with()).is_cpu()) {
                EXPECT_GT(plain.counters.references, plain.counters.survivors + 1000u);  // a CPU makes no tiles of them
            } else {
                EXPECT_GT(plain.counters.tiles, plain.counters.survivors + 1000u);
            }
        }
        EXPECT_GT(plain.counters.references, 500u);
        // A CPU's items have counts of their own; of the last grid in groups of 64 they share them.
        for (const std::uint32_t group : FEW_WORK_GROUP_SIZES)
            EXPECT_EQ(run(device_with(group), scene, grid).references, plain.references) << "groups of " << group;
    }
}

TEST(Bins, OrderFree) {
    const gnomon::Device device = device_with();
    const LightScene scene = comparison_scene();
    const auto order = shuffled_order(scene.triangles.size() / 9, 105);
    LightScene shuffled = scene;
    for (std::size_t i = 0; i < scene.triangles.size(); ++i)
        shuffled.triangles[i] = scene.triangles[9 * order[i / 9] + i % 9];
    auto mixed = run(device, shuffled, GRIDS[0]).references;
    for (auto& list : mixed) {
        for (std::uint32_t& id : list) id = order[id];
        std::sort(list.begin(), list.end());
    }
    EXPECT_EQ(mixed, run(device, scene, GRIDS[0]).references);
    LightScene reversed = scene;
    reversed.triangles = reversed_winding(scene.triangles);
    Tally tally;
    for (const gnomon::FrameGrid grid : {GRIDS[0], GRIDS[1]}) check(device, reversed, grid, tally);
}

TEST(Bins, SurvivesDegenerates) {
    const gnomon::Device device = device_with();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    Tally tally;
    for (const auto& [name, light] : lights_of_every_kind()) {
        LightScene scene{name, {}, random_points(200, -1, 1, 106), light};
        add(scene.triangles, {nan, 0, 0}, {1, 0, 0}, {0, 0, 1});
        add(scene.triangles, {-3e38f, 1, -3e38f}, {3e38f, 1, -3e38f}, {0, 1, 3e38f});
        add(scene.triangles, {-1, 1, -1}, {-1, 1, -1}, {1, 1, 1});
        add(scene.triangles, {1e-45f, 0, 0}, {0, 1e-45f, 0}, {0, 0, 1e-45f});
        add(scene.triangles, {light[0], light[1], light[2]}, {1, 0, 0}, {0, 0, 1});     // a vertex at the light
        add(scene.triangles, {-9, light[1], -9}, {9, light[1], -9}, {0, light[1], 9});  // the light in its plane
        check(device, scene, {64, 3}, tally);
    }
    EXPECT_GT(tally.referenced, 100u);
}

// Not vacuous: the second run has a fraction of the first one's references and bins, in the same buffers.
TEST(Bins, WritesOnlyItsOwn) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    LightScene scene = comparison_scene();
    LightStages stages;
    FrameOutput out{};
    for (const gnomon::FrameGrid grid : {gnomon::FrameGrid{64, 1}, {64, 3}}) {
        const UploadedScene inputs(device, scene);
        out.frame = light_frames(inputs.light, grid)[0];
        if (grid.bin_log2 == 3) {
            for (const gnomon::cl::Buffer* list :
                 {&stages.lists.bins().ranges(), &stages.lists.bins().entries(), &stages.lists.bins().pairs()})
                put_canaries(session, *list);
        }
        StageSettings settings;
        settings.grid = grid;
        run_stages_once(session, stages, inputs, settings, out);
    }
    expect_canaries(session, stages.lists.bins().ranges(), 8 * 8 * 2 * sizeof(std::uint32_t), "ranges");
    expect_canaries(session, stages.lists.bins().entries(), out.counters.entries * session.lanes() * BIN_ENTRY_BYTES,
                    "entries");
    expect_canaries(session, stages.lists.bins().pairs(), out.counters.pairs * sizeof(gnomon::Pair), "pairs");
}

// A GPU's lists are in runs with the highest triangles first. Not vacuous: some lists have several runs, and heights
// differ.
TEST(Bins, HighestFirstOnAGpu) {
    gnomon::DeviceOptions options;
    options.gpu_kernels = true;
    const gnomon::Device device({}, options);
    gnomon::cl::Session& session = session_of(device);
    ASSERT_EQ(session.lanes(), 1u);
    LightScene scene = comparison_scene();
    append(scene.triangles, soup(300, 0.9f, 107));
    const UploadedScene inputs(device, scene);
    StageSettings settings;
    settings.grid = {64, 4};
    LightStages stages;
    FrameOutput out{};
    out.frame = light_frames(inputs.light, settings.grid)[0];
    while (!run_stages_once(session, stages, inputs, settings, out)) {
    }
    std::vector<cl_uint2> ranges(4 * 4);
    std::vector<std::array<cl_uint, 4>> entries(out.counters.entries);
    session.read(stages.lists.bins().ranges().get(), ranges.data(), ranges.size() * sizeof(cl_uint2));
    session.read(stages.lists.bins().entries().get(), entries.data(), entries.size() * BIN_ENTRY_BYTES);
    int lower = 0, runs_after_the_first = 0;
    for (const cl_uint2& range : ranges)
        for (cl_uint i = range.s[0]; i < range.s[1]; ++i) {
            if ((i - range.s[0]) % LIST_RUN == 0) {
                runs_after_the_first += i != range.s[0];
                continue;
            }
            const cl_uint height = entries[i][2] & 0xFFFFu, before = entries[i - 1][2] & 0xFFFFu;
            EXPECT_LE(height, before) << "entry " << i - range.s[0] << " of a list";
            lower += height < before;
        }
    EXPECT_GT(lower, 500);
    EXPECT_GT(runs_after_the_first, 10);
}

// Not vacuous: from room for 1 reference to thousands.
TEST(Bins, Grows) {
    const gnomon::Device device = device_with();
    const LightScene scene = comparison_scene();
    const UploadedScene inputs(device, scene);
    StageSettings settings;
    LightStages stages;
    stages.lists.limit_initial_capacity(1);
    FrameOutput out{};
    out.frame = light_frames(inputs.light, settings.grid)[0];
    int passes = 1;
    while (!run_stages_once(session_of(device), stages, inputs, settings, out)) ++passes;
    EXPECT_GE(passes, 2);
    EXPECT_GT(stages.lists.bins().pair_capacity(), 1u);
    settings.first_capacity = 1;
    const FrameOutput grown = run_light_stages(device, scene, settings).at(0);
    EXPECT_EQ(grown.visibility, run(device, scene, settings.grid).visibility);
}

}  // namespace
