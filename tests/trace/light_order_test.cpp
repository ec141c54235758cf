// SPDX-License-Identifier: MIT
// Stage light_order: points in any order have the oracle's visibility, each in its own place, whether the run sorts
// them or not; `auto` sorts what is in no order, and that alone.
#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include "support/expect_exact.hpp"
#include "support/light_scenes.hpp"

namespace {

using namespace support;

const gnomon::Device& device() {
    static const gnomon::Device made;
    return made;
}

/// The scene with its points in another order, and every seventh of them absent.
LightScene shuffled(const LightScene& scene) {
    std::vector<std::size_t> order(scene.points.size() / 3);
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::shuffle(order.begin(), order.end(), std::mt19937(5));
    LightScene made = scene;
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            made.points[3 * i + c] =
                i % 7 == 0 ? std::numeric_limits<float>::quiet_NaN() : scene.points[3 * order[i] + c];
        if (!scene.receivers.empty()) made.receivers[i] = scene.receivers[order[i]];
    }
    return made;
}

/// A grid of side x side points, row by row, `high` over the plane z = 0, over which boxes stand.
LightScene boxes_and_grid(std::size_t side, float high) {
    LightScene scene{"boxes", lattice_blocks(6, 3, 15), {}, along(0.3f, 0.2f, -1)};
    for (std::size_t y = 0; y < side; ++y)
        for (std::size_t x = 0; x < side; ++x)
            for (const float c : {6 * float(x) / float(side), 6 * float(y) / float(side), high})
                scene.points.push_back(c);
    return scene;
}

TEST(LightOrder, EveryPointKeepsItsPlaceAndItsVisibility) {
    AnswerTally tally;
    std::uint64_t sorted = 0;
    std::size_t scenes = 0;
    for (const LightScene& scene : light_scenes()) {
        if (++scenes % 5 != 0) continue;
        for (const Mode mode : {Mode::animated, Mode::prepared}) {
            sorted +=
                expect_exact(device(), shuffled(scene), {{"sort-points", "on"}}, tally, mode).count("points_sorted");
        }
    }
    EXPECT_GT(sorted, scenes / 5);
    EXPECT_GT(tally.lit, 1000u);
    EXPECT_GT(tally.shadowed, 1000u);
    EXPECT_GT(tally.by_exact, 100u);
}

TEST(LightOrder, ReceiversAndTheEyeGoWithTheirPoints) {
    // Points on the boxes' own faces: without its receiver a point may be shadowed by it, and facing decides many.
    LightScene scene = boxes_and_grid(1, 0);
    scene.points.clear();
    Random random(3);
    for (std::uint32_t id = 0; id < scene.triangles.size() / 9; ++id)
        for (int k = 0; k < 12; ++k) {
            const float a = random.between(0, 1), b = random.between(0, 1 - a);
            for (std::size_t c = 0; c < 3; ++c) {
                const float* v = &scene.triangles[9 * id + c];
                scene.points.push_back(v[0] + a * (v[3] - v[0]) + b * (v[6] - v[0]));
            }
            scene.receivers.push_back(id);
        }
    scene.eye = Float3{20, -30, 40};
    AnswerTally tally;
    for (const char* choice : {"on", "off"}) {
        const Answer got = expect_exact(device(), shuffled(scene), {{"sort-points", choice}}, tally);
        EXPECT_EQ(got.count("points_sorted"), choice == std::string("on"));
        EXPECT_GT(got.count("points_facing_away"), 100u);
    }
}

TEST(LightOrder, AutomaticSortsPointsWithoutOrderOnACpu) {
    const LightScene rows = boxes_and_grid(160, -0.25f);
    const auto sorted = [&](const LightScene& scene) {
        AnswerTally tally;
        return expect_exact(device(), scene, {}, tally).count("points_sorted");
    };
    EXPECT_EQ(sorted(shuffled(rows)), std::uint64_t(session_of(device()).is_cpu()));
    // Rows of 160 points: a run of neighbours is a tenth of the scene long. Rows of 16 are squares.
    EXPECT_EQ(sorted(rows), std::uint64_t(session_of(device()).is_cpu()));
    LightScene squares = rows;
    for (std::size_t i = 0; i < 160 * 160; ++i) {
        const std::size_t block = i / 16, x = block % 40 * 4 + i % 4, y = block / 40 * 4 + i % 16 / 4;
        std::copy_n(&rows.points[3 * (160 * y + x)], 3, &squares.points[3 * i]);
    }
    EXPECT_EQ(sorted(squares), 0u);
    EXPECT_EQ(sorted(shuffled(boxes_and_grid(120, -0.25f))), 0u) << "few points";
}

TEST(LightOrder, PointsWithoutExtentStayAsTheyAre) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), huge = std::numeric_limits<float>::max();
    AnswerTally tally;
    for (const float c : {nan, 0.5f, huge}) {
        LightScene scene = boxes_and_grid(10, 0);
        std::ranges::fill(scene.points, c);
        EXPECT_EQ(expect_exact(device(), scene, {{"sort-points", "on"}}, tally).count("points_sorted"), 0u);
    }
    LightScene line = boxes_and_grid(40, -1);  // a point light on the line through all points
    for (std::size_t i = 0; i < 1600; ++i) line.points[3 * i] = 0, line.points[3 * i + 1] = 0;
    line.light = at(0, 0, 5);
    expect_exact(device(), line, {{"sort-points", "on"}}, tally);
    LightScene far = boxes_and_grid(40, -1);
    for (std::size_t i = 0; i < 1600; i += 3) far.points[3 * i] = i % 2 == 0 ? huge : -huge;
    expect_exact(device(), far, {{"sort-points", "on"}}, tally);
}

TEST(LightOrder, PicturesStayAsTheyAre) {
    const gnomon::Triangles triangles = gnomon::Triangles::upload(device(), lattice_blocks(6, 3, 15));
    const auto camera = gnomon::Camera::look_at({2, 2, 14}, {2, 2, 0}, {0, 1, 0}, 40);
    const gnomon::Points points = gnomon::look(device(), triangles, camera, 320, 200).points;
    const auto technique = technique_with(device(), {{"sort-points", "on"}});
    EXPECT_EQ(answer(device(), *technique, triangles, points, gnomon::Light::directional({0.3f, 0.2f, -1}))
                  .count("points_sorted"),
              0u);
}

}  // namespace
