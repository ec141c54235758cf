// SPDX-License-Identifier: MIT
// Poses, instances and packed files, on made glTF files of a few triangles. Expected positions are worked out by hand,
// with numbers whose doubles are exact; tests/python/test_gltf.py compares real files with an evaluation of its own.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <meshoptimizer.h>
#if GNOMON_TEST_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif

#include <gnomon.hpp>
#include "gltf_file.hpp"

namespace {

using namespace gltf_file;

const float nan = std::numeric_limits<float>::quiet_NaN();

std::vector<float> moved(std::vector<float> xyz, float x, float y, float z) {
    for (std::size_t i = 0; i < xyz.size(); i += 3) {
        xyz[i] += x;
        xyz[i + 1] += y;
        xyz[i + 2] += z;
    }
    return xyz;
}

std::vector<float> both(std::vector<float> a, const std::vector<float>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

int floats(Gltf& gltf, const std::vector<float>& values, const std::string& type, std::size_t width) {
    return gltf.accessor(gltf.view_of(values), f32, values.size() / width, type);
}

std::string text(int number) { return std::to_string(number); }

// ---- Animations -----------------------------------------------------------------------------------------------------

/// One animation of one channel, of node 0.
void animate(Gltf& gltf, const std::string& path, const std::string& interpolation, const std::vector<float>& times,
             const std::vector<float>& values) {
    const std::size_t width = path == "rotation" ? 4 : path == "weights" ? 1 : 3;
    const int input = floats(gltf, times, "SCALAR", 1);
    const int output = floats(gltf, values, width == 4 ? "VEC4" : width == 3 ? "VEC3" : "SCALAR", width);
    gltf.add("animations", R"({"name": "move", "channels": [{"sampler": 0, "target": {"node": 0, "path": ")" + path +
                               R"("}}], "samplers": [{"input": )" + text(input) + R"(, "output": )" + text(output) +
                               R"(, "interpolation": ")" + interpolation + R"("}]})");
}

class Poses : public SceneFile {};

TEST_F(Poses, WithoutATimeTheSceneIsAtRest) {
    Gltf gltf = triangle_file();
    animate(gltf, "translation", "LINEAR", {1, 3}, {0, 0, 0, 8, 0, 0});
    const Scene scene = load(gltf);
    EXPECT_TRUE(same_bits(scene.triangles, one_triangle));
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.animations, std::vector<std::string>{"move"});
    EXPECT_EQ(scene.animation, "");
}

TEST_F(Poses, LinearTranslation) {
    Gltf gltf = triangle_file();
    animate(gltf, "translation", "LINEAR", {1, 3}, {0, 0, 0, 8, 0, 4});
    EXPECT_EQ(load_at(gltf, -5).triangles, one_triangle) << "the first keyframe holds";
    EXPECT_EQ(load_at(gltf, 1.5).triangles, moved(one_triangle, 2, 0, 1));
    EXPECT_EQ(load_at(gltf, 3).triangles, moved(one_triangle, 8, 0, 4));
    EXPECT_EQ(load_at(gltf, 99).triangles, moved(one_triangle, 8, 0, 4)) << "the last keyframe holds";
    EXPECT_EQ(load_at(gltf, 1.5).animation, "move");
}

TEST_F(Poses, StepKeepsAKeyframe) {
    Gltf gltf = triangle_file();
    animate(gltf, "translation", "STEP", {0, 1, 2}, {1, 0, 0, 2, 0, 0, 3, 0, 0});
    EXPECT_EQ(load_at(gltf, 0.999).triangles, moved(one_triangle, 1, 0, 0));
    EXPECT_EQ(load_at(gltf, 1).triangles, moved(one_triangle, 2, 0, 0));
}

// Hermite at the middle of two seconds: (p0 + p1) / 2 + 2 s (m0 - m1) / 8.
TEST_F(Poses, CubicSpline) {
    Gltf gltf = triangle_file();
    animate(gltf, "translation", "CUBICSPLINE", {0, 2},
            {9, 9, 9, 1, 0, 0, 4, 0, 0, /* next */ 0, 8, 0, 3, 2, 0, 9, 9, 9});
    EXPECT_EQ(load_at(gltf, 1).triangles, moved(one_triangle, 3, -1, 0));
    EXPECT_EQ(load_at(gltf, 0).triangles, moved(one_triangle, 1, 0, 0));
}

// A quarter turn about z, half way, is an eighth: (1, 0) becomes (s, s) with s = sqrt(1/2).
TEST_F(Poses, SlerpTakesTheShortWay) {
    const float s = std::sqrt(0.5f);
    Gltf gltf = triangle_file();
    animate(gltf, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, -s, -s});  // the second is the negated quarter turn
    const std::vector<float> turned = load_at(gltf, 0.5).triangles;
    EXPECT_FLOAT_EQ(turned[3], s);
    EXPECT_FLOAT_EQ(turned[4], s);
    EXPECT_FLOAT_EQ(turned[6], -s);
}

TEST_F(Poses, AnimationsAreChosenByNameOrIndex) {
    Gltf gltf = triangle_file();
    animate(gltf, "translation", "LINEAR", {0, 1}, {1, 0, 0, 2, 0, 0});
    animate(gltf, "scale", "LINEAR", {0, 1}, {2, 2, 2, 4, 4, 4});
    gltf.set("/animations/1/name", "\"grow\"");
    EXPECT_EQ(load(gltf, {.animation = "grow"}).triangles[3], 2) << "at its start";
    EXPECT_EQ(load(gltf, {.animation = "1", .time_s = 1.0}).triangles[3], 4);
    EXPECT_THROW(load(gltf, {.animation = "2"}), SceneError);
    Gltf still = triangle_file();
    expect_error(still, {"has no animations"}, 0, 1.0);
}

TEST_F(Poses, ChannelsWithoutAKnownTarget) {
    Gltf gltf = triangle_file();
    animate(gltf, "translation", "LINEAR", {0, 1}, {1, 0, 0, 2, 0, 0});
    gltf.set("/animations/0/channels/0/target", R"({"path": "translation"})");
    const Scene scene = load_at(gltf, 1);
    EXPECT_EQ(scene.triangles, one_triangle) << "glTF says: ignore it";
    EXPECT_TRUE(scene.warnings.empty());
    gltf.set("/animations/0/channels/0/target", R"({"node": 0, "path": "pointer"})");
    expect_warning(load_at(gltf, 1), {"an animation of 'pointer' (ignored)"});
    expect_error(gltf, {"a time that is no number"}, 0, std::nan(""));
}

TEST_F(Poses, AFileServesManyTimes) {
    Gltf gltf = triangle_file();
    animate(gltf, "translation", "LINEAR", {0, 4}, {0, 0, 0, 4, 0, 0});
    gltf.set("/meshes/0/primitives/1", R"({"attributes": {"POSITION": 0}, "mode": 0})");
    gnomon::scene::SceneFile file(write(gltf));
    for (const float t : {0.0f, 3.0f, 1.0f}) {
        const Scene scene = file.at(t);
        EXPECT_EQ(scene.triangles, moved(one_triangle, t, 0, 0));
        EXPECT_EQ(scene.warnings.size(), 1u) << "points are left out, said once for each time";
    }
}

// ---- Morph targets and skins ----------------------------------------------------------------------------------------

Gltf morphed_file() {
    Gltf gltf = triangle_file();
    floats(gltf, {0, 0, 8, 0, 0, 0, 0, 0, 0}, "VEC3", 3);
    gltf.set("/meshes/0/primitives/0/targets", R"([{"POSITION": 1}])");
    return gltf;
}

TEST_F(Poses, MorphWeightsOfMeshNodeAndAnimation) {
    Gltf gltf = morphed_file();
    EXPECT_TRUE(same_bits(load(gltf).triangles, one_triangle)) << "no weights";
    gltf.set("/meshes/0/weights", "[0.5]");
    EXPECT_EQ(load(gltf).triangles[2], 4);
    gltf.set("/nodes/0/weights", "[0.25]");
    EXPECT_EQ(load(gltf).triangles[2], 2) << "the node's win";
    animate(gltf, "weights", "LINEAR", {0, 1}, {0, 1});
    EXPECT_EQ(load_at(gltf, 0.125).triangles[2], 1) << "the animation's win";
}

TEST_F(Poses, SparseMorphTarget) {
    Gltf gltf = morphed_file();
    const int where = gltf.view_of<std::uint8_t>({2, 0, 0, 0}), what = gltf.view_of<float>({0, 0, 16});
    gltf.set("/accessors/1/bufferView", "");
    gltf.make_sparse(1, 1, where, u8, what);
    gltf.set("/meshes/0/weights", "[0.5]");
    EXPECT_EQ(load(gltf).triangles[8], 8);
}

/// The triangle's corners belong to joint 1 (nodes[1]), to joint 2 (nodes[2]), and to both in the ratio 1 to 3.
Gltf skinned_file() {
    Gltf gltf = triangle_file();
    gltf.accessor(gltf.view_of<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}), u8, 3, "VEC4");
    floats(gltf, {1, 0, 0, 0, 1, 0, 0, 0, 0.25f, 0.75f, 0, 0}, "VEC4", 4);
    std::vector<float> matrices{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    matrices = both(matrices, matrices);
    matrices[16 + 13] = -1;  // joint 2 was bound at y = 1
    floats(gltf, matrices, "MAT4", 16);
    gltf.set("/meshes/0/primitives/0/attributes", R"({"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2})");
    gltf.set("/nodes/0/skin", "0").set("/nodes/0/translation", "[100, 100, 100]");
    gltf.node(R"({"translation": [0, 0, 8], "children": [2]})");
    gltf.node(R"({"translation": [0, 5, 0]})");
    gltf.add("skins", R"({"joints": [1, 2], "inverseBindMatrices": 3})");
    gltf.add("scenes", R"({"nodes": [0]})");  // the joints stand outside the scene
    return gltf;
}

TEST_F(Poses, SkinBlendsItsJoints) {
    Gltf gltf = skinned_file();
    const Scene scene = load(gltf);
    // Joint 1 moves by (0, 0, 8), joint 2 by (0, 4, 8). The mesh node's own transform does not count.
    EXPECT_EQ(scene.triangles, (std::vector<float>{0, 0, 8, 1, 4, 8, 0, 4, 8}));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(Poses, SkinWeightsOfBytesAreNormalized) {
    Gltf gltf = skinned_file();
    const int weights =
        gltf.accessor(gltf.view_of<std::uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 100, 100, 0, 0}), u8, 3, "VEC4");
    gltf.set("/accessors/" + text(weights) + "/normalized", "true");
    gltf.set("/meshes/0/primitives/0/attributes/WEIGHTS_0", text(weights));
    EXPECT_EQ(load(gltf).triangles, (std::vector<float>{0, 0, 8, 1, 4, 8, 0, 3, 8}));
}

TEST_F(Poses, SecondSetOfJointsCounts) {
    Gltf gltf = skinned_file();
    gltf.accessor(gltf.view_of<std::uint8_t>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}), u8, 3, "VEC4");
    floats(gltf, {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 4);
    gltf.set("/meshes/0/primitives/0/attributes/JOINTS_1", "4").set("/meshes/0/primitives/0/attributes/WEIGHTS_1", "5");
    EXPECT_EQ(load(gltf).triangles[1], 2) << "half of each joint";
}

TEST_F(Poses, NanWeightsMakeTrianglesThatCastNoShadow) {
    Gltf gltf = skinned_file();
    floats(gltf, {nan, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 4);
    gltf.set("/meshes/0/primitives/0/attributes/WEIGHTS_0", "4");
    expect_warning(load(gltf), {"NaN or infinite vertex"});
}

// A number that files write where they have no data is no place, unless others of its axis are near; vertices that no
// triangle names and quantized positions do not count.
TEST_F(Poses, VerticesThatStandForNoDataAreRefused) {
    const auto refusal_of = [&](const std::vector<float>& xyz, const char* indices = "") {
        Gltf gltf;
        const int positions = gltf.positions(xyz);
        if (*indices) gltf.indices<std::uint16_t>({0, 1, 2});
        gltf.mesh(R"({"attributes": {"POSITION": )" + text(positions) + "}" + indices + "}");
        gltf.node(R"({"mesh": 0})");
        gltf.set("/scenes", R"([{"nodes": [0]}])");
        try {
            load(gltf);
        } catch (const SceneError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    for (const float number : {-9999.0f, -99999.0f, -999999.0f, -32768.0f, -32767.0f, -2147483648.0f, -1e20f, 1e20f})
        EXPECT_NE(refusal_of({0, 0, 0, 1, number, 0, 1, 0, 1}).find(": vertex 1 of primitive 0 of mesh"),
                  std::string::npos)
            << refusal_of({0, 0, 0, 1, number, 0, 1, 0, 1});
    EXPECT_NE(refusal_of({5e5, 0, 0, 6e5, 0, 0, -9999, 0, 1}).find("which one number stands for no data"),
              std::string::npos);
    EXPECT_NE(refusal_of({0, -9999, 0, 1, -9999, 0, 0, -9999, 1}).find("move the mesh by its node"), std::string::npos);
    for (const std::vector<float>& place : std::initializer_list<std::vector<float>>{
             {0, -9998, 0, 1, -9999, 0, 1, -9999, 1},             // near others
             {-9999, 0, 0, 9999, 0, 0, 0, 0, 9999},               // a corner of a square around the origin
             {-9999, 0, -9998, -9999, 0, -9997, -9999, 5, -9998}  // on a wall that lies there
         })
        EXPECT_EQ(refusal_of(place), "");
    EXPECT_EQ(refusal_of({0, 0, 0, 1, 0, 0, 0, 0, 1, 3, -9999, 3}, R"(, "indices": 1)"), "");
}

// ---- Instances, quantization, scenes, variants ----------------------------------------------------------------------

TEST_F(Poses, GpuInstances) {
    Gltf gltf = triangle_file();
    const int translation = floats(gltf, {1, 2, 3, 0, 0, 0}, "VEC3", 3);
    const int scale = floats(gltf, {1, 1, 1, 2, 2, 2}, "VEC3", 3);
    const int rotation = gltf.accessor(gltf.view_of<std::int8_t>({0, 0, 0, 127, 0, 0, 127, 0}), 5120, 2, "VEC4");
    gltf.set("/accessors/" + text(rotation) + "/normalized", "true");
    gltf.set("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", R"({"TRANSLATION": )" + text(translation) +
                                                                           R"(, "SCALE": )" + text(scale) +
                                                                           R"(, "ROTATION": )" + text(rotation) + "}");
    gltf.set("/nodes/0/translation", "[10, 0, 0]");
    // The second is turned by 180 degrees about z, and twice as large.
    const std::vector<float> second{10, 0, 0, 8, 0, 0, 10, -2, 0};
    const Scene scene = load(gltf);
    EXPECT_EQ(scene.triangles, both(moved(one_triangle, 11, 2, 3), second));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_F(Poses, QuantizedPositions) {
    const auto check = [&](const std::string& normalized, int type, const Bytes& bytes, int stride, Float3 corner) {
        Gltf gltf;
        gltf.accessor(gltf.view(bytes, stride), type, 3, "VEC3");
        gltf.set("/accessors/0/normalized", normalized);
        gltf.mesh(R"({"attributes": {"POSITION": 0}})");
        gltf.node(R"({"mesh": 0, "scale": [2, 2, 2]})");
        const Scene scene = load(gltf);
        ASSERT_EQ(scene.triangle_count(), 1u);
        EXPECT_EQ((Float3{scene.triangles[0], scene.triangles[1], scene.triangles[2]}), corner);
        EXPECT_TRUE(scene.warnings.empty());
    };
    const Bytes bytes{0x80, 0x81, 0x7F, 0, 1, 0, 0, 0, 0, 1, 0, 0};
    check("false", 5120, bytes, 4, {-256, -254, 254});
    check("true", 5120, bytes, 4, {-2, -2, 2});
    check("false", 5121, bytes, 4, {256, 258, 254});
    check("true", 5121, {255, 0, 51, 0, 1, 0, 0, 0, 0, 1, 0, 0}, 4, {2, 0, float(2 * 0.2)});
    Bytes shorts;
    for (const std::uint16_t s : {0x8000, 0x7FFF, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0}) append(shorts, s);
    check("false", 5122, shorts, 8, {-65536, 65534, 2});
    check("true", 5122, shorts, 8, {-2, 2, float(2.0 / 32767)});
    check("true", 5123, shorts, 8, {float(65536.0 / 65535), float(65534.0 / 65535), float(2.0 / 65535)});
}

TEST_F(Poses, ScenesAreChosenByNameOrIndex) {
    Gltf gltf = triangle_file();
    gltf.node(R"({"mesh": 0, "translation": [5, 0, 0]})");
    gltf.set("/scenes", R"([{"nodes": [0]}, {"name": "away", "nodes": [1]}])");
    EXPECT_EQ(load(gltf).triangles, one_triangle);
    for (const char* choice : {"away", "1"})
        EXPECT_EQ(load(gltf, {.scene = choice}).triangles, moved(one_triangle, 5, 0, 0));
    try {
        load(gltf, {.scene = "home"});
        ADD_FAILURE() << "there is no such scene";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("there is no scene 'home': the file has these: 0 '', 1 'away'"),
                  std::string::npos)
            << error.what();
    }
}

TEST_F(Poses, VariantsAreANoteNotAWarning) {
    Gltf gltf = triangle_file();
    gltf.set("/extensions/KHR_materials_variants/variants", R"([{"name": "red"}])");
    gltf.set("/extensionsUsed", R"(["KHR_materials_variants"])");
    const Scene scene = load(gltf);
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("material variants"), std::string::npos);
}

// ---- Bad files ------------------------------------------------------------------------------------------------------

/// A change of a skinned, morphed, animated and instanced file, and words of the sentence that it must give.
struct Damage {
    const char* name;
    std::vector<std::pair<const char*, const char*>> changes;
    std::vector<std::string> words;
};

void PrintTo(const Damage& damage, std::ostream* out) { *out << damage.name; }

class DamagedPose : public SceneFile, public testing::WithParamInterface<Damage> {};

Gltf posed_file() {
    Gltf gltf = skinned_file();
    floats(gltf, {0, 0, 8, 0, 0, 0, 0, 0, 0}, "VEC3", 3);  // accessor 4
    gltf.set("/meshes/0/primitives/0/targets", R"([{"POSITION": 4}])");
    animate(gltf, "translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0});  // accessors 5, 6
    gltf.node(R"({"mesh": 1, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}})");
    gltf.mesh(R"({"attributes": {"POSITION": 0}})", "many");
    gltf.set("/scenes/0/nodes", "[0, 3]");
    floats(gltf, {1, 0}, "SCALAR", 1);    // accessor 7: falling times
    floats(gltf, {0, nan}, "SCALAR", 1);  // accessor 8
    gltf.accessor(gltf.view_of<std::uint8_t>({0, 9, 0, 0, 1, 0, 0, 0, 9, 1, 0, 0}), u8, 3, "VEC4");  // accessor 9
    return gltf;
}

TEST_F(Poses, TheFileThatIsDamagedBelowIsSound) {
    const Scene scene = load_at(posed_file(), 0.5);
    EXPECT_EQ(scene.triangle_count(), 4u);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings[0];
}

TEST_P(DamagedPose, IsNamed) {
    Gltf gltf = posed_file();
    for (const auto& [pointer, value] : GetParam().changes) gltf.set(pointer, value);
    expect_error(gltf, GetParam().words, std::uint64_t(4) << 30, 0.5);
}

constexpr const char* instances = "/nodes/3/extensions/EXT_mesh_gpu_instancing/attributes";

INSTANTIATE_TEST_SUITE_P(
    All, DamagedPose,
    testing::ValuesIn(std::vector<Damage>{
        {"JointNode", {{"/skins/0/joints", "[1, 9]"}}, {"skins[0].joints is 9", "nodes has 4 entries"}},
        {"NoJoints", {{"/skins/0/joints", ""}}, {"skins[0].joints is missing"}},
        {"JointsAreACycle", {{"/nodes/2/children", "[1]"}}, {"nodes[", "its own ancestor", "cycle"}},
        {"JointInTheMesh", {{"/meshes/0/primitives/0/attributes/JOINTS_0", "9"}}, {"joint 9", "2 joints"}},
        {"JointsOfFloats",
         {{"/meshes/0/primitives/0/attributes/JOINTS_0", "2"}},
         {"the joints of", "VEC4 of unsigned"}},
        {"WeightsOfVec3", {{"/meshes/0/primitives/0/attributes/WEIGHTS_0", "0"}}, {"the weights of", "VEC4 of float"}},
        {"FewWeights", {{"/accessors/2/count", "2"}}, {"the weights of", "are 2 for 3 positions"}},
        {"FewMatrices", {{"/accessors/3/count", "1"}}, {"skins[0] has 2 joints, but only 1 inverse bind"}},
        {"MatricesOfVectors", {{"/skins/0/inverseBindMatrices", "0"}}, {"inverse bind matrices of skins[0]", "MAT4"}},
        {"Target", {{"/meshes/0/primitives/0/targets", R"([{"POSITION": 99}])"}}, {"targets.POSITION is 99"}},
        {"TargetOfWrongType", {{"/meshes/0/primitives/0/targets", "[3]"}}, {"must hold objects only"}},
        {"ShortTarget", {{"/accessors/4/count", "2"}}, {"morph target 0 of primitive 0", "are 2 for 3 positions"}},
        {"MorphWeights", {{"/meshes/0/weights", R"(["a"])"}}, {"meshes[0].weights must be numbers"}},
        {"FallingTimes", {{"/animations/0/samplers/0/input", "7"}}, {"animations[0].channels[0]", "do not rise"}},
        {"NanTimes", {{"/animations/0/samplers/0/input", "8"}}, {"animations[0].channels[0]", "do not rise"}},
        {"NoKeyframes", {{"/accessors/5/count", "0"}}, {"animations[0].channels[0] has no keyframes"}},
        {"TimesOfVec3", {{"/animations/0/samplers/0/input", "6"}}, {"the times of animations[0].samplers[0]"}},
        {"OutputCount", {{"/accessors/6/count", "1"}}, {"animations[0].channels[0] has 3 numbers", "needs 2 times 3"}},
        {"Sampler", {{"/animations/0/channels/0/sampler", "1"}}, {"channels[0].sampler is 1", "has 1 sampler"}},
        {"TargetNode", {{"/animations/0/channels/0/target/node", "7"}}, {"channels[0].target.node is 7"}},
        {"Interpolation", {{"/animations/0/samplers/0/interpolation", "\"BEZIER\""}}, {"is 'BEZIER'"}},
        {"AnimatedMatrix",
         {{"/nodes/0/translation", ""}, {"/nodes/0/matrix", "[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]"}},
         {"animations[0].channels[0] moves nodes[0], which has a matrix"}},
        {"NoInstances", {{instances, "{}"}}, {"EXT_mesh_gpu_instancing.attributes is empty"}},
        {"InstancesOfVec4", {{instances, R"({"SCALE": 2})"}}, {"the instances' SCALE of node 3", "VEC3 of float"}},
        {"InstancesDiffer", {{instances, R"({"TRANSLATION": 0, "SCALE": 6})"}}, {"of node 3 are", "another attribute"}},
        {"ABillionInstancesOfZeros",
         {{"/accessors/0/bufferView", ""}, {"/accessors/0/count", "1000000000"}},
         {"accessors[", "are 3 for 1000000000 positions"}},
    }),
    [](const auto& damage) { return std::string(damage.param.name); });

/// What gnomon draws otherwise than the file says: a warning each, which --strict makes an error (command_test.cpp).
class Approximation : public SceneFile, public testing::WithParamInterface<Damage> {};

TEST_P(Approximation, IsAWarning) {
    Gltf gltf = posed_file();
    for (const auto& [pointer, value] : GetParam().changes) gltf.set(pointer, value);
    expect_warning(load_at(gltf, 0.5), GetParam().words);
}

INSTANTIATE_TEST_SUITE_P(
    All, Approximation,
    testing::ValuesIn(std::vector<Damage>{
        {"Points", {{"/meshes/1/primitives/0/mode", "0"}}, {"points and lines are left out", "mesh 'many'"}},
        {"Lines", {{"/meshes/1/primitives/0/mode", "3"}}, {"points and lines are left out", "(lines)"}},
        {"NoPositions",
         {{"/meshes/1/primitives/0/attributes", R"({"NORMAL": 0})"}},
         {"left out for want of positions"}},
        {"NoJoints",
         {{"/meshes/0/primitives/0/attributes/JOINTS_0", ""}},
         {"a skin without joints and weights (drawn unskinned)"}},
        {"InstancesOfASkin",
         {{"/nodes/0/extensions", R"({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}})"}},
         {"instances of a skinned mesh (all stand where its joints are)"}},
        {"OtherTargets",
         {{"/animations/0/channels/0/target/path", "\"pointer\""}},
         {"an animation of 'pointer' (ignored)"}},
        {"OtherExtensions", {{"/extensionsUsed", R"(["EXT_of_tomorrow"])"}}, {"'EXT_of_tomorrow' (ignored)"}},
        {"OtherMeshopt",
         {{"/extensionsUsed", R"(["KHR_meshopt_compression"])"}},
         {"'KHR_meshopt_compression' (ignored)"}},
        {"OrthographicCamera",
         {{"/cameras", R"([{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 1, "zfar": 2}}])"},
          {"/nodes/3/camera", "0"}},
         {"orthographic cameras are left out"}},
        {"CameraWithoutADirection",
         {{"/cameras", R"([{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}])"},
          {"/nodes/3/camera", "0"},
          {"/nodes/3/scale", "[0, 0, 0]"}},
         {"left out, for the node's transform is degenerate"}},
        {"Blend",
         {{"/materials", R"([{"alphaMode": "BLEND"}])"}, {"/meshes/1/primitives/0/material", "0"}},
         {"alphaMode BLEND (drawn opaque"}},
        {"Glass",
         {{"/materials", R"([{"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}])"},
          {"/meshes/1/primitives/0/material", "0"}},
         {"KHR_materials_transmission (drawn opaque)"}},
    }),
    [](const auto& of) { return std::string(of.param.name); });

TEST_F(Poses, ABillionInstancesAreRefused) {
    Gltf gltf = triangle_file();
    gltf.add("accessors", R"({"componentType": 5126, "type": "VEC3", "count": 1000000000})");
    gltf.set("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", R"({"TRANSLATION": 1})");
    expect_error(gltf, {"accessors[1] has a count of 1000000000 but no bufferView"});
    gltf.set("/accessors/1/count", "16000000");
    for (int i = 0; i < 70; ++i)
        gltf.node(R"({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}}})");
    expect_error(gltf, {"has 1136000000 triangles with its instances", "of memory"}, std::uint64_t(8) << 30);
}

// The device holds 36 bytes per triangle and what they are culled by; 12 bytes remain for that.
TEST_F(Poses, InstancesTake48BytesPerTriangleOnTheDevice) {
    constexpr std::size_t rows = 63, instances_count = 958;  // 63 * 64 * 2 = 8,064 triangles, 7.7 million in all
    std::vector<float> xyz;
    for (std::size_t y = 0; y <= rows; ++y)
        for (std::size_t x = 0; x <= rows + 1; ++x) xyz.insert(xyz.end(), {float(x), float(y), float((x * y) % 7)});
    std::vector<std::uint16_t> order;
    for (std::size_t y = 0; y < rows; ++y)
        for (std::size_t x = 0; x <= rows; ++x) {
            const auto at = std::uint16_t(y * (rows + 2) + x), above = std::uint16_t(at + rows + 2);
            order.insert(order.end(),
                         {at, std::uint16_t(at + 1), above, above, std::uint16_t(at + 1), std::uint16_t(above + 1)});
        }
    Gltf gltf;
    gltf.positions(xyz);
    gltf.indices(order);
    gltf.mesh(R"({"attributes": {"POSITION": 0}, "indices": 1})");
    std::vector<float> places;
    for (std::size_t i = 0; i < instances_count; ++i) places.insert(places.end(), {70 * float(i), 0, 0});
    floats(gltf, places, "VEC3", 3);
    gltf.node(R"({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}}})");
    const Scene scene = gnomon::scene::load(write("many.glb", gltf.glb()));
    const std::size_t count = rows * (rows + 1) * 2 * instances_count;
    ASSERT_EQ(scene.triangle_count(), count);

    const gnomon::Device device;
    const std::uint64_t before = device.memory_bytes();
    gnomon::Triangles triangles = gnomon::Triangles::upload(device, scene.triangles);
    triangles.keep_clusters(device);
    device.finish();
    const std::uint64_t bytes = device.memory_bytes() - before;
    EXPECT_LE(bytes, 48 * count) << "a mesh in a good order needs no copy for its clusters";
    EXPECT_GE(bytes, 36 * count);
}

// ---- Packed files ---------------------------------------------------------------------------------------------------

/// A square of four vertices of shorts and two triangles; all packed, with a fallback buffer that does not exist.
Gltf meshopt_file() {
    const std::array<std::int16_t, 16> vertices{0, 0, 0, 0, 4, 0, 0, 0, 4, 4, 0, 0, 0, 4, 0, 0};
    const std::array<std::uint32_t, 6> order{0, 1, 2, 0, 2, 3};
    Bytes packed(meshopt_encodeVertexBufferBound(4, 8)), packed_order(meshopt_encodeIndexBufferBound(6, 4));
    packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), vertices.data(), 4, 8));
    packed_order.resize(meshopt_encodeIndexBuffer(packed_order.data(), packed_order.size(), order.data(), 6));
    Gltf gltf;
    gltf.view(packed);
    gltf.view(packed_order);
    const auto pack = [&](int view, std::size_t bytes, const std::string& rest) {
        json& v = gltf.root["bufferViews"][std::size_t(view)];
        json extension = v;
        extension.update(json::parse(rest));
        v = json::parse(R"({"buffer": 1, "byteLength": )" + std::to_string(bytes) + "}");
        v["extensions"]["EXT_meshopt_compression"] = extension;
    };
    pack(0, 32, R"({"byteStride": 8, "count": 4, "mode": "ATTRIBUTES"})");
    gltf.set("/bufferViews/0/byteStride", "8");
    pack(1, 12, R"({"byteStride": 2, "count": 6, "mode": "TRIANGLES"})");
    gltf.accessor(0, 5122, 4, "VEC3");
    gltf.accessor(1, u16, 6, "SCALAR");
    gltf.set_buffer(std::to_string(gltf.buffer.size()), gltf.data_uri());
    gltf.set("/buffers/1", R"({"byteLength": 44, "extensions": {"EXT_meshopt_compression": {"fallback": true}}})");
    gltf.set("/extensionsRequired", R"(["EXT_meshopt_compression", "KHR_mesh_quantization"])");
    gltf.mesh(R"({"attributes": {"POSITION": 0}, "indices": 1})");
    gltf.node(R"({"mesh": 0})");
    return gltf;
}

TEST_F(Poses, Meshopt) {
    const Scene scene = load(meshopt_file());
    ASSERT_EQ(scene.triangle_count(), 2u);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.triangles, (std::vector<float>{0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 0, 0, 4, 4, 0, 0, 4, 0}));
}

TEST_F(Poses, DamagedMeshoptIsNamed) {
    const std::string at = "/bufferViews/0/extensions/EXT_meshopt_compression";
    const auto damaged = [&](const std::string& property, const std::string& value, const std::string& word) {
        Gltf gltf = meshopt_file();
        gltf.set(at + property, value);
        expect_error(gltf, {"bufferViews[0]", word}, 1 << 20);
    };
    damaged("/byteStride", "6", "a byteStride that is a multiple of 4");
    damaged("/byteStride", "0", "byteStride is 0");
    damaged("/byteLength", "1000", "reads beyond buffers[0]");
    damaged("/byteOffset", "18446744073709551615", "reads beyond buffers[0]");
    damaged("/count", "5", "has 32 bytes, but its EXT_meshopt_compression 5 times 8");
    damaged("/count", "1000000000000000000", "more than the 1 MiB of memory");
    Gltf gltf = meshopt_file();
    gltf.set(at + "/count", "500000000").set("/bufferViews/0/byteLength", "4000000000");
    expect_error(gltf, {"bufferViews[0] holds no stream of EXT_meshopt_compression"}, std::uint64_t(1) << 50);
    damaged("/mode", "\"INDICES\"", "a byteStride of 2 or 4");
    damaged("/mode", "\"WHAT\"", "mode is 'WHAT'");
}

#if GNOMON_TEST_DRACO

Bytes draco_stream(const std::vector<float>& xyz, int method) {
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(int(xyz.size() / 9));
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    for (std::size_t i = 0; i < xyz.size() / 9; ++i)
        builder.SetAttributeValuesForFace(position, draco::FaceIndex(std::uint32_t(i)), &xyz[9 * i], &xyz[9 * i + 3],
                                          &xyz[9 * i + 6]);
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    draco::EncoderBuffer out;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &out).ok());
    return Bytes(out.data(), out.data() + out.size());
}

const std::vector<float> two_triangles{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0.1f};

/// `count`: of vertices, as the accessor declares it.
Gltf draco_file(int method, int count = 4) {
    Gltf gltf;
    gltf.view(draco_stream(two_triangles, method));
    gltf.add("accessors", R"({"componentType": 5126, "type": "VEC3", "count": )" + text(count) + "}");
    gltf.add("accessors", R"({"componentType": 5123, "type": "SCALAR", "count": 6})");
    gltf.mesh(R"({"attributes": {"POSITION": 0}, "indices": 1, "extensions": {"KHR_draco_mesh_compression": {
        "bufferView": 0, "attributes": {"POSITION": 0}}}})");
    gltf.node(R"({"mesh": 0})");
    gltf.set("/extensionsRequired", R"(["KHR_draco_mesh_compression"])");
    return gltf;
}

/// The corners of each triangle from its least on, and the triangles in order: Draco may turn and exchange them.
std::vector<std::array<Float3, 3>> sorted(const std::vector<float>& xyz) {
    std::vector<std::array<Float3, 3>> out;
    for (std::size_t i = 0; i < xyz.size(); i += 9) {
        std::array<Float3, 3> t;
        std::memcpy(&t, &xyz[i], sizeof t);
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        out.push_back(t);
    }
    std::sort(out.begin(), out.end());
    return out;
}

TEST_F(Poses, Draco) {
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const Scene scene = load(draco_file(method));
        EXPECT_EQ(sorted(scene.triangles), sorted(two_triangles)) << method;
        EXPECT_TRUE(scene.warnings.empty());
    }
}

TEST_F(Poses, DracoCountsOfTheStreamAreTaken) {
    const Scene scene = load(draco_file(draco::MESH_SEQUENTIAL_ENCODING, 40));
    EXPECT_EQ(sorted(scene.triangles), sorted(two_triangles));
    expect_warning(scene, {"primitive 0 of mesh 'thing' has other counts in its Draco stream", "POSITION 4 for 40"});
}

TEST_F(Poses, DamagedDracoIsNamed) {
    Gltf gltf = draco_file(draco::MESH_EDGEBREAKER_ENCODING);
    gltf.set("/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/attributes/POSITION", "3");
    expect_error(gltf, {"has no attribute POSITION in its Draco stream"});
    gltf.set("/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/attributes/POSITION", "2147483648");
    expect_error(gltf, {"has no attribute POSITION in its Draco stream"});  // 2^31: above every int
    gltf = draco_file(draco::MESH_EDGEBREAKER_ENCODING);
    gltf.set("/bufferViews/0/byteLength", "20");
    expect_error(gltf, {"primitive 0 of mesh 'thing' holds no Draco stream that can be decoded"});
    gltf = draco_file(draco::MESH_EDGEBREAKER_ENCODING);
    gltf.buffer[5] = 1;  // the stream's version
    expect_error(gltf, {"primitive 0 of mesh 'thing'", "version 1.2"});
}

// A few bytes that promise gigabytes are refused before memory is reserved.
TEST_F(Poses, DracoStreamsThatPromiseTooMuch) {
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        Gltf gltf = draco_file(method);
        // "DRACO", version, type, method, flags; Edgebreaker's traversal; then the two counts, one byte each here.
        const std::size_t counts = method == draco::MESH_EDGEBREAKER_ENCODING ? 12 : 11;
        const Bytes huge{0xFF, 0xFF, 0xFF, 0x7F, 0xFF, 0xFF, 0xFF, 0x7F};  // 2^28 - 1, twice
        gltf.buffer.erase(gltf.buffer.begin() + long(counts), gltf.buffer.begin() + long(counts) + 2);
        gltf.buffer.insert(gltf.buffer.begin() + long(counts), huge.begin(), huge.end());
        gltf.set("/bufferViews/0/byteLength", std::to_string(gltf.buffer.size()));
        expect_error(gltf, {"primitive 0 of mesh 'thing' promises 268435455 elements"}, std::uint64_t(1) << 50);
    }
}

// Of each byte every value: a scene or a sentence, in 16 MiB.
TEST_F(Poses, EveryDamagedByteOfADracoStreamIsSurvived) {
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const Gltf good = draco_file(method);
        const std::size_t size = good.buffer.size();
        for (std::size_t at = 0; at < size; ++at)
            for (const int value : {0, 1, 2, 3, 4, 8, 16, 32, 64, 127, 128, 192, 254, 255}) {
                Gltf gltf = good;
                gltf.buffer[at] = static_cast<unsigned char>(value);
                try {
                    load(gltf, {.memory_bytes = 16 << 20});
                } catch (const SceneError&) {
                }
            }
    }
}

#endif

}  // namespace
