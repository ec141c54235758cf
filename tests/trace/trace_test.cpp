// SPDX-License-Identifier: MIT
// Stages trace and exact_trace. Every decision of the trace is true; it queues the pairs that it leaves undecided and
// no others; and after the exact stage every point has the oracle's visibility.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <iostream>
#include <limits>
#include <set>

#include "support/expect_exact.hpp"
#include "support/light_scenes.hpp"
#include "support/terrains.hpp"
#include "support/truth.hpp"

namespace {

using namespace support;

struct Tally {
    std::uint64_t by_trace = 0, by_exact = 0, queued = 0, lit = 0, by_integers = 0;
};

/// By bits, as the trace compares: -0 and 0 are one place, and such a pair is left to the exact predicate.
bool has_corner_at(const LightScene& scene, std::uint32_t triangle, std::uint32_t point) {
    const float* p = &scene.points[3 * std::size_t(point)];
    for (std::size_t c = 0; c < 9; c += 3)
        if (std::memcmp(p, &scene.triangles[9 * std::size_t(triangle) + c], 3 * sizeof(float)) == 0) return true;
    return false;
}

/// After the trace: decided points are in shadow, and the queue has a blocking pair of every other shadowed point.
void check_trace(const gnomon::Device& device, const LightScene& scene, Tally& tally) {
    SCOPED_TRACE(scene.name);
    gnomon::cl::Session& session = session_of(device);
    const UploadedScene inputs(device, scene);
    const std::vector<float> truth = truth_of(scene);
    const std::size_t count = scene.points.size() / 3;
    const gnomon::LightFrame first_frame = gnomon::make_light_frame(inputs.light, StageSettings{}.grid);
    const auto frames = light_frames(inputs.light, StageSettings{}.grid);
    for (std::uint32_t face = 0; face < frames.size(); ++face) {
        LightStages stages;
        FrameOutput out{};
        out.frame = frames[face];
        while (!run_stages_once(session, stages, inputs, {}, out)) {
        }
        if (out.projection.active_points == 0) continue;
        // The same again, without the exact stage.
        const std::vector<float>&before = out.visibility_before, &after = out.visibility;
        session.write(inputs.visibility.get(), before.data(), count * sizeof(float));
        gnomon::FrameCounters counted = out.counters;
        counted.uncertain = counted.tests_low = counted.tests_high = counted.decided_by_trace = 0;
        session.write(inputs.counters.get(), &counted, sizeof(counted));
        stages.trace.run(
            session, gnomon::Task::trace,
            {first_frame, face, 1, inputs.triangle_inputs(), inputs.point_inputs(), stages.projection, nullptr,
             gnomon::list_buffers(stages.lists.bins(), stages.lists.setup()), inputs.visibility.get(), inputs.counters},
            nullptr);
        const auto traced = downloaded<float>(session, inputs.visibility.get(), count);
        session.read(inputs.counters.get(), &counted, sizeof(counted));
        ASSERT_LE(counted.uncertain, stages.trace.capacity());
        const auto queue = downloaded<std::uint32_t>(session, stages.trace.queue().get(), 2 * counted.uncertain);
        std::set<std::uint32_t> waiting;
        for (std::size_t i = 0; i < queue.size(); i += 2) {
            const std::uint32_t point = queue[i], id = queue[i + 1];
            ASSERT_LT(point, count);
            ASSERT_LT(id, scene.triangles.size() / 9);
            EXPECT_TRUE(scene.receivers.empty() || scene.receivers[point] != id) << "a receiver was queued";
            EXPECT_FALSE(has_corner_at(scene, id, point)) << "a triangle of a point's own fan was queued";
            const reference::Triangle t = reference::triangle_at(scene.triangles, id);
            if (exact_pair(t, reference::point_at(scene.points, point), scene.light).blocks) waiting.insert(point);
        }
        std::uint64_t decided = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            if (traced[i] == 0.0f) {
                EXPECT_EQ(truth[i], 0.0f) << "the filter decided wrongly about point " << i;
            }
            if (traced[i] == 1.0f && after[i] == 0.0f) {
                EXPECT_TRUE(waiting.contains(i)) << "nothing blocking is queued for point " << i;
            }
            decided += is_open(before[i]) && traced[i] == 0.0f;
        }
        EXPECT_EQ(counted.decided_by_trace, decided);
        tally.by_trace += decided;
        tally.queued += counted.uncertain;
        session.write(inputs.visibility.get(), after.data(), count * sizeof(float));
    }
}

void check_answers(const LightScene& scene, const std::vector<FrameOutput>& frames, Tally& tally) {
    std::vector<float> visibility(scene.points.size() / 3, 1.0f);
    if (!frames.empty()) visibility = frames.back().visibility;
    std::transform(visibility.begin(), visibility.end(), visibility.begin(), decided);
    const std::vector<float> truth = truth_of(scene);
    expect_equal(visibility, truth, scene, "trace");
    tally.lit += static_cast<std::uint64_t>(std::ranges::count(truth, 1.0f));
    for (const FrameOutput& out : frames) {
        tally.by_exact += out.counters.decided_by_exact;
        tally.by_integers += out.counters.exact_exact;
    }
}

std::vector<LightScene> all_scenes() {
    std::vector<LightScene> scenes = light_scenes();
    for (const auto& more :
         {reference_scenes(), huge_triangle_scenes(), underflow_scenes(), point_light_plane_scenes()})
        scenes.insert(scenes.end(), more.begin(), more.end());
    return scenes;
}

// Not vacuous: each level decides hundreds of points, and thousands stay lit.
TEST(Trace, EqualsReference) {
    const gnomon::Device device = device_with();
    Tally tally;
    for (const LightScene& scene : all_scenes()) {
        SCOPED_TRACE(scene.name);
        check_answers(scene, run_light_stages(device, scene), tally);
    }
    std::cout << tally.by_exact << " points by the exact stage, " << tally.by_integers << " pairs by integers, "
              << tally.lit << " points lit\n";
    EXPECT_GT(tally.by_exact, 500u);
    EXPECT_GT(tally.by_integers, 500u);
    EXPECT_GT(tally.lit, 5000u);
}

// Not vacuous: the filter alone decides thousands, and queues thousands of pairs.
TEST(Trace, FilterSaysOnlyWhatIsCertain) {
    const gnomon::Device device = device_with();
    Tally tally;
    const std::vector<LightScene> scenes = all_scenes();
    for (std::size_t i = 0; i < scenes.size(); i += 2) check_trace(device, scenes[i], tally);
    EXPECT_GT(tally.by_trace, 2000u);
    EXPECT_GT(tally.queued, 2000u);
}

// Each point is a corner of up to six triangles, of whose plane the filter is never certain.
TEST(Trace, AFanIsNotQueued) {
    const gnomon::Device device = device_with();
    const Floats triangles = rough_terrain(117, 0.3f).triangles();
    for (const auto& [name, light] : lights_of_every_kind()) {
        LightScene scene{"terrain, " + name, triangles, {}, light};
        for (std::size_t i = 0; i < triangles.size(); i += 63) add(scene.points, vertex(triangles, i / 3));
        Tally tally;
        check_trace(device, scene, tally);
        check_answers(scene, run_light_stages(device, scene), tally);
    }
}

LightScene comparison_scene(const Light& light) {
    LightScene scene = tie_scene("comparison", soup(300, 0.3f, 111), light, 3000, 2, 112);
    Random random(113);
    for (std::size_t i = 0; i < scene.points.size() / 3; ++i) scene.receivers.push_back(random.below(330));
    return scene;
}

std::vector<float> answer(const gnomon::Device& device, const LightScene& scene, const StageSettings& settings = {}) {
    std::vector<float> visibility = run_light_stages(device, scene, settings).back().visibility;
    std::transform(visibility.begin(), visibility.end(), visibility.begin(), decided);
    return visibility;
}

// Not vacuous: ties of an ulp decide thousands of points; about half of these points are in shadow.
TEST(Trace, OrderFree) {
    const gnomon::Device device = device_with();
    for (const Light& light : {along(0.3f, -1, 0.2f), at(0.05f, -0.1f, 0.2f)}) {
        const LightScene scene = comparison_scene(light);
        const std::vector<float> plain = answer(device, scene);
        const auto dark = std::count(plain.begin(), plain.end(), 0.0f);
        EXPECT_TRUE(dark > 500 && dark < 2700) << dark;
        LightScene reversed = scene;
        reversed.triangles = reversed_winding(scene.triangles);
        EXPECT_EQ(answer(device, reversed), plain);
        const auto order = shuffled_order(scene.triangles.size() / 9, 114);
        LightScene shuffled = scene;
        std::vector<std::uint32_t> place(order.size());
        for (std::uint32_t i = 0; i < order.size(); ++i) {
            place[order[i]] = i;
            std::copy_n(&scene.triangles[9 * order[i]], 9, &shuffled.triangles[9 * i]);
        }
        for (std::uint32_t& receiver : shuffled.receivers)
            if (receiver < place.size()) receiver = place[receiver];
        EXPECT_EQ(answer(device, shuffled), plain);
    }
}

TEST(Trace, ShapeFree) {
    for (const Light& light : {along(0.3f, -1, 0.2f), at(0.05f, -0.1f, 0.2f)}) {
        const LightScene scene = comparison_scene(light);
        const std::vector<float> plain = answer(device_with(), scene);
        for (const std::uint32_t group : FEW_WORK_GROUP_SIZES)
            EXPECT_EQ(answer(device_with(group), scene), plain) << "work-groups of " << group;
        // Another grid leaves other pairs undecided, and without double precision more of them reach the integers.
        for (const gnomon::FrameGrid grid : {gnomon::FrameGrid{1, 0}, {17, 1}, {256, 2}}) {
            StageSettings settings;
            settings.grid = grid;
            EXPECT_EQ(answer(device_with(), scene, settings), plain) << "grid of " << grid.size;
        }
        gnomon::DeviceOptions options;
        options.hide_fp64 = true;
        EXPECT_EQ(answer(gnomon::Device({}, options), scene), plain) << "without double precision";
    }
}

TEST(Trace, SurvivesDegenerates) {
    const gnomon::Device device = device_with();
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    Tally tally;
    for (const auto& [name, light] : lights_of_every_kind()) {
        SCOPED_TRACE(name);
        LightScene scene{name, soup(5, 2, 115), random_points(300, -1, 1, 116), light};
        add(scene.triangles, {nan, 0, 0}, {1, 0, 0}, {0, 0, 1});
        add(scene.triangles, {-3e38f, 1, -3e38f}, {3e38f, 1, -3e38f}, {0, 1, 3e38f});
        add(scene.triangles, {-1, 1, -1}, {-1, 1, -1}, {1, 1, 1});
        add(scene.triangles, {1e-45f, 0, 0}, {0, 1e-45f, 0}, {0, 0, 1e-45f});
        add(scene.triangles, {light[0], light[1], light[2]}, {1, 0, 0}, {0, 0, 1});
        add(scene.triangles, {-9, light[1], -9}, {9, light[1], -9}, {0, light[1], 9});
        append(scene.points, {nan, 0, 0, 0, inf, 0, 0, -1e38f, 0, light[0], light[1], light[2]});
        check_answers(scene, run_light_stages(device, scene), tally);
    }
    EXPECT_GT(tally.lit, 100u);
}

// Sixteen points at a time around positions in and below two roofs, which fill texels of the map: a block may be below
// a roof, above it, on both sides of it, or across its edge.
LightScene blocks_scene(const Light& light, bool has_doubtful_points) {
    LightScene scene;
    scene.name = "blocks under roofs";
    scene.light = light;
    Random random(115);
    add(scene.triangles, {-3, 0, -3}, {3, 0.5f, -3}, {-3, 0.2f, 3});
    add(scene.triangles, {4, 1, 4}, {-1, 1.2f, 4}, {4, 0.8f, -1});
    for (int block = 0; block < 1500; ++block) {
        const float spread = block % 3 == 0 ? 0.3f : 0.02f;
        const float x = random.between(-4, 4), y = random.between(-1, 1.5f), z = random.between(-4, 4);
        for (int i = 0; i < 16; ++i) {
            append(scene.points, {x + random.between(-spread, spread), y + random.between(-spread, spread),
                                  z + random.between(-spread, spread)});
            if (has_doubtful_points) scene.receivers.push_back(random.below(3));
        }
    }
    return scene;
}

// Blocks and single points give the same bits and counts. Not vacuous: the map hides hundreds of whole blocks, and the
// point light's points are in several faces.
TEST(Trace, DecidesBlocksBelowTheMap) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    for (const Light& light : {along(0.3f, -1, 0.2f), along(-0.2f, 0.1f, 1), at(0.5f, 6, 0.2f), at(0.1f, 0.9f, 0)})
        for (const bool has_doubtful_points : {false, true}) {
            const LightScene scene = blocks_scene(light, has_doubtful_points);
            const UploadedScene inputs(device, scene);
            std::uint64_t by_map = 0;
            for (const gnomon::LightFrame& frame : light_frames(inputs.light, StageSettings{}.grid)) {
                LightStages stages;
                FrameOutput out{};
                out.frame = frame;
                while (!run_stages_once(session, stages, inputs, {.with_map = true}, out)) {
                }
                if (out.projection.active_points == 0) continue;
                by_map += out.counters.decided_by_map;
                EXPECT_EQ(out.counters.decided_by_map, out.izb_counters.decided_by_map);
            }
            EXPECT_GT(by_map, 500u);
        }
}

// A queue with room for one pair: a pair without room is decided in place, and later runs have more room. Not vacuous:
// the scene leaves hundreds of pairs undecided.
TEST(Trace, BoundsItsQueue) {
    const gnomon::Device device = device_with();
    const LightScene scene = comparison_scene(along(0, -1, 0));
    const UploadedScene inputs(device, scene);
    LightStages stages;
    stages.trace.limit_initial_capacity(1);
    FrameOutput out{};
    out.frame = light_frames(inputs.light, StageSettings{}.grid)[0];
    while (!run_stages_once(session_of(device), stages, inputs, {}, out)) {
    }
    EXPECT_GT(stages.trace.capacity(), 100u);
    EXPECT_LE(stages.trace.capacity(), gnomon::Trace::initial_capacity);
    EXPECT_GT(out.counters.uncertain, 100u);
    EXPECT_EQ(out.visibility, answer(device, scene));
}

// Not vacuous: the buffers have room behind the outputs of the stages, and both stages write.
TEST(Trace, WritesOnlyItsOwn) {
    const gnomon::Device device = device_with();
    gnomon::cl::Session& session = session_of(device);
    const LightScene scene = comparison_scene(along(0.3f, -1, 0.2f));
    const UploadedScene inputs(device, scene);
    const std::size_t count = scene.points.size() / 3;
    LightStages stages;
    FrameOutput out{};
    out.frame = light_frames(inputs.light, StageSettings{}.grid)[0];
    while (!run_stages_once(session, stages, inputs, {}, out)) {
    }
    gnomon::cl::Buffer visibility(session, (count + 8) * sizeof(float));
    put_canaries(session, visibility);
    session.write(visibility.get(), out.visibility_before.data(), count * sizeof(float));
    put_canaries(session, stages.trace.queue());
    gnomon::FrameCounters counted = out.counters;
    counted.uncertain = 0;
    session.write(inputs.counters.get(), &counted, sizeof(counted));
    const gnomon::FramedInputs framed{inputs.triangle_inputs(), inputs.point_inputs(), out.frame, visibility.get()};
    const gnomon::TraceInputs trace_inputs =
        gnomon::trace_inputs(framed, 0, stages.projection, nullptr,
                             gnomon::list_buffers(stages.lists.bins(), stages.lists.setup()), inputs.counters);
    stages.trace.run(session, gnomon::Task::trace, trace_inputs, nullptr);
    stages.trace.decide_queue(session, trace_inputs);
    session.read(inputs.counters.get(), &counted, sizeof(counted));
    ASSERT_GT(counted.uncertain, 0u);
    expect_canaries(session, visibility, count * sizeof(float), "visibility");
    expect_canaries(session, stages.trace.queue(), counted.uncertain * 2 * sizeof(std::uint32_t), "queue");
}

}  // namespace
