// SPDX-License-Identifier: MIT
// Prepared lights: the same bits as without, for all points; a point is lit without a list only if the exact oracle
// finds no triangle; a prepared light serves the runs that can use it, other runs do not change it, forget() frees it,
// and a failure does no harm. (frustum_traced_test compares whole scenes with the oracle, prepared and not.)
#include <gtest/gtest.h>

#include <limits>

#include "prepared/prepared_light.hpp"
#include "support/expect_exact.hpp"
#include "support/light_scenes.hpp"

namespace {

using namespace support;
using gnomon::Device;
using gnomon::Light;

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

std::vector<LightScene> all_scenes() {
    std::vector<LightScene> scenes = light_scenes();
    for (const auto& more :
         {point_light_plane_scenes(), huge_triangle_scenes(), underflow_scenes(), reference_scenes()})
        scenes.insert(scenes.end(), more.begin(), more.end());
    return scenes;
}

// ---- Points by their position ---------------------------------------------------------------------------------------

enum Verdict { absent = 0, lit = 1, open = 2, fallback_point = 3 };

constexpr const char* classify_source = R"(
#include "prepared/prepared_light.h"
__kernel void classify(LightFrame light_frame, PointsLayout layout, PreparedTables tables,
                       __global const uint2* ranges, __global const float* positions, __global float* verdicts) {
    __global const PreparedDomain* domains = prepared_domains_of(tables, ranges);
    GN_FOR_EACH(block, block_count(layout)) {
        PointBlock points = load_block(positions, layout, block);
        LaneInt lanes = valid_lanes(layout, block) & present_lanes(points), fallback_points;
        lanes &= LANE_COMPARE(frames_of(light_frame, points), !=, (LaneInt)((int)POINT_LIGHT_FRAMES));
        LaneInt open = prepared_lanes(light_frame, domains, points, lanes, &fallback_points);
        LaneFloat verdict = LANES_SELECT((LaneFloat)(0.0f), (LaneFloat)(1.0f), lanes);
        verdict = LANES_SELECT(verdict, (LaneFloat)(2.0f), open);
        store_lanes(LANES_SELECT(verdict, (LaneFloat)(3.0f), fallback_points), verdicts, layout, block);
    }
}
)";

/// The scene's own points, and others: around it at all distances, towards the light and away from it, and about an ulp
/// beside its triangles.
Floats points_everywhere(const LightScene& scene, std::uint64_t seed) {
    Random random(seed);
    Floats points = scene.points;
    const std::size_t vertices = scene.triangles.size() / 3;
    for (int i = 0; i < 400; ++i) {
        Float3 p = vertex(scene.triangles, random.below(static_cast<std::uint32_t>(vertices)));
        const Float3 q = vertex(scene.triangles, random.below(static_cast<std::uint32_t>(vertices)));
        const int kind = static_cast<int>(random.below(4));
        const float far = std::ldexp(1.0f, static_cast<int>(random.below(24)) - 12);
        for (int c = 0; c < 3; ++c) {
            const float to_light = scene.light[c] - scene.light[3] * p[c];
            if (kind == 0) p[c] += to_light * far * (random.below(2) == 0 ? 1.0f : -1.0f);
            if (kind == 1) p[c] += (q[c] - p[c]) * far;
            if (kind == 2) p[c] *= 1 + far;
        }
        add(points, kind == 3 ? nudged(random, p) : p);
    }
    return points;
}

TEST(PreparedDomain, PointsThatItCallsLitAreLit) {
    const Device device;
    gnomon::cl::Session& session = session_of(device);
    session.add_source("classify.cl", classify_source);
    std::size_t counts[4] = {};
    std::uint64_t seed = 1;
    for (const LightScene& scene : all_scenes()) {
        if (seed++ % 2 == 0) continue;  // saves the oracle's time
        const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
        const Floats positions = points_everywhere(scene, seed);
        const gnomon::Points points = gnomon::Points::upload(device, positions);
        gnomon::Statistics statistics;
        const gnomon::PreparedLight prepared(session, statistics, triangles, Light{scene.light}, {16, 0}, {}, 0);
        if (!prepared.is_usable()) continue;
        const gnomon::PointInputs inputs = gnomon::point_inputs(points);
        const gnomon::cl::Buffer verdicts(session, points.count() * sizeof(float));
        session.launch("classify.cl", "classify", gnomon::cl::Range::items(points.count()), prepared.light_frame(),
                       inputs.layout, prepared.lists().tables, prepared.lists().ranges, inputs.positions, verdicts);
        const auto found = downloaded<float>(session, verdicts.get(), points.count());
        Floats asked;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const int verdict = static_cast<int>(found[i]);
            ++counts[verdict];
            if (verdict == lit) add(asked, vertex(positions, i));
        }
        const auto shadowed = reference::shadowed(scene.triangles, asked, {}, scene.light, {});
        for (std::size_t i = 0; i < shadowed.size(); ++i)
            ASSERT_EQ(shadowed[i], 0) << scene.name << ": a point called lit is in shadow: (" << asked[3 * i] << ", "
                                      << asked[3 * i + 1] << ", " << asked[3 * i + 2] << ")";
    }
    EXPECT_GT(counts[lit], 5000u);
    EXPECT_GT(counts[open], 5000u);
    EXPECT_GT(counts[fallback_point], 500u);
}

// ---- Planes of receivers --------------------------------------------------------------------------------------------

constexpr const char* compare_planes_source = R"(
#include "prepared/prepared_facing.clh"
__kernel void compare_planes(float4 light, uint triangle_count, PreparedTables tables, __global const float* vertices,
                             __global const uint2* ranges, __global const float* eyes, __global float* verdicts) {
    __global const float4* planes = prepared_table(ranges, tables.planes);
    __global const float* largest = (__global const float*)prepared_table(ranges, tables.largest);
    GN_FOR_EACH(i, triangle_count) {
        float3 eye = (float3)(eyes[3 * i], eyes[3 * i + 1], eyes[3 * i + 2]);
        float4 p = planes[i];
        float above = (p.x * eye.x + p.y * eye.y) + (p.z * eye.z + p.w);
        bool certain = fabs(above) > plane_bound(*largest, eye);
        int level = DET3_BY_FLOAT;
        bool away = is_backfacing(load_triangle(vertices, i), light, eye, &level);
        verdicts[i] = !certain ? 0.0f : (above < 0.0f) == away ? 1.0f : 2.0f;
    }
}
)";

/// A position on the plane of triangle `i`, up to rounding; or near the plane; or anywhere.
Float3 eye_about(Random& random, const Floats& triangles, std::size_t i) {
    const Float3 a = vertex(triangles, 3 * i), b = vertex(triangles, 3 * i + 1), c = vertex(triangles, 3 * i + 2);
    const double s = random.between(-3, 3), t = random.between(-3, 3);
    Float3 eye;
    for (int k = 0; k < 3; ++k) eye[k] = float(a[k] + s * (double(b[k]) - a[k]) + t * (double(c[k]) - a[k]));
    const std::uint32_t kind = random.below(4);
    if (kind == 1) eye = nudged(random, eye);
    if (kind == 2) eye[random.below(3)] *= 1 + std::ldexp(1.0f, -static_cast<int>(random.below(24)));
    if (kind == 3) eye = vertex(triangles, random.below(static_cast<std::uint32_t>(triangles.size() / 3)));
    for (float& e : eye)
        if (!std::isfinite(e)) e = 1;
    return eye;
}

TEST(PreparedPlanes, WhatTheyCallCertainIsRight) {
    const Device device;
    gnomon::cl::Session& session = session_of(device);
    session.add_source("compare_planes.cl", compare_planes_source);
    Random random(11);
    std::vector<LightScene> scenes = all_scenes();
    for (const float scale : {1e-30f, 1e-12f, 1e-4f, 1e5f, 1e9f, 1e20f}) {
        Floats soup_of_size = soup(200, 0.4f, 3);
        for (float& x : soup_of_size) x *= scale;
        for (const auto& light : {std::array{0.3f, -1.0f, 0.2f, 0.0f}, std::array{scale, 2 * scale, 0.0f, 1.0f}})
            scenes.push_back({"scaled soup", soup_of_size, {}, light});
    }
    std::size_t counts[3] = {};
    for (const LightScene& scene : scenes) {
        const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
        const auto count = static_cast<cl_uint>(triangles.count());
        gnomon::Statistics statistics;
        const gnomon::PreparedLight prepared(session, statistics, triangles, Light{scene.light}, {16, 0}, {}, 0);
        if (!prepared.is_usable()) continue;
        Floats eyes;
        for (std::size_t i = 0; i < count; ++i) add(eyes, eye_about(random, scene.triangles, i));
        const gnomon::cl::Buffer eye_buffer(session, eyes.size() * sizeof(float)),
            verdicts(session, count * sizeof(float));
        session.write(eye_buffer.get(), eyes.data(), eyes.size() * sizeof(float));
        session.launch("compare_planes.cl", "compare_planes", gnomon::cl::Range::items(count),
                       gnomon::float4_of(scene.light), count, prepared.lists().tables, triangles.buffer(),
                       prepared.lists().ranges, eye_buffer, verdicts);
        const auto found = downloaded<float>(session, verdicts.get(), count);
        for (std::size_t i = 0; i < count; ++i) {
            ++counts[static_cast<int>(found[i])];
            ASSERT_NE(found[i], 2.0f) << scene.name << ": triangle " << i << " seen from (" << eyes[3 * i] << ", "
                                      << eyes[3 * i + 1] << ", " << eyes[3 * i + 2] << ")";
        }
    }
    EXPECT_GT(counts[0], 500u);
    EXPECT_GT(counts[1], 4000u);
}

// ---- Lists ----------------------------------------------------------------------------------------------------------

constexpr const char* disorder_source = R"(
#include "occluders/bin_lists.h"
// Counts the entries, and those that are above the entry before, differ from their triangle's bounds, lie behind an
// unused one, or, by_id, are not at their triangle's own slot.
__kernel void count_disorder(uint bins, uint by_id, __global const uint2* ranges, __global BinEntries* entries,
                             __global const TriangleBounds* bounds, volatile __global uint* counts) {
#if GN_LANES > 1
    GN_FOR_EACH(bin, bins) {
        uint2 range = ranges[bin];
        ushort last = 65535;
        bool ended = false;
        for (uint i = 0; i < (range.y - range.x) * GN_LANES; ++i) {
            __global BinEntries* at = &entries[range.x + i / GN_LANES];
            uint lane = i % GN_LANES, slot = ENTRY_SLOT(at, lane);
            if (ENTRY_LANE(at, x0, lane) > ENTRY_LANE(at, x1, lane)) { ended = true; continue; }
            if (i % (KEPT_RUN * GN_LANES) == 0) last = 65535;
            TriangleBounds of = bounds[slot];
            bool same = ENTRY_LANE(at, x0, lane) == of.x0 && ENTRY_LANE(at, y0, lane) == of.y0 &&
                        ENTRY_LANE(at, x1, lane) == of.x1 && ENTRY_LANE(at, y1, lane) == of.y1 &&
                        ENTRY_LANE(at, z, lane) == of.z;
            atomic_inc(&counts[0]);
            if (ENTRY_LANE(at, z, lane) > last || ended) atomic_inc(&counts[1]);
            if (!same) atomic_inc(&counts[2]);
            if (by_id && of.id != slot) atomic_inc(&counts[3]);
            if (i >= KEPT_RUN * GN_LANES) atomic_inc(&counts[4]);
            last = ENTRY_LANE(at, z, lane);
        }
    }
#endif
}
)";

// On a CPU: a walk stops in a run at an entry that is too low, and takes a record's slot for its triangle's id.
TEST(PreparedLists, AreInOrderAndByTriangle) {
    const Device device;
    gnomon::cl::Session& session = session_of(device);
    if (!session.is_cpu()) GTEST_SKIP() << "a GPU's lists have another order (bins_test)";
    session.add_source("count_disorder.cl", disorder_source);
    const auto triangles = gnomon::Triangles::upload(device, soup(40'000, 0.3f, 21));
    for (const Light& light : {Light::directional({0.2f, -1, 0.1f}), Light::point({0.1f, 5, 0.2f})}) {
        gnomon::Statistics statistics;
        const gnomon::PreparedLight prepared(session, statistics, triangles, light, {16, 2}, {}, 0);
        ASSERT_TRUE(prepared.is_usable());
        const cl_uint bins = frame_count_of(prepared.light_frame()) * 16;
        const gnomon::cl::Buffer counts(session, 5 * sizeof(cl_uint));
        session.fill(counts, 0, 5 * sizeof(cl_uint));
        session.launch("count_disorder.cl", "count_disorder", gnomon::cl::Range::items(bins), bins,
                       cl_uint(light.is_directional()), prepared.lists().ranges, prepared.lists().entries,
                       prepared.lists().bounds, counts);
        const auto found = downloaded<cl_uint>(session, counts.get(), 5);
        if (light.is_directional()) {
            EXPECT_EQ(found[0], prepared.counted().references);
            EXPECT_GT(found[4], 1000u) << "entries in a list's second run or later";
        }
        EXPECT_GT(found[0], 1000u);
        EXPECT_EQ(found[1], 0u) << "out of order";
        EXPECT_EQ(found[2], 0u) << "unlike their bounds";
        EXPECT_EQ(found[3], 0u) << "at another slot";
    }
}

// ---- The same bits --------------------------------------------------------------------------------------------------

/// The scene with other points; points beyond the number of its own have no receiver.
LightScene with_points(LightScene scene, const Floats& points) {
    scene.points = points;
    if (!scene.receivers.empty()) scene.receivers.resize(points.size() / 3, gnomon::no_receiver);
    return scene;
}

TEST(Prepared, SameBitsAsUnpreparedOverAllScenesAndPointsEverywhere) {
    const Device device;
    const char* sizes[] = {"16", "100", "512"};
    std::uint64_t used = 0, fallen_back = 0, dark = 0, by_map = 0, seed = 1;
    for (const LightScene& scene : all_scenes()) {
        const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
        const auto plain = gnomon::make_technique("frustum-traced", device),
                   prepared = gnomon::make_technique("frustum-traced", device);
        prepared->set("map-size", sizes[seed % 3]);
        if (seed % 4 == 0) prepared->set("conservative-map", "off");
        if (seed % 5 == 0) prepared->set("first-capacity", "3");
        prepared->prepare(triangles, Light{scene.light});
        const Floats everywhere = points_everywhere(scene, ++seed);
        for (const Floats* positions : {&scene.points, &everywhere}) {
            const gnomon::Points points = upload_points(device, with_points(scene, *positions));
            const auto facing = facing_of(scene.eye);
            const Answer wanted = answer(device, *plain, triangles, points, Light{scene.light}, facing);
            const Answer got = answer(device, *prepared, triangles, points, Light{scene.light}, facing);
            ASSERT_EQ(got.visibility, wanted.visibility) << scene.name;
            const bool was_used = got.count("prepared") != 0;
            ASSERT_EQ(wanted.count("prepared"), 0u);
            used += was_used;
            fallen_back += got.count("prepared_fallback_points") != 0;
            if (!was_used) continue;
            by_map += got.count("points_decided_by_map");
            dark += static_cast<std::uint64_t>(std::ranges::count(got.visibility, 0.0f));
        }
    }
    EXPECT_GT(used, 150u);
    EXPECT_GT(fallen_back, 50u);
    EXPECT_GT(dark, 10'000u);
    EXPECT_GT(by_map, 100u);
}

/// Two lights over the same soup.
struct Still {
    Device device = device_with();
    Floats vertices = soup(300, 0.4f, 5);
    gnomon::Triangles triangles = gnomon::Triangles::upload(device, vertices);
    gnomon::Points points = gnomon::Points::upload(device, random_points(2000, -1, 1, 6));
    Light sun = Light::directional({0.2f, -1, 0.1f}), point_light = Light::point({0.1f, 3, 0.2f});
    std::unique_ptr<gnomon::Technique> technique = gnomon::make_technique("frustum-traced", device);

    Answer run(const gnomon::Triangles& of, const Light& light) {
        return answer(device, *technique, of, points, light);
    }
};

TEST(Prepared, IsUsedForItsOwnTrianglesAndLightAlone) {
    Still still;
    const auto others = gnomon::Triangles::upload(still.device, soup(300, 0.4f, 7));
    const auto fewer = gnomon::Triangles::wrap(still.device, still.triangles.buffer(), 299);
    const auto later = gnomon::Triangles::wrap(still.device, still.triangles.buffer(), 200, 900);
    const auto same = gnomon::Triangles::wrap(still.device, still.triangles.buffer(), 300);
    const auto bits = [&](const gnomon::Triangles& triangles, const Light& light) {
        return answer(still.device, *gnomon::make_technique("frustum-traced", still.device), triangles, still.points,
                      light)
            .visibility;
    };
    const auto expect = [&](const gnomon::Triangles& triangles, const Light& light, bool is_used) {
        const Answer asked = still.run(triangles, light);
        EXPECT_EQ(asked.count("prepared"), is_used);
        EXPECT_EQ(asked.visibility, bits(triangles, light));
        for (const gnomon::StageStatistics& stage : asked.statistics.stages)
            EXPECT_EQ(
                stage.skipped == "prepared",
                is_used && (stage.name == "triangle_setup" || stage.name == "bins" || stage.name == "light_frame" ||
                            stage.name == "receiver_depth_pyramid" || stage.name == "conservative_map"))
                << stage.name;
    };
    EXPECT_NE(bits(still.triangles, still.sun), bits(later, still.sun));
    for (const Light& light : {still.sun, still.point_light}) {
        const Light& other_light = light.is_directional() ? still.point_light : still.sun;
        const gnomon::Statistics statistics = still.technique->prepare(still.triangles, light);
        EXPECT_EQ(statistics.count("prepared"), 1u);
        EXPECT_GT(statistics.count("references"), 100u);
        EXPECT_GT(statistics.total_wall_ms, 0.0);
        for (int round = 0; round < 2; ++round) {
            expect(still.triangles, light, true);
            expect(same, light, true);
            expect(others, light, false);
            expect(fewer, light, false);
            expect(later, light, false);
            expect(still.triangles, other_light, false);
        }
        still.technique->release_prepared_light();
        expect(still.triangles, light, false);
    }
    still.technique->prepare(still.triangles, still.sun);
    still.technique->set("map-size", "64");
    expect(still.triangles, still.sun, false);
    still.technique->prepare(still.triangles, still.sun);
    still.technique->prepare(still.triangles, still.point_light);
    expect(still.triangles, still.sun, false);
    expect(still.triangles, still.point_light, true);
}

TEST(Prepared, ServesEveryCameraOfOneLight) {
    Still still;
    std::uint64_t dark = 0;
    for (const Light& light : {still.sun, still.point_light}) {
        still.technique->prepare(still.triangles, light);
        const auto plain = gnomon::make_technique("frustum-traced", still.device);
        for (const gnomon::Float3& eye : {gnomon::Float3{0, 1, 4}, gnomon::Float3{3, 0, 0.5f},
                                          gnomon::Float3{0.1f, 0.2f, 0.1f}, gnomon::Float3{-20, 30, -20}}) {
            const auto camera = gnomon::Camera::look_at(eye, {0, 0, 0}, {0, 1, 0}, 40);
            const gnomon::View view = gnomon::look(still.device, still.triangles, camera, 120, 80);
            const Answer asked = answer(still.device, *still.technique, still.triangles, view.points, light);
            EXPECT_EQ(asked.count("prepared"), 1u);
            EXPECT_EQ(asked.visibility, answer(still.device, *plain, still.triangles, view.points, light).visibility);
            dark += asked.count("points_in_shadow");
        }
    }
    EXPECT_GT(dark, 5000u);
}

// Facing tests views' points by the planes of their receivers. Eyes and lights in those planes leave the points
// undecided: then the predicate decides, in a second run by the kernels made for GPUs.
void check_eyes_and_lights_in_planes(const Device& device) {
    Floats blocks = lattice_blocks(9, 3, 1);
    add(blocks, {-9, -1, -9}, {-9, -1, 27}, {27, -1, -9});
    const auto triangles = gnomon::Triangles::upload(device, blocks);
    const auto plain = gnomon::make_technique("frustum-traced", device),
               prepared = gnomon::make_technique("frustum-traced", device);
    std::uint64_t dark = 0, away = 0, by_map = 0;
    for (const Light& light : {Light::directional({0, -1, 0}), Light::directional({-1, 0, -1}), Light::point({3, 7, 1}),
                               Light::directional({-1, -3, -2}), Light::point({-20, 1, 3})}) {
        prepared->prepare(triangles, light);
        for (const gnomon::Float3& eye : {gnomon::Float3{9, 3, 7}, gnomon::Float3{3, 12, 1}, gnomon::Float3{-8, 2, 2},
                                          gnomon::Float3{7.5f, 6.25f, 11}}) {
            const auto camera = gnomon::Camera::look_at(eye, {1.5f, 1.25f, 1.5f}, {0, 1, 0.01f}, 40);
            gnomon::View view = gnomon::look(device, triangles, camera, 96, 64);
            ASSERT_TRUE(view.points.is_lifted_off(triangles, eye));
            const Answer asked = answer(device, *prepared, triangles, view.points, light);
            EXPECT_EQ(asked.count("prepared"), 1u);
            const gnomon::ViewOnHost host = view.read(device, triangles);
            const LightScene seen{"blocks",   blocks,        view.points.read(device).position,
                                  light.xyzw, host.receiver, camera.eye};
            ASSERT_EQ(expect_equal(asked.visibility, truth_of(seen), seen, "prepared"), 0u);
            EXPECT_EQ(asked.visibility, answer(device, *plain, triangles, view.points, light).visibility);
            dark += asked.count("points_in_shadow");
            away += asked.count("points_facing_away");
            by_map += asked.count("points_decided_by_map");
            view.points.set_camera(camera, view.width, view.height);
            ASSERT_FALSE(view.points.is_lifted_off(triangles, eye));
            EXPECT_EQ(asked.visibility, answer(device, *prepared, triangles, view.points, light).visibility);
        }
    }
    EXPECT_GT(dark, 10'000u);
    EXPECT_GT(away, 5000u);
    EXPECT_GT(by_map, 100u);
}

TEST(Prepared, EyesAndLightsInThePlanesOfReceivers) { check_eyes_and_lights_in_planes(Device()); }
TEST(Prepared, EyesAndLightsInThePlanesOfReceiversWithTheKernelsMadeForGpus) {
    check_eyes_and_lights_in_planes(Device({}, {.gpu_kernels = true}));
}

/// All x, all y, all z.
gnomon::Points points_in_rows(const Device& device, const Floats& positions, std::span<const std::uint32_t> receivers) {
    const std::size_t count = positions.size() / 3;
    Floats rows(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) rows[i % 3 * count + i / 3] = positions[i];
    const gnomon::Points uploaded = gnomon::Points::upload(device, rows, receivers);
    return gnomon::Points::wrap(device, uploaded.positions(), {0, 1, count}, count, uploaded.receivers());
}

// Points that the caller promises to be lifted off: on a CPU facing precedes the trace, and finds them in all blocks:
// within the prepared bounds, beside them and across their sides. Runs with fallback points ignore the prepared light.
TEST(Prepared, LiftedPointsAnywhere) {
    const Device device;
    Floats vertices = soup(60, 0.5f, 21);
    add(vertices, {-2, -1, -2}, {2, -1, -2}, {0, -1, 3});
    const auto triangles = gnomon::Triangles::upload(device, vertices);
    const auto plain = gnomon::make_technique("frustum-traced", device),
               prepared = gnomon::make_technique("frustum-traced", device);
    Random random(22);
    std::uint64_t used = 0, fallen_back = 0, dark = 0, lit = 0;
    for (const Light& light : {Light::directional({0.2f, -1, 0.1f}), Light::directional({1, -0.3f, 0.4f}),
                               Light::directional({1, -0.01f, 0.1f}), Light::point({0.1f, 3, 0.2f})}) {
        prepared->prepare(triangles, light);
        for (const float reach : {0.9f, 1.5f, 10.0f}) {
            Floats positions;
            for (int block = 0; block < 60; ++block) {
                const float across = block % 3 == 0 ? 0.9f : reach, spread = block % 2 == 0 ? 0.01f : 0.2f;
                const float x = random.between(-reach, reach), y = random.between(-0.99f, across),
                            z = random.between(-across, across);
                for (int i = 0; i < 16; ++i)
                    append(positions, {x + random.between(0, spread), y + random.between(0, spread),
                                       z + random.between(0, spread)});
            }
            const std::vector<std::uint32_t> receivers(positions.size() / 3, 60);
            // A CPU has a separate trace for coordinates in rows, the camera's layout.
            const bool in_rows = reach != 1.5f;
            gnomon::Points points = in_rows ? points_in_rows(device, positions, receivers)
                                            : gnomon::Points::upload(device, positions, receivers);
            const Float3 eye{0.5f, 9, 0.5f};
            const auto facing = gnomon::Facing::eye(eye);
            points.set_lifted_off(triangles, eye);
            const Answer asked = answer(device, *prepared, triangles, points, light, facing);
            EXPECT_EQ(asked.visibility, answer(device, *plain, triangles, points, light, facing).visibility);
            const LightScene lifted{"lifted", vertices, positions, light.xyzw, receivers, eye};
            ASSERT_EQ(expect_equal(asked.visibility, truth_of(lifted), lifted, "prepared"), 0u);
            used += asked.count("prepared");
            fallen_back += asked.count("prepared_fallback_points") != 0;
            dark += asked.count("points_in_shadow");
            lit += positions.size() / 3 - asked.count("points_in_shadow");
        }
    }
    EXPECT_GT(used, 6u);
    EXPECT_GT(fallen_back, 0u);
    EXPECT_GT(dark, 500u);
    EXPECT_GT(lit, 500u);
}

// More than 8 per bin of the default grid: a CPU's bins get finer.
TEST(Prepared, BinsOfManyTriangles) {
    const Device device;
    const auto triangles = gnomon::Triangles::upload(device, soup(530'000, 0.004f, 8));
    const gnomon::Points points = gnomon::Points::upload(device, random_points(20'000, -1, 1, 9));
    const auto technique = gnomon::make_technique("frustum-traced", device);
    for (const Light& light : {Light::directional({0.2f, -1, 0.1f}), Light::point({0.1f, 0.3f, 0.2f})}) {
        const Answer wanted = answer(device, *technique, triangles, points, light);
        technique->prepare(triangles, light);
        const Answer asked = answer(device, *technique, triangles, points, light);
        EXPECT_EQ(asked.count("prepared"), 1u);
        EXPECT_EQ(asked.visibility, wanted.visibility);
        EXPECT_GT(asked.count("points_in_shadow"), 1000u);
        EXPECT_LT(asked.count("points_in_shadow"), 19'000u);
    }
}

TEST(Prepared, NothingToPrepareIsNoTrouble) {
    Still still;
    const auto none = gnomon::Triangles::upload(still.device, {}),
               bad = gnomon::Triangles::upload(still.device, Floats(90, not_a_number));
    for (const Light& light : {still.sun, still.point_light})
        for (const gnomon::Triangles& triangles : {none, bad}) {
            still.technique->prepare(triangles, light);
            EXPECT_EQ(still.run(triangles, light).visibility, std::vector<float>(still.points.count(), 1.0f));
        }
    still.technique->prepare(still.triangles, still.sun);
    const gnomon::Points no_points = gnomon::Points::upload(still.device, {}),
                         no_place = gnomon::Points::upload(still.device, Floats(300, not_a_number));
    EXPECT_TRUE(answer(still.device, *still.technique, still.triangles, no_points, still.sun).visibility.empty());
    const Answer absent_points = answer(still.device, *still.technique, still.triangles, no_place, still.sun);
    EXPECT_EQ(absent_points.visibility, std::vector<float>(100, 1.0f));
    EXPECT_EQ(absent_points.count("points_absent"), 100u);
    EXPECT_THROW(still.technique->prepare(still.triangles, Light{}), gnomon::InvalidArgument);
}

TEST(Prepared, AnyTechniqueTakesIt) {
    Still still;
    const auto other = gnomon::make_technique("shadow-map", still.device);
    const std::vector<float> before = answer(still.device, *other, still.triangles, still.points, still.sun).visibility;
    other->prepare(still.triangles, still.sun);
    EXPECT_EQ(answer(still.device, *other, still.triangles, still.points, still.sun).visibility, before);
    other->release_prepared_light();
}

// ---- Memory and faults ----------------------------------------------------------------------------------------------

TEST(PreparedMemory, IsCountedAndFreed) {
    Still still;
    for (const Light& light : {still.sun, still.point_light}) {
        still.run(still.triangles, light);
        const std::uint64_t before = still.device.memory_bytes();
        const std::uint64_t run_bytes = still.run(still.triangles, light).statistics.device_memory_bytes;
        const std::uint64_t kept = still.technique->prepare(still.triangles, light).count("prepared_bytes");
        EXPECT_GT(kept, 10'000u);
        EXPECT_EQ(still.device.memory_bytes(), before + kept);
        EXPECT_EQ(still.run(still.triangles, light).statistics.device_memory_bytes, run_bytes + kept);
        still.technique->release_prepared_light();
        EXPECT_EQ(still.device.memory_bytes(), before);
        EXPECT_EQ(still.run(still.triangles, light).statistics.device_memory_bytes, run_bytes);
    }
}

TEST(PreparedMemory, ALimitThatItDoesNotFitUnderLeavesRunsAlone) {
    const Still still;
    const Device device({}, {.memory_limit_bytes = 8u << 20});
    const auto triangles = gnomon::Triangles::upload(device, still.vertices);
    const gnomon::Points points = gnomon::Points::upload(device, random_points(2000, -1, 1, 6));
    const auto technique = gnomon::make_technique("frustum-traced", device);
    technique->set("first-capacity", "1000");
    const Answer wanted = answer(device, *technique, triangles, points, still.point_light);
    technique->set("map-size", "1024");
    try {
        technique->prepare(triangles, still.point_light);
        ADD_FAILURE() << "six maps of 1024 x 1024 texels do not fit under 8 MiB";
    } catch (const gnomon::OutOfDeviceMemory& error) {
        EXPECT_NE(std::string(error.what()).find("limit"), std::string::npos) << error.what();
    }
    technique->set("map-size", "auto");
    const Answer after = answer(device, *technique, triangles, points, still.point_light);
    EXPECT_EQ(after.visibility, wanted.visibility);
    EXPECT_EQ(after.count("prepared"), 0u);
}

/// A light that is prepared and used, again and again.
struct PreparedAnew {
    Still still;
    const Light light;
    const std::vector<float> wanted;
    gnomon::cl::Session& session;

    PreparedAnew(bool has_point_light, const char* first_capacity)
        : light(has_point_light ? still.point_light : still.sun),
          wanted((still.technique->set("map-size", "64"), still.technique->set("first-capacity", first_capacity),
                  still.run(still.triangles, light).visibility)),
          session(session_of(still.device)) {}

    Answer prepare_and_run() {
        still.technique->prepare(still.triangles, light);
        return still.run(still.triangles, light);
    }
    void expect_sound(std::size_t failed) {
        ASSERT_EQ(still.run(still.triangles, light).visibility, wanted) << "after a failure of call " << failed;
        const Answer again = prepare_and_run();
        ASSERT_EQ(again.visibility, wanted) << "after a failure of call " << failed;
        ASSERT_EQ(again.count("prepared"), 1u);
    }
};

TEST(PreparedFaults, EveryCallFailsOnceAndNothingIsLost) {
    for (const bool has_point_light : {false, true}) {
        // Lists that never grow, so that the calls are the same each time.
        PreparedAnew anew(has_point_light, "262144");
        EXPECT_EQ(anew.prepare_and_run().count("prepared"), 1u);
        std::size_t calls = 0;
        anew.session.inject_faults([&](std::string_view) { return ++calls, CL_SUCCESS; });
        ASSERT_EQ(anew.prepare_and_run().visibility, anew.wanted);
        ASSERT_GT(calls, 30u);
        const std::uint64_t kept = anew.still.device.memory_bytes();
        for (std::size_t failing = 1; failing <= calls; ++failing) {
            std::size_t call = 0;
            anew.session.inject_faults(
                [&](std::string_view) { return ++call == failing ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_SUCCESS; });
            EXPECT_THROW(anew.prepare_and_run(), gnomon::OutOfDeviceMemory) << "call " << failing;
            anew.session.inject_faults(nullptr);
            anew.expect_sound(failing);
            ASSERT_EQ(anew.still.device.memory_bytes(), kept) << "after a failure of call " << failing;
        }
    }
}

// How often tight lists grow depends on the order of the work-items: calls fail until a frame does not grow lists.
TEST(PreparedFaults, CallsThatFailWhileListsGrowLoseNothing) {
    for (const bool has_point_light : {false, true}) {
        PreparedAnew anew(has_point_light, "16");
        std::size_t failures = 0;
        bool has_failed = true;
        for (std::size_t failing = 1; has_failed; failing += 5) {
            std::size_t call = 0;
            anew.session.inject_faults(
                [&](std::string_view) { return ++call == failing ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_SUCCESS; });
            try {
                anew.prepare_and_run();
                has_failed = false;
            } catch (const gnomon::OutOfDeviceMemory&) {
                ++failures;
            }
            anew.session.inject_faults(nullptr);
            anew.expect_sound(failing);
        }
        EXPECT_GT(failures, 10u);
    }
}

class WorkGroups : public testing::TestWithParam<std::uint32_t> {};

TEST_P(WorkGroups, OfAnySizeGiveTheSameBits) {
    const Device device = device_with(GetParam());
    Still still;
    const auto triangles = gnomon::Triangles::upload(device, still.vertices);
    const gnomon::Points points = gnomon::Points::upload(device, random_points(2000, -1, 1, 6));
    const auto technique = gnomon::make_technique("frustum-traced", device);
    for (const Light& light : {still.sun, still.point_light}) {
        technique->prepare(triangles, light);
        const Answer asked = answer(device, *technique, triangles, points, light);
        EXPECT_EQ(asked.count("prepared"), 1u);
        EXPECT_EQ(asked.visibility, still.run(still.triangles, light).visibility);
    }
}
INSTANTIATE_TEST_SUITE_P(Sizes, WorkGroups, testing::ValuesIn(FEW_WORK_GROUP_SIZES));

}  // namespace
