// SPDX-License-Identifier: MIT
// An appearance on the device gives the surfaces that gathering a view's own gives, view after view.
#include <gtest/gtest.h>

#include <optional>

#include "shading/surface.hpp"
#include "support/floor_view.hpp"
#include "support/scene_makers.hpp"

namespace {

using namespace gnomon;
using support::Floats;

/// Triangles in disorder, with all that a surface may have, or a part of it.
struct Scene {
    Floats triangles = support::soup(400, 0.5f, 3);
    Materials materials{{}, {{0.9f, 0.5f, 0.4f}, {0.3f, 0.8f, 0.5f}, {0.4f, 0.4f, 0.9f}}};
    Floats coordinates = support::random_points(800, -1, 2, 5), colors = support::random_points(1200, 0, 1, 6);
    std::vector<std::uint32_t> normals;
    std::vector<std::uint8_t> texels[2];
    std::vector<ColorTexture> textures;
    std::vector<ColorTextureUse> uses{{0}, {no_texture}, {1}};

    Scene() {
        const Floats directions = support::random_points(1200, -1, 1, 7);
        for (std::size_t i = 0; i < 400; ++i) materials.triangle_material.push_back(std::uint32_t(i % 3));
        for (std::size_t i = 0; i < 1200; ++i)
            normals.push_back(pack_normal({directions[3 * i], directions[3 * i + 1], directions[3 * i + 2]}));
        for (int which = 0; which < 2; ++which) {
            for (int i = 0; i < 4 * 16 * 12; ++i) texels[which].push_back(std::uint8_t(i * (which + 37)));
            textures.push_back({16, 12, texels[which]});
        }
        uses[2].weigh_by_alpha = true;
    }
    SurfaceDetail detail() const { return {coordinates, colors, normals, uses, textures}; }
};

const Camera cameras[] = {Camera::look_at({0, 1, 4}, {0, 0, 0}, {0, 1, 0}, 50),
                          Camera::look_at({3, 0, 1}, {0, 0, 0}, {0, 1, 0}, 70)};

void expect_same(const Surfaces& one, const Surfaces& other) {
    const SurfacesOnHost a = one.read(), b = other.read();
    EXPECT_EQ(a.albedo, b.albedo);
    EXPECT_EQ(a.normal, b.normal);
}

TEST(Appearance, GivesTheSurfacesOfEachView) {
    const Scene scene;
    const SurfaceDetail all = scene.detail();
    const std::vector<SurfaceDetail> details{
        all,
        {},
        {.texture_coordinates = all.texture_coordinates, .texture_uses = all.texture_uses, .textures = all.textures},
        {.corner_colors = all.corner_colors},
        {.corner_normals = all.corner_normals}};
    for (const bool gpu_kernels : {false, true}) {
        const Device device({}, {.gpu_kernels = gpu_kernels});
        const Triangles triangles = Triangles::upload(device, scene.triangles);
        const auto technique = make_technique("frustum-traced", device);
        for (const SurfaceDetail& detail : details) {
            const Appearance appearance = Appearance::upload(device, scene.materials, detail);
            for (int repeat = 0; repeat < 2; ++repeat)
                for (const Camera& camera : cameras) {
                    const View view = look(device, triangles, camera, 61, 40);
                    const Surfaces kept = appearance.surfaces(triangles, view);
                    const Surfaces alone(device, triangles, view, scene.materials, detail);
                    expect_same(kept, alone);
                    const Visibility visibility(device, view.points.count());
                    const Light light = support::lights()[0];
                    technique->run(triangles, view.points, light, visibility);
                    for (const std::optional<double> ev : {std::optional<double>(0), std::optional<double>()}) {
                        const Picture a = shade(kept, {&visibility, 1}, {&light, 1}, {.exposure_ev = ev});
                        const Picture b = shade(alone, {&visibility, 1}, {&light, 1}, {.exposure_ev = ev});
                        EXPECT_EQ(a.rgba, b.rgba);
                        EXPECT_EQ(a.exposure_ev, b.exposure_ev);
                    }
                }
        }
    }
}

TEST(Appearance, SurfacesThatAreKeptStayAsTheyAre) {
    const Scene scene;
    const Device device;
    const Triangles triangles = Triangles::upload(device, scene.triangles);
    const Appearance appearance = Appearance::upload(device, scene.materials, scene.detail());
    const View first = look(device, triangles, cameras[0], 40, 30),
               second = look(device, triangles, cameras[1], 40, 30);
    const Surfaces kept = appearance.surfaces(triangles, first);
    const SurfacesOnHost before = kept.read();
    EXPECT_NE(appearance.surfaces(triangles, second).read().albedo, before.albedo);
    EXPECT_EQ(kept.read().albedo, before.albedo);
    EXPECT_EQ(kept.read().normal, before.normal);
    const std::uint64_t bytes = device.memory_bytes();
    for (int i = 0; i < 3; ++i) appearance.surfaces(triangles, second);
    EXPECT_EQ(device.memory_bytes(), bytes) << "buffers serve again";
}

/// The caller's arrays may go, and the appearance: surfaces stay.
TEST(Appearance, ArraysAreNotNeededAfterwards) {
    const Device device;
    std::optional<Scene> scene(std::in_place);
    const Triangles triangles = Triangles::upload(device, scene->triangles);
    const View view = look(device, triangles, cameras[0], 40, 30);
    const Floats wanted = Surfaces(device, triangles, view, scene->materials, scene->detail()).read().albedo;
    std::optional<Appearance> appearance = Appearance::upload(device, scene->materials, scene->detail());
    EXPECT_GT(appearance->texture_bytes(), 0u);
    scene.reset();
    const Surfaces surfaces = appearance->surfaces(triangles, view);
    appearance.reset();
    EXPECT_EQ(surfaces.read().albedo, wanted);
}

TEST(Appearance, APictureStaysInTheCallersBuffer) {
    const Device device;
    const Scene scene;
    const Triangles triangles = Triangles::upload(device, scene.triangles);
    const View view = look(device, triangles, cameras[0], 40, 30);
    const Surfaces surfaces = Appearance::upload(device, scene.materials, scene.detail()).surfaces(triangles, view);
    const Visibility lit(device, 40 * 30);
    const Light light = support::lights()[0];
    make_technique("frustum-traced", device)->run(triangles, view.points, light, lit);
    const cl::Buffer rgba(session_of(device), 4 * 40 * 30), small(session_of(device), 4 * 40 * 30 - 1);
    const double ev = shade_into(rgba.get(), surfaces, {&lit, 1}, {&light, 1}, {.exposure_ev = std::nullopt});
    const Picture picture = shade(surfaces, {&lit, 1}, {&light, 1}, {.exposure_ev = std::nullopt});
    EXPECT_EQ(session_of(device).read_values<std::uint8_t>(rgba.get(), 4 * 40 * 30), picture.rgba);
    EXPECT_EQ(ev, picture.exposure_ev);
    EXPECT_THROW(shade_into(small.get(), surfaces, {&lit, 1}, {&light, 1}), InvalidArgument);
    EXPECT_THROW(shade(surfaces, {&lit, 1}, {&light, 1}, {.sky_sums = rgba.get()}), InvalidArgument);
}

TEST(Appearance, RefusesOtherTrianglesAndWhatDoesNotFit) {
    const Device device, small({}, {.memory_limit_bytes = 1u << 20});
    const Scene scene;
    const Triangles some = Triangles::upload(device, std::span(scene.triangles).first(9 * 7));
    const View view = look(device, some, cameras[0], 4, 4);
    EXPECT_THROW(Appearance::upload(device, scene.materials).surfaces(some, view), InvalidArgument);
    const std::vector<std::uint8_t> white(std::size_t(4) * 1024 * 1024, 255);
    const ColorTexture large{1024, 1024, white};
    SurfaceDetail detail = scene.detail();
    const std::vector<ColorTextureUse> one(3, {0});
    detail.texture_uses = one;
    detail.textures = {&large, 1};
    EXPECT_NO_THROW(Appearance::upload(device, scene.materials, detail));
    EXPECT_THROW(Appearance::upload(small, scene.materials, detail), OutOfDeviceMemory);
}

}  // namespace
