// SPDX-License-Identifier: MIT
// Unshadowed triangles: by the exact oracle no triangle shadows a found triangle, for points on, above and beside it;
// and the stage finds triangles in meshes and beside walls, but not under roofs.
#include <gtest/gtest.h>

#include "prepared/prepared_light.hpp"
#include "reference/predicates.hpp"
#include "support/expect_exact.hpp"
#include "support/light_scenes.hpp"

namespace {

using namespace support;
using gnomon::Device;

/// Only the kernels made for GPUs search for unshadowed triangles.
Device device_like_a_gpu() { return Device({}, {.gpu_kernels = true}); }

std::vector<bool> unshadowed_triangles(const Device& device, const Floats& vertices, const Light& light,
                                       std::uint32_t size) {
    gnomon::cl::Session& session = session_of(device);
    const auto triangles = gnomon::Triangles::upload(device, vertices);
    gnomon::Statistics statistics;
    const gnomon::ListSettings with_map{true, false, gnomon::CoverTest::tight};
    const gnomon::PreparedLight prepared(session, statistics, triangles, {light}, {size, 0}, with_map, 0);
    std::vector<bool> lit(triangles.count());
    if (!prepared.is_usable()) return lit;
    const std::vector<cl_uint> words = prepared.unshadowed_bits(session);
    for (std::size_t i = 0; i < lit.size(); ++i) lit[i] = (words[i / 32] >> (i % 32) & 1) != 0;
    return lit;
}

/// Points inside, on edges and vertices, and beside, in the plane and above it, as far as promised: never below.
void add_points_about(LightScene& scene, std::uint64_t seed) {
    const Floats& vertices = scene.triangles;
    const Light& light = scene.light;
    Random random(seed);
    reference::Effort effort;
    for (std::uint32_t id = 0; id < vertices.size() / 9; ++id) {
        const reference::Triangle t = reference::triangle_at(vertices, id);
        if (!reference::is_finite(t) || !reference::is_facing(t, light, *scene.eye, effort)) continue;
        for (int i = 0; i < 24; ++i) {
            const float least = i % 4 == 0 ? -1.0f : i % 4 == 1 ? 0.0f : 0.01f;
            float u = random.between(least, 0.5f), v = random.between(least, 0.5f);
            if (i % 8 == 1) u = 0;
            if (i % 8 == 5) v = 1 - u;
            const Float3 &a = vertex(vertices, 3 * id), &b = vertex(vertices, 3 * id + 1),
                         &c = vertex(vertices, 3 * id + 2);
            const float extent = std::abs(b[0] - a[0]) + std::abs(b[1] - a[1]) + std::abs(b[2] - a[2]);
            const float up = i % 3 == 0 ? 0 : std::ldexp(extent, static_cast<int>(random.below(24)) - 22);
            Float3 p;
            for (int k = 0; k < 3; ++k) p[k] = a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]) + up * light[k];
            const int side = reference::side_of_direction({light[0], light[1], light[2]}, t, effort);
            if (!reference::is_finite(p) || reference::side_of_point(p, t, effort) * side > 0) continue;
            add(scene.points, p);
            scene.receivers.push_back(id);
        }
    }
}

TEST(UnshadowedTriangles, NothingShadowsThem) {
    const Device device = device_like_a_gpu();
    std::vector<LightScene> scenes = light_scenes();
    for (const auto& more : {huge_triangle_scenes(), underflow_scenes(), reference_scenes()})
        scenes.insert(scenes.end(), more.begin(), more.end());
    for (const auto& [name, light] : lights_of_every_kind()) {
        scenes.push_back({"sphere, " + name, icosphere(2, 1), {}, light});
        scenes.push_back({"blocks, " + name, lattice_blocks(60, 5, 3), {}, light});
    }
    const auto technique = gnomon::make_technique("frustum-traced", device);
    std::size_t prepared = 0, found = 0, points_on_found = 0, dark = 0;
    for (LightScene& scene : scenes) {
        if (scene.light[3] != 0) continue;
        const Light& l = scene.light;
        const float far = std::min(1e6f / std::max({std::abs(l[0]), std::abs(l[1]), std::abs(l[2])}), 1e30f);
        scene.eye = {far * l[0], far * l[1], far * l[2]};
        scene.points.clear();
        scene.receivers.clear();
        add_points_about(scene, 5);
        if (scene.receivers.empty()) continue;
        const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
        gnomon::Points points = upload_points(device, scene);
        points.set_lifted_off(triangles, *scene.eye);
        const std::vector<float> truth = truth_of(scene);
        const std::uint32_t size = (&scene - scenes.data()) % 2 == 0 ? 16 : 256;
        technique->set("map-size", std::to_string(size));
        technique->prepare(triangles, {scene.light});
        const Answer found_visibility =
            answer(device, *technique, triangles, points, {scene.light}, facing_of(scene.eye));
        prepared += found_visibility.count("prepared");
        const std::vector<bool> lit = unshadowed_triangles(device, scene.triangles, scene.light, size);
        ASSERT_EQ(expect_equal(found_visibility.visibility, truth, scene, "prepared"), 0u);
        for (std::size_t i = 0; i < truth.size(); ++i) {
            points_on_found += lit[scene.receivers[i]];
            dark += truth[i] == 0;
        }
        found += static_cast<std::size_t>(std::count(lit.begin(), lit.end(), true));
    }
    EXPECT_GT(prepared, 100u);
    EXPECT_GT(found, 2500u);
    EXPECT_GT(points_on_found, 50000u);
    EXPECT_GT(dark, 50000u);
}

/// A floor of squares of two triangles each, at height y.
void add_floor(Floats& triangles, int side, float y) {
    for (int i = 0; i < side * side; ++i) {
        const float x = static_cast<float>(i % side), z = static_cast<float>(i / side);
        add(triangles, {x, y, z}, {x + 1, y, z}, {x + 1, y, z + 1});
        add(triangles, {x, y, z}, {x + 1, y, z + 1}, {x, y, z + 1});
    }
}

TEST(UnshadowedTriangles, AreFoundInMeshesAndNotUnderRoofs) {
    const Device device = device_like_a_gpu();
    Floats triangles;
    add_floor(triangles, 8, 0);
    const std::size_t floor = triangles.size() / 9;
    // A wall along x = 0, with the light behind it or not, and a roof over one square and parts of others.
    add(triangles, {0, 0, 0}, {0, 1, 0}, {0, 1, 8});
    add(triangles, {0, 0, 0}, {0, 1, 8}, {0, 0, 8});
    add(triangles, {4.9f, 2, 4.9f}, {6.3f, 2, 4.9f}, {4.9f, 2, 6.3f});
    for (const Light& light : {Light{0.25f, 1, 0, 0}, Light{-0.25f, 1, 0.01f, 0}}) {
        const std::vector<bool> lit = unshadowed_triangles(device, triangles, light, 256);
        Random random(8);
        std::size_t lit_squares = 0;
        for (std::uint32_t id = 0; id < lit.size(); ++id) {
            Floats inside;
            for (int i = 0; i < 2000; ++i) {
                const float u = random.between(0.001f, 0.998f), v = random.between(0.001f, 0.999f - u);
                for (int k = 0; k < 3; ++k)
                    inside.push_back(triangles[9 * id + k] * (1 - u - v) + triangles[9 * id + 3 + k] * u +
                                     triangles[9 * id + 6 + k] * v);
            }
            const std::vector<std::uint32_t> receivers(inside.size() / 3, id);
            const std::vector<float> truth = truth_of({"", triangles, inside, light, receivers});
            const bool is_lit = std::count(truth.begin(), truth.end(), 0.0f) == 0;
            EXPECT_EQ(lit[id], is_lit) << "triangle " << id;
            lit_squares += id < floor && is_lit;
        }
        EXPECT_GT(lit_squares, floor / 2);
        EXPECT_LT(lit_squares, floor);
    }
}

// A sample of triangles decides whether the search runs: on an open floor it finds all triangles; if slats above leave
// only some squares open, it finds hardly any, as the sample rarely contains an open square.
TEST(UnshadowedTriangles, AreSoughtWhereASampleFindsMany) {
    const Device device = device_like_a_gpu();
    const Light light{0, 1, 0, 0};
    constexpr int side = 64, open_squares = 16;
    Floats triangles;
    add_floor(triangles, side, 0);
    const std::size_t floor = triangles.size() / 9;
    const std::vector<bool> all = unshadowed_triangles(device, triangles, light, 256);
    EXPECT_EQ(std::count(all.begin(), all.end(), true), floor);

    const auto add_slat = [&](float z, float end) { add(triangles, {-1, 2, z - .1f}, {-1, 2, z + .1f}, {end, 2, z}); };
    for (int i = 1; i < side - 1; i += 2) add_slat(static_cast<float>(i), side + 9);  // over the edge of two rows
    add_slat(side - 1.5f, side + 9);
    add_slat(side - .5f, side - open_squares);
    std::vector<bool> few = unshadowed_triangles(device, triangles, light, 256);
    few.resize(floor);  // without the slats
    EXPECT_LT(std::count(few.begin(), few.end(), true), open_squares);
}

}  // namespace
