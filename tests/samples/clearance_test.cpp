// SPDX-License-Identifier: MIT
// Stage clearance: a triangle that is called too low over a receiver's plane shadows no sample on that receiver, by the
// exact predicate; and most of a receiver's neighbours in a convex mesh are called so.
#include <gtest/gtest.h>

#include <iostream>

#include "reference/predicates.hpp"
#include "support/device.hpp"
#include "support/fragment_stages.hpp"
#include "support/kernel_file.hpp"
#include "support/pixel_scenes.hpp"
#include "support/terrains.hpp"

namespace {

using namespace support;

constexpr const char* KERNELS = "samples/clearance_test.cl";
constexpr std::uint32_t OTHERS = 8;  // as in clearance_test.cl

bool share_a_corner(const Floats& triangles, std::uint32_t a, std::uint32_t b) {
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            if (vertex(triangles, 3 * std::size_t(a) + i) == vertex(triangles, 3 * std::size_t(b) + k)) return true;
    return false;
}

/// For each fragment in turn other ones of its receiver's neighbours, and triangles from anywhere.
std::vector<std::uint32_t> some_others(Random& random, const Floats& triangles, std::uint32_t receiver) {
    const auto count = std::uint32_t(triangles.size() / 9);
    std::vector<std::uint32_t> others, neighbours;
    for (std::uint32_t id = 0; id < count; ++id)
        if (id != receiver && share_a_corner(triangles, receiver, id)) neighbours.push_back(id);
    while (others.size() < OTHERS)
        others.push_back(others.size() % 4 == 3 || neighbours.empty()
                             ? random.below(count)
                             : neighbours[random.below(std::uint32_t(neighbours.size()))]);
    return others;
}

struct Tally {
    std::size_t clear = 0, clear_neighbours = 0, neighbours = 0, blocking = 0;
};

/// The fragments of a view on receivers that face the light, as the kernel takes them.
struct Inputs {
    std::vector<std::size_t> slots;
    std::vector<std::uint32_t> receivers, others;
    Floats centres, footprints;  ///< coordinate by coordinate
};

Inputs inputs_of(const CameraScene& scene, const gnomon::Light& light, const ClassifiedFragments& of) {
    Inputs in;
    Random random(3);
    reference::Effort effort;
    for (std::size_t slot = 0; slot < of.used; ++slot) {
        if (of.masks[slot] == 0 || !std::isfinite(of.shape(6, slot))) continue;
        const std::uint32_t id = of.receivers[slot];
        if (!reference::is_facing(reference::triangle_at(scene.triangles, id), light.xyzw, scene.eye, effort)) continue;
        in.slots.push_back(slot);
        in.receivers.push_back(id);
        for (const std::uint32_t other : some_others(random, scene.triangles, id)) in.others.push_back(other);
    }
    for (std::size_t c = 0; c < 3; ++c)
        for (const std::size_t slot : in.slots) in.centres.push_back(of.centre(slot)[c]);
    for (std::size_t i = 0; i < FOOTPRINT_FLOATS; ++i)
        for (const std::size_t slot : in.slots) in.footprints.push_back(of.shape(i, slot));
    return in;
}

std::vector<std::uint32_t> find_clear(gnomon::cl::Session& session, const CameraScene& scene,
                                      const gnomon::Light& light, const Inputs& in) {
    add_kernel_file(session, KERNELS);
    gnomon::PointsLayout layout{};
    layout.point_stride = 1;
    layout.coordinate_stride = layout.count = cl_uint(in.slots.size());
    const gnomon::cl::Buffer clear(session, in.slots.size() * 4);
    session.launch(KERNELS, "find_clear", session.blocks(in.slots.size()), layout,
                   gnomon::float4{{scene.eye[0], scene.eye[1], scene.eye[2], 0}}, gnomon::float4_of(light.xyzw),
                   uploaded(session, scene.triangles), uploaded(session, in.centres), uploaded(session, in.footprints),
                   uploaded(session, in.receivers), uploaded(session, in.others), clear);
    return downloaded<std::uint32_t>(session, clear.get(), in.slots.size());
}

/// Whether the triangle shadows a sample of the fragment.
bool shadows_a_sample(const RecordedSamples& recorded, const ClassifiedFragments& of, std::size_t slot,
                      const reference::Triangle& triangle, const gnomon::Light& light) {
    reference::Effort effort;
    bool is_shadowed = false;
    recorded.for_samples(of, slot, [&](std::size_t place, std::uint32_t sample) {
        const Float3 p = vertex(recorded.positions, sample * recorded.pixels() + place);
        is_shadowed |= reference::blocks(reference::Ray::to_light(p, light.xyzw), triangle, effort);
    });
    return is_shadowed;
}

void expect_clear_is_true(const gnomon::Device& device, const CameraScene& scene, const gnomon::Light& light,
                          Tally& tally) {
    const RecordedSamples recorded = record_samples(device, scene, light, 8, Classify::nothing);
    const ClassifiedFragments& of = recorded.classified.front();
    const Inputs in = inputs_of(scene, light, of);
    const auto clear = find_clear(session_of(device), scene, light, in);
    for (std::size_t i = 0; i < clear.size(); ++i)
        for (std::uint32_t k = 0; k < OTHERS; ++k) {
            const std::uint32_t other = in.others[OTHERS * i + k];
            if (other == in.receivers[i]) continue;
            const bool is_clear = (clear[i] >> k & 1) != 0,
                       is_neighbour = share_a_corner(scene.triangles, in.receivers[i], other);
            const bool blocks =
                shadows_a_sample(recorded, of, in.slots[i], reference::triangle_at(scene.triangles, other), light);
            tally.clear += is_clear;
            tally.neighbours += is_neighbour;
            tally.clear_neighbours += is_clear && is_neighbour;
            tally.blocking += blocks;
            ASSERT_FALSE(is_clear && blocks)
                << "triangle " << other << " over fragment " << in.slots[i] << " on " << in.receivers[i];
        }
}

CameraScene terrain_from_above() {
    Floats triangles = rough_terrain(5, 0.2f).triangles();
    return {"terrain", triangles, {20, 150, 60}, {10, 113, 40}, {0, 1, 0}, 70, 32, 32};
}

TEST(Clearance, WhatIsClearShadowsNoSample) {
    const gnomon::Device device = device_with();
    if (session_of(device).lanes() == 1) GTEST_SKIP() << "a GPU traces undecided footprints";
    std::vector<CameraScene> scenes =
        named_camera_scenes({"ball", "inside a ball", "tiny ball", "ball at 1000.000000"});
    scenes.push_back(terrain_from_above());
    for (const CameraScene& scene : hard_pixel_scenes())
        if (scene.name == "dust" || scene.name == "islands") scenes.push_back(scene);
    Tally tally;
    for (const CameraScene& scene : scenes)
        for (const gnomon::Light& light :
             {gnomon::Light::directional({0.3f, -1, -0.2f}), gnomon::Light::directional({1, -0.05f, -0.3f}),
              gnomon::Light::point({3, 120, 9}), gnomon::Light::point({0.2f, 0.3f, 1.5f})}) {
            SCOPED_TRACE(scene.name);
            expect_clear_is_true(device, scene, light, tally);
            if (HasFailure()) return;
        }
    std::cout << tally.clear << " triangles clear, " << tally.clear_neighbours << " of them among " << tally.neighbours
              << " neighbours; " << tally.blocking << " shadow a sample\n";
    EXPECT_GT(tally.clear_neighbours, tally.neighbours / 4);
    EXPECT_GT(tally.blocking, 1000u);
}

}  // namespace
