// SPDX-License-Identifier: MIT
// Stage facing: a point is in shadow by definition unless the light is strictly on the eye's side of its receiver's
// plane; an open point may shadow itself if the receiver's plane is strictly between it and the light.
#include "receivers/facing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "support/light_scenes.hpp"

namespace {

using namespace support;

struct Answer {
    std::vector<float> visibility;
    gnomon::FrameCounters counters;
    std::vector<gnomon::PointBounds> bounds{};  ///< of each frame
    std::uint32_t undecided = 0;                ///< on a GPU: points that the float filter left undecided
};

/// Runs the stage, with canaries behind the visibility. With `is_lifted` no point may shadow itself.
Answer run(const gnomon::Device& device, const LightScene& scene, bool is_lifted = false) {
    gnomon::cl::Session& session = session_of(device);
    const UploadedScene inputs(device, scene);
    const std::size_t count = scene.points.size() / 3;
    gnomon::cl::Buffer visibility(session, (count + 8) * sizeof(float));
    put_canaries(session, visibility);
    session.fill(inputs.counters, 0, sizeof(gnomon::FrameCounters));
    gnomon::PointInputs points = inputs.point_inputs();
    points.layout.is_lifted = is_lifted;
    gnomon::FacingStage facing;
    facing.run(session, gnomon::make_light_frame(inputs.light, {64, 3}), inputs.triangle_inputs(), points,
               visibility.get(), inputs.counters);
    expect_canaries(session, visibility, count * sizeof(float), "visibility");
    Answer answer{downloaded<float>(session, visibility.get(), count), {}};
    session.read(inputs.counters.get(), &answer.counters, sizeof(answer.counters));
    answer.bounds = downloaded<gnomon::PointBounds>(session, facing.frame_bounds().get(), scene.light[3] != 0 ? 6 : 1);
    if (facing.undecided().bytes() != 0) answer.undecided = session.read_value<std::uint32_t>(facing.undecided());
    return answer;
}

constexpr float DARK = 0, LIT = 1, OPEN = 2, MAY_SELF_SHADOW = 3;

/// True if the receiver's plane is strictly between point and light. Only then can the receiver block the point.
bool is_behind_receiver(const reference::Triangle& t, const Float3& p, const Light& light, reference::Effort& effort) {
    const Float3 l{light[0], light[1], light[2]};
    const int side_of_light =
        light[3] != 0 ? -reference::side_of_point(l, t, effort) : reference::side_of_direction(l, t, effort);
    return side_of_light != 0 && reference::side_of_point(p, t, effort) == side_of_light;
}

/// The expected result, by the reference's predicates.
std::vector<float> expected(const LightScene& scene) {
    std::vector<float> visibility;
    reference::Effort effort;
    for (std::size_t i = 0; i < scene.points.size() / 3; ++i) {
        const Float3 p = reference::point_at(scene.points, i);
        const bool at_light = scene.light[3] != 0 && p == Float3{scene.light[0], scene.light[1], scene.light[2]};
        float answer = at_light || !reference::is_finite(p) ? LIT : OPEN;
        if (reference::is_finite(p) && !scene.receivers.empty() && scene.receivers[i] < scene.triangles.size() / 9) {
            const reference::Triangle t = reference::triangle_at(scene.triangles, scene.receivers[i]);
            if (reference::is_finite(t)) {
                if (answer == OPEN && is_behind_receiver(t, p, scene.light, effort)) answer = MAY_SELF_SHADOW;
                if (scene.eye && !reference::is_facing(t, scene.light, *scene.eye, effort)) answer = DARK;
            }
        }
        visibility.push_back(answer);
    }
    return visibility;
}

/// As expected(), but no point may shadow itself.
std::vector<float> expected_of_lifted(const LightScene& scene) {
    std::vector<float> truth = expected(scene);
    std::replace(truth.begin(), truth.end(), MAY_SELF_SHADOW, OPEN);
    return truth;
}

/// The oracle's scenes, with several eyes: random, at a vertex, at the light, and none.
std::vector<LightScene> scenes() {
    std::vector<LightScene> all;
    for (const LightScene& scene : reference_scenes()) {
        const Float3 corner = vertex(scene.triangles, 5);
        const Float3 light = {scene.light[0], scene.light[1], scene.light[2]};
        for (const Float3& eye : {Float3{0.3f, 5, -2}, corner, light}) {
            all.push_back(scene);
            all.back().eye = eye;
        }
        all.push_back(scene);
    }
    return all;
}

// Not vacuous: in the scenes on lattices the light or the eye is exactly in hundreds of the receivers' planes, where
// only an exact sign is right, and both results occur.
TEST(Facing, EqualsReference) {
    const gnomon::Device device = device_with();
    std::uint64_t away = 0, open = 0, self_shadowing = 0, by_integers = 0;
    for (const LightScene& scene : scenes()) {
        SCOPED_TRACE(scene.name);
        const Answer answer = run(device, scene);
        const std::vector<float> truth = expected(scene);
        EXPECT_EQ(answer.visibility, truth);
        const auto zeros = static_cast<std::uint64_t>(std::count(truth.begin(), truth.end(), 0.0f));
        EXPECT_EQ(answer.counters.facing_away, zeros);
        away += zeros;
        open += static_cast<std::uint64_t>(std::count(truth.begin(), truth.end(), OPEN));
        self_shadowing += static_cast<std::uint64_t>(std::count(truth.begin(), truth.end(), MAY_SELF_SHADOW));
        by_integers += answer.counters.facing_exact;
    }
    EXPECT_GT(away, 1000u);
    EXPECT_GT(open, 1000u);
    EXPECT_GT(self_shadowing, 1000u);
    EXPECT_GT(by_integers, 10u);
}

// Coordinates so small that the float level proves no sign: if coordinates are equal, a CPU knows that products are 0,
// else the predicate decides. Not vacuous: all results occur under each light.
TEST(Facing, KnowsZerosByEqualCoordinates) {
    const gnomon::Device device = device_with();
    std::mt19937 random(14);
    const auto coordinate = [&] { return 0x1p-30f * float(int(random() % 3) - 1); };
    LightScene scene;
    for (int i = 0; i < 600; ++i) {
        for (int k = 0; k < 3; ++k) add(scene.triangles, {coordinate(), coordinate(), coordinate()});
        add(scene.points, {coordinate(), coordinate(), coordinate()});
        scene.receivers.push_back(std::uint32_t(i));
    }
    scene.eye = Float3{0x1p-29f, 0x3p-30f, -0x1p-28f};
    for (const Light& light : {Light{1, 0, 0, 0}, Light{-0.0f, 1, -0.0f, 0}, Light{0, 0, -1, 0}, Light{1, 1, 0, 0},
                               Light{0, 1, -2, 0}, Light{0, 0x1p-30f, -0x1p-30f, 1}}) {
        scene.light = light;
        SCOPED_TRACE(light[0] + 10 * light[1] + 100 * light[2] + 1000 * light[3]);
        const std::vector<float> truth = expected(scene);
        EXPECT_EQ(run(device, scene).visibility, truth);
        EXPECT_GT(std::count(truth.begin(), truth.end(), DARK), 100);
        EXPECT_GT(std::count(truth.begin(), truth.end(), OPEN), 50);
        EXPECT_GT(std::count(truth.begin(), truth.end(), MAY_SELF_SHADOW), 10);
    }
}

// If no point may shadow itself, each triangle is classified once for all points on it. If a CPU's block has triangles
// far apart, it classifies its own receivers. Not vacuous: both results occur, some only by an exact sign; and without
// the cache, some points may shadow themselves, and more signs are exact.
TEST(Facing, ClassifiesTrianglesForLiftedPoints) {
    for (const std::uint32_t group : WORK_GROUP_SIZES) {
        const gnomon::Device device = device_with(group);
        std::uint64_t away = 0, open = 0, by_integers = 0, by_integers_one_by_one = 0;
        for (LightScene scene : scenes()) {
            if (!scene.eye || scene.receivers.empty()) continue;
            SCOPED_TRACE(scene.name);
            // First the points in their own order, on triangles from anywhere; then in the order of their triangles,
            // repeated until several points are on each.
            std::vector<std::size_t> order(scene.receivers.size());
            std::iota(order.begin(), order.end(), 0);
            std::stable_sort(order.begin(), order.end(),
                             [&](std::size_t i, std::size_t j) { return scene.receivers[i] < scene.receivers[j]; });
            do {
                for (const std::size_t i : order) {
                    add(scene.points, vertex(scene.points, i));
                    scene.receivers.push_back(scene.receivers[i]);
                }
            } while (scene.points.size() / 3 < 2 * scene.triangles.size() / 9);
            const std::vector<float> truth = expected_of_lifted(scene);
            const Answer answer = run(device, scene, true);
            EXPECT_EQ(answer.visibility, truth);
            away += static_cast<std::uint64_t>(std::count(truth.begin(), truth.end(), 0.0f));
            open += static_cast<std::uint64_t>(std::count(truth.begin(), truth.end(), OPEN));
            by_integers += answer.counters.facing_exact;
            by_integers_one_by_one += run(device, scene).counters.facing_exact;
        }
        EXPECT_GT(away, 1000u);
        EXPECT_GT(open, 1000u);
        EXPECT_GT(by_integers, 10u);
        if (session_of(device).is_cpu()) {
            EXPECT_LT(by_integers, by_integers_one_by_one);
        }
    }
}

/// Multiples of 2^-8 up to `reach`, so that sums and differences up to 2^16 are exact.
Float3 exact_vector(reference::Random& random, float reach) {
    Float3 v = random_vector(random, -reach, reach);
    for (float& x : v) x = std::round(x * 0x1p8f) * 0x1p-8f;
    return v;
}

/// A triangle with the light (or its direction) in its plane, or so near to the plane that floats do not prove the
/// side. A few triangles have no area, so that eye and light are in their planes.
void add_in_line_with(Floats& triangles, const Light& light, reference::Random& random) {
    const Float3 a = exact_vector(random, 0x1p14f);
    const Float3 side = random.below(16) == 0 ? Float3{0, 0, 0} : exact_vector(random, 0x1p14f);
    Float3 b, c;
    for (int k = 0; k < 3; ++k) {
        b[k] = a[k] + side[k];
        c[k] = (light[3] != 0 ? 0 : a[k]) + light[k] - side[k];
    }
    for (int k = 0; k < 3; ++k)  // the least change, if that is less than 2^-21 of the edge
        if (std::abs(c[k] - a[k]) >= 0x1p13f) c[k] += 0x1p-8f * float(int(random.below(3)) - 1);
    add(triangles, a, b, c);
}

/// A point on each of `count` triangles. The planes of the last triangle and others, `undecided` in all, contain the
/// light or, for a third of them, the eye. So do planes of some absent points, which must not be classified.
LightScene partly_undecided(std::uint32_t undecided, std::uint32_t count, const Light& light) {
    LightScene scene{"partly undecided", {}, {}, light};
    scene.eye = Float3{0x1p14f, -0x3p12f, 0x5p12f};
    const Light eye = {(*scene.eye)[0], (*scene.eye)[1], (*scene.eye)[2], 1};
    const Float3 absent = {std::numeric_limits<float>::quiet_NaN(), 0, 0};
    reference::Random random(41);
    for (std::uint32_t i = 0; i < count; ++i) {
        // As evenly as possible: at each i where i undecided / count reaches the next whole number.
        const bool is_undecided = std::uint64_t(i + 1) * undecided / count != std::uint64_t(i) * undecided / count;
        const bool is_absent = !is_undecided && i % 16 == 0;
        if (is_undecided || is_absent)
            add_in_line_with(scene.triangles, i % 3 == 0 ? eye : light, random);
        else
            for (int k = 0; k < 3; ++k) add(scene.triangles, exact_vector(random, 0x1p14f));
        const bool is_at_light = light[3] != 0 && i % 16 == 1;
        const Float3 p = exact_vector(random, 0x1p14f);
        add(scene.points, is_absent ? absent : is_at_light ? Float3{light[0], light[1], light[2]} : p);
        scene.receivers.push_back(i);
    }
    return scene;
}

/// The open points' number, and their extent across the light's direction: the fit of a grid depends on both. (The
/// margins of the other bounds depend on which points an item takes together.)
std::vector<std::uint32_t> extents(const std::vector<gnomon::PointBounds>& bounds) {
    std::vector<std::uint32_t> words;
    for (const gnomon::PointBounds& of : bounds)
        words.insert(words.end(), {of.highest[0], of.highest[1], of.minus_lowest[0], of.minus_lowest[1], of.count});
    return words;
}
std::vector<std::uint32_t> extents_of_open(const gnomon::Device& device, const LightScene& scene,
                                           const std::vector<float>& truth) {
    LightScene open{"open points alone", scene.triangles, {}, scene.light};
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (truth[i] == OPEN) add(open.points, vertex(scene.points, i));
    return extents(run(device, open).bounds);
}

// A GPU filters by floats, and lists the undecided points up to a capacity; if there are more, the exact kernel scans
// all points. Not vacuous: the scene has the intended number of undecided points, and some of these are backfacing and
// some open, which only integers separate.
TEST(Facing, ExactFallbackDecidesUndecidedPoints) {
    constexpr std::uint32_t few = 1000, listed = UNDECIDED_CAPACITY, many = listed + listed / 8;
    gnomon::DeviceOptions options;
    options.gpu_kernels = true;
    for (const std::uint32_t group : FEW_WORK_GROUP_SIZES) {
        options.work_group_size = group;
        const gnomon::Device device({}, options);
        for (const Light& light : {Light{0x1p13f, 0x7p12f, -0x3p12f, 0}, Light{-0x1p12f, 0x1p14f, 0x3p11f, 1}})
            for (const auto& [undecided, count] : {std::pair{0u, few},
                                                   {1u, few},
                                                   {few / 3, few},
                                                   {few, few},
                                                   {listed, many},
                                                   {listed + 1, many},
                                                   {many, many}}) {
                SCOPED_TRACE(std::to_string(undecided) + " of " + std::to_string(count) +
                             ", w = " + std::to_string(light[3]) + ", work-groups of " + std::to_string(group));
                const LightScene scene = partly_undecided(undecided, count, light);
                const std::vector<float> truth = expected_of_lifted(scene);
                const Answer answer = run(device, scene, true);
                EXPECT_EQ(answer.undecided, undecided);
                EXPECT_TRUE(answer.visibility == truth);
                EXPECT_EQ(answer.counters.facing_away, std::count(truth.begin(), truth.end(), DARK));
                EXPECT_EQ(answer.counters.absent, std::count_if(scene.points.begin(), scene.points.end(),
                                                                [](float x) { return std::isnan(x); }));
                EXPECT_EQ(extents(answer.bounds), extents_of_open(device, scene, truth));
            }
    }
}

// Not vacuous: for two thirds of the points of this scene, the receiver decides whether the result is 0 or 1.
TEST(Facing, OrderFree) {
    const gnomon::Device device = device_with();
    for (LightScene scene : scenes()) {
        SCOPED_TRACE(scene.name);
        const std::vector<float> plain = run(device, scene).visibility;
        scene.triangles = reversed_winding(scene.triangles);
        EXPECT_EQ(run(device, scene).visibility, plain);
    }
}

TEST(Facing, ShapeFree) {
    const LightScene scene = scenes()[4];
    ASSERT_TRUE(scene.eye.has_value());
    for (const std::uint32_t group : WORK_GROUP_SIZES)
        EXPECT_EQ(run(device_with(group), scene).visibility, expected(scene)) << "work-groups of " << group;
}

// Absent points, and receivers that do not exist or are not finite: not backfacing for any eye. Not vacuous: the same
// point with the backfacing receiver is in shadow.
TEST(Facing, SurvivesDegenerates) {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    Floats triangles;
    add(triangles, {-1, 0, -1}, {1, 0, -1}, {0, 0, 1});    // 0: the light below it, the eye above
    add(triangles, {-1, 0, -1}, {1, nan, -1}, {0, 0, 1});  // 1: not finite
    add(triangles, {-1, 0, -1}, {1, -inf, -1}, {0, 0, 1});
    add(triangles, {0, 0, 0}, {1, 0, 0}, {2, 0, 0});            // 3: no area, so no side
    add(triangles, {0, 0, 0}, {0, 0, 1e-45f}, {1e-45f, 0, 0});  // 4: the smallest possible area
    add(triangles, {-3e38f, 0, -3e38f}, {3e38f, 0, -3e38f}, {0, 0, 3e38f});
    LightScene scene{"degenerates", triangles, {}, along(0, 1, 0)};
    scene.eye = Float3{0, 1, 0};
    const std::vector<std::uint32_t> receivers = {0, 1, 2, 3, 4, 5, 6, 0xFFFFFFFFu, 0, 0};
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        add(scene.points, {0, i == 8 ? nan : 0, i == 9 ? inf : 0});
        scene.receivers.push_back(receivers[i]);
    }
    const gnomon::Device device = device_with();
    const Answer answer = run(device, scene);
    EXPECT_EQ(answer.visibility, (std::vector<float>{0, 2, 2, 0, 0, 0, 2, 2, 1, 1}));
    EXPECT_EQ(answer.visibility, expected(scene));
    EXPECT_EQ(answer.counters.absent, 2u);
    // Without an eye no point is backfacing.
    scene.eye.reset();
    EXPECT_EQ(run(device, scene).visibility, (std::vector<float>{2, 2, 2, 2, 2, 2, 2, 2, 1, 1}));
}

// A structure of arrays with gaps is read by its layout. Not vacuous: if it were read as packed triples, the NaN
// between the coordinates would make points absent.
TEST(Facing, ReadsAnyLayout) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    const LightScene scene = scenes()[0];
    const std::size_t count = scene.points.size() / 3, first = 5, point_stride = 2, coordinate_stride = 2 * count + 1;
    std::vector<float> spread(first + 3 * coordinate_stride, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            spread[first + i * point_stride + c * coordinate_stride] = scene.points[3 * i + c];
    const gnomon::cl::Buffer positions = uploaded(session, spread), receivers = uploaded(session, scene.receivers);
    UploadedScene inputs(device, scene);
    inputs.points = gnomon::Internals::seen_from(
        gnomon::Points::wrap(device, positions.get(), {first, point_stride, coordinate_stride}, count, receivers.get()),
        scene.eye);
    session.fill(inputs.counters, 0, sizeof(gnomon::FrameCounters));
    inputs.facing.run(session, gnomon::make_light_frame(inputs.light, {64, 3}), inputs.triangle_inputs(),
                      inputs.point_inputs(), inputs.visibility.get(), inputs.counters);
    EXPECT_EQ(downloaded<float>(session, inputs.visibility.get(), count), expected(scene));
    gnomon::FrameCounters counters;
    session.read(inputs.counters.get(), &counters, sizeof(counters));
    EXPECT_EQ(counters.absent, 0u);
}

}  // namespace
