// SPDX-License-Identifier: MIT
// Tests of pack_scene, run as a program: no bit and no order is lost, all else of the file stays, and the packed scenes
// of the repository are what the tool writes. scene_test compares their triangles with the unpacked files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "scene/scene.hpp"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path scenes_folder = GNOMON_SCENES, shared_folder = GNOMON_SHARED_SCENES;
constexpr const char* extension = "EXT_meshopt_compression";

std::string read_file(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    EXPECT_TRUE(stream.good()) << file;
    return {std::istreambuf_iterator<char>(stream), {}};
}

Json json_of(const fs::path& file) {
    const std::string bytes = read_file(file);
    std::uint32_t json_bytes = 0;
    std::memcpy(&json_bytes, &bytes[12], sizeof json_bytes);
    return Json::parse(bytes.substr(20, json_bytes));
}

class PackScene : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder = fs::path(testing::TempDir()) / ("gnomon_pack_scene_" + std::string(test->name()));
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }

    /// The exit code; `errors` is what the tool said.
    int pack(const fs::path& input, const fs::path& output, const std::string& copyright = "nobody") {
        const fs::path said = folder / "errors.txt";
        const std::string command = std::string("'") + GNOMON_PACK_SCENE + "' '" + input.string() + "' -o '" +
                                    output.string() + "' --copyright '" + copyright + "' 2>'" + said.string() + "'";
        const int status = std::system(command.c_str());
        errors = read_file(said);
        return status;
    }

    fs::path folder;
    std::string errors;
};

// Scenes with ties and with twice the same triangle: order and corners matter.
TEST_F(PackScene, LosesNothingOfAScene) {
    for (const char* name : {"lattice", "coplanar_pair", "pillars_point_light", "grass"}) {
        const fs::path unpacked = scenes_folder / (std::string(name) + ".glb"), packed = folder / "packed.glb";
        ASSERT_EQ(pack(unpacked, packed), 0) << errors;
        const auto before = gnomon::scene::load(unpacked), after = gnomon::scene::load(packed);
        EXPECT_EQ(after.warnings, std::vector<std::string>{});
        ASSERT_EQ(after.triangles.size(), before.triangles.size());
        EXPECT_EQ(std::memcmp(after.triangles.data(), before.triangles.data(), before.triangles.size() * sizeof(float)),
                  0);

        Json was = json_of(unpacked), is = json_of(packed);
        EXPECT_EQ(is["asset"]["copyright"], "nobody");
        EXPECT_EQ(is["extensionsRequired"], Json({extension}));
        EXPECT_EQ(is["buffers"][1]["extensions"][extension], Json({{"fallback", true}}));
        EXPECT_EQ(is["buffers"][1]["byteLength"], was["buffers"][0]["byteLength"]);
        for (Json& view : is["bufferViews"]) {
            const Json& stream = view["extensions"][extension];
            EXPECT_EQ(stream["mode"], view["target"] == 34963 ? "INDICES" : "ATTRIBUTES");
            EXPECT_FALSE(stream.contains("filter"));
            view.erase("extensions");
            view.erase("byteStride");
            view["buffer"] = 0;
        }
        EXPECT_EQ(is["extensionsUsed"].back(), extension);
        is["extensionsUsed"].erase(is["extensionsUsed"].size() - 1);
        is["asset"].erase("copyright");
        for (Json* json : {&was, &is})
            for (const char* key : {"buffers", "extensionsRequired"}) json->erase(key);
        EXPECT_EQ(is, was) << name;
    }
}

// Author, licence and changes travel with the file, and the tool makes the same bytes again.
TEST_F(PackScene, CommittedScenesAreWhatTheToolWrites) {
    for (const auto& [name, author, source] : {std::tuple{"sponza", "Frank Meinl, Crytek", "crytek_sponza.glb"},
                                               std::tuple{"lost_empire", "Morgan McGuire", "lost_empire.glb"}}) {
        const fs::path committed = scenes_folder / (std::string(name) + ".glb");
        const std::string copyright = json_of(committed)["asset"]["copyright"];
        for (const std::string part : {author, "CC BY 3.0", "https://creativecommons.org/licenses/by/3.0/", "Changes:"})
            EXPECT_NE(copyright.find(part), std::string::npos) << copyright;
        const fs::path unpacked = shared_folder / source, packed = folder / "packed.glb";
        if (!fs::exists(unpacked)) continue;
        ASSERT_EQ(pack(unpacked, packed, copyright), 0) << errors;
        EXPECT_TRUE(read_file(packed) == read_file(committed)) << name << ".glb was made with meshoptimizer 0.18";
    }
}

TEST_F(PackScene, WhatCannotBePackedGetsOneClearSentence) {
    const fs::path cut = folder / "cut.glb", text = folder / "text.glb";
    std::ofstream(cut, std::ios::binary) << read_file(scenes_folder / "lattice.glb").substr(0, 20000);
    std::ofstream(text) << "this is no scene, but it is long enough to be one";
    const std::vector<std::pair<fs::path, std::string>> cases{
        {folder / "missing.glb", "cannot read"},
        {cut, "the file is cut off"},
        {text, "is not a .glb file of glTF 2.0"},
        {scenes_folder / "empty.glb", "one buffer"},
        {scenes_folder / "sponza.glb", "one buffer"},                      // packed already
        {scenes_folder / "leaves.glb", "no accessor reads bufferViews["},  // its images
    };
    for (const auto& [input, expected] : cases) {
        EXPECT_NE(pack(input, folder / "packed.glb"), 0) << input;
        EXPECT_TRUE(errors.starts_with("pack_scene: ")) << errors;
        EXPECT_NE(errors.find(expected), std::string::npos) << input << ": " << errors;
        EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << errors;
        EXPECT_FALSE(fs::exists(folder / "packed.glb")) << input;
    }
    EXPECT_NE(pack(scenes_folder / "lattice.glb", folder / "missing" / "packed.glb"), 0);
    EXPECT_NE(errors.find("cannot write"), std::string::npos) << errors;
}

}  // namespace
