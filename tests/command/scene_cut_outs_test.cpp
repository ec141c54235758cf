// SPDX-License-Identifier: MIT
// Cut-outs of glTF files: what is loaded, and Sponza with its plants against the oracle, which decides masks in
// rationals. GNOMON_CUT_OUT_SIZE=1920x1080 judges larger pictures.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include "decoded_image.hpp"
#include "gltf_file.hpp"
#include "reference/view.hpp"
#include "scene/scene.hpp"
#include "support/scene_masks.hpp"

namespace {

using namespace gnomon;

scene::SceneCutOuts::Texture decoded(std::span<const unsigned char> bytes) {
#ifdef __SANITIZE_ADDRESS__
    // OpenImageIO 2.4 loses a string where libpng jumps out of its reading callback: 31 bytes per broken PNG.
    const __lsan::ScopedDisabler disabled;
#endif
    app::AlphaImage image = app::read_alpha(bytes);
    return {image.width, image.height, std::move(image.alpha)};
}

TEST(SceneCutOuts, SponzaEqualsReference) {
    const std::filesystem::path file = GNOMON_SHARED_SCENES "/crytek_sponza_textured.glb";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "NOT TESTED: " << file << " is missing";
    unsigned width = 128, height = 72;
    if (const char* size = std::getenv("GNOMON_CUT_OUT_SIZE")) std::sscanf(size, "%ux%u", &width, &height);
    const scene::Scene scene = scene::load(file, {.decode_alpha = decoded});
    EXPECT_TRUE(scene.warnings.empty());
    const reference::Masks masks = support::masks_of(scene);
    const scene::CutOutsView cut_outs(scene);
    const reference::PinholeCamera views[] = {{{-1000, 150, -40}, {200, 200, -30}, {0, 1, 0}, 60, width, height},
                                              {{800, 600, -35}, {-300, 120, -40}, {0, 1, 0}, 65, width, height}};
    const Light lights[] = {Light::directional({0.12f, -1, 0.06f}), Light::directional({-0.45f, -0.9f, 0.06f}),
                            Light::directional({0.35f, -1, -0.004f}), Light::point({0, 600, -40})};
    for (const bool gpu_kernels : {false, true}) {
        const Device device({}, {.gpu_kernels = gpu_kernels});
        Triangles triangles = Triangles::upload(device, scene.triangles, *cut_outs.get());
        EXPECT_EQ(
            triangles.cut_out_counts().masked + triangles.cut_out_counts().opaque + triangles.cut_out_counts().clear,
            34940u);
        EXPECT_GT(triangles.cut_out_counts().masked, 20000u);
        EXPECT_EQ(triangles.cut_out_counts().unusable, 0u);
        triangles.keep_clusters(device);
        const auto technique = make_technique("frustum-traced", device);
        for (const auto& view : views) {
            const auto camera = Camera::look_at(view.eye, view.target, view.up, view.fov_y_degrees);
            const View looked = look(device, triangles, camera, width, height);
            const ViewOnHost host = looked.read(device, triangles);
            for (const Light& light : lights) {
                const Visibility visibility(device, host.receiver.size());
                technique->run(triangles, looked.points, light, visibility);
                const std::vector<float> answers = visibility.read();
                const auto report =
                    reference::judge_view(scene.triangles, view, light.xyzw,
                                          {host.position, host.normal, host.receiver, answers}, {.masks = &masks});
                EXPECT_EQ(report.wrong(), 0u);
                std::printf("%u pixels, %u ambiguous, wrong: %u nearest, %u side, %u distance, %u visibility\n",
                            unsigned(report.pixels), unsigned(report.camera_ambiguous),
                            unsigned(report.wrong_nearest.count), unsigned(report.wrong_side.count),
                            unsigned(report.wrong_distance.count), unsigned(report.wrong_visibility.count));
            }
        }
    }
}

// ---- What is loaded
// --------------------------------------------------------------------------------------------------

using gltf_file::Gltf;
using SceneCutOutsFile = gltf_file::SceneFile;

// Alphas 0, 51, 255 above 127, 128, 204.
constexpr const char* png_3x2 =
    "iVBORw0KGgoAAAANSUhEUgAAAAMAAAACCAYAAACddGYaAAAAH0lEQVR4nGPgEpFj0DCyMWZkYv7PwMnJWQ/"
    "EDUB8BgAtKgQnI5ha4AAAAABJRU5ErkJg"
    "gg==";
// 16-bit alphas 128 and 0x8080: 0.498 and 128 in units of 1 / 255.
constexpr const char* png_16_bits =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABEAYAAACksqPJAAAAFElEQVR4nGNgYGRgYmBmaIDQDQ0ABnUBjeci978AAAAASUVORK5CYII=";

Gltf masked_file(const char* png = png_3x2) {
    Gltf gltf = gltf_file::triangle_file();
    gltf.accessor(gltf.view_of(std::vector<float>{0, 0, 1, 0, 0.25f, 1}), gltf_file::f32, 3, "VEC2");
    gltf.set("/meshes/0/primitives/0", R"({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0})");
    gltf.set("/materials", R"([{"name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.4, "pbrMetallicRoughness":
        {"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 1, 1, 0.5]}}])");
    gltf.set("/textures", R"([{"source": 0, "sampler": 0}])");
    gltf.set("/samplers", R"([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}])");
    gltf.set("/images", R"([{"uri": "data:image/png;base64,)" + std::string(png) + "\"}]");
    return gltf;
}
const scene::LoadOptions with_images{.decode_alpha = decoded};

TEST_F(SceneCutOutsFile, AMaskIsLoaded) {
    const scene::Scene scene = load(masked_file(), with_images);
    EXPECT_TRUE(scene.warnings.empty());
    const scene::SceneCutOuts& c = scene.cut_outs;
    ASSERT_EQ(c.material_of_triangle, std::vector<std::uint32_t>{0});
    EXPECT_EQ(scene.texture_coordinates, (std::vector<float>{0, 0, 1, 0, 0.25f, 1}));
    EXPECT_TRUE(c.corner_alphas.empty());
    ASSERT_EQ(c.materials.size(), 1u);
    EXPECT_EQ(c.materials[0].wrap_u, TextureWrap::clamp);
    EXPECT_EQ(c.materials[0].wrap_v, TextureWrap::mirror);
    EXPECT_EQ(c.materials[0].filter, TextureFilter::nearest);
    EXPECT_EQ(c.materials[0].cutoff, 0.4f);
    EXPECT_EQ(c.materials[0].alpha_factor, 0.5f);
    ASSERT_EQ(c.textures.size(), 1u);
    EXPECT_EQ(c.textures[0].width, 3u);
    EXPECT_EQ(c.textures[0].alpha, (std::vector<std::uint8_t>{0, 51, 255, 127, 128, 204}));
}

TEST_F(SceneCutOutsFile, DefaultsAreThoseOfGltf) {
    Gltf gltf = masked_file();
    gltf.set("/materials/0/alphaCutoff", "").set("/textures/0/sampler", "");
    gltf.set("/materials/0/pbrMetallicRoughness/baseColorFactor", "");
    const CutOutMaterial m = load(gltf, with_images).cut_outs.materials.at(0);
    EXPECT_EQ(m.wrap_u, TextureWrap::repeat);
    EXPECT_EQ(m.filter, TextureFilter::linear);
    EXPECT_EQ(m.cutoff, 0.5f);
    EXPECT_EQ(m.alpha_factor, 1.0f);
}

TEST_F(SceneCutOutsFile, SixteenBitsAreRoundedOnce) {
    const scene::Scene scene = load(masked_file(png_16_bits), with_images);
    EXPECT_EQ(scene.cut_outs.textures.at(0).alpha, (std::vector<std::uint8_t>{0, 128}));
}

// A quarter turn, u' = offset + scale_v v and v' = offset - scale_u u, as viewers turn the Khronos test file.
TEST_F(SceneCutOutsFile, TextureTransformsAreRoundedOnce) {
    Gltf gltf = masked_file();
    gltf.set("/extensionsUsed", R"(["KHR_texture_transform"])");
    gltf.set("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions", R"({"KHR_texture_transform":
        {"offset": [0.1, 0.2], "rotation": 1.5707963267948966, "scale": [3, 5]}})");
    const scene::Scene scene = load(gltf, with_images);
    EXPECT_TRUE(scene.warnings.empty());
    const std::vector<float>& uv = scene.texture_coordinates;
    const double wanted[6] = {0.1, 0.2, 0.1, 0.2 - 3, 0.1 + 5, 0.2 - 0.75};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(uv[i], wanted[i], 1e-6) << i;
    gltf.set("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform",
             R"({"scale": [3, 5]})");
    EXPECT_EQ(load(gltf, with_images).texture_coordinates, (std::vector<float>{0, 0, 3, 0, 0.75f, 5}));
}

TEST_F(SceneCutOutsFile, VertexColoursGiveAlpha) {
    Gltf gltf = masked_file();
    const std::vector<std::uint8_t> rgba{0, 0, 0, 0, 0, 0, 0, 51, 0, 0, 0, 255};
    gltf.accessor(gltf.view_of(rgba), gltf_file::u8, 3, "VEC4");
    gltf.set("/accessors/2/normalized", "true");
    gltf.set("/meshes/0/primitives/0/attributes/COLOR_0", "2");
    EXPECT_EQ(load(gltf, with_images).cut_outs.corner_alphas, (std::vector<float>{0, 0.2f, 1}));
}

TEST_F(SceneCutOutsFile, WithoutCoordinatesTheFactorDecides) {
    Gltf gltf = masked_file();
    gltf.set("/meshes/0/primitives/0/attributes/TEXCOORD_0", "");
    const scene::Scene scene = load(gltf, with_images);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.cut_outs.materials.at(0).texture, no_texture);
}

TEST_F(SceneCutOutsFile, WhatCannotBeReadIsOpaqueWithAWarning) {
    const scene::Scene without = load(masked_file());
    expect_warning(without, {"alphaMode MASK (drawn opaque)"});
    EXPECT_TRUE(without.cut_outs.empty());
    for (const char* image : {R"({"uri": "data:image/png;base64,AAAA"})", R"({"uri": "missing.png"})", R"({})",
                              R"({"uri": "https://example.org/leaf.png"})", R"({"bufferView": 77})",
                              R"({"uri": "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAMAAAACCAYAAACd"})"}) {
        Gltf gltf = masked_file();
        gltf.set("/images/0", image);
        const scene::Scene scene = load(gltf, with_images);
        expect_warning(scene, {"alphaMode MASK of material 'leaf'", "drawn opaque"});
        EXPECT_TRUE(scene.cut_outs.empty()) << image;
    }
    Gltf ktx = masked_file();
    ktx.set("/textures/0", R"({"extensions": {"KHR_texture_basisu": {"source": 0}}})");
    expect_warning(load(ktx, with_images), {"KTX2", "drawn opaque"});
    Gltf infinite = masked_file();
    infinite.set("/accessors/1", R"({"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"})");
    infinite.view_of(std::vector<float>{0, 0, 1, std::numeric_limits<float>::infinity(), 3e9f, 1});
    expect_warning(load(infinite, with_images), {"texture coordinates that are no numbers", "1 triangle drawn opaque"});
}

TEST_F(SceneCutOutsFile, BlendCastersAreChosen) {
    Gltf gltf = masked_file();
    gltf.set("/materials/0/alphaMode", R"("BLEND")");
    const scene::Scene opaque = load(gltf, with_images);
    expect_warning(opaque, {"alphaMode BLEND (drawn opaque"});
    EXPECT_TRUE(opaque.cut_outs.empty());
    const scene::Scene mask = load(gltf, {.blend = scene::BlendCasters::mask, .decode_alpha = decoded});
    EXPECT_EQ(mask.cut_outs.materials.at(0).cutoff, 0.5f);
    EXPECT_EQ(mask.cut_outs.materials.at(0).texture, 0u);
    const scene::Scene clear = load(gltf, {.blend = scene::BlendCasters::clear, .decode_alpha = decoded});
    const scene::CutOutsView view(clear);
    const Device device;
    EXPECT_EQ(Triangles::upload(device, clear.triangles, *view.get()).cut_out_counts().clear, 1u);
}

}  // namespace
