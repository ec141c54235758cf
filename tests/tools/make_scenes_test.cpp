// SPDX-License-Identifier: MIT
// Tests of make_scenes: the same bytes every time and on every machine, the counts it promises, committed files that
// have not drifted from the tool, the geometry that scenes claim (closed, exactly flat, exactly edge-on), and one clear
// sentence for every bad argument. The tool is run as a program; files are read with a small reader of our own.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path scenes_folder = GNOMON_SCENES_DIR;

std::string read_file(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    EXPECT_TRUE(stream.good()) << file;
    return {std::istreambuf_iterator<char>(stream), {}};
}

struct Outcome {
    int status;
    std::string output, errors;
};

struct Part {
    std::string material;
    std::vector<std::array<float, 3>> positions;
    std::vector<std::uint32_t> indices;
};

struct File {
    Json json;
    std::vector<Part> parts;

    std::size_t triangle_count() const {
        std::size_t count = 0;
        for (const Part& part : parts) count += part.indices.size() / 3;
        return count;
    }
    const Part& part(const std::string& material) const {
        const auto found = std::ranges::find(parts, material, &Part::material);
        if (found == parts.end()) throw std::out_of_range("no part " + material);
        return *found;
    }
    std::vector<std::string> camera_names() const { return node_names("camera"); }
    std::vector<std::string> light_names() const { return node_names("extensions"); }
    /// The node's -Z column, which is the way a light travels.
    std::array<double, 3> direction(const std::string& node) const {
        const Json& matrix = node_named(node).at("matrix");
        return {-matrix[8].get<double>(), -matrix[9].get<double>(), -matrix[10].get<double>()};
    }
    std::array<double, 3> position(const std::string& node) const {
        const Json& matrix = node_named(node).at("matrix");
        return {matrix[12], matrix[13], matrix[14]};
    }

private:
    std::vector<std::string> node_names(const std::string& key) const {
        std::vector<std::string> names;
        for (const Json& node : json.at("nodes")) {
            if (node.contains(key)) names.push_back(node.at("name"));
        }
        return names;
    }
    const Json& node_named(const std::string& name) const {
        for (const Json& node : json.at("nodes")) {
            if (node.at("name") == name) return node;
        }
        throw std::out_of_range("no node " + name);
    }
};

template <typename Element>
std::vector<Element> read_accessor(const Json& json, std::size_t index, const std::string& binary) {
    const Json& accessor = json.at("accessors").at(index);
    const Json& view = json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
    const auto offset = view.at("byteOffset").get<std::size_t>(), bytes = view.at("byteLength").get<std::size_t>();
    EXPECT_EQ(bytes, accessor.at("count").get<std::size_t>() * sizeof(Element));
    EXPECT_LE(offset + bytes, binary.size());
    std::vector<Element> elements(bytes / sizeof(Element));
    std::memcpy(elements.data(), binary.data() + offset, bytes);
    return elements;
}

File parse_glb(const std::string& bytes) {
    std::array<std::uint32_t, 5> header{};
    std::memcpy(header.data(), bytes.data(), sizeof header);
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(header[1], 2u);
    EXPECT_EQ(header[2], bytes.size());
    File file{Json::parse(bytes.substr(20, header[3])), {}};
    if (!file.json.contains("meshes")) return file;
    const std::string binary = bytes.substr(20 + header[3] + 8);
    EXPECT_EQ(binary.size(), file.json.at("buffers")[0].at("byteLength").get<std::size_t>());
    for (const Json& primitive : file.json.at("meshes")[0].at("primitives")) {
        Part part;
        part.material = file.json.at("materials").at(primitive.at("material").get<std::size_t>()).at("name");
        part.positions =
            read_accessor<std::array<float, 3>>(file.json, primitive.at("attributes").at("POSITION"), binary);
        part.indices = read_accessor<std::uint32_t>(file.json, primitive.at("indices"), binary);
        file.parts.push_back(std::move(part));
    }
    return file;
}

File committed(const std::string& name) { return parse_glb(read_file(scenes_folder / (name + ".glb"))); }

/// The scenes of the folder that make_scenes makes: all but the two of pack_scene_test.
std::vector<std::string> committed_names() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(scenes_folder)) {
        if (entry.path().extension() == ".glb") names.push_back(entry.path().stem());
    }
    for (const char* packed : {"sponza", "lost_empire"}) std::erase(names, packed);
    std::ranges::sort(names);
    return names;
}

/// FNV-1a, 64 bits.
std::uint64_t hash(const std::string& bytes) {
    std::uint64_t value = 0xCBF29CE484222325u;
    for (const char byte : bytes) value = (value ^ static_cast<unsigned char>(byte)) * 0x100000001B3u;
    return value;
}

class MakeScenes : public testing::Test {
protected:
    void SetUp() override {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder = fs::path(testing::TempDir()) / ("gnomon_make_scenes_" + std::string(test->name()));
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }

    Outcome run(const std::string& arguments) const {
        const fs::path output = folder / "output.txt", errors = folder / "errors.txt";
        const std::string command = std::string("'") + GNOMON_MAKE_SCENES + "' " + arguments + " >'" + output.string() +
                                    "' 2>'" + errors.string() + "'";
        const int status = std::system(command.c_str());
        return {status, read_file(output), read_file(errors)};
    }
    std::string make(const std::string& arguments) const {
        const fs::path file = folder / "scene.glb";
        const Outcome outcome = run(arguments + " -o '" + file.string() + "'");
        EXPECT_EQ(outcome.status, 0) << arguments << ": " << outcome.errors;
        return read_file(file);
    }

    fs::path folder;
};

constexpr std::array large_names{"colonnade", "city", "foliage", "pipes", "town", "terrain"};

TEST_F(MakeScenes, CommittedFilesAreWhatTheToolMakes) {
    ASSERT_EQ(run("--all '" + (folder / "all").string() + "'").status, 0);
    std::vector<std::string> made;
    for (const auto& entry : fs::directory_iterator(folder / "all")) made.push_back(entry.path().stem());
    std::ranges::sort(made);
    EXPECT_EQ(made, committed_names()) << "run make_scenes --all scenes and commit the result";
    std::uintmax_t bytes = 0;
    for (const std::string& name : made) {
        bytes += fs::file_size(folder / "all" / (name + ".glb"));
        EXPECT_TRUE(read_file(folder / "all" / (name + ".glb")) == read_file(scenes_folder / (name + ".glb")))
            << name << ".glb has drifted from the tool; run make_scenes --all scenes and look at what changed";
    }
    EXPECT_LT(bytes, 3'000'000u) << "the committed scenes are to stay small";
}

TEST_F(MakeScenes, SameArgumentsGiveTheSameBytes) {
    for (const std::string name : large_names) {
        const std::string first = make(name + " --triangles 20000 --seed 7");
        EXPECT_TRUE(first == make(name + " --triangles=20000 --seed=7")) << name;
        EXPECT_FALSE(first == make(name + " --triangles 20000 --seed 8")) << name << ": the seed changes nothing";
    }
}

// The hashes were made on x86-64 with g++ 12 -O3; another machine or compiler that gives others breaks the promise of
// the same bytes everywhere. After a wanted change of a scene, take the new value from the failure.
TEST_F(MakeScenes, LargeScenesAreTheSameOnEveryMachine) {
    const std::map<std::string, std::uint64_t> expected{
        {"colonnade", 0x9a71f0710111f34f}, {"city", 0x95060e0f5bd7cbf8}, {"foliage", 0x8bd69b381125ac12},
        {"pipes", 0x1dded939b71c5fd2},     {"town", 0x19970237fab6000b}, {"terrain", 0xb2f0af99558c1f5f}};
    for (const auto& [name, value] : expected) {
        const std::uint64_t found = hash(make(name + " --triangles 20000"));
        EXPECT_EQ(found, value) << name << " is now 0x" << std::hex << found;
    }
}

TEST_F(MakeScenes, LargeScenesMeetTheirCountAndAreWhole) {
    for (const std::string name : large_names) {
        for (const std::size_t wanted : {10'000u, 20'000u, 55'555u, 100'000u}) {
            const File file = parse_glb(make(name + " --triangles " + std::to_string(wanted)));
            const std::size_t count = file.triangle_count();
            EXPECT_LE(count > wanted ? count - wanted : wanted - count, wanted / 50) << name;
            EXPECT_EQ(file.camera_names(), (std::vector<std::string>{"v0", "v1"})) << name;
            EXPECT_EQ(file.light_names(), (std::vector<std::string>{"sun", "low"})) << name;
            for (const Part& part : file.parts) {
                EXPECT_LT(std::ranges::max(part.indices), part.positions.size()) << name << ", " << part.material;
            }
        }
    }
}

double area_of(const Part& part, std::size_t first) {
    const auto corner = [&](std::size_t i) { return part.positions[part.indices[first + i]]; };
    double squares = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t d = (c + 1) % 3;
        const double turn = (double(corner(1)[c]) - corner(0)[c]) * (double(corner(2)[d]) - corner(0)[d]) -
                            (double(corner(1)[d]) - corner(0)[d]) * (double(corner(2)[c]) - corner(0)[c]);
        squares += turn * turn;
    }
    return std::sqrt(squares) / 2;
}

// The benchmark of many lights takes points on all faces, .9 m apart, so a million of them cover this area.
TEST_F(MakeScenes, ATownOfUsualSizeTakesAMillionPointsNearlyAMetreApart) {
    const File file = parse_glb(make("town"));
    EXPECT_NEAR(double(file.triangle_count()), 60'000, 600);
    double area = 0;
    for (const Part& part : file.parts)
        for (std::size_t i = 0; i < part.indices.size(); i += 3) area += area_of(part, i);
    EXPECT_GT(area, 0.7e6);
    EXPECT_LT(area, 1.0e6);
}

// A terrain is a function of x and z: every triangle faces up, and a finer grid of the same seed has the same ground.
TEST_F(MakeScenes, TerrainIsAHeightFieldWhoseGroundDoesNotDependOnItsGrid) {
    const auto heights = [&](const std::string& triangles) {
        std::map<std::pair<float, float>, float> found;
        const File file = parse_glb(make("terrain --triangles " + triangles));
        const Part& part = file.part("rock");
        for (std::size_t i = 0; i < part.indices.size(); i += 3) {
            const auto &a = part.positions[part.indices[i]], &b = part.positions[part.indices[i + 1]],
                       &c = part.positions[part.indices[i + 2]];
            EXPECT_GT((double(b[2]) - a[2]) * (double(c[0]) - a[0]) - (double(b[0]) - a[0]) * (double(c[2]) - a[2]), 0);
        }
        for (const auto& [x, y, z] : part.positions) EXPECT_TRUE(found.emplace(std::pair{x, z}, y).second);
        return found;
    };
    const auto coarse = heights("20000"), fine = heights("80000");
    std::size_t shared = 0;
    for (const auto& [place, height] : coarse) {
        const auto same = fine.find(place);
        if (same == fine.end()) continue;
        ++shared;
        EXPECT_EQ(same->second, height);
    }
    EXPECT_GT(shared, coarse.size() / 2);
    float low = 0, high = 0;
    for (const auto& [place, height] : fine) {
        low = std::min(low, height);
        high = std::max(high, height);
    }
    EXPECT_GT(high - low, 150);
    EXPECT_LT(high - low, 500);
}

TEST_F(MakeScenes, SliversComeInTheNumberAskedFor) {
    EXPECT_EQ(parse_glb(make("million_slivers --triangles 10")).triangle_count(), 10u);
    EXPECT_EQ(parse_glb(make("million_slivers --triangles 34567")).triangle_count(), 34'567u);
}

// From the camera, whose picture has 1080 rows over 50 degrees.
TEST_F(MakeScenes, ABushOfManyLeavesLiesWithinThirtyPixels) {
    const File file = parse_glb(make("far_bush"));
    EXPECT_EQ(file.triangle_count(), 200'000u);
    const auto eye = file.position("main");
    const double pixel = 2 * std::tan(25 * 3.14159265358979 / 180) / 1080;
    double farthest = 0;
    for (const auto& leaf : file.part("leaves").positions)
        farthest = std::max(farthest, std::abs(leaf[0]) / (eye[2] - leaf[2]) / pixel);
    EXPECT_LT(farthest, 15.5);
    EXPECT_GT(farthest, 12);
}

TEST(CommittedScenes, HaveNamedCamerasAndLightsAndValidIndices) {
    for (const std::string& name : committed_names()) {
        const File file = committed(name);
        EXPECT_FALSE(file.camera_names().empty()) << name;
        EXPECT_FALSE(file.light_names().empty()) << name;
        EXPECT_EQ(file.camera_names().front(), "main") << name;
        for (const Part& part : file.parts) {
            EXPECT_LT(std::ranges::max(part.indices), part.positions.size()) << name << ", " << part.material;
        }
    }
}

TEST(CommittedScenes, ReadmeNamesTheirCountsCamerasAndLights) {
    std::ifstream readme(scenes_folder / "README.md");
    std::map<std::string, std::string> rows;
    for (std::string line; std::getline(readme, line);) {
        if (!line.starts_with("| `")) continue;
        rows[line.substr(3, line.find('`', 3) - 3)] = line;
    }
    for (const std::string& name : committed_names()) {
        const File file = committed(name);
        ASSERT_TRUE(rows.contains(name)) << name;
        EXPECT_NE(rows[name].find("| " + std::to_string(file.triangle_count()) + " |"), std::string::npos)
            << rows[name];
        std::vector<std::string> words = file.camera_names();
        std::ranges::copy(file.light_names(), std::back_inserter(words));
        for (const std::string& word : words) {
            EXPECT_NE(rows[name].find('`' + word + '`'), std::string::npos) << name << " has " << word;
        }
    }
    for (const std::string name : large_names) EXPECT_TRUE(rows.contains(name)) << name;
}

TEST(CommittedScenes, EmptyHasNoTrianglesAndSingleTriangleHasOne) {
    EXPECT_EQ(committed("empty").triangle_count(), 0u);
    EXPECT_EQ(committed("single_triangle").triangle_count(), 1u);
}

// A surface is closed if every edge is walked once in each direction.
TEST(CommittedScenes, ClosedMeshesAreClosed) {
    for (const auto& [scene, material] :
         {std::pair{"sphere_closed", "sphere"}, std::pair{"closed_box_lit_inside", "room"},
          std::pair{"closed_box_lit_inside", "things"}, std::pair{"closed_box_lit_inside", "crate"},
          std::pair{"pillars_point_light", "pillars"}, std::pair{"thin_wires", "wires"},
          std::pair{"millimetres_in_kilometres", "pins"}, std::pair{"millimetres_in_kilometres", "mountain"},
          std::pair{"lattice", "blocks"}}) {
        const Part part = committed(scene).part(material);
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> walks;
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
            ++walks[{part.indices[i], part.indices[next]}];
        }
        for (const auto& [edge, count] : walks) {
            ASSERT_EQ(count, 1) << scene << ", " << material;
            ASSERT_TRUE(walks.contains({edge.second, edge.first})) << scene << ", " << material;
        }
    }
}

// Coordinates are small multiples of 1/64, so these double products and sums are exact.
double determinant(const std::array<double, 3>& u, const std::array<double, 3>& v, const std::array<double, 3>& w) {
    return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

std::array<double, 3> difference(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    return {double(a[0]) - b[0], double(a[1]) - b[1], double(a[2]) - b[2]};
}

TEST(CommittedScenes, FinsAreExactlyEdgeOnToTheirLights) {
    const File file = committed("light_in_plane");
    const auto determinants = [&](const std::string& material, bool is_point_light) {
        const Part& part = file.part(material);
        const auto lamp = file.position("lamp");
        std::vector<double> values;
        for (std::size_t i = 0; i < part.indices.size(); i += 3) {
            const auto& a = part.positions[part.indices[i]];
            const auto& b = part.positions[part.indices[i + 1]];
            const auto& c = part.positions[part.indices[i + 2]];
            const std::array<double, 3> to_lamp{lamp[0] - a[0], lamp[1] - a[1], lamp[2] - a[2]};
            values.push_back(
                determinant(difference(b, a), difference(c, a), is_point_light ? to_lamp : file.direction("sun")));
        }
        return values;
    };
    for (const double value : determinants("edge_on_to_sun", false)) EXPECT_EQ(value, 0);
    for (const double value : determinants("edge_on_to_lamp", true)) EXPECT_EQ(value, 0);
    for (const double value : determinants("honest_caster", false)) EXPECT_NE(value, 0);
    for (const double value : determinants("honest_caster", true)) EXPECT_NE(value, 0);
}

TEST(CommittedScenes, TessellatedFloorsAreExactlyFlatUnderTheGrazingLight) {
    const File file = committed("tessellated_floor");
    for (const auto& position : file.part("level").positions) EXPECT_EQ(position[1], 0);
    for (const auto& position : file.part("tilted").positions) {
        EXPECT_EQ(position[1], 0.5f + (position[0] - 4) / 4 + (position[2] + 4) / 8);
    }
    const auto light = file.direction("grazing");
    EXPECT_LT(light[1], 0);
    EXPECT_LT(light[1] - light[0] / 4 - light[2] / 8, 0) << "the light must be above the tilted floor too";
}

TEST(CommittedScenes, LatticeAndItsLightsAreWholeNumbers) {
    const File file = committed("lattice");
    for (const Part& part : file.parts) {
        for (const auto& position : part.positions) {
            for (const float value : position) EXPECT_EQ(value, static_cast<float>(static_cast<int>(value)));
        }
    }
    EXPECT_EQ(file.direction("along_100"), (std::array<double, 3>{1, 0, 0}));
    EXPECT_EQ(file.direction("along_110"), (std::array<double, 3>{1, 1, 0}));
    EXPECT_EQ(file.direction("along_111"), (std::array<double, 3>{1, 1, 1}));
    EXPECT_EQ(file.direction("straight_down"), (std::array<double, 3>{0, -1, 0}));
    EXPECT_EQ(file.position("lamp"), (std::array<double, 3>{4, 6, 4}));
}

TEST_F(MakeScenes, BadArgumentsGetOneClearSentence) {
    const std::string file = " -o '" + (folder / "scene.glb").string() + "'";
    const std::vector<std::pair<std::string, std::string>> cases{
        {"", "name a scene"},
        {"nonesuch" + file, "there is no scene 'nonesuch'; --list"},
        {"city", "with -o FILE.glb"},
        {"city --triangles 9999" + file, "takes 10000 to 20000000"},
        {"city --triangles 20000001" + file, "takes 10000 to 20000000"},
        {"million_slivers --triangles 9" + file, "takes 10 to 20000000"},
        {"city --triangles many" + file, "--triangles"},
        {"city --triangles -5" + file, "--triangles -5 is out of range"},
        {"needle --triangles 100" + file, "fixed size"},
        {"needle --seed 2" + file, "nothing in the scene 'needle' is random"},
        {"needle --sead 2" + file, "--sead"},
        {"needle -o '" + (folder / "missing" / "scene.glb").string() + "'", "cannot write"},
        {"needle -o '" + folder.string() + "'", "cannot write"},
        {"needle -o /dev/full", "could not write all of '/dev/full'"},
        {"--all '" + (folder / "output.txt" / "below").string() + "'", "cannot make the folder"},
        {"--all '" + folder.string() + "' --seed 3", "nothing else"},
    };
    for (const auto& [arguments, expected] : cases) {
        const Outcome outcome = run(arguments);
        EXPECT_NE(outcome.status, 0) << arguments;
        EXPECT_TRUE(outcome.errors.starts_with("make_scenes: ")) << arguments << ": " << outcome.errors;
        EXPECT_NE(outcome.errors.find(expected), std::string::npos) << arguments << ": " << outcome.errors;
        EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
        EXPECT_EQ(outcome.output, "") << arguments;
        EXPECT_FALSE(fs::exists(folder / "scene.glb")) << arguments;
    }
}

TEST_F(MakeScenes, ListNamesEveryScene) {
    const Outcome outcome = run("--list");
    EXPECT_EQ(outcome.status, 0);
    std::vector<std::string> names = committed_names();
    names.insert(names.end(), large_names.begin(), large_names.end());
    names.push_back("far_bush");
    for (const std::string& name : names) EXPECT_NE(('\n' + outcome.output).find('\n' + name + ' '), std::string::npos);
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(outcome.output, '\n')), names.size());
}

}  // namespace
