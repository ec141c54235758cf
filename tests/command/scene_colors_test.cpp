// SPDX-License-Identifier: MIT
// What pictures take of glTF files: colours of textures and vertices, normals; and how images are decoded.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "decoded_image.hpp"
#include "gltf_file.hpp"
#include "scene/scene.hpp"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace {

using namespace gnomon;
using gltf_file::Bytes;
using gltf_file::Gltf;
using SceneColorsFile = gltf_file::SceneFile;

// Red at alpha 128, and a blue green that is clear.
constexpr const char* png_rgba =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAEUlEQVR4nGP4z8DQwNDwnwEADf8C/5BLjCgAAAAASUVORK5CYII=";
// Grey 77 at 255, grey 200 at 3.
constexpr const char* png_grey_alpha =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAQAAABeK7cBAAAADUlEQVR4nGPw/X+CGQAFyQIYs8z6fgAAAABJRU5ErkJggg==";
// 0x8080, 0, 0xFFFF above 127, 128, 0x7FFF.
constexpr const char* png_16_bits =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAACEAIAAABGc/0zAAAAFklEQVR4nGNoaGBg+P+fgaGeoaH+PwAjdQV8cRC7JQAAAABJRU5ErkJggg==";
constexpr const char* png_grey =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGPgBAAACwAKwyvukgAAAABJRU5ErkJggg==";

// Headers of 100000 x 100000 and 30000 x 30000 texels, with 64 bytes of data.
constexpr const char* png_huge =
    "iVBORw0KGgoAAAANSUhEUgABhqAAAYagCAYAAACoUgvIAAAADElEQVR4nGNgoAwAAABAAAG3NHzvAAAAAElFTkSuQmCC";
constexpr const char* png_large =
    "iVBORw0KGgoAAAANSUhEUgAAdTAAAHUwCAYAAABmJ/i6AAAADElEQVR4nGNgoAwAAABAAAG3NHzvAAAAAElFTkSuQmCC";

int decoded_images = 0;

scene::ColorImage decoded(std::span<const unsigned char> bytes, std::uint64_t max_bytes) {
#ifdef __SANITIZE_ADDRESS__
    const __lsan::ScopedDisabler disabled;  // as in scene_cut_outs_test.cpp
#endif
    ++decoded_images;
    app::RgbaImage image = app::read_colors(bytes, max_bytes);
    return {image.width, image.height, std::move(image.rgba)};
}
scene::SceneCutOuts::Texture alpha_decoded(std::span<const unsigned char> bytes) {
    app::AlphaImage image = app::read_alpha(bytes);
    return {image.width, image.height, std::move(image.alpha)};
}
const scene::LoadOptions with_colors{.decode_alpha = alpha_decoded, .decode_colors = decoded};

Gltf textured_file(const char* png = png_rgba) {
    Gltf gltf = gltf_file::triangle_file();
    gltf.accessor(gltf.view_of(std::vector<float>{0, 0, 1, 0, 0.25f, 1}), gltf_file::f32, 3, "VEC2");
    gltf.set("/meshes/0/primitives/0", R"({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0})");
    gltf.set("/materials", R"([{"name": "bark", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])");
    gltf.set("/textures", R"([{"source": 0, "sampler": 0}])");
    gltf.set("/samplers", R"([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}])");
    gltf.set("/images", R"([{"uri": "data:image/png;base64,)" + std::string(png) + "\"}]");
    return gltf;
}

TEST_F(SceneColorsFile, ATextureIsLoaded) {
    const scene::Scene scene = load(textured_file(), with_colors);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_TRUE(scene.cut_outs.empty());
    EXPECT_EQ(scene.texture_coordinates, (std::vector<float>{0, 0, 1, 0, 0.25f, 1}));
    ASSERT_EQ(scene.colors.texture_uses.size(), 1u);
    const ColorTextureUse& use = scene.colors.texture_uses[0];
    EXPECT_EQ(use.wrap_u, TextureWrap::clamp);
    EXPECT_EQ(use.wrap_v, TextureWrap::mirror);
    EXPECT_EQ(use.filter, TextureFilter::nearest);
    EXPECT_FALSE(use.weigh_by_alpha);
    ASSERT_EQ(use.texture, 0u);
    const scene::ColorImage& image = scene.colors.images->at(0);
    EXPECT_EQ(image.width, 2u);
    EXPECT_EQ(image.rgba, (std::vector<std::uint8_t>{255, 0, 0, 128, 0, 128, 255, 0}));  // not multiplied by alpha
    const scene::Scene without = load(textured_file());
    EXPECT_TRUE(without.colors.texture_uses.empty() && without.texture_coordinates.empty());
    EXPECT_TRUE(without.warnings.empty());
}

TEST_F(SceneColorsFile, MinificationIsThatOfTheSampler) {
    const auto of = [&](const std::string& sampler) {
        Gltf gltf = textured_file();
        gltf.set("/samplers", "[{" + sampler + "}]");
        return load(gltf, with_colors).colors.texture_uses.at(0).minification;
    };
    EXPECT_EQ(of(R"("minFilter": 9728)"), TextureMinification::nearest);
    EXPECT_EQ(of(R"("minFilter": 9729)"), TextureMinification::linear);
    for (int with_levels = 9984; with_levels <= 9987; ++with_levels)
        EXPECT_EQ(of("\"minFilter\": " + std::to_string(with_levels)), TextureMinification::mean);
    EXPECT_EQ(of(R"("magFilter": 9728)"), TextureMinification::mean);
}

TEST_F(SceneColorsFile, ImagesOfAllKindsGiveRgba) {
    const auto rgba = [&](const char* png) { return load(textured_file(png), with_colors).colors.images->at(0).rgba; };
    EXPECT_EQ(rgba(png_grey_alpha), (std::vector<std::uint8_t>{77, 77, 77, 255, 200, 200, 200, 3}));
    EXPECT_EQ(rgba(png_16_bits), (std::vector<std::uint8_t>{128, 0, 255, 255, 0, 0, 127, 255}));
    EXPECT_EQ(rgba(png_grey), (std::vector<std::uint8_t>{9, 9, 9, 255}));
}

/// One image, one decoding, for a mask and two materials; the alpha is that of the alpha's own decoder.
TEST_F(SceneColorsFile, AnImageIsDecodedOnceForAlphaAndColours) {
    Gltf gltf = textured_file();
    gltf.set("/materials", R"([{"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}},
                               {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])");
    gltf.set("/meshes/0/primitives",
             R"([{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0},
                 {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 1}])");
    decoded_images = 0;
    const scene::Scene both = load(gltf, with_colors), alone = load(gltf, {.decode_alpha = alpha_decoded});
    EXPECT_EQ(decoded_images, 1);
    EXPECT_EQ(both.cut_outs.textures.at(0).alpha, alone.cut_outs.textures.at(0).alpha);
    EXPECT_EQ(both.cut_outs.textures.at(0).alpha, (std::vector<std::uint8_t>{128, 0}));
    EXPECT_EQ(both.cut_outs.material_of_triangle, alone.cut_outs.material_of_triangle);
    EXPECT_EQ(both.cut_outs.material_of_triangle, (std::vector<std::uint32_t>{0, no_cut_out}));
    EXPECT_TRUE(both.colors.texture_uses[0].weigh_by_alpha);
    EXPECT_FALSE(both.colors.texture_uses[1].weigh_by_alpha);
    EXPECT_EQ(both.colors.images->size(), 1u);
}

TEST_F(SceneColorsFile, WhatCannotBeReadIsLeftOutWithAWarning) {
    for (const char* image : {R"({"uri": "data:image/png;base64,AAAA"})", R"({"uri": "missing.png"})", R"({})",
                              R"({"bufferView": 77})", R"({"uri": "https://example.org/bark.png"})"}) {
        Gltf gltf = textured_file();
        gltf.set("/images/0", image);
        const scene::Scene scene = load(gltf, with_colors);
        expect_warning(scene, {"base colour texture of material 'bark'", "left out"});
        EXPECT_EQ(scene.colors.texture_uses.at(0).texture, no_texture) << image;
        EXPECT_TRUE(load(gltf).warnings.empty()) << "without a picture nobody misses it";
    }
    Gltf ktx = textured_file();
    ktx.set("/textures/0", R"({"extensions": {"KHR_texture_basisu": {"source": 0}}})");
    expect_warning(load(ktx, with_colors), {"KTX2", "left out"});
    // 8 bytes of texels into a budget of 7.
    EXPECT_THROW(app::read_colors({}, 7), Error);
    Gltf wrong = textured_file();
    wrong.set("/accessors/1/type", R"("VEC3")").set("/accessors/1/count", "2");
    expect_warning(load(wrong, with_colors), {"TEXCOORD_0", "wrong type or length"});
}

// Neither decoder takes memory for what a header promises.
TEST_F(SceneColorsFile, ImagesThatPromiseTooMuchAreLeftOut) {
    for (const char* const png : {png_huge, png_large}) {
        const scene::Scene scene = load(textured_file(png), with_colors);
        expect_warning(scene, {"base colour texture of material 'bark'", "left out", "are more than 2^28"});
        EXPECT_EQ(scene.colors.texture_uses.at(0).texture, no_texture);
        Gltf masked = textured_file(png);
        masked.set("/materials/0/alphaMode", R"("MASK")");
        expect_warning(load(masked, {.decode_alpha = alpha_decoded}),
                       {"alphaMode MASK", "drawn opaque", "more than 2^28"});
    }
}

TEST_F(SceneColorsFile, TextureTransformsAndSetsAreTaken) {
    Gltf gltf = textured_file();
    gltf.set("/extensionsUsed", R"(["KHR_texture_transform"])");
    gltf.set("/materials/0/pbrMetallicRoughness/baseColorTexture/extensions",
             R"({"KHR_texture_transform": {"offset": [0.5, 0], "scale": [3, 5], "texCoord": 1}})");
    gltf.accessor(gltf.view_of(std::vector<std::uint8_t>{0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0}), gltf_file::u8, 3,
                  "VEC2");
    gltf.set("/accessors/2/normalized", "true").set("/bufferViews/2/byteStride", "4");
    gltf.set("/meshes/0/primitives/0/attributes/TEXCOORD_1", "2");
    const scene::Scene scene = load(gltf, with_colors);
    EXPECT_EQ(scene.texture_coordinates, (std::vector<float>{0.5f, 0, 3.5f, 0, 0.5f, 5}));
}

TEST_F(SceneColorsFile, VertexColoursAreLinearFactors) {
    Gltf gltf = gltf_file::triangle_file();
    gltf.accessor(gltf.view_of(std::vector<std::uint16_t>{65535, 0, 13107, 0, 65535, 0, 0, 0, 0}), gltf_file::u16, 3,
                  "VEC3");
    gltf.set("/accessors/1/normalized", "true");
    gltf.set("/meshes/0/primitives/0/attributes/COLOR_0", "1");
    const scene::Scene scene = load(gltf, with_colors);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.colors.corner_colors, (std::vector<float>{1, 0, 0.2f, 0, 1, 0, 0, 0, 0}));
    EXPECT_TRUE(load(gltf).colors.corner_colors.empty());
}

/// A plane x + y = 1 stretched by two along x is x / 2 + y = 1: its normal (1, 1) becomes (1, 2). A mirror gives the
/// other side, which the eye corrects.
TEST_F(SceneColorsFile, NormalsFollowTheirPlanes) {
    const auto normals = [&](const std::string& node, Float3 n) {
        Gltf gltf = gltf_file::triangle_file();
        gltf.accessor(gltf.view_of(std::vector<float>{n[0], n[1], n[2], n[0], n[1], n[2], n[0], n[1], n[2]}),
                      gltf_file::f32, 3, "VEC3");
        gltf.set("/meshes/0/primitives/0/attributes/NORMAL", "1");
        gltf.set("/nodes/0", node);
        return load(gltf, with_colors).colors.corner_normals;
    };
    const auto all = [](Float3 n) { return std::vector<std::uint32_t>(3, pack_normal(n)); };
    EXPECT_EQ(normals(R"({"mesh": 0})", {3, 4, 0}), all({3, 4, 0}));
    EXPECT_EQ(normals(R"({"mesh": 0, "scale": [2, 1, 1]})", {1, 1, 0}), all({1, 2, 0}));
    EXPECT_EQ(normals(R"({"mesh": 0, "scale": [-1, 1, 1]})", {1, 1, 0}), all({1, -1, 0}));
    EXPECT_EQ(normals(R"({"mesh": 0, "translation": [9, 9, 9], "rotation": [0, 0, 0.7071067811865476,
                          0.7071067811865476]})",
                      {1, 0, 0}),
              all({0, 1, 0}));
    EXPECT_EQ(normals(R"({"mesh": 0})", {0, 0, 0}), std::vector<std::uint32_t>(3, 0));
}

}  // namespace
