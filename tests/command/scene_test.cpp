// SPDX-License-Identifier: MIT
// The scene room: each feature on a glTF file of a few triangles, written here byte by byte; each bad input with the
// sentence it must give; the built-in sundial; and the real scenes where they are at hand.
// Expected triangles are written down by hand or come from exact arithmetic (float products in long double are exact).
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gltf_file.hpp"

namespace {

using namespace gltf_file;

constexpr float infinity = std::numeric_limits<float>::infinity();

// ---- Containers and buffers -----------------------------------------------------------------------------------------

TEST_F(SceneFile, LoadsGltfWithDataUri) {
    Gltf gltf = triangle_file();
    const Scene scene = load(gltf);
    EXPECT_EQ(scene.triangles, one_triangle);
    EXPECT_EQ(scene.warnings, std::vector<std::string>{});
}

TEST_F(SceneFile, LoadsDataUriOfAnyMediaType) {
    Gltf gltf = triangle_file();
    gltf.set_buffer("36", gltf.data_uri(""));
    EXPECT_EQ(load(gltf).triangles, one_triangle);
}

TEST_F(SceneFile, LoadsGlb) {
    EXPECT_EQ(gnomon::scene::load(write("scene.glb", triangle_file().glb())).triangles, one_triangle);
}

TEST_F(SceneFile, ContentsDecideNotTheName) {
    EXPECT_EQ(gnomon::scene::load(write("scene.gltf", triangle_file().glb())).triangles, one_triangle);
}

TEST_F(SceneFile, LoadsExternalBufferWithEscapedNameAndExtraBytes) {
    Gltf gltf = triangle_file();
    gltf.set_buffer("36", "my%20points+1.bin");
    Bytes longer = gltf.buffer;
    longer.resize(longer.size() + 7);
    write("my points+1.bin", longer);
    EXPECT_EQ(load(gltf).triangles, one_triangle);
}

TEST_F(SceneFile, GlbMayKeepAnotherBufferOutside) {
    Gltf gltf = triangle_file();
    gltf.set("/buffers", R"([{"byteLength": 36}, {"byteLength": 36, "uri": "two.bin"}])");
    std::vector<float> other = one_triangle;
    for (float& c : other) c += 5;
    Bytes outside;
    for (const float c : other) append(outside, c);
    write("two.bin", outside);
    gltf.add("bufferViews", R"({"buffer": 1, "byteLength": 36})");
    gltf.accessor(1, f32, 3, "VEC3");
    gltf.mesh(R"({"attributes": {"POSITION": 1}})");
    gltf.node(R"({"mesh": 1})");
    const Scene scene = gnomon::scene::load(write("scene.glb", gltf.glb()));
    ASSERT_EQ(scene.triangle_count(), 2u);
    EXPECT_TRUE(std::equal(other.begin(), other.end(), scene.triangles.begin() + 9));
}

TEST_F(SceneFile, ImagesAreNeitherNeededNorDecoded) {
    Gltf gltf = triangle_file();
    gltf.set("/images", R"([{"uri": "missing.png"}, {"uri": "data:image/png;base64,"},
                            {"uri": "data:image/png;base64,AAAA"}, {"bufferView": 0, "mimeType": "image/png"}])");
    gltf.set("/textures", R"([{"source": 0}])");
    gltf.set("/materials", R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])");
    gltf.set("/meshes/0/primitives/0/material", "0");
    const Scene scene = load(gltf);
    EXPECT_EQ(scene.triangles, one_triangle);
    EXPECT_EQ(scene.warnings, std::vector<std::string>{});
}

// ---- Primitives and accessors ---------------------------------------------------------------------------------------

std::vector<float> corners(const std::vector<int>& order) {
    std::vector<float> out;
    for (const int i : order)
        out.insert(out.end(), &five_points[3 * std::size_t(i)], &five_points[3 * std::size_t(i)] + 3);
    return out;
}

template <class T>
Gltf file_with_indices(const std::vector<T>& order) {
    Gltf gltf = indexed_file(4);
    gltf.indices(order);
    gltf.set("/meshes/0/primitives/0/indices", "2");
    return gltf;
}

TEST_F(SceneFile, AllIndexWidths) {
    Gltf narrow = file_with_indices<std::uint8_t>({4, 2, 3, 1, 0, 2});
    Gltf middle = file_with_indices<std::uint16_t>({4, 2, 3, 1, 0, 2});
    Gltf wide = file_with_indices<std::uint32_t>({4, 2, 3, 1, 0, 2});
    for (Gltf* gltf : {&narrow, &middle, &wide}) EXPECT_EQ(load(*gltf).triangles, corners({4, 2, 3, 1, 0, 2}));
}

// glTF 2.0, 3.7.2.1: a strip's triangle i is (i, i + 1 + i % 2, i + 2 - i % 2), a fan's (i + 1, i + 2, 0).
TEST_F(SceneFile, StripKeepsItsWinding) {
    Gltf gltf = indexed_file(5);
    EXPECT_EQ(load(gltf).triangles, corners({0, 1, 2, 1, 3, 2, 2, 3, 4}));
}

TEST_F(SceneFile, FanKeepsItsWinding) {
    Gltf gltf = indexed_file(6);
    EXPECT_EQ(load(gltf).triangles, corners({1, 2, 0, 2, 3, 0, 3, 4, 0}));
}

TEST_F(SceneFile, StripAndFanWithoutIndices) {
    for (const int mode : {5, 6}) {
        Gltf gltf = triangle_file(five_points);
        gltf.set("/meshes/0/primitives/0/mode", std::to_string(mode));
        EXPECT_EQ(load(gltf).triangles,
                  mode == 5 ? corners({0, 1, 2, 1, 3, 2, 2, 3, 4}) : corners({1, 2, 0, 2, 3, 0, 3, 4, 0}));
    }
}

TEST_F(SceneFile, StrideAndOffsets) {
    Gltf gltf;
    Bytes bytes(8, 0xFF);  // skipped by the accessor's offset
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) append(bytes, one_triangle[3 * i + k]);
        if (i < 2) append(bytes, std::numeric_limits<double>::quiet_NaN());  // the gap; none after the last element
    }
    gltf.view(Bytes(4, 0xFF));
    gltf.accessor(gltf.view(bytes, 20), f32, 3, "VEC3");
    gltf.set("/accessors/0/byteOffset", "8");
    gltf.mesh(R"({"attributes": {"POSITION": 0}})");
    gltf.node(R"({"mesh": 0})");
    EXPECT_EQ(load(gltf).triangles, one_triangle);
}

TEST_F(SceneFile, SparsePositionsOverABase) {
    Gltf gltf = triangle_file();
    const int indices = gltf.view_of<std::uint8_t>({0, 2}), values = gltf.view_of<float>({7, 8, 9, 4, 5, 6});
    gltf.make_sparse(0, 2, indices, u8, values);
    EXPECT_EQ(load(gltf).triangles, (std::vector<float>{7, 8, 9, 1, 0, 0, 4, 5, 6}));
}

TEST_F(SceneFile, SparsePositionsOverZeros) {
    for (const int width : {u16, u32}) {
        Gltf gltf = triangle_file();
        const int indices = width == u16 ? gltf.view_of<std::uint16_t>({99, 1}) : gltf.view_of<std::uint32_t>({99, 1});
        gltf.make_sparse(0, 1, indices, width, gltf.view_of<float>({0, 0, 0, 4, 5, 6}));
        gltf.set("/accessors/0/bufferView", "");
        gltf.set("/accessors/0/sparse/indices/byteOffset", width == u16 ? "2" : "4");
        gltf.set("/accessors/0/sparse/values/byteOffset", "12");
        EXPECT_EQ(load(gltf).triangles, (std::vector<float>{0, 0, 0, 4, 5, 6, 0, 0, 0}));
    }
}

TEST_F(SceneFile, AccessorsWithoutBufferViewAreZeros) {
    Gltf gltf = triangle_file();
    gltf.set("/accessors/0/bufferView", "");
    EXPECT_EQ(load(gltf).triangles, std::vector<float>(9, 0.0f));
}

TEST_F(SceneFile, IndicesWithoutBufferViewAreZerosAndMayBeSparse) {
    Gltf gltf = indexed_file(4, 3);
    gltf.set("/accessors/1/bufferView", "");
    EXPECT_EQ(load(gltf).triangles, corners({0, 0, 0}));
    const int indices = gltf.view_of<std::uint8_t>({1, 2});
    gltf.make_sparse(1, 2, indices, u8, gltf.view_of<std::uint16_t>({4, 3}));
    EXPECT_EQ(load(gltf).triangles, corners({0, 4, 3}));
}

TEST_F(SceneFile, IncompleteTrianglesAreLeftOutWithAWarning) {
    for (const int mode : {4, 5, 6}) {
        Gltf gltf = indexed_file(mode, mode == 4 ? 5 : 2);
        const Scene scene = load(gltf);
        EXPECT_EQ(scene.triangle_count(), mode == 4 ? 1u : 0u);
        expect_warning(scene, {"incomplete", "primitive 0 of mesh 'thing'"});
    }
}

TEST_F(SceneFile, PointsAndLinesAreLeftOutByName) {
    for (const int mode : {0, 1, 2, 3}) {
        Gltf gltf = triangle_file();
        gltf.set("/meshes/0/primitives/1", R"({"attributes": {"POSITION": 0}, "mode": )" + std::to_string(mode) + "}");
        const Scene scene = load(gltf);
        EXPECT_EQ(scene.triangles, one_triangle);
        expect_warning(scene, {"primitive 1 of mesh 'thing'", mode == 0 ? "(points)" : "(lines)"});
    }
}

// ---- Nodes and transforms -------------------------------------------------------------------------------------------

TEST_F(SceneFile, InstancesComeInNodeOrder) {
    Gltf gltf = triangle_file();
    gltf.node(R"({"mesh": 0, "translation": [10, 0, 0]})");
    gltf.node(R"({"mesh": 0, "translation": [0, 20, 0]})");
    gltf.set("/nodes/0/children", "[2, 1]");
    gltf.set("/scenes", R"([{"nodes": [0]}])");
    EXPECT_EQ(load(gltf).triangles, (std::vector<float>{0,  0,  0, 1,  0,  0, 0,  1,  0,     // node 0
                                                        0,  20, 0, 1,  20, 0, 0,  21, 0,     // node 2
                                                        10, 0,  0, 11, 0,  0, 10, 1,  0}));  // node 1
}

TEST_F(SceneFile, NestedTransformsApplyInnermostFirst) {
    Gltf gltf = triangle_file();
    // Scale by (2, 3, 4), then a quarter turn about z (x to y, y to -x), then move; the parent is a column-major matrix
    // that swaps x and z and moves by (100, 200, 300).
    gltf.set("/nodes/0/translation", "[1, 2, 3]")
        .set("/nodes/0/rotation", "[0, 0, 1, 1]")
        .set("/nodes/0/scale", "[2, 3, 4]");
    gltf.node(R"({"children": [0], "matrix": [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 100, 200, 300, 1]})");
    EXPECT_EQ(load(gltf).triangles, (std::vector<float>{103, 202, 301, 103, 204, 301, 103, 202, 298}));
}

TEST_F(SceneFile, IdentityKeepsEveryBit) {
    const float payload = std::bit_cast<float>(0x7FC12345u);
    const std::vector<float> odd{-0.0f, 0.0f, -0.0f, 1e-45f, -3e-39f, infinity, payload, -0.0f, 3e38f};
    for (const char* identity :
         {R"({"mesh": 0})", R"({"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]})",
          R"({"mesh": 0, "translation": [0, 0, -0.0], "rotation": [0, 0, -0.0, 1], "scale": [1, 1, 1]})",
          R"({"mesh": 0, "rotation": [0, 0, 0, -0.5]})"}) {
        Gltf gltf = triangle_file(odd);
        gltf.set("/nodes/0", identity);
        gltf.node(R"({"children": [0]})");
        EXPECT_TRUE(same_bits(load(gltf).triangles, odd)) << identity;
    }
}

/// Scale and translation are no float32 values, so a transform that rounds them, or the product, to float32 as well
/// differs; the last count shows that this test would notice.
TEST_F(SceneFile, PositionsAreRoundedOnce) {
    const double scale = 1.1000000000000001, move = 1234.5678901234567;
    std::vector<float> xyz;
    for (int i = 0; i < 900; ++i) xyz.push_back(float(i - 450) * 0.37f);
    Gltf gltf = triangle_file(xyz);
    gltf.set("/nodes/0/scale", "[1.1000000000000001, 1.1000000000000001, 1.1000000000000001]");
    gltf.set("/nodes/0/translation", "[1234.5678901234567, 1234.5678901234567, 1234.5678901234567]");
    const Scene scene = load(gltf);
    ASSERT_EQ(scene.triangles.size(), xyz.size());
    std::size_t differs_from_float_arithmetic = 0;
    for (std::size_t i = 0; i < xyz.size(); ++i) {
        // Exact to 64 bits; float32 keeps 24, and none of these values lies within the double's error of a tie.
        const auto expected =
            float(static_cast<long double>(xyz[i]) * static_cast<long double>(scale) + static_cast<long double>(move));
        EXPECT_EQ(scene.triangles[i], expected) << xyz[i];
        volatile float in_float = xyz[i] * float(scale);
        in_float = in_float + float(move);
        differs_from_float_arithmetic += in_float != expected;
    }
    EXPECT_GT(differs_from_float_arithmetic, 0u);
}

TEST_F(SceneFile, TransformsAreComposedInDouble) {
    // 2^40 up and 2^40 down again: float32 composition would lose the 0.25, and so would rounding between the nodes.
    Gltf gltf = triangle_file();
    gltf.set("/nodes/0/translation", "[1099511627776.25, 0, 0]");
    gltf.node(R"({"children": [0], "translation": [-1099511627776.0, 0, 0]})");
    EXPECT_EQ(load(gltf).triangles, (std::vector<float>{0.25, 0, 0, 1.25, 0, 0, 0.25, 1, 0}));
}

TEST_F(SceneFile, DegenerateTransformsAreAllowed) {
    Gltf gltf = triangle_file();
    gltf.set("/nodes/0/scale", "[0, 0, 0]").set("/nodes/0/translation", "[1, 2, 3]");
    const Scene scene = load(gltf);
    EXPECT_EQ(scene.triangles, (std::vector<float>{1, 2, 3, 1, 2, 3, 1, 2, 3}));
    EXPECT_EQ(scene.warnings, std::vector<std::string>{});
}

TEST_F(SceneFile, ShowsTheDefaultScene) {
    Gltf gltf = triangle_file();
    gltf.node(R"({"mesh": 0, "translation": [0, 0, 5]})");
    gltf.set("/scenes", R"([{"nodes": [0]}, {"nodes": [1]}])");
    EXPECT_EQ(load(gltf).triangles[2], 0.0f) << "scene 0 where none is named";
    gltf.set("/scene", "1");
    EXPECT_EQ(load(gltf).triangles[2], 5.0f);
    EXPECT_EQ(load(gltf).triangle_count(), 1u);
    gltf.set("/scene", "").set("/scenes", "");
    EXPECT_EQ(load(gltf).triangle_count(), 2u) << "all roots where there are no scenes";
}

TEST_F(SceneFile, DeepHierarchiesNeedNoStack) {
    Gltf gltf = triangle_file();
    const int depth = 200000;
    for (int i = 0; i < depth; ++i) gltf.node(R"({"translation": [0, 0, 1], "children": [)" + std::to_string(i) + "]}");
    EXPECT_EQ(load(gltf).triangles[2], float(depth));
}

TEST_F(SceneFile, ManyNodesAndTrianglesLoadQuickly) {
    std::vector<float> xyz;
    for (int i = 0; i < 30 * 9; ++i) xyz.push_back(float(i));
    Gltf gltf = triangle_file(xyz);
    for (int i = 1; i < 100000; ++i) gltf.node(R"({"mesh": 0, "translation": [1, 2, 3]})");
    const std::filesystem::path file = write(gltf);
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(gnomon::scene::load(file).triangle_count(), 3000000u);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    RecordProperty("seconds", std::to_string(seconds));
    EXPECT_LT(seconds, 30) << "something grows faster than the scene";
}

TEST_F(SceneFile, NonFiniteTrianglesKeepTheirPlaceAndAreNamed) {
    std::vector<float> xyz;
    for (int i = 0; i < 4; ++i) xyz.insert(xyz.end(), one_triangle.begin(), one_triangle.end());
    xyz[9 + 4] = std::numeric_limits<float>::quiet_NaN();
    xyz[18 + 8] = -infinity;
    Gltf gltf = triangle_file(xyz);
    Scene scene = load(gltf);
    EXPECT_TRUE(same_bits(scene.triangles, xyz));
    ASSERT_EQ(scene.warnings.size(), 1u);
    expect_warning(scene, {"2 triangles", "2 in mesh 'thing' under node 'place'"});

    // Finite vertices that leave float32's range count too, under the node that does it.
    gltf.node(R"({"name": "far", "mesh": 0, "scale": [1e39, 1, 1]})");
    scene = load(gltf);
    EXPECT_EQ(scene.triangle_count(), 8u);
    EXPECT_EQ(scene.triangles[36 + 3], infinity);
    ASSERT_EQ(scene.warnings.size(), 1u);
    expect_warning(scene,
                   {"6 triangles", "2 in mesh 'thing' under node 'place'", "4 in mesh 'thing' under node 'far'"});
}

// ---- Materials, cameras, lights -------------------------------------------------------------------------------------

TEST_F(SceneFile, Materials) {
    Gltf gltf = triangle_file();
    gltf.set("/materials",
             R"([{"name": "plain"}, {"pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 0.75, 0.1]}}])");
    gltf.set("/meshes/0/primitives",
             R"([{"attributes": {"POSITION": 0}, "material": 1}, {"attributes": {"POSITION": 0}},
                                         {"attributes": {"POSITION": 0}, "material": 0}])");
    const Scene scene = load(gltf);
    EXPECT_EQ(scene.materials.triangle_material, (std::vector<std::uint32_t>{1, 2, 0}));
    EXPECT_EQ(scene.materials.base_color, (std::vector<Float3>{{1, 1, 1}, {0.25f, 0.5f, 0.75f}, {0.8f, 0.8f, 0.8f}}));
}

TEST_F(SceneFile, PerspectiveCamera) {
    Gltf gltf = triangle_file();
    gltf.add("cameras", R"({"type": "perspective", "perspective": {"yfov": 0.75, "znear": 0.1}})");
    // A quarter turn about +Y turns -Z into -X and +X into -Z; the scale must not matter.
    gltf.node(R"({"camera": 0, "translation": [1, 2, 3], "rotation": [0, 1, 0, 1], "scale": [2, 5, 7]})");
    gltf.node(R"({"name": "front", "camera": 0})");
    const Scene scene = load(gltf);
    ASSERT_EQ(scene.cameras.size(), 2u);
    const gnomon::Camera& camera = scene.cameras[0].camera;
    EXPECT_EQ(scene.cameras[0].name, "camera 0");
    EXPECT_EQ(camera.eye, (Float3{1, 2, 3}));
    EXPECT_EQ(camera.fov_y_radians, 0.75);
    const std::array<std::array<double, 3>, 3> expected{{{0, 0, -1}, {0, 1, 0}, {-1, 0, 0}}};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(camera.right[i], expected[0][i], 1e-15);
        EXPECT_NEAR(camera.up[i], expected[1][i], 1e-15);
        EXPECT_NEAR(camera.forward[i], expected[2][i], 1e-15);
    }
    EXPECT_EQ(scene.cameras[1].name, "front");
    EXPECT_EQ(scene.cameras[1].camera.forward, (std::array<double, 3>{0, 0, -1}));
}

TEST_F(SceneFile, OrthographicAndDegenerateCamerasAreNamed) {
    Gltf gltf = triangle_file();
    gltf.add("cameras", R"({"type": "orthographic", "name": "plan",
                            "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}})");
    gltf.add("cameras", R"({"type": "perspective", "name": "flat", "perspective": {"yfov": 1, "znear": 0.1}})");
    gltf.node(R"({"camera": 0})");
    gltf.node(R"({"camera": 1, "scale": [1, 1, 0]})");
    const Scene scene = load(gltf);
    EXPECT_TRUE(scene.cameras.empty());
    expect_warning(scene, {"orthographic", "'plan'"});
    expect_warning(scene, {"degenerate", "camera 'flat'"});
}

Gltf light_file() {
    Gltf gltf = triangle_file();
    gltf.set("/extensionsUsed", R"(["KHR_lights_punctual"])");
    gltf.set("/extensions/KHR_lights_punctual/lights",
             R"([{"type": "directional", "name": "sun"}, {"type": "point"}, {"type": "spot", "spot": {}}])");
    return gltf;
}

/// A node with a light and other properties.
std::string node_with_light(int light, const std::string& others) {
    return R"({"extensions": {"KHR_lights_punctual": {"light": )" + std::to_string(light) + "}}, " + others + "}";
}

TEST_F(SceneFile, Lights) {
    Gltf gltf = light_file();
    // A turn by -90 degrees about +X turns -Z into -Y: straight down, as long as the scale along z.
    gltf.node(node_with_light(0, R"("matrix": [1, 0, 0, 0, 0, 0, -1, 0, 0, 3, 0, 0, 5, 6, 7, 1])"));
    gltf.node(node_with_light(1, R"("translation": [0.1, 2, 3])"));
    gltf.node(node_with_light(2, R"("translation": [4, 5, 6], "name": "stage")"));
    const Scene scene = load(gltf);
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].name, "sun");
    EXPECT_EQ(scene.lights[0].type, "directional");
    EXPECT_EQ(scene.lights[0].light.xyzw, (std::array<float, 4>{0, 3, 0, 0}));  // minus the direction of travel
    EXPECT_EQ(scene.lights[1].name, "light 1");
    EXPECT_EQ(scene.lights[1].type, "point");
    EXPECT_EQ(scene.lights[1].light.xyzw, (std::array<float, 4>{0.1f, 2, 3, 1}));
    EXPECT_EQ(scene.lights[2].name, "stage");
    EXPECT_EQ(scene.lights[2].type, "spot");
    EXPECT_EQ(scene.lights[2].light.xyzw, (std::array<float, 4>{4, 5, 6, 1}));
    EXPECT_EQ(scene.warnings, std::vector<std::string>{});
}

TEST_F(SceneFile, DegenerateLightIsNamed) {
    Gltf gltf = light_file();
    gltf.node(node_with_light(0, R"("scale": [0, 0, 0])"));
    const Scene scene = load(gltf);
    EXPECT_TRUE(scene.lights.empty());
    expect_warning(scene, {"degenerate", "light 'sun'"});
}

// ---- What is not supported ------------------------------------------------------------------------------------------

TEST_F(SceneFile, OneWarningNamesAllThatIsNotSupported) {
    Gltf gltf = triangle_file();
    gltf.set("/meshes/0/primitives", R"([{"attributes": {"POSITION": 0}, "material": 0},
                                         {"attributes": {"POSITION": 0}, "material": 1}])");
    gltf.set("/materials", R"([{"alphaMode": "MASK"}, {"alphaMode": "BLEND"}])");
    gltf.set("/skins", R"([{"joints": [0]}])");
    gltf.set("/nodes/0/skin", "0");
    gltf.set("/extensionsUsed", R"(["KHR_materials_unlit", "ACME_warp"])");
    const Scene scene = load(gltf);
    EXPECT_EQ(scene.triangle_count(), 2u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    expect_warning(scene, {"a skin without joints and weights", "alphaMode MASK", "alphaMode BLEND", "'ACME_warp'"});
    EXPECT_EQ(scene.warnings[0].find("KHR_materials_unlit"), std::string::npos) << "colour only";
}

// KHR_node_visibility hides a node and all nodes below it, but no camera.
TEST_F(SceneFile, HiddenNodesAreNotDrawn) {
    Gltf gltf = triangle_file();
    gltf.add("cameras", R"({"type": "perspective", "perspective": {"yfov": 0.75, "znear": 0.1}})");
    gltf.set("/extensions", R"({"KHR_lights_punctual": {"lights": [{"type": "point"}, {"type": "point"}]}})");
    gltf.set("/extensionsRequired", R"(["KHR_node_visibility"])");
    gltf.set("/nodes", R"([{"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": true}}},
        {"mesh": 0, "camera": 0, "children": [2], "extensions": {"KHR_node_visibility": {"visible": false},
                                                                 "KHR_lights_punctual": {"light": 0}}},
        {"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": true}}},
        {"extensions": {"KHR_node_visibility": {}, "KHR_lights_punctual": {"light": 1}}}])");
    gltf.set("/scenes", R"([{"nodes": [0, 1, 3]}])");
    const Scene scene = load(gltf);
    EXPECT_EQ(scene.triangle_count(), 1u);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.cameras.size(), 1u);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].name, "light 1") << "the number in the file";
    EXPECT_EQ(scene.lights[0].file_index, 1);
    gltf.set("/nodes/0/extensions/KHR_node_visibility/visible", "0");
    expect_error(gltf, {"KHR_node_visibility", "visible", "must be true or false"});
}

TEST_F(SceneFile, CamerasHaveTheNumbersOfTheFile) {
    Gltf gltf = triangle_file();
    gltf.add("cameras", R"({"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}})");
    gltf.add("cameras", R"({"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}})");
    gltf.node(R"({"camera": 0})");
    gltf.node(R"({"camera": 1})");
    const Scene scene = load(gltf);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "camera 1");
    EXPECT_EQ(scene.cameras[0].file_index, 1);
}

// 89 equal sentences are one.
TEST_F(SceneFile, EqualWarningsAreOneWithTheirParts) {
    Gltf gltf = triangle_file();
    std::string primitives, materials;
    for (int i = 0; i < 89; ++i) {
        const std::string comma = i == 0 ? "" : ",";
        primitives +=
            comma + R"({"attributes": {"POSITION": 0, "TEXCOORD_0": 0}, "material": )" + std::to_string(i) + "}";
        materials += comma + R"({"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})";
    }
    gltf.set("/meshes/0/primitives", "[" + primitives + "]");
    gltf.set("/materials", "[" + materials + "]");
    gltf.set("/textures", R"([{"source": 0}])");
    gltf.set("/images", R"([{"uri": "bark.png"}])");
    const auto image = [](std::span<const unsigned char>, std::uint64_t) { return gnomon::scene::ColorImage{}; };
    const Scene scene = load(gltf, {.decode_colors = image});
    ASSERT_EQ(scene.warnings.size(), 1u);
    expect_warning(scene, {"TEXCOORD_0 of primitive 0 of mesh 'thing'", "86 more (ignored: of the wrong type"});
    EXPECT_LT(scene.warnings[0].size(), 700u) << scene.warnings[0];
}

// A texture that is not there is an image, and its path stands once.
TEST_F(SceneFile, AMissingImageIsNamedOnce) {
    Gltf gltf = triangle_file();
    gltf.add("bufferViews", R"({"buffer": 0, "byteLength": 24})");
    gltf.accessor(1, f32, 3, "VEC2");
    gltf.set("/meshes/0/primitives", R"([{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}])");
    gltf.set("/materials", R"([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])");
    gltf.set("/textures", R"([{"source": 0}])");
    gltf.set("/images", R"([{"uri": "wood.png"}])");
    const auto image = [](std::span<const unsigned char>, std::uint64_t) { return gnomon::scene::ColorImage{}; };
    const Scene scene = load(gltf, {.decode_colors = image});
    ASSERT_EQ(scene.warnings.size(), 1u);
    expect_warning(scene, {"its image cannot be read: its file 'wood.png' does not exist"});
    EXPECT_EQ(scene.warnings[0].find("wood.png"), scene.warnings[0].rfind("wood.png"));
    EXPECT_EQ(scene.warnings[0].find("buffer"), std::string::npos);
}

// A node of Earth size moves float32 vertices: .25 m here, at triangles of 1 m. One far away, but large, does not.
TEST_F(SceneFile, NodesOfEarthSizeAreNamed) {
    Gltf gltf = triangle_file();
    gltf.set("/nodes/0/translation", "[4500001.1, 0, 5300001.1]");
    gltf.set("/nodes/0/name", R"("place")");
    expect_warning(load(gltf), {"float32 moves what lies far", "mesh 'thing' under node 'place' by up to 0.1"});
    gltf.set("/nodes/0/scale", "[1e6, 1e6, 1e6]");
    EXPECT_TRUE(load(gltf).warnings.empty());
    gltf.set("/nodes/0/scale", "[1, 1, 1]");
    gltf.set("/nodes/0/translation", "[451.1, 0, 531.1]");
    EXPECT_TRUE(load(gltf).warnings.empty());
    gltf.set("/nodes/0/translation", "[4500001, 0, 5300001.5]");  // float32 holds the sums
    EXPECT_TRUE(load(gltf).warnings.empty());
    gltf.set("/nodes/0/translation", "[4500001.1, 0, 5300001.1]");
    gltf.set("/nodes/0/scale", "[0.01, 0.01, 0.01]");  // and makes one point of the triangle
    expect_warning(load(gltf), {"float32 moves what lies far", "its triangles measure 0.01"});
}

// So are cameras and lamps, beside a mesh that float32 holds; far from a scene they move nothing that it shows.
TEST_F(SceneFile, CamerasAndLampsOfEarthSizeAreNamed) {
    Gltf gltf = triangle_file();
    gltf.set("/extensionsUsed", R"(["KHR_lights_punctual"])");
    gltf.set("/extensions", R"({"KHR_lights_punctual": {"lights": [{"type": "point"}, {"type": "directional"}]}})");
    gltf.set("/cameras", R"([{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}])");
    const auto nodes = [&](const std::string& mesh_at, const std::string& at) {
        gltf.set("/nodes",
                 R"([{"mesh": 0, "translation": )" + mesh_at + R"(}, {"name": "eye", "camera": 0, "translation": )" +
                     at + R"(}, {"name": "lamp", "translation": )" + at +
                     R"(, "extensions": {"KHR_lights_punctual": {"light": 0}}}, {"name": "sun", "translation": )" + at +
                     R"(, "extensions": {"KHR_lights_punctual": {"light": 1}}}])");
        gltf.set("/scenes/0/nodes", "[0, 1, 2, 3]");
    };
    nodes("[4500001, 0, 5300001]", "[4500001.201, 3, 5300001]");
    const Scene moved = load(gltf);
    ASSERT_EQ(moved.warnings.size(), 1u);
    expect_warning(moved, {"float32 moves what lies far", "camera 'eye' by 0.2, light 'lamp' by 0.2"});
    EXPECT_EQ(moved.warnings[0].find("sun"), std::string::npos);
    EXPECT_TRUE(load(gltf, {.keeps_doubles = true}).warnings.empty());
    for (const char* at : {"[4500001.5, 3, 5300001]", "[4500001, 3e9, 5300001]"}) {
        nodes("[4500001, 0, 5300001]", at);
        EXPECT_TRUE(load(gltf).warnings.empty()) << at;
    }
    nodes("[0, 0, 0]", "[3.1, 0.1, 1e8]");
    EXPECT_TRUE(load(gltf).warnings.empty());
}

// Who asks for doubles has the sums of the file's numbers, and no warning; where float32 serves there are none.
TEST_F(SceneFile, DoublesAreKeptWhereFloat32MovesVertices) {
    Gltf gltf = triangle_file();
    EXPECT_TRUE(load(gltf, {.keeps_doubles = true}).doubles.empty());
    const std::vector<float> at_origin = load(gltf).triangles;
    gltf.set("/nodes/0/translation", "[4500001.1, 0, 5300001.1]");
    EXPECT_TRUE(load(gltf).doubles.empty());
    const Scene scene = load(gltf, {.keeps_doubles = true});
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.doubles.size(), 9u);
    constexpr std::array place{4500001.1, 0.0, 5300001.1};
    for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(scene.doubles[i], double(at_origin[i]) + place[i % 3]) << i;
    gltf.set("/nodes/0/name", R"("place")");
    expect_warning(load(gltf, {.memory_bytes = 100, .keeps_doubles = true}), {"float32 moves what lies far"});
}

TEST_F(SceneFile, GlassIsNamed) {
    Gltf gltf = triangle_file();
    gltf.set("/meshes/0/primitives", R"([{"attributes": {"POSITION": 0}, "material": 0}])");
    gltf.set("/materials", R"([{"extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.5}}}])");
    expect_warning(load(gltf), {"KHR_materials_transmission (drawn opaque)"});
    gltf.set("/materials/0/extensions/KHR_materials_transmission/transmissionFactor", "0");
    EXPECT_TRUE(load(gltf).warnings.empty());
    gltf.set("/materials/0/extensions/KHR_materials_transmission", "7");
    EXPECT_TRUE(load(gltf).warnings.empty());
}

TEST_F(SceneFile, UnknownRequiredExtensionIsAnError) {
    std::vector<std::string> unknown{"ACME_warp"};
    if (!GNOMON_TEST_DRACO) unknown.emplace_back("KHR_draco_mesh_compression");
    for (const std::string& name : unknown) {
        Gltf gltf = triangle_file();
        gltf.set("/extensionsRequired", R"(["KHR_materials_unlit", ")" + name + "\"]");
        expect_error(gltf, {"requires the extension '" + name + "'"});
    }
    Gltf gltf = triangle_file();
    gltf.set("/extensionsRequired", R"(["KHR_lights_punctual", "KHR_texture_transform", "KHR_mesh_quantization",
                                        "EXT_mesh_gpu_instancing"])");
    EXPECT_EQ(load(gltf).triangles, one_triangle);
}

// What a build without the library says (GNOMON_DRACO=OFF).
TEST_F(SceneFile, CompressedWithoutFallbackIsAnError) {
    Gltf gltf = triangle_file();
    gltf.set("/meshes/0/primitives/0/extensions", R"({"KHR_draco_mesh_compression": {"bufferView": 0}})");
    gltf.set("/accessors/0/bufferView", "");
    if (!GNOMON_TEST_DRACO) expect_error(gltf, {"primitive 0 of mesh 'thing'", "KHR_draco_mesh_compression"});
}

TEST_F(SceneFile, UncompressedDataStandsInForAMissingLibrary) {
    Gltf gltf = triangle_file();
    gltf.set("/extensionsUsed", R"(["KHR_draco_mesh_compression"])");
    if (!GNOMON_TEST_DRACO)
        gltf.set("/meshes/0/primitives/0/extensions", R"({"KHR_draco_mesh_compression": {"bufferView": 0}})");
    const Scene scene = load(gltf);
    EXPECT_EQ(scene.triangles, one_triangle);
    if (!GNOMON_TEST_DRACO) expect_warning(scene, {"KHR_draco_mesh_compression (the uncompressed data is read)"});
}

TEST_F(SceneFile, NoTrianglesIsAWarning) {
    Gltf gltf;
    const Scene scene = load(gltf);
    EXPECT_EQ(scene.triangle_count(), 0u);
    expect_warning(scene, {"has no triangles"});
}

TEST_F(SceneFile, PrimitiveWithoutPositionsIsNamed) {
    Gltf gltf = triangle_file();
    gltf.set("/meshes/0/primitives/1", R"({"attributes": {"NORMAL": 0}})");
    expect_warning(load(gltf), {"primitive 1 of mesh 'thing'", "positions"});
}

// ---- Bad files ------------------------------------------------------------------------------------------------------

TEST_F(SceneFile, MissingFile) { expect_error(folder / "nowhere.glb", {"does not exist"}); }
TEST_F(SceneFile, Directory) { expect_error(folder, {"is a directory"}); }
TEST_F(SceneFile, EmptyFile) { expect_error(write("empty.glb", std::string()), {"is empty"}); }
TEST_F(SceneFile, NotAFile) { expect_error("/dev/null", {"not a regular file"}); }

TEST_F(SceneFile, NotAGltf) {
    expect_error(write("picture.glb", std::string("\x89PNG\r\n\x1a\n and so on")), {"not a glTF"});
    expect_error(write("list.gltf", std::string("[1, 2]")), {"not a glTF"});
    expect_error(write("spaces.gltf", std::string("   \n")), {"not a glTF"});
    expect_error(write("other.gltf", std::string("{\"a\": 1}")), {"asset is missing"});
}

TEST_F(SceneFile, GltfOfAnotherVersion) {
    Gltf gltf = triangle_file();
    gltf.set("/asset", R"({"version": "1.0"})");
    expect_error(gltf, {"asset.version is '1.0' and must be the text '2.0': export it as glTF 2.0"});
    gltf.set("/accessors", "{}");  // where 2.0 has an array
    expect_error(gltf, {"asset.version is '1.0'"});
    gltf.set("/accessors", "[]");
    gltf.set("/asset", R"({"version": "2.1", "minVersion": "2.1"})");
    expect_error(gltf, {"asset.minVersion", "'2.1'"});
    gltf.set("/asset", R"({"version": 2})");
    expect_error(gltf, {"asset.version is '2' and must be the text '2.0'"});
}

TEST_F(SceneFile, EveryTruncationOfAGltf) {
    Gltf gltf = triangle_file();
    const std::string text = gltf.text();
    for (std::size_t size = 2; size < text.size(); size += 5)
        expect_error(write("cut.gltf", text.substr(0, size)), {"cut off after " + std::to_string(size) + " bytes"});
}

TEST_F(SceneFile, BrokenJsonIsPlaced) {
    expect_error(write("broken.gltf", std::string("{\"asset\" {}}")), {"broken at byte 10 of 12 bytes"});
}

TEST_F(SceneFile, EveryTruncationOfAGlb) {
    const Bytes whole = triangle_file().glb();
    for (std::size_t size = 4; size < whole.size(); ++size)
        expect_error(write("cut.glb", Bytes(whole.begin(), whole.begin() + long(size))), {"the .glb is cut off"});
}

TEST_F(SceneFile, BrokenGlbHeaders) {
    const auto with = [&](std::size_t at, std::uint32_t value) {
        Bytes bytes = triangle_file().glb();
        std::memcpy(&bytes[at], &value, sizeof value);
        return write("broken.glb", bytes);
    };
    expect_error(with(4, 1), {".glb of version 1"});
    expect_error(with(8, 0xFFFFFFFF), {"cut off", "4294967295 bytes"});
    expect_error(with(8, 0), {"no JSON chunk"});
    expect_error(with(12, 0xFFFFFFF0), {"cut off", "chunk 0"});
    expect_error(with(16, 0x004E4942), {"first chunk"});
}

// Its lists are objects, by name.
TEST_F(SceneFile, OfGltf1) {
    for (const std::string version : {R"("asset": {"version": "1.0"},)", R"("asset": {"version": 0.8},)", ""}) {
        const std::string json = "{" + version + R"("meshes": {"a": {}}, "accessors": {}})";
        expect_error(write("old.gltf", Bytes(json.begin(), json.end())),
                     {"old.gltf: is glTF 1; only glTF 2.0 can be read: export it as that"});
    }
}

TEST_F(SceneFile, GlbWithoutItsBinaryChunk) {
    Gltf gltf = triangle_file();
    gltf.set_buffer("36", "");
    gltf.buffer.clear();
    expect_error(write("bare.glb", gltf.glb()), {"buffers[0] has no data"});
    gltf = triangle_file();
    gltf.set_buffer("360", "");
    expect_error(write("short.glb", gltf.glb()), {"buffers[0] needs 360 bytes", "only 36"});
}

TEST_F(SceneFile, DeepOrMonstrousJson) {
    const std::string open(100000, '['), close(100000, ']');
    expect_error(write("deep.gltf", "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + open + close + "}"),
                 {"nests deeper"});
    expect_error(write("open.gltf", "{\"extras\":" + open), {"nests deeper"});
    expect_error(write("huge.gltf", std::string("{\"asset\":{\"version\":\"2.0\"},\"extras\":1e999}")),
                 {"range of double"});
}

TEST_F(SceneFile, MissingAndShortBufferFiles) {
    Gltf gltf = triangle_file();
    gltf.set_buffer("36", "away.bin");
    expect_error(gltf, {"away.bin", "does not exist"});
    write("away.bin", Bytes(35));
    expect_error(gltf, {"buffers[0] needs 36 bytes", "away.bin", "only 35"});
    std::filesystem::create_directory(folder / "folder.bin");
    gltf.set_buffer("36", "folder.bin");
    expect_error(gltf, {"folder.bin", "is a directory"});
    gltf.set_buffer("36", "https://example.org/a.bin");
    expect_error(gltf, {"buffers[0]", "https://example.org/a.bin"});
    gltf.set_buffer("36", "a%00b.bin");
    expect_error(gltf, {"buffers[0].uri contains a zero byte"});
    gltf.set_buffer("36", "$(touch " + (folder / "pwned").string() + ")");
    expect_error(gltf, {"does not exist"});
    EXPECT_FALSE(std::filesystem::exists(folder / "pwned"));
    gltf.set_buffer("36", "");
    expect_error(gltf, {"buffers[0] has no data"});
}

TEST_F(SceneFile, BrokenDataUris) {
    Gltf gltf = triangle_file();
    const std::string good = base64(gltf.buffer);
    for (const std::string& bad : {good.substr(0, 20), good.substr(0, 20) + "!" + good.substr(21), std::string()}) {
        gltf.set_buffer("36", "data:application/octet-stream;base64," + bad);
        expect_error(gltf, {"buffers[0] needs 36 bytes", "data URI holds only"});
    }
    gltf.set_buffer("36", "data:application/octet-stream,abc");
    expect_error(gltf, {"buffers[0]", "not base64"});
    gltf.set_buffer("9000000000000000000", gltf.data_uri());
    expect_error(gltf, {"buffers[0] needs 9000000000000000000 bytes"});
}

/// A few changes of a good file (JSON pointer and new value; none: taken away), and words of the sentence they must
/// give.
struct Damage {
    const char* name;
    std::vector<std::pair<const char*, const char*>> changes;
    std::vector<std::string> words;
};

void PrintTo(const Damage& damage, std::ostream* out) { *out << damage.name; }

class DamagedScene : public SceneFile, public testing::WithParamInterface<Damage> {};

/// Something of everything: mesh 0 with sparse positions, indices and a material, node 0 with a camera, node 1 with a
/// light; and the accessors that the damages below refer to.
Gltf full_file() {
    Gltf gltf = light_file();
    gltf.indices<std::uint16_t>({0, 1, 2});           // accessor 1, view 1
    gltf.view_of<std::uint8_t>({2, 0, 0, 0});         // view 2
    gltf.view_of<float>({0, 1, 0});                   // view 3
    gltf.indices<std::uint16_t>({0, 1, 3});           // accessor 2, view 4
    gltf.indices<std::uint32_t>({0, 1, 0xFFFFFFFE});  // accessor 3, view 5
    gltf.indices<std::uint16_t>({0, 1, 0xFFFF});      // accessor 4, view 6
    gltf.view_of<std::uint8_t>({3, 0, 0, 0});         // view 7
    gltf.accessor(3, f32, 3, "SCALAR");               // accessor 5
    gltf.make_sparse(0, 1, 2, u8, 3);
    gltf.set("/meshes/0/primitives/0/indices", "1").set("/meshes/0/primitives/0/material", "0");
    gltf.add("materials", R"({"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1]}})");
    gltf.add("cameras", R"({"type": "perspective", "perspective": {"yfov": 0.75, "znear": 0.1}})");
    gltf.set("/nodes/0/camera", "0");
    gltf.node(node_with_light(2, R"("name": "lamp")"));
    gltf.add("scenes", R"({"nodes": [0, 1]})");
    return gltf;
}

TEST_F(SceneFile, TheFileThatIsDamagedBelowIsSound) {
    Gltf gltf = full_file();
    const Scene scene = load(gltf);
    EXPECT_EQ(scene.triangles, one_triangle);
    EXPECT_EQ(scene.warnings, std::vector<std::string>{});
}

TEST_P(DamagedScene, IsNamed) {
    Gltf gltf = full_file();
    for (const auto& [pointer, text] : GetParam().changes) gltf.set(pointer, text);
    expect_error(gltf, GetParam().words);
}

const std::vector<Damage> index_damages{
    {"PositionAccessor",
     {{"/meshes/0/primitives/0/attributes/POSITION", "6"}},
     {"meshes[0].primitives[0].attributes.POSITION is 6", "accessors has 6 entries"}},
    {"OtherAttribute", {{"/meshes/0/primitives/0/attributes/NORMAL", "9"}}, {"attributes.NORMAL is 9"}},
    {"IndexAccessor", {{"/meshes/0/primitives/0/indices", "77"}}, {"primitives[0].indices is 77"}},
    {"NegativeIndex", {{"/meshes/0/primitives/0/indices", "-1"}}, {"primitives[0].indices is -1"}},
    {"Material", {{"/meshes/0/primitives/0/material", "1"}}, {"primitives[0].material is 1", "materials has 1 entry"}},
    {"BufferView", {{"/accessors/0/bufferView", "50"}}, {"accessors[0].bufferView is 50"}},
    {"Buffer",
     {{"/bufferViews/0/buffer", "1"}, {"/buffers", R"([{"byteLength": 1}])"}},
     {"bufferViews[0].buffer is 1"}},
    {"WrappedIndex", {{"/nodes/0/mesh", "4294967296"}}, {"nodes[0].mesh is 4294967296"}},
    {"Mesh", {{"/nodes/0/mesh", "1"}}, {"nodes[0].mesh is 1", "meshes has 1 entry"}},
    {"MeshOfWrongType", {{"/nodes/0/mesh", "\"0\""}}, {"nodes[0].mesh must be a whole number"}},
    {"MeshNull", {{"/nodes/0/mesh", "null"}}, {"nodes[0].mesh must be a whole number"}},
    {"Camera", {{"/nodes/0/camera", "3"}}, {"nodes[0].camera is 3"}},
    {"Skin", {{"/nodes/0/skin", "0"}}, {"nodes[0].skin is 0", "skins has 0 entries"}},
    {"Light",
     {{"/nodes/1/extensions/KHR_lights_punctual/light", "3"}},
     {"nodes[1].extensions.KHR_lights_punctual.light is 3", "lights has 3 entries"}},
    {"LightMissing",
     {{"/nodes/1/extensions/KHR_lights_punctual/light", ""}},
     {"nodes[1].extensions.KHR_lights_punctual.light is missing"}},
    {"Child", {{"/nodes/0/children", "[2]"}}, {"nodes[0].children is 2"}},
    {"SceneNode", {{"/scenes/0/nodes", "[0, 5]"}}, {"scenes[0].nodes is 5"}},
    {"DefaultScene", {{"/scene", "1"}}, {"scene is 1", "scenes has 1 entry"}},
    {"SparseIndicesView",
     {{"/accessors/0/sparse/indices/bufferView", "9"}},
     {"accessors[0].sparse.indices.bufferView is 9"}},
    {"SparseValuesView",
     {{"/accessors/0/sparse/values/bufferView", "9"}},
     {"accessors[0].sparse.values.bufferView is 9"}},
};

const std::vector<Damage> extent_damages{
    {"ViewBeyondBuffer",
     {{"/bufferViews/0/byteLength", "1000"}},
     {"bufferViews[0] reads beyond its buffer", "1000 bytes"}},
    {"ViewOffsetBeyondBuffer",
     {{"/bufferViews/0/byteOffset", "1000"}},
     {"bufferViews[0] reads beyond its buffer", "from byte 1000"}},
    {"ViewOverflow",
     {{"/bufferViews/0/byteOffset", "18446744073709551612"}},
     {"bufferViews[0] reads beyond its buffer"}},
    {"AccessorBeyondView",
     {{"/accessors/0/count", "4"}},
     {"accessors[0] reads beyond its bufferView", "4 elements of 12 bytes", "has 36 bytes"}},
    {"AccessorOffset", {{"/accessors/0/byteOffset", "4"}}, {"accessors[0] reads beyond its bufferView", "from byte 4"}},
    {"AccessorOverflow",
     {{"/accessors/0/byteOffset", "18446744073709551608"}},
     {"accessors[0] reads beyond its bufferView"}},
    {"CountOverflow",  // times 12 it is 8 modulo 2^64
     {{"/accessors/0/count", "1537228672809129302"}},
     {"accessors[0] reads beyond its bufferView"}},
    {"NegativeCount", {{"/accessors/0/count", "-3"}}, {"accessors[0].count is -3", "negative"}},
    {"FractionalCount", {{"/accessors/0/count", "2.5"}}, {"accessors[0].count must be a whole number"}},
    {"CountOfWrongType", {{"/accessors/0/count", "\"3\""}}, {"accessors[0].count must be a whole number"}},
    {"CountMissing", {{"/accessors/0/count", ""}}, {"accessors[0].count is missing"}},
    {"NegativeOffset", {{"/bufferViews/0/byteOffset", "-4"}}, {"bufferViews[0].byteOffset is -4"}},
    {"NegativeLength", {{"/bufferViews/0/byteLength", "-4"}}, {"bufferViews[0].byteLength is -4"}},
    {"StrideOdd", {{"/bufferViews/0/byteStride", "13"}}, {"bufferViews[0].byteStride is 13"}},
    {"StrideHuge", {{"/bufferViews/0/byteStride", "256"}}, {"bufferViews[0].byteStride is 256"}},
    {"StrideOverlaps",
     {{"/bufferViews/0/byteStride", "8"}},
     {"accessors[0]", "12 bytes", "bufferViews[0].byteStride is only 8"}},
    {"Misaligned",
     {{"/bufferViews/0/byteOffset", "2"}, {"/bufferViews/0/byteLength", "38"}},
     {"accessors[0] is misaligned", "4-byte"}},
    {"IndicesMisaligned",
     {{"/accessors/1/byteOffset", "1"}, {"/accessors/1/count", "2"}},
     {"accessors[1] is misaligned", "2-byte"}},
    {"IndicesStrided",
     {{"/bufferViews/1/byteStride", "4"}, {"/bufferViews/1/byteLength", "12"}},
     {"accessors[1]", "byteStride of 4"}},
    {"SparseCount", {{"/accessors/0/sparse/count", "4"}}, {"accessors[0].sparse.count is 4", "at most 3"}},
    {"SparseIndicesExtent",
     {{"/accessors/0/sparse/indices/byteOffset", "4"}},
     {"accessors[0].sparse.indices reads beyond its bufferView"}},
    {"SparseValuesExtent",
     {{"/accessors/0/sparse/values/byteOffset", "4"}},
     {"accessors[0].sparse.values reads beyond its bufferView"}},
    {"SparseOffsetHuge",
     {{"/accessors/0/sparse/values/byteOffset", "4294967296"}},
     {"accessors[0].sparse.values.byteOffset is 4294967296"}},
    {"SparseIndexTooLarge",
     {{"/accessors/0/sparse/indices/bufferView", "7"}},
     {"accessors[0].sparse names element 3", "count of 3"}},
    {"SparseComponentType",
     {{"/accessors/0/sparse/indices/componentType", "5126"}},
     {"accessors[0].sparse.indices.componentType is 5126"}},
    {"SparseWithoutValues", {{"/accessors/0/sparse/values", ""}}, {"accessors[0].sparse.values is missing"}},
    {"ZerosBomb",
     {{"/accessors/0/bufferView", ""}, {"/accessors/0/count", "3000000000"}, {"/meshes/0/primitives/0/indices", ""}},
     {"accessors[0] has a count of 3000000000 but no bufferView"}},
};

const std::vector<Damage> value_damages{
    {"VertexIndex",
     {{"/meshes/0/primitives/0/indices", "2"}},
     {"primitive 0 of mesh 'thing' has the vertex index 3, but only 3 vertices"}},
    {"VertexIndexHuge", {{"/meshes/0/primitives/0/indices", "3"}}, {"vertex index 4294967294", "only 3 vertices"}},
    {"PrimitiveRestart", {{"/meshes/0/primitives/0/indices", "4"}}, {"vertex index 65535", "primitive-restart"}},
    {"IndicesOfFloats",
     {{"/meshes/0/primitives/0/indices", "5"}},
     {"indices of primitive 0 of mesh 'thing'", "not unsigned"}},
    {"PositionsNotVec3", {{"/accessors/0/type", "\"VEC2\""}}, {"positions of primitive 0 of mesh 'thing'", "not VEC3"}},
    {"ComponentType", {{"/accessors/0/componentType", "5130"}}, {"accessors[0].componentType is 5130"}},
    {"AccessorType", {{"/accessors/0/type", "\"VEC5\""}}, {"accessors[0].type is 'VEC5'"}},
    {"Mode", {{"/meshes/0/primitives/0/mode", "7"}}, {"meshes[0].primitives[0].mode is 7"}},
    {"NoAttributes", {{"/meshes/0/primitives/0/attributes", ""}}, {"primitives[0].attributes is missing"}},
    {"NoPrimitives", {{"/meshes/0/primitives", ""}}, {"meshes[0].primitives is missing"}},
    {"Rotation", {{"/nodes/0/rotation", "[0, 0, 0, 0]"}}, {"rotation of node 'place'"}},
    {"RotationLength", {{"/nodes/0/rotation", "[0, 0, 1]"}}, {"nodes[0].rotation must be 4 numbers"}},
    {"Translation", {{"/nodes/0/translation", "[0, \"a\", 1]"}}, {"nodes[0].translation must be 3 numbers"}},
    {"Matrix", {{"/nodes/0/matrix", "[1, 2, 3]"}}, {"nodes[0].matrix must be 16 numbers"}},
    {"MatrixNotAffine",
     {{"/nodes/0/matrix", "[1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]"}},
     {"nodes[0].matrix is not affine"}},
    {"MatrixBesideScale",
     {{"/nodes/0/matrix", "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]"}, {"/nodes/0/scale", "[1, 1, 1]"}},
     {"nodes[0].matrix stands beside"}},
    {"FieldOfView", {{"/cameras/0/perspective/yfov", "4"}}, {"cameras[0].perspective.yfov is 4"}},
    {"CameraType", {{"/cameras/0/type", "\"fisheye\""}}, {"cameras[0].type is 'fisheye'"}},
    {"CameraBody", {{"/cameras/0/perspective", ""}}, {"cameras[0].perspective is missing"}},
    {"LightType", {{"/extensions/KHR_lights_punctual/lights/0/type", "\"area\""}}, {"lights[0].type is 'area'"}},
    {"BaseColor",
     {{"/materials/0/pbrMetallicRoughness/baseColorFactor", "[1, 1, 1]"}},
     {"materials[0].pbrMetallicRoughness.baseColorFactor must be 4 numbers"}},
    {"AlphaMode", {{"/materials/0/alphaMode", "\"GLASS\""}}, {"materials[0].alphaMode is 'GLASS'"}},
    {"NodesNotAnArray", {{"/nodes", "{}"}}, {"nodes must be an array"}},
    {"NodeNotAnObject", {{"/nodes/1", "5"}}, {"nodes[1] must be an object"}},
    {"ExtensionList", {{"/extensionsRequired", "[1]"}}, {"extensionsRequired must hold strings"}},
};

const std::vector<Damage> hierarchy_damages{
    {"OwnChild", {{"/nodes/0/children", "[0]"}}, {"nodes[0] 'place' is its own ancestor"}},
    {"Cycle",  // found although the scene does not reach it
     {{"/nodes", R"([{"children": [1]}, {"children": [2]}, {"children": [0]}, {"mesh": 0}])"},
      {"/scenes/0/nodes", "[3]"}},
     {"is its own ancestor", "cycle"}},
    {"TwoParents",
     {{"/nodes", R"([{"children": [2]}, {"children": [2]}, {"name": "shared"}])"}},
     {"nodes[2] 'shared' is a child twice", "nodes[0]", "nodes[1]"}},
    {"ChildListedTwice", {{"/nodes/0/children", "[1, 1]"}}, {"nodes[1] 'lamp' is a child twice"}},
    {"RootIsAChild", {{"/nodes/0/children", "[1]"}}, {"scenes[0] lists nodes[1] 'lamp' as a root"}},
    {"RootTwice", {{"/scenes/0/nodes", "[0, 0]"}}, {"scenes[0] lists nodes[0] 'place' twice"}},
};

const auto damage_name = [](const auto& info) { return std::string(info.param.name); };
INSTANTIATE_TEST_SUITE_P(Index, DamagedScene, testing::ValuesIn(index_damages), damage_name);
INSTANTIATE_TEST_SUITE_P(Extent, DamagedScene, testing::ValuesIn(extent_damages), damage_name);
INSTANTIATE_TEST_SUITE_P(Value, DamagedScene, testing::ValuesIn(value_damages), damage_name);
INSTANTIATE_TEST_SUITE_P(Hierarchy, DamagedScene, testing::ValuesIn(hierarchy_damages), damage_name);

TEST_F(SceneFile, InstancesOfInstancesAreCountedBeforeTheyAreMade) {
    // 9 million vertices of zeros cost nothing; drawn by a thousand nodes they are 120 GB from a file of 20 KB.
    constexpr std::uint64_t memory_bytes = std::uint64_t(64) << 30;
    Gltf gltf = triangle_file();
    gltf.set("/accessors/0/bufferView", "").set("/accessors/0/count", "9000000");
    for (int i = 0; i < 1000; ++i) gltf.node(R"({"mesh": 0})");
    expect_error(gltf, {"3003000000 triangles", "need 114658 MiB, more than the 65536 MiB"}, memory_bytes);
    for (int i = 0; i < 1000; ++i) gltf.node(R"({"mesh": 0})");
    expect_error(gltf, {"6003000000 triangles with its instances", "32-bit triangle ids"});
}

TEST_F(SceneFile, EveryDamagedByteOfAGlbIsSurvived) {
    // Whatever a byte becomes: a scene or a SceneError, nothing else (and nothing for the sanitizers).
    const Bytes whole = full_file().glb();
    std::size_t loaded = 0;
    for (std::size_t at = 0; at < whole.size(); ++at)
        for (const unsigned char value : {0x00, 0x22, 0x2D, 0x39, 0x5B, 0xFF}) {
            Bytes bytes = whole;
            bytes[at] = value;
            const std::filesystem::path file = write("damaged.glb", bytes);
            try {
                gnomon::scene::load(file);
                ++loaded;
            } catch (const SceneError& error) {
                EXPECT_TRUE(std::string(error.what()).starts_with(file.string() + ": ")) << error.what();
            }
        }
    EXPECT_GT(loaded, 0u);
}

// ---- The built-in scene and the defaults ----------------------------------------------------------------------------

using Corner = std::array<std::uint32_t, 3>;

TEST(Sundial, HasWhatTheCommandNeeds) {
    const Scene scene = gnomon::scene::sundial();
    EXPECT_GE(scene.triangle_count(), 5000u);
    EXPECT_LE(scene.triangle_count(), 50000u);
    EXPECT_EQ(scene.materials.triangle_material.size(), scene.triangle_count());
    for (const std::uint32_t material : scene.materials.triangle_material)
        ASSERT_LT(material, scene.materials.base_color.size());
    for (const float c : scene.triangles) ASSERT_TRUE(std::isfinite(c));
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "default");
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].name, "sun");
    EXPECT_TRUE(scene.lights[0].light.is_directional());
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_TRUE(same_bits(scene.triangles, gnomon::scene::sundial().triangles));
}

/// Closed and consistently wound: every directed edge is met by as many opposite ones, after rounding.
TEST(Sundial, SolidsAreClosed) {
    const Scene scene = gnomon::scene::sundial();
    std::map<std::pair<Corner, Corner>, int> balance;
    for (std::size_t t = 0; t < scene.triangle_count(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            Corner a, b;
            std::memcpy(a.data(), &scene.triangles[9 * t + 3 * k], sizeof a);
            std::memcpy(b.data(), &scene.triangles[9 * t + 3 * ((k + 1) % 3)], sizeof b);
            ASSERT_NE(a, b) << "triangle " << t << " is degenerate";
            a < b ? ++balance[{a, b}] : --balance[{b, a}];
        }
    for (const auto& [edge, difference] : balance) ASSERT_EQ(difference, 0);
}

/// Outward: by the divergence theorem the solids' volumes are positive. The lawn alone, a 64-gon of radius 60 and depth
/// 0.44, has n/2 r^2 sin(2 pi / n) h = 4970 m^3; inward winding would turn the sign, a hole would change the sum.
TEST(Sundial, SolidsAreWoundOutwards) {
    const Scene scene = gnomon::scene::sundial();
    std::map<std::uint32_t, double> volume;
    for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
        const float* v = &scene.triangles[9 * t];
        const double det = double(v[0]) * (double(v[4]) * v[8] - double(v[5]) * v[7]) -
                           double(v[1]) * (double(v[3]) * v[8] - double(v[5]) * v[6]) +
                           double(v[2]) * (double(v[3]) * v[7] - double(v[4]) * v[6]);
        volume[scene.materials.triangle_material[t]] += det / 6;
    }
    for (const auto& [material, cubic_metres] : volume) EXPECT_GT(cubic_metres, 0) << "material " << material;
    EXPECT_NEAR(volume[0], 32 * 3600 * std::sin(2 * 3.14159265358979 / 64) * 0.44, 0.01);
}

/// From the octahedral map, as pack_normal() makes it.
std::array<double, 3> unpacked(std::uint32_t bits) {
    const auto part = [](std::uint32_t word) { return (double(word) - 32768) / 32767; };
    std::array<double, 3> n{part(bits & 0xFFFFu), part(bits >> 16), 0};
    n[2] = 1 - std::abs(n[0]) - std::abs(n[1]);
    const double fold = std::max(-n[2], 0.0);
    for (int i = 0; i < 2; ++i) n[i] += n[i] >= 0 ? -fold : fold;
    const double size = std::hypot(n[0], n[1], n[2]);
    for (double& c : n) c /= size;
    return n;
}

/// The normals of the golden ball point away from its centre, also where its facets do not; the lawn has none.
TEST(Sundial, WhatIsRoundHasNormals) {
    const Scene scene = gnomon::scene::sundial();
    const std::vector<std::uint32_t>& normals = scene.colors.corner_normals;
    ASSERT_EQ(normals.size(), 3 * scene.triangle_count());
    std::array<double, 3> low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    std::vector<std::size_t> of_ball;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const std::uint32_t material = scene.materials.triangle_material[i / 3];
        if (material == 0 && scene.triangles[9 * (i / 3) + 1] == scene.triangles[9 * (i / 3) + 4] &&
            scene.triangles[9 * (i / 3) + 1] == scene.triangles[9 * (i / 3) + 7]) {
            EXPECT_EQ(normals[i], 0u);
        }
        if (material != 10 || scene.triangles[3 * i + 1] < 1.8f) continue;
        of_ball.push_back(i);
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min<double>(low[k], scene.triangles[3 * i + k]);
            high[k] = std::max<double>(high[k], scene.triangles[3 * i + k]);
        }
    }
    ASSERT_GT(of_ball.size(), 1000u);
    for (const std::size_t i : of_ball) {
        const std::array<double, 3> n = unpacked(normals[i]);
        double along = 0, squared = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double from_centre = scene.triangles[3 * i + k] - (low[k] + high[k]) / 2;
            along += n[k] * from_centre;
            squared += from_centre * from_centre;
        }
        EXPECT_GT(along / std::sqrt(squared), 0.999) << "corner " << i;
    }
}

/// The dial tells the time: the style's tip casts its shadow onto the line of half past three. The hour line of a
/// horizontal dial is tan(line) = sin(latitude) tan(15 degrees * hours), which the scene uses for its bars but not for
/// its sun.
TEST(Sundial, TellsHalfPastThree) {
    const Scene scene = gnomon::scene::sundial();
    const std::array<float, 4> toward = scene.lights[0].light.xyzw;
    EXPECT_GT(toward[1], 0) << "the sun is up";
    const double latitude = 50 * 3.14159265358979 / 180;
    // From the foot of the style, one metre north and tan(latitude) up, then along the light down to the plate.
    const double t = std::tan(latitude) / toward[1];
    const double east = -t * toward[0], north = 1 + t * toward[2];
    EXPECT_NEAR(std::atan2(east, north), std::atan(std::sin(latitude) * std::tan(3.5 * 15 * 3.14159265358979 / 180)),
                1e-6);
}

TEST(Defaults, FramingCameraSeesEveryVertex) {
    const std::vector<std::pair<Float3, float>> boxes{
        {{0, 0, 0}, 1.0f}, {{1e6f, -2e6f, 3e5f}, 10.0f}, {{1e6f, 0, 0}, 0.0f}, {{0, 0, 0}, 1e-20f}, {{5, 5, 5}, 1e30f}};
    for (const auto& [center, size] : boxes) {
        Scene scene;
        // Nine corners (one twice) of the box, so the bound is met and not only kept.
        for (int v = 0; v < 9; ++v)
            for (int i = 0; i < 3; ++i)
                scene.triangles.push_back(center[std::size_t(i)] + ((v >> i & 1) != 0 ? size : -size));
        const std::vector<float> finite = scene.triangles;
        scene.triangles.insert(scene.triangles.end(), {infinity, 0, 0, 1e35f, 0, 0, 0, 0, 0});  // must not count
        const gnomon::Camera camera = gnomon::scene::framing_camera(scene);
        EXPECT_NEAR(camera.fov_y_radians, 50 * 3.14159265358979 / 180, 1e-12);
        for (std::size_t v = 0; v < finite.size(); v += 3) {
            double x = 0, y = 0, z = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                const double d = double(finite[v + i]) - camera.eye[i];
                x += d * camera.right[i];
                y += d * camera.up[i];
                z += d * camera.forward[i];
            }
            EXPECT_GT(z, 0) << size;
            EXPECT_LE(std::fabs(x), z * std::tan(camera.fov_y_radians / 2)) << size;
            EXPECT_LE(std::fabs(y), z * std::tan(camera.fov_y_radians / 2)) << size;
        }
    }
    EXPECT_TRUE(std::isfinite(gnomon::scene::framing_camera({}).eye[0])) << "an empty scene has a camera too";
}

/// How much of the picture's width and height the box of projected vertices takes, and where its middle lies (0: in the
/// middle of the picture), for a picture of this aspect.
struct Shown {
    double width, height, middle_x, middle_y;
};
Shown shown(const gnomon::Camera& camera, const std::vector<float>& vertices, double aspect) {
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    const double slope = std::tan(camera.fov_y_radians / 2);
    for (std::size_t v = 0; v < vertices.size(); v += 3) {
        double p[3] = {};
        for (std::size_t i = 0; i < 3; ++i) {
            const double d = double(vertices[v + i]) - double(camera.eye[i]);
            p[0] += d * camera.right[i] / (slope * aspect);
            p[1] += d * camera.up[i] / slope;
            p[2] += d * camera.forward[i];
        }
        for (int i = 0; i < 2; ++i) {
            low[i] = std::min(low[i], p[i] / p[2]);
            high[i] = std::max(high[i], p[i] / p[2]);
        }
    }
    return {(high[0] - low[0]) / 2, (high[1] - low[1]) / 2, (high[0] + low[0]) / 2, (high[1] + low[1]) / 2};
}

std::vector<float> cuboid(const Float3& low, const Float3& high) {
    std::vector<float> triangles;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const bool is_high : {false, true})
            for (const auto& order : {std::array{0, 1, 2}, std::array{0, 2, 3}})
                for (std::size_t k = 0; k < 3; ++k) {
                    const int corner = order[is_high ? k : 2 - k];
                    const bool at[3] = {is_high, corner == 1 || corner == 2, corner >= 2};
                    for (std::size_t c = 0; c < 3; ++c) triangles.push_back(at[(c + 3 - axis) % 3] ? high[c] : low[c]);
                }
    return triangles;
}

std::vector<float> together(std::vector<float> a, const std::vector<float>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

// The box of what is to be seen takes 60 to 95 % of one side of the picture, is inside of it and in its middle.
TEST(DefaultCamera, FillsThePicture) {
    const std::vector<float> cube = cuboid({-1, 0, -1}, {1, 2, 1});
    const std::vector<float> far_off = cuboid({899, 0, -1}, {901, 2, 1});
    const std::vector<float> ground = cuboid({-50, -0.01f, -50}, {50, 0, 50});
    const struct {
        const char* name;
        std::vector<float> content, beside;
    } cases[] = {
        {"a cube", cube, {}},
        {"on wide ground", cube, ground},
        {"a tower", cuboid({0, 0, 0}, {1, 50, 1}), {}},
        {"a wide plate", cuboid({0, 0, 0}, {100, 0.1f, 60}), {}},
        {"a plane", cuboid({-3, 0, -3}, {3, 0, 3}), {}},
        {"a wall to the east", cuboid({0, 0, -5}, {0, 3, 5}), {}},
        {"a wall to the north", cuboid({-5, 0, 0}, {5, 3, 0}), {}},
        {"a wall seen edge-on from the first viewer", {0, 0, 0, 8, 0, 10, 8, 5, 10, 0, 0, 0, 8, 5, 10, 0, 5, 0}, {}},
        {"a long thing", cuboid({-500, 0, 0}, {500, 1, 1}), {}},
        {"two things far apart", together(cube, far_off), {}},
        {"small and far from the origin", cuboid({1000, 1000, 1000}, {1001, 1001, 1001}), {}},
        {"small and farther from the origin", cuboid({1e5f, 0, 1e5f}, {1e5f + 2, 2, 1e5f + 2}), {}},
        {"a house at 400 km", cuboid({4e5f, 0, 4e5f}, {4e5f + 10, 8, 4e5f + 10}), {}},
        {"a grain", cuboid({0, 0, 0}, {1e-5f, 1e-5f, 1e-5f}), {}},
        {"ground alone", ground, {}},
        {"Earth-size", cuboid({4.5e6f, 0, 5.3e6f}, {4.6e6f, 1e4f, 5.4e6f}), {}},
    };
    for (const double aspect : {16.0 / 9, 1.0, 0.5})
        for (const auto& [name, content, beside] : cases) {
            Scene scene;
            scene.triangles = together(content, beside);
            const Shown box = shown(gnomon::scene::framing_camera(scene, aspect), content, aspect);
            EXPECT_GE(std::max(box.width, box.height), 0.6) << name << ' ' << aspect;
            EXPECT_LE(std::max(box.width, box.height), 0.95) << name << ' ' << aspect;
            EXPECT_LT(std::abs(box.middle_x), 0.06) << name << ' ' << aspect;
            EXPECT_LT(std::abs(box.middle_y), 0.06) << name << ' ' << aspect;
            EXPECT_GE(std::min(box.width, box.height), 0.005) << name << ": not edge-on";
        }
}

/// Turned about the axis y, then about x, by these angles in degrees.
std::vector<float> turned(std::vector<float> triangles, double about_y, double about_x = 0) {
    const double y = about_y * 3.14159265358979 / 180, x = about_x * 3.14159265358979 / 180;
    for (std::size_t v = 0; v < triangles.size(); v += 3) {
        const double px = triangles[v], py = triangles[v + 1], pz = triangles[v + 2];
        const double qx = px * std::cos(y) + pz * std::sin(y), qz = -px * std::sin(y) + pz * std::cos(y);
        triangles[v] = float(qx);
        triangles[v + 1] = float(py * std::cos(x) - qz * std::sin(x));
        triangles[v + 2] = float(py * std::sin(x) + qz * std::cos(x));
    }
    return triangles;
}

/// A square of 100 x 100 quads, 1 each, around the axis y: their heights are height(x, z).
std::vector<float> landscape(const std::function<double(double, double)>& height) {
    std::vector<float> triangles;
    for (int i = -50; i < 50; ++i)
        for (int j = -50; j < 50; ++j)
            for (const auto& [x, z] : {std::pair{0, 0}, {0, 1}, {1, 1}, {0, 0}, {1, 1}, {1, 0}})
                triangles.insert(triangles.end(), {float(i + x), float(height(i + x, j + z)), float(j + z)});
    return triangles;
}

/// Whether a triangle of these lies between the eye and the point.
bool is_hidden(const gnomon::Camera& camera, const Float3& point, const std::vector<float>& triangles) {
    const auto side = [](const double* a, const double* b, const double* c) {
        return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    };
    for (std::size_t t = 0; t < triangles.size(); t += 9) {
        double p[4][3];  // of the triangle's corners and the point, from the eye
        for (std::size_t i = 0; i < 12; ++i)
            p[i / 3][i % 3] = double(i < 9 ? triangles[t + i] : point[i - 9]) - double(camera.eye[i % 3]);
        const double e[3] = {side(p[0], p[1], p[3]), side(p[1], p[2], p[3]), side(p[2], p[0], p[3])};
        const double volume = side(p[0], p[1], p[2]), sum = e[0] + e[1] + e[2];
        const bool is_through = (e[0] > 0 && e[1] > 0 && e[2] > 0) || (e[0] < 0 && e[1] < 0 && e[2] < 0);
        if (is_through && volume / sum > 0 && volume / sum < 1) return true;
    }
    return false;
}

// What is wide or far does not make the content a speck, and does not hide it.
TEST(DefaultCamera, FillsThePictureBesideWallsAndStrays) {
    const std::vector<float> cube = cuboid({-1, 0, -1}, {1, 2, 1});
    const std::vector<float> ground = cuboid({-50, -0.01f, -50}, {50, 0, 50});
    const std::vector<float> north = cuboid({-50, 0, -2}, {50, 60, -2}), south = cuboid({-50, 0, 3}, {50, 60, 3});
    const std::vector<float> east = cuboid({3, 0, -50}, {3, 60, 50}), ceiling = cuboid({-50, 3, -50}, {50, 3, 50});
    const auto stray = [](float x, float y, float z) { return std::vector<float>{x, y, z, x + 1, y, z, x, y, z + 1}; };
    const std::vector<float> car_park = together(ground, cuboid({-50, 2.2f, -50}, {50, 2.5f, 50}));
    std::vector<float> town = ground;
    for (int i = 0; i < 400; ++i) {
        const float x = float(5 * (i / 20) - 50), z = float(5 * (i % 20) - 50);
        town = together(town, cuboid({x, 0, z}, {x + 3, float(1 + i % 7), z + 3}));
    }
    const auto dunes = [](double x, double z) { return 0.008 * std::sin(x) * std::sin(z); };
    const struct {
        const char* name;
        std::vector<float> content, beside;
    } cases[] = {
        {"before a wall", cube, north},
        {"behind a wall", cube, south},
        {"west of a wall", cube, east},
        {"before a thick wall", cube, cuboid({-50, -30, -5}, {50, 60, -2})},
        {"between walls", cube, together(together(north, south), ground)},
        {"in a corner", cube, together(together(north, east), ground)},
        {"under a ceiling", cube, ceiling},
        {"under a low ceiling", cube, cuboid({-50, 2, -50}, {50, 2, 50})},
        {"under a ceiling, before a wall", cube, together(ceiling, north)},
        {"in a car park", cube, car_park},
        {"flat, in a corner", cuboid({-1, 0, -1}, {1, 0.3f, 1}), together(together(north, east), ground)},
        {"on a thick plate", cube, cuboid({-50, -3, -50}, {50, 0, 50})},
        {"half sunk into the ground", cube, cuboid({-50, 1, -50}, {50, 1, 50})},
        {"a tower on a square", cuboid({-1, 0, -1}, {1, 50, 1}), ground},
        {"before a wall that is turned", turned(cube, 30), turned(north, 30)},
        {"in a corner that is turned", turned(cube, 70), turned(together(together(north, east), ground), 70)},
        {"on a slope", turned(cube, 20, 25), turned(ground, 20, 25)},
        {"on ground of many triangles", cube, landscape([](double, double) { return 0.0; })},
        {"on rough ground", cube, landscape(dunes)},
        {"a stray", cube, stray(5000, 0, 0)},
        {"a stray above", cube, stray(0, 30000, 0)},
        {"strays on three sides", cube,
         together(together(stray(-9000, 1, 80), stray(5, -40, 7000)), stray(1e5f, 0, 0))},
        {"strays in a row", cube, together(together(stray(1000, 0, 0), stray(2000, 0, 9)), stray(3000, 7, 0))},
        {"a stray of no area", cube, {1e6f, 1e6f, 1e6f, 1e6f, 1e6f, 1e6f, 1e6f, 1e6f, 1e6f}},
        {"a stray beside ground", cube, together(stray(20000, 0, 0), ground)},
        {"ground on a wide sea", cube, together(ground, cuboid({-5000, -1, -5000}, {5000, -1, 5000}))},
        // All of these is content.
        {"a town", town, {}},
        {"a house with a chimney", together(cuboid({0, 0, 0}, {10, 6, 8}), cuboid({2, 6, 2}, {2.5f, 7, 2.5f})), {}},
        {"a hill", landscape([](double x, double z) { return 9 * std::exp(-(x * x + z * z) / 300); }), {}},
        {"low hills", landscape([](double x, double z) { return 0.5 * std::sin(x / 9) * std::cos(z / 7); }), {}},
        {"a hill and a tree",
         together(landscape([](double x, double z) { return 9 * std::exp(-(x * x + z * z) / 300); }),
                  cuboid({350, 0, 0}, {351, 9, 1})),
         {}},
        {"two houses far apart", together(cuboid({0, 0, 0}, {9, 9, 9}), cuboid({500, 0, 0}, {509, 9, 9})), {}},
    };
    for (const double aspect : {16.0 / 9, 1.0, 0.5})
        for (const auto& [name, content, beside] : cases) {
            Scene scene;
            scene.triangles = together(beside, content);
            const gnomon::Camera camera = gnomon::scene::framing_camera(scene, aspect);
            const Shown box = shown(camera, content, aspect);
            EXPECT_GE(std::max(box.width, box.height), 0.6) << name << ' ' << aspect;
            EXPECT_LE(std::max(box.width, box.height), 0.95) << name << ' ' << aspect;
            EXPECT_LT(std::abs(box.middle_x), 0.06) << name << ' ' << aspect;
            EXPECT_LT(std::abs(box.middle_y), 0.06) << name << ' ' << aspect;
            std::size_t hidden = 0;
            for (std::size_t v = 0; v < content.size(); v += 3) {
                Float3 half_way;  // to the middle of the first corner's opposite one, which is inside
                for (std::size_t i = 0; i < 3; ++i) half_way[i] = (content[v + i] + content[i]) / 2;
                hidden += std::size_t(is_hidden(camera, half_way, beside));
            }
            EXPECT_LE(2 * hidden, content.size() / 3) << name << ' ' << aspect << ": hidden";
        }
}

std::vector<float> times(double factor, std::vector<float> triangles) {
    for (float& c : triangles) c = float(factor * c);
    return triangles;
}

std::vector<float> inside_out(std::vector<float> triangles) {
    for (std::size_t t = 0; t < triangles.size(); t += 9)
        std::swap_ranges(triangles.begin() + std::ptrdiff_t(t), triangles.begin() + std::ptrdiff_t(t) + 3,
                         triangles.begin() + std::ptrdiff_t(t) + 3);
    return triangles;
}

/// A sphere of radius 1 around the origin, of quads with their fronts inside; `is_dome`: its upper half.
std::vector<float> sphere(int columns, int rows, bool is_dome = false) {
    std::vector<float> triangles;
    const double pi = 3.14159265358979;
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j)
            for (const auto& [a, b] : {std::pair{0, 0}, {0, 1}, {1, 1}, {0, 0}, {1, 1}, {1, 0}}) {
                const double turn = 2 * pi * (i + a) / columns, rise = (is_dome ? pi / 2 : pi) * (j + b) / rows;
                for (const double c :
                     {std::sin(rise) * std::cos(turn), std::cos(rise), std::sin(rise) * std::sin(turn)})
                    triangles.push_back(float(c));
            }
    return triangles;
}

std::vector<float> moved(std::vector<float> t, gnomon::Float3 by) {
    for (std::size_t i = 0; i < t.size(); ++i) t[i] += by[i % 3];
    return t;
}

/// Triangles with a middle height in between.
std::vector<float> part_of(const std::vector<float>& t, double least, double most) {
    std::vector<float> part;
    for (std::size_t i = 0; i < t.size(); i += 9) {
        const double y = (t[i + 1] + t[i + 4] + t[i + 7]) / 3.0;
        if (y >= least && y <= most) part.insert(part.end(), t.begin() + i, t.begin() + i + 9);
    }
    return part;
}

/// A wall of quads around the y axis.
std::vector<float> cylinder(int columns, float low, float high, double radius) {
    std::vector<float> triangles;
    for (int i = 0; i < columns; ++i)
        for (const auto& [a, height] : {std::pair{0, low}, {1, high}, {1, low}, {0, low}, {0, high}, {1, high}}) {
            const double turn = 2 * 3.14159265358979 * (i + a) / columns;
            for (const double c : {radius * std::cos(turn), double(height), radius * std::sin(turn)})
                triangles.push_back(float(c));
        }
    return triangles;
}

// A closed box, sphere or dome around all else hides it from outside, whichever side its faces show; so does a panorama
// that is open above, which shows its fronts to those inside.
TEST(DefaultCamera, StandsInASky) {
    const std::vector<float> house = turned(cuboid({-5, 0, -4}, {5, 6, 4}), 30);
    const std::vector<float> box = cuboid({-300, -300, -300}, {300, 300, 300});
    const std::vector<float> ground = cuboid({-400, -0.01f, -400}, {400, 0, 400});
    const struct {
        const char* name;
        std::vector<float> content, sky;
    } cases[] = {
        {"a box", house, box},
        {"a box whose fronts are inside", house, inside_out(box)},
        {"a box of both sides", house, together(box, inside_out(box))},
        {"a thick box", house, together(box, times(0.97, box))},
        {"a box that is turned", house, turned(box, 40, 20)},
        {"a box on the ground", house, cuboid({-300, 0, -300}, {300, 400, 300})},
        {"a box, and ground in it", house, together(box, times(0.7, ground))},
        {"a sphere", house, times(1000, inside_out(sphere(24, 12)))},
        {"a sphere whose fronts are inside", house, times(1000, sphere(24, 12))},
        {"a finer sphere", house, times(1000, turned(sphere(90, 60), 3, 70))},
        {"a sphere, and ground in it", house, together(times(600, sphere(24, 12)), ground)},
        {"a dome on ground that is as wide", house, together(times(400, sphere(24, 12, true)), ground)},
        {"a dome on ground that is wider", house, together(times(300, sphere(24, 12, true)), ground)},
        {"a box in a sphere", house, together(box, times(1000, sphere(24, 12)))},
        {"a dome alone", house, times(400, sphere(24, 12, true))},
        {"a coarse dome", house, times(400, sphere(6, 3, true))},
        {"a dome on narrower ground", house, together(times(400, sphere(24, 12, true)), times(0.5, ground))},
        {"a dome on ground nearly as wide", house, together(times(400, sphere(24, 12, true)), times(0.8, ground))},
        {"a dome that goes on below wider ground", house,
         together(moved(times(400, sphere(24, 12, true)), {0, -50, 0}), ground)},
        {"a sphere without its lowest part", house, part_of(times(400, sphere(24, 12)), -200, 400)},
        {"a box without a bottom", house, part_of(box, -299, 300)},
        {"a small box", turned(cuboid({-1, 0, -1}, {1, 2, 1}), 10), cuboid({-9, 0, -9}, {9, 30, 9})},
        {"two houses", together(house, cuboid({40, 0, 0}, {49, 9, 9})), box},
        {"a house off the middle", cuboid({150, 0, -60}, {160, 9, -50}), box},
        {"a box, and a plate in it", house, together(box, cuboid({-50, -2, -50}, {50, -1, 50}))},
        {"a panorama", house, inside_out(cylinder(32, -40, 60, 100))},
        {"a panorama on the ground", house, inside_out(cylinder(64, 0, 60, 100))},
        {"a coarse panorama with a floor", house, together(inside_out(cylinder(8, 0, 60, 100)), times(0.2, ground))},
        {"a panorama on wider ground", house, together(inside_out(cylinder(24, 0, 60, 100)), times(0.3, ground))},
        {"a panorama from below the ground on", house,
         together(inside_out(cylinder(24, -30, 60, 100)), times(0.3, ground))},
        {"a sphere that is open above, its fronts inside", house, part_of(times(400, sphere(24, 12)), -500, 380)},
        {"walls around", house, inside_out(part_of(box, -299, 299))},
    };
    for (const double aspect : {16.0 / 9, 1.0, 0.5})
        for (const auto& [name, content, sky] : cases) {
            Scene scene;
            scene.triangles = together(sky, content);
            const gnomon::scene::Framing framing(scene, aspect);
            const gnomon::Camera camera = framing.camera();
            const Shown shows = shown(camera, content, aspect);
            EXPECT_GE(std::max(shows.width, shows.height), 0.6) << name << ' ' << aspect;
            EXPECT_LE(std::max(shows.width, shows.height), 0.95) << name << ' ' << aspect;
            EXPECT_LT(std::abs(shows.middle_x) + std::abs(shows.middle_y), 0.12) << name << ' ' << aspect;
            std::size_t hidden = 0;
            for (std::size_t v = 0; v < content.size(); v += 3)
                hidden += std::size_t(is_hidden(camera, {content[v], content[v + 1], content[v + 2]}, sky));
            EXPECT_LE(6 * hidden, content.size() / 3) << name << ' ' << aspect << ": hidden";
        }
}

// A sky that is open above and shows its fronts outside, or bulges, is seen from outside; a sentence says so.
TEST(DefaultCamera, SaysThatASkyIsSeenFromOutside) {
    const std::vector<float> house = cuboid({-5, 0, -4}, {5, 6, 4}), ball = times(400, sphere(24, 12));
    const std::vector<float> box = cuboid({-300, -300, -300}, {300, 300, 300});
    std::vector<float> bulging = ball;
    for (std::size_t i = 0; i < bulging.size(); i += 3) {
        const float size = 1 + 0.2f * std::sin(bulging[i] / 40) * std::cos(bulging[i + 2] / 40);
        for (std::size_t k = 0; k < 3; ++k) bulging[i + k] *= size;
    }
    const auto said = [&](const std::vector<float>& sky) {
        Scene scene;
        scene.triangles = together(house, sky);
        scene.mesh_uses = {{0, 1}, {house.size() / 9, 0}};
        scene.mesh_names = {"mesh 'sky'", "mesh 1"};
        return gnomon::scene::Framing(scene, 1).hidden(scene);
    };
    for (const auto& sky : {inside_out(part_of(ball, -500, 380)), part_of(box, -300, 299), inside_out(bulging)})
        EXPECT_EQ(said(sky),
                  "the default view shows mesh 'sky' from outside, and all else is far smaller and inside "
                  "of it: --eye and --target show that from there")
            << sky.size();
    for (const auto& sky : {ball, box, cuboid({-300, -2, -300}, {300, -1, 300}), cuboid({-15, 0, -15}, {15, 15, 15})})
        EXPECT_EQ(said(sky), "");
}

// Where a sky leaves less room than the picture of all would take, the eye stands in it nevertheless.
TEST(DefaultCamera, StandsInANarrowSky) {
    const std::vector<float> hills =
        landscape([](double x, double z) { return 0.5 * std::sin(x / 9) * std::cos(z / 7); });
    const std::vector<float> house = cuboid({-7, -9, -7}, {7, 6, 7});
    for (const auto& [content, sky] : {std::pair{hills, times(75, sphere(24, 12))},
                                       {house, times(20, sphere(24, 12))},
                                       {house, inside_out(cuboid({-10, -10, -10}, {10, 10, 10}))}}) {
        Scene scene;
        scene.triangles = together(sky, content);
        const gnomon::Camera camera = gnomon::scene::framing_camera(scene);
        const Shown shows = shown(camera, content, 1);
        EXPECT_GT(std::max(shows.width, shows.height), 0.6);
        EXPECT_FALSE(is_hidden(camera, {0, 0, 0}, sky));
    }
}

// What is closed and has nothing else inside, or of which more is seen from outside, is seen from there.
TEST(DefaultCamera, StandsOutsideOfBodies) {
    const std::vector<float> ball = sphere(24, 12), bench = cuboid({1.5f, -1, 0}, {1.7f, -0.8f, 0.5f});
    const std::vector<float> cube = cuboid({-1, -1, -1}, {1, 1, 1}), small = times(0.3, ball);
    for (const auto& [name, triangles] : std::vector<std::pair<const char*, std::vector<float>>>{
             {"a ball", ball},
             {"a box", cube},
             {"a globe in clouds", together(ball, times(1.1, ball))},
             {"a case with a box in it", together(cube, times(0.7, cube))},
             {"a box with a bench before it", together(together(cube, bench), small)},
             {"a cup with a ball in it", together(cylinder(24, -1, 1, 1), times(0.2, ball))},
             {"a yard with a house in it", together(inside_out(cylinder(24, -1, 1, 1)), times(0.4, ball))},
             {"a statue, and triangles in it", together(together(cube, turned(times(0.9, cube), 45, 45)), small)},
         }) {
        Scene scene;
        scene.triangles = triangles;
        const gnomon::Camera camera = gnomon::scene::framing_camera(scene);
        EXPECT_GT(std::hypot(camera.eye[0], camera.eye[1], camera.eye[2]), 2) << name;
    }
}

// A sequence: what moves stays in the picture.
TEST(DefaultCamera, FramesTheWholeMotion) {
    Scene first, last;
    first.triangles = cuboid({0, 0, 0}, {1, 1, 1});
    last.triangles = cuboid({30, 5, 0}, {31, 6, 1});
    gnomon::scene::Framing framing(first, 1);
    framing.add(last);
    const Shown box = shown(framing.camera(), together(first.triangles, last.triangles), 1);
    EXPECT_GE(std::max(box.width, box.height), 0.6);
    EXPECT_LE(std::max(std::abs(box.middle_x) + box.width, std::abs(box.middle_y) + box.height), 0.95);
}

/// A box around (2, 1, 3), 8 x 3 x 4 metres. `is_inward`: its fronts are inside.
std::vector<float> box_triangles(bool is_inward, double size = 1) {
    std::vector<float> triangles;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1})
            for (const auto& order : {std::array{0, 1, 2}, std::array{0, 2, 3}})
                for (std::size_t k = 0; k < 3; ++k) {
                    const int corner = order[(side > 0) == is_inward ? 2 - k : k];
                    std::array<double, 3> p{};
                    p[axis] = side;
                    p[(axis + 1) % 3] = corner == 1 || corner == 2 ? 1 : -1;
                    p[(axis + 2) % 3] = corner >= 2 ? 1 : -1;
                    const std::array<double, 3> middle{2, 1, 3}, half{4, 1.5, 2};
                    for (std::size_t c = 0; c < 3; ++c) triangles.push_back(float(middle[c] + size * half[c] * p[c]));
                }
    return triangles;
}

bool is_inside_the_box(const Scene& scene) {
    const Float3 eye = gnomon::scene::framing_camera(scene).eye;
    return std::abs(eye[0] - 2) < 4 && std::abs(eye[1] - 1) < 1.5f && std::abs(eye[2] - 3) < 2;
}

TEST(DefaultCamera, OfAnInteriorIsInside) {
    Scene room, solid, thick, hut;
    room.triangles = box_triangles(true);
    EXPECT_TRUE(is_inside_the_box(room));
    const gnomon::Camera camera = gnomon::scene::framing_camera(room);
    EXPECT_NEAR(std::abs(camera.forward[0]), 1, 1e-6) << "along the longer side";
    solid.triangles = box_triangles(false);
    EXPECT_FALSE(is_inside_the_box(solid));
    // A building with walls that have an outside too, as Sponza has.
    thick.triangles = box_triangles(true, 0.99);
    const std::vector<float> outside = box_triangles(false);
    thick.triangles.insert(thick.triangles.end(), outside.begin(), outside.end());
    EXPECT_TRUE(is_inside_the_box(thick));
    // The same hut in a landscape: what is outside is to be seen.
    hut = thick;
    for (const float c : {-40.f, -0.5f, -40.f, -40.f, -0.5f, 40.f, 40.f, -0.5f, 40.f}) hut.triangles.push_back(c);
    EXPECT_FALSE(is_inside_the_box(hut));
    // A wall is missing: one looks in from there.
    room.triangles.resize(room.triangles.size() - 18);
    EXPECT_FALSE(is_inside_the_box(room));
}

TEST(Defaults, LightTravelsAsStated) {
    EXPECT_EQ(gnomon::scene::default_light().xyzw, (std::array<float, 4>{0.4f, 1.0f, 0.3f, 0.0f}));
}

// ---- Real scenes ----------------------------------------------------------------------------------------------------

struct RealScene {
    const char *file, *unpacked;
    std::size_t triangles;
    std::uint64_t digest;  ///< of the unpacked file's triangles

    friend std::ostream& operator<<(std::ostream& out, const RealScene& scene) { return out << scene.file; }
};

/// FNV-1a of 64 bits over the little-endian bytes.
std::uint64_t digest(const std::vector<float>& triangles) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(triangles.data());
    std::uint64_t hash = 0xCBF29CE484222325u;
    for (std::size_t i = 0; i < triangles.size() * sizeof(float); ++i) hash = (hash ^ bytes[i]) * 0x100000001B3u;
    return hash;
}

/// The triangles of an unpacked file. It is one identity node and one mesh of uint32 triangles over float32 positions,
/// with one buffer, so that a JSON parser is enough to gather them from the bytes of the .glb.
std::vector<float> triangles_in(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    std::uint32_t json_size;
    std::memcpy(&json_size, &bytes[12], 4);
    const json root = json::parse(bytes.substr(20, json_size));
    const char* chunk = bytes.data() + 20 + json_size + 8;
    const auto first = [&](const json& accessor) {
        return chunk + root["bufferViews"][accessor["bufferView"].get<int>()].value("byteOffset", 0) +
               accessor.value("byteOffset", 0);
    };
    std::vector<float> expected;
    for (const json& part : root["meshes"][0]["primitives"]) {
        const char* positions = first(root["accessors"][part["attributes"]["POSITION"].get<int>()]);
        const json& indices = root["accessors"][part["indices"].get<int>()];
        for (int i = 0; i < indices["count"].get<int>(); ++i) {
            std::uint32_t index;
            std::memcpy(&index, first(indices) + 4 * i, 4);
            expected.resize(expected.size() + 3);
            std::memcpy(&expected[expected.size() - 3], positions + std::size_t(12) * index, 12);
        }
    }
    return expected;
}

class PackedScene : public testing::TestWithParam<RealScene> {};

// The digests are those of the unpacked files, by this Python program:
//   import json, struct, sys
//   b = open(sys.argv[1], "rb").read()
//   n, h = struct.unpack_from("<I", b, 12)[0], 0xCBF29CE484222325
//   g = json.loads(b[20 : 20 + n])
//   def at(a): return 28 + n + g["bufferViews"][a["bufferView"]]["byteOffset"] + a.get("byteOffset", 0)
//   for p in g["meshes"][0]["primitives"]:
//       v, i = (g["accessors"][k] for k in (p["attributes"]["POSITION"], p["indices"]))
//       for (k,) in struct.iter_unpack("<I", b[at(i) : at(i) + 4 * i["count"]]):
//           for byte in b[at(v) + 12 * k : at(v) + 12 * k + 12]: h = (h ^ byte) * 0x100000001B3 % 2**64
//   print(f"{h:x}")
TEST_P(PackedScene, HasTheTrianglesOfTheUnpackedFileInTheirOrder) {
    const Scene scene = gnomon::scene::load(std::filesystem::path(GNOMON_SCENES) / GetParam().file);
    EXPECT_EQ(scene.triangle_count(), GetParam().triangles);
    EXPECT_EQ(scene.warnings, std::vector<std::string>{});
    EXPECT_EQ(digest(scene.triangles), GetParam().digest);

    const auto unpacked = std::filesystem::path(GNOMON_SHARED_SCENES) / GetParam().unpacked;
    if (!std::filesystem::exists(unpacked)) return;
    EXPECT_TRUE(same_bits(scene.triangles, triangles_in(unpacked)));
    EXPECT_TRUE(same_bits(scene.triangles, gnomon::scene::load(unpacked).triangles));
}

INSTANTIATE_TEST_SUITE_P(Real, PackedScene,
                         testing::Values(RealScene{"sponza.glb", "crytek_sponza.glb", 262267, 0x05b469bfedb7f498},
                                         RealScene{"lost_empire.glb", "lost_empire.glb", 224998, 0x8964eb61c895f123}),
                         [](const auto& test) { return std::filesystem::path(test.param.file).stem().string(); });

}  // namespace
