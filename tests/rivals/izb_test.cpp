// SPDX-License-Identifier: MIT
// Stage izb: every point that still needs an answer is listed once, in its texel's list; those below their texel's
// conservative height are decided instead, never by their own receiver. The trace removes what it puts into shadow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <set>

#include "reference/visibility.hpp"
#include "support/light_scenes.hpp"
#include "support/truth.hpp"

namespace {

using namespace support;

StageSettings with_map(gnomon::FrameGrid grid = {64, 3}) {
    StageSettings settings;
    settings.grid = grid;
    settings.with_map = true;
    return settings;
}

std::uint32_t receiver_of(const LightScene& scene, std::uint32_t point) {
    return scene.receivers.empty() ? reference::NO_RECEIVER : scene.receivers[point];
}

bool receiver_blocks(const LightScene& scene, std::uint32_t point) {
    const std::uint32_t receiver = receiver_of(scene, point);
    if (receiver >= scene.triangles.size() / 9) return false;
    const reference::Triangle t = reference::triangle_at(scene.triangles, receiver);
    return reference::is_finite(t) && exact_pair(t, reference::point_at(scene.points, point), scene.light).blocks;
}

/// A point lies in the list of its texel, and those that are left after the trace are those that it left in the light.
void check_lists(const FrameOutput& out) {
    const std::uint32_t side = 1u << out.frame.bin_log2;
    std::vector<std::uint32_t> lit, left;
    for (const ListedPoint& p : out.points) {
        const auto texel = [](float at, std::uint32_t count) {
            return std::min(std::uint32_t(std::max(at, 0.0f)), count - 1);
        };
        const std::uint32_t x = texel(p.x, out.frame.width), y = texel(p.y, out.frame.height);
        EXPECT_EQ(p.bin, y / side * out.frame.bins_x + x / side) << "point " << p.id;
        EXPECT_EQ(p.texel, y % side * side + x % side) << "point " << p.id;
        if (out.visibility_after_izb_trace[p.id] != 0) lit.push_back(p.id);
    }
    for (const ListedPoint& p : out.points_left) left.push_back(p.id);
    EXPECT_EQ(left, lit);
}

/// Which points the stage must decide, and which list: from where the points are (listed without a map) and the map.
void check_frame(const FrameOutput& all, const FrameOutput& out, const LightScene& scene) {
    std::set<std::uint32_t> listed;
    for (const ListedPoint& p : out.points) EXPECT_TRUE(listed.insert(p.id).second) << "point " << p.id << " twice";
    for (const ListedPoint& p : all.points) {
        const std::size_t texel = std::size_t(p.y) * out.frame.width + std::size_t(p.x);
        const bool decided = all.projection.indistinct == 0 && key_of_float(p.z) < out.map[texel] &&
                             !may_self_shadow(out.visibility_before[p.id]);
        EXPECT_TRUE(!decided || !receiver_blocks(scene, p.id)) << "point " << p.id;
        EXPECT_EQ(listed.contains(p.id), !decided) << "point " << p.id;
        EXPECT_EQ(out.visibility_after_izb[p.id], decided ? 0.0f : 1.0f) << "point " << p.id;
    }
    for (const gnomon::FrameCounters& counted : {out.izb_counters, out.counters}) {  // of izb and of the trace
        EXPECT_EQ(counted.listed, out.points.size());
        EXPECT_EQ(counted.listed + counted.decided_by_map, all.points.size());
    }
}

/// Directional lights only: with one frame, both runs meet the points in the same state.
std::vector<LightScene> scenes() {
    std::vector<LightScene> all;
    for (const LightScene& scene : reference_scenes())
        if (scene.light[3] == 0) all.push_back(scene);
    Floats triangles = soup(20, 0.8f, 91);
    Random random(92);
    for (const auto& [name, light] : lights_of_every_kind()) {
        if (light[3] != 0) continue;
        LightScene scene{name, triangles, points_behind(triangles, light, 500, 2, 93), light};
        for (int i = 0; i < 500; ++i) scene.receivers.push_back(random.below(24));
        all.push_back(scene);
    }
    return all;
}

// Not vacuous: the map decides hundreds of points, and spares some for their receiver's sake.
TEST(Izb, EqualsReference) {
    const gnomon::Device device = device_with();
    std::uint64_t decided = 0;
    for (const LightScene& scene : scenes())
        for (const gnomon::FrameGrid grid : {gnomon::FrameGrid{64, 3}, {100, 2}}) {
            SCOPED_TRACE(scene.name);
            StageSettings without = with_map(grid);
            without.with_map = false;
            const auto all = run_light_stages(device, scene, without),
                       out = run_light_stages(device, scene, with_map(grid));
            ASSERT_EQ(all.size(), 1u);
            check_frame(all[0], out.at(0), scene);
            check_lists(all[0]);
            check_lists(out[0]);
            decided += out[0].counters.decided_by_map;
        }
    EXPECT_GT(decided, 500u);
}

/// A floor that is its points' receiver; the points lie above and below it, from an ulp to a hundredth.
LightScene floor_scene() {
    LightScene scene{"floor", {}, {}, along(0.1f, -1, 0.2f)};
    add(scene.triangles, {-3, 1, -3}, {3, 1.3f, -3}, {0, 1.1f, 4});
    Random random(94);
    for (int i = 0; i < 2000; ++i) {
        const auto place = place_on(random, scene.triangles, 0);
        const double aside = i % 2 == 0 ? 0 : random.between(-0.01f, 0.01f);
        add(scene.points, nudged(random, {float(place[0]), float(place[1] + aside), float(place[2])}));
        scene.receivers.push_back(0);
    }
    return scene;
}

// Not vacuous: the floor covers most texels, hundreds of the points lie exactly below it, and the same points without
// a receiver are dark.
TEST(Izb, ReceiverNeverShadowsItsOwnPoints) {
    const gnomon::Device device = device_with();
    LightScene scene = floor_scene();
    // With an eye above the floor and without: a caller's points need not lie on the eye's side of their receiver.
    for (const std::optional<Float3>& eye : {std::optional<Float3>(), std::optional<Float3>({0, 9, 0})}) {
        SCOPED_TRACE(eye ? "with an eye" : "without an eye");
        scene.eye = eye;
        const FrameOutput out = run_light_stages(device, scene, with_map()).at(0);
        EXPECT_EQ(std::count(out.visibility.begin(), out.visibility.end(), 0.0f), 0);
        EXPECT_GT(std::count_if(out.map.begin(), out.map.end(), [](std::uint32_t key) { return key != 0; }), 500);
    }
    scene.eye.reset();
    scene.receivers.clear();
    const FrameOutput out = run_light_stages(device, scene, with_map()).at(0);
    EXPECT_GT(std::count(out.visibility.begin(), out.visibility.end(), 0.0f), 300);
}

LightScene comparison_scene() {
    const Floats triangles = soup(30, 0.8f, 95);
    return {"comparison", triangles, random_points(5000, -1, 1, 96), at(0.1f, 0.2f, 3)};
}

bool same(const ListedPoint& a, const ListedPoint& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

// Not vacuous: 5000 points, some 80 a bin, whose places in the lists depend on who comes first.
TEST(Izb, ShapeFree) {
    const LightScene scene = comparison_scene();
    const auto plain = run_light_stages(device_with(), scene, with_map());
    for (const std::uint32_t group : FEW_WORK_GROUP_SIZES) {
        const auto found = run_light_stages(device_with(group), scene, with_map());
        ASSERT_EQ(found.size(), plain.size());
        for (std::size_t f = 0; f < plain.size(); ++f) {
            ASSERT_EQ(found[f].points.size(), plain[f].points.size()) << "work-groups of " << group;
            for (std::size_t i = 0; i < plain[f].points.size(); ++i)
                EXPECT_TRUE(same(found[f].points[i], plain[f].points[i])) << "work-groups of " << group;
            EXPECT_EQ(found[f].visibility_after_izb, plain[f].visibility_after_izb);
        }
    }
}

TEST(Izb, OrderFree) {
    const gnomon::Device device = device_with();
    const LightScene scene = comparison_scene();
    LightScene shuffled = scene;
    const auto order = shuffled_order(scene.points.size() / 3, 97);
    for (std::size_t i = 0; i < scene.points.size(); ++i) shuffled.points[i] = scene.points[3 * order[i / 3] + i % 3];
    const auto plain = run_light_stages(device, scene, with_map()),
               mixed = run_light_stages(device, shuffled, with_map());
    ASSERT_EQ(plain.size(), mixed.size());
    for (std::size_t f = 0; f < plain.size(); ++f) {
        EXPECT_EQ(plain[f].depth_after_map, mixed[f].depth_after_map);
        for (std::size_t i = 0; i < order.size(); ++i)
            EXPECT_EQ(mixed[f].visibility_after_izb[i], plain[f].visibility_after_izb[order[i]]);
    }
}

// Not vacuous: the second run lists a tenth of the first one's points, into the same buffers.
TEST(Izb, WritesOnlyItsOwn) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    LightScene scene = comparison_scene();
    scene.light = along(0, -1, 0);
    LightStages stages;
    FrameOutput out{};
    {
        const UploadedScene inputs(device, scene);
        out.frame = light_frames(inputs.light, StageSettings{}.grid)[0];
        run_stages_once(session, stages, inputs, {}, out);
    }
    scene.points.resize(3 * 500);
    const UploadedScene inputs(device, scene);
    gnomon::Izb& izb = stages.izb;
    put_canaries(session, izb.lists());
    const gnomon::TriangleInputs triangles = inputs.triangle_inputs();
    const gnomon::PointInputs points = inputs.point_inputs();
    izb.run(session, {.light_frame = out.frame,
                      .first_frame = 0,
                      .frame_count = 1,
                      .triangles = triangles,
                      .points = points,
                      .projections = stages.projection,
                      .map = nullptr,
                      .lists = gnomon::list_buffers(stages.lists.bins(), stages.lists.setup()),
                      .visibility = inputs.visibility.get(),
                      .counters = inputs.counters});
    const std::uint32_t list_count = out.frame.bins_x * out.frame.bins_y << 2 * out.frame.bin_log2;
    const std::uint32_t slots = downloaded<std::uint32_t>(session, izb.offsets().get(), list_count + 1)[list_count];
    ASSERT_GT(slots, 499u);
    ASSERT_LE(slots, izb.slot_count());
    const std::size_t stride = izb.slot_count();
    const auto words = downloaded<std::uint32_t>(session, izb.lists().get(), IZB_WORDS * stride);
    for (std::size_t array = 0; array < IZB_WORDS; ++array)
        for (std::size_t i = array * stride + slots; i < (array + 1) * stride; ++i)
            ASSERT_EQ(words[i], CANARY) << "array " << array;
    expect_canaries(session, izb.lists(), IZB_WORDS * stride * sizeof(float), "the lists of points");
}

}  // namespace
