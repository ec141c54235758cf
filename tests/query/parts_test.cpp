// SPDX-License-Identifier: MIT
// Scenes too large for a device's memory (by a limit), in parts: every bit is the same as in one part.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include <gnomon.hpp>
#include "support/cut_out_scenes.hpp"
#include "support/scene_makers.hpp"

namespace {

using gnomon::Device;
using gnomon::Light;
using support::Floats;

constexpr std::uint32_t width = 160, height = 120;
constexpr std::size_t triangle_count = 100000, point_count = 10000;

const Floats& vertices() {
    static const Floats soup = support::soup(triangle_count, 0.04f, 11);
    return soup;
}
const Floats& places() {
    static const Floats points = support::random_points(point_count, -1, 1, 12);
    return points;
}
const gnomon::Camera camera = gnomon::Camera::look_at({0.3f, 1, 4}, {0, 0, 0}, {0, 1, 0}, 40);
const Light lights[] = {Light::directional({0.2f, -1, 0.1f}), Light::point({0.1f, 0.2f, 0.3f})};

Device limited_to(std::uint64_t bytes) {
    gnomon::DeviceOptions options;
    options.memory_limit_bytes = bytes;
    return Device({}, options);
}

/// Few entries at first, or one list would take all the memory; a map that leaves room for one part only.
std::unique_ptr<gnomon::Technique> made(const Device& device) {
    auto technique = gnomon::make_technique("frustum-traced", device);
    technique->set("first-capacity", "4096");
    technique->set("map-size", "2048");
    return technique;
}

/// Each triangle a colour of its own.
gnomon::Materials colors_of(const std::vector<std::uint32_t>& ids) {
    gnomon::Materials materials;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        materials.triangle_material.push_back(std::uint32_t(i));
        materials.base_color.push_back({float(ids[i] % 7) / 7, float(ids[i] % 31) / 31, float(ids[i] % 101) / 101});
    }
    return materials;
}

struct Bits {
    gnomon::ViewOnHost view;
    Floats seen[2], scattered[2];  ///< by light
    std::vector<std::uint8_t> picture;
};

Bits whole(const Device& device, const gnomon::CutOuts* cut_outs = nullptr) {
    Bits bits;
    const auto triangles = cut_outs != nullptr ? gnomon::Triangles::upload(device, vertices(), *cut_outs)
                                               : gnomon::Triangles::upload(device, vertices());
    const gnomon::View view = look(device, triangles, camera, width, height);
    bits.view = view.read(device, triangles);
    const auto points = gnomon::Points::upload(device, places());
    const gnomon::Visibility seen(device, view.points.count()), scattered(device, points.count());
    const auto technique = made(device);
    for (int i = 0; i < 2; ++i) {
        technique->run(triangles, points, lights[i], scattered);
        bits.scattered[i] = scattered.read();
        technique->run(triangles, view.points, lights[i], seen);
        bits.seen[i] = seen.read();
    }
    std::vector<std::uint32_t> ids(triangle_count);
    for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = std::uint32_t(i);
    bits.picture = shade(device, triangles, view, seen, colors_of(ids), lights[1]);
    return bits;
}

Bits in_parts(const Device& device, std::uint64_t& max_parts, const gnomon::CutOuts* cut_outs = nullptr) {
    Bits bits;
    const gnomon::ViewOfParts looked = look_in_parts(device, {vertices(), cut_outs}, camera, width, height);
    bits.view = looked.view.read(device, looked.triangles);
    for (std::uint32_t& receiver : bits.view.receiver)
        if (receiver != gnomon::no_receiver) receiver = looked.ids.at(receiver);
    const auto points = gnomon::Points::upload(device, places());
    const gnomon::Visibility seen(device, looked.view.points.count()), scattered(device, points.count());
    const auto make = [&] { return made(device); };
    max_parts = 0;
    for (int i = 0; i < 2; ++i) {
        for (const gnomon::Statistics& run :
             {run_in_parts(make, device, {vertices(), cut_outs}, points, {}, lights[i], scattered),
              run_in_parts(make, device, {vertices(), cut_outs}, looked.view.points, looked.ids, lights[i], seen)})
            max_parts = std::max(max_parts, run.count("parts"));
        bits.scattered[i] = scattered.read();
        bits.seen[i] = seen.read();
    }
    bits.picture = shade(device, looked.triangles, looked.view, seen, colors_of(looked.ids), lights[1]);
    return bits;
}

void expect_same(const Bits& found, const Bits& wanted) {
    EXPECT_EQ(found.view.receiver, wanted.view.receiver);
    EXPECT_EQ(found.view.position, wanted.view.position);
    EXPECT_EQ(found.view.normal, wanted.view.normal);
    EXPECT_EQ(found.picture, wanted.picture);
    for (int i = 0; i < 2; ++i) {
        EXPECT_EQ(found.seen[i], wanted.seen[i]) << "light " << i;
        EXPECT_EQ(found.scattered[i], wanted.scattered[i]) << "light " << i;
    }
}

TEST(Parts, GiveTheBitsOfTheWhole) {
    const Device plenty;
    const Bits wanted = whole(plenty);
    const std::uint64_t needed = plenty.peak_memory_bytes();
    ASSERT_NE(std::count(wanted.seen[0].begin(), wanted.seen[0].end(), 0.0f), 0);
    std::uint64_t parts = 0;
    expect_same(in_parts(plenty, parts), wanted);
    EXPECT_EQ(parts, 1u) << "all of it fits";
    for (const int percent : {75, 50}) {
        const std::uint64_t limit = needed * std::uint64_t(percent) / 100;
        SCOPED_TRACE(std::to_string(limit) + " of " + std::to_string(needed) + " bytes");
        EXPECT_THROW(whole(limited_to(limit)), gnomon::OutOfDeviceMemory);
        const Device device = limited_to(limit);
        expect_same(in_parts(device, parts), wanted);
        EXPECT_LE(device.peak_memory_bytes(), limit);
        EXPECT_EQ(device.memory_bytes(), 0u);
    }
    EXPECT_GT(parts, 1u);
}

TEST(Parts, HonourCutOuts) {
    const Device plenty;
    const support::CutOutData data(support::mixed_masks(triangle_count, 3, true));
    const gnomon::CutOuts cut_outs = data.cut_outs();
    const Bits opaque = whole(plenty), wanted = whole(plenty, &cut_outs);
    EXPECT_NE(wanted.seen[0], opaque.seen[0]) << "the masks must matter";
    EXPECT_NE(wanted.view.receiver, opaque.view.receiver);
    const Device device = limited_to(plenty.peak_memory_bytes() / 2);
    std::uint64_t parts = 0;
    expect_same(in_parts(device, parts, &cut_outs), wanted);
    EXPECT_GT(parts, 1u);
}

TEST(Parts, WhatFitsInNoPartIsAClearError) {
    const Device device = limited_to(400000);
    try {
        look_in_parts(device, {vertices()}, camera, width * 4, height * 4);
        ADD_FAILURE() << "a picture that does not fit";
    } catch (const gnomon::OutOfDeviceMemory& error) {
        EXPECT_NE(std::string(error.what()).find("limit of 400000"), std::string::npos) << error.what();
    }
    {
        const auto points = gnomon::Points::upload(device, Floats(3 * 20000, 0.0f));
        const gnomon::Visibility visibility(device, points.count());
        EXPECT_THROW(
            run_in_parts([&] { return made(device); }, device, {vertices()}, points, {}, lights[0], visibility),
            gnomon::OutOfDeviceMemory);
    }
    EXPECT_EQ(device.memory_bytes(), 0u);
}

/// Points on triangles, and normals that have nothing to do with these.
struct Faced {
    gnomon::Points points, normals;

    explicit Faced(const Device& device) {
        std::vector<std::uint32_t> receivers(point_count);
        for (std::size_t i = 0; i < receivers.size(); ++i) receivers[i] = std::uint32_t(7 * i % triangle_count);
        points = gnomon::Points::upload(device, places(), receivers);
        normals = gnomon::Points::upload(device, support::random_points(point_count, -1, 1, 3));
    }
    std::vector<gnomon::Facing> facings(const Floats& on_host) const {
        return {gnomon::Facing::none(), gnomon::Facing::eye({0, 9, 4}), gnomon::Facing::winding(),
                gnomon::Facing::normals(on_host), gnomon::Facing::normals(normals.positions())};
    }
};

// By what is decided part by part: the same bits as of the whole. Not vacuous: each facing darkens points.
TEST(Parts, FaceAsTheWholeDoes) {
    const Device plenty;
    const Faced faced(plenty);
    const Floats on_host = faced.normals.read(plenty).position;
    std::vector<Floats> wanted;
    {
        const auto triangles = gnomon::Triangles::upload(plenty, vertices());
        const gnomon::Visibility visibility(plenty, point_count);
        for (const gnomon::Facing& facing : faced.facings(on_host)) {
            made(plenty)->run(triangles, faced.points, lights[0], visibility, {.facing = facing});
            wanted.push_back(visibility.read());
            EXPECT_EQ(wanted.back() == wanted.front(), wanted.size() == 1);
        }
    }
    const Device device = limited_to(plenty.peak_memory_bytes() / 2);
    const Faced in_parts(device);
    const gnomon::Visibility visibility(device, point_count);
    const auto make = [&] { return made(device); };
    std::size_t i = 0;
    for (const gnomon::Facing& facing : in_parts.facings(on_host)) {
        const auto run =
            run_in_parts(make, device, {vertices()}, in_parts.points, {}, lights[0], visibility, {.facing = facing});
        EXPECT_GT(run.count("parts"), 1u);
        EXPECT_EQ(visibility.read(), wanted[i++]);
    }
    const auto fans = gnomon::VertexFans::find(device, std::span(vertices()).first(9), places());
    EXPECT_THROW(run_in_parts(make, device, {vertices()}, in_parts.points, {}, lights[0], visibility,
                              {.facing = gnomon::Facing::fans(fans)}),
                 gnomon::InvalidArgument);
}

TEST(Parts, WithoutTrianglesEverythingIsLit) {
    const Device device;
    const gnomon::ViewOfParts looked = look_in_parts(device, gnomon::SceneOnHost{}, camera, 4, 3);
    EXPECT_TRUE(looked.ids.empty());
    const gnomon::Visibility visibility(device, 12);
    const auto run = run_in_parts([&] { return made(device); }, device, gnomon::SceneOnHost{}, looked.view.points,
                                  looked.ids, lights[0], visibility);
    EXPECT_EQ(run.count("parts"), 0u);
    EXPECT_EQ(visibility.read(), Floats(12, 1.0f));
    const Floats eight(8);
    EXPECT_THROW(look_in_parts(device, {eight}, camera, 4, 3), gnomon::InvalidArgument);
}

}  // namespace
