// SPDX-License-Identifier: MIT
// The golden record: every bit of the camera's points and of the visibility of known views, from commit 1cd155d (the
// headers of the records describe how they were made and checked). Each line is one test: the library runs its `gnomon
// render` command line with the light animated, with the light prepared, with clusters of the triangles, and with both;
// all four runs must give the recorded bits.
//
// Three variables of the environment add to the comparison:
//   GNOMON_GOLDEN_WRITE=FILE   appends each line as it was found to FILE.
//   GNOMON_GOLDEN_ORACLE=1     compares each point's visibility with the oracle (tests/reference), too.
//   GNOMON_GPU_KERNELS=1       is read by the library: the kernels for GPUs must give the same bits.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gnomon.hpp>
#include "reference/visibility.hpp"
#include "scene/scene.hpp"
#include "support/decoded_png.hpp"
#include "support/scene_masks.hpp"
#include "tools/make_scenes/recipes.hpp"

namespace {

static_assert(std::endian::native == std::endian::little, "hashes are of little-endian bytes");

// ---- The record -----------------------------------------------------------------------------------------------------

/// One line: NAME: SCENE OPTIONS => FINDINGS, where OPTIONS are those of `gnomon render` and FINDINGS are words in
/// pairs, a name and its value.
struct Line {
    std::string name, scene, options, findings;
    bool is_shared = false;

    friend std::ostream& operator<<(std::ostream& out, const Line& line) { return out << line.name; }
};

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(' ');
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

std::vector<Line> lines_of(const std::string& file, bool is_shared) {
    std::ifstream stream(std::filesystem::path(GNOMON_GOLDEN) / file);
    std::vector<Line> lines;
    for (std::string text; std::getline(stream, text);) {
        if (trimmed(text).empty() || text[0] == '#') continue;
        Line line;
        line.is_shared = is_shared;
        const std::size_t colon = text.find(": "), arrow = text.find("=>");
        if (colon == std::string::npos || arrow == std::string::npos || arrow < colon)
            throw std::runtime_error(file + " has a line that is not NAME: SCENE OPTIONS => FINDINGS: " + text);
        line.name = text.substr(0, colon);
        line.findings = trimmed(text.substr(arrow + 2));
        std::istringstream question(text.substr(colon + 1, arrow - colon - 1));
        question >> line.scene;
        std::getline(question, line.options);
        line.options = trimmed(line.options);
        lines.push_back(line);
    }
    return lines;
}

/// The command lines that repeat the runs by hand.
std::string command_of(const Line& line) {
    const std::size_t colon = line.scene.find(':');
    std::string command, scene = line.scene;
    if (colon != std::string::npos) {
        const std::string recipe = scene.substr(0, colon);
        const std::string count = scene.substr(colon + 1);
        scene = recipe + ".glb";
        command = "make_scenes " + recipe + " -o " + scene + " --triangles " + count + " --seed 1 && ";
    } else if (scene == "sundial") {
        scene.clear();
    } else {
        scene = (line.is_shared ? GNOMON_SHARED_SCENES "/" : GNOMON_SCENES "/") + scene;
    }
    return command + "gnomon render " + scene + (scene.empty() ? "" : " ") + line.options +
           " --aov found.exr --stats found.json";
}

// ---- The scene and the options of a line ----------------------------------------------------------------------------

struct Question {
    gnomon::Camera camera;
    gnomon::Light light;
    std::uint32_t width = 0, height = 0, samples = 1;
};

/// Three numbers, each float32 as the command reads it.
gnomon::Float3 vector_of(const std::string& text) {
    gnomon::Float3 vector{};
    const char* at = text.c_str();
    for (float& number : vector) {
        char* end = nullptr;
        number = std::strtof(at, &end);
        if (end == at) throw std::runtime_error("not a vector: " + text);
        at = *end == ',' ? end + 1 : end;
    }
    if (*at != '\0') throw std::runtime_error("not a vector: " + text);
    return vector;
}

template <typename Named>
const Named& named(const std::vector<Named>& all, const std::string& name) {
    for (const Named& one : all)
        if (one.name == name) return one;
    throw std::runtime_error("the scene has no camera or light " + name);
}

Question question_of(const Line& line, const gnomon::scene::Scene& scene) {
    std::map<std::string, std::string> options;
    std::istringstream words(line.options);
    for (std::string option, value; words >> option >> value;) options[option] = value;
    const auto taken = [&](const std::string& option) {
        const auto found = options.extract(option);
        return found.empty() ? std::string() : found.mapped();
    };
    Question question;
    if (std::sscanf(taken("--size").c_str(), "%ux%u", &question.width, &question.height) != 2)
        throw std::runtime_error("a line needs --size WxH");
    if (const std::string samples = taken("--samples"); !samples.empty())
        question.samples = static_cast<std::uint32_t>(std::stoul(samples));
    if (const std::string camera = taken("--camera"); !camera.empty())
        question.camera = named(scene.cameras, camera).camera;
    else
        question.camera = gnomon::Camera::look_at(vector_of(taken("--eye")), vector_of(taken("--target")), {0, 1, 0},
                                                  std::stod(taken("--fovy")));
    if (const std::string light = taken("--light"); !light.empty())
        question.light = named(scene.lights, light).light;
    else if (const std::string position = taken("--light-position"); !position.empty())
        question.light = gnomon::Light::point(vector_of(position));
    else
        question.light = gnomon::Light::directional(vector_of(taken("--light-direction")));
    if (!options.empty()) throw std::runtime_error("the golden record does not know " + options.begin()->first);
    return question;
}

/// A scene of a recipe of make_scenes, through a file as a user would make it; the file is then removed.
gnomon::scene::Scene made(const std::string& recipe_name, std::uint64_t triangles) {
    for (const gnomon::make_scenes::Recipe& recipe : gnomon::make_scenes::recipes()) {
        if (recipe.name != recipe_name) continue;
        gnomon::make_scenes::Scene scene = recipe.make({triangles, 1});
        scene.name = recipe.name;
        const auto file = std::filesystem::temp_directory_path() /
                          ("gnomon_golden_" + std::to_string(std::random_device{}()) + ".glb");
        gnomon::make_scenes::write_glb(scene, file);
        gnomon::scene::Scene loaded = gnomon::scene::load(file);
        std::filesystem::remove(file);
        return loaded;
    }
    throw std::runtime_error("make_scenes has no recipe " + recipe_name);
}

/// The scene of a line, kept until a line with another scene; null if it is a shared file that is missing.
const gnomon::scene::Scene* scene_of(const Line& line) {
    static std::string kept;
    static gnomon::scene::Scene scene;
    if (kept == line.scene) return &scene;
    const std::size_t colon = line.scene.find(':');
    const auto file = std::filesystem::path(line.is_shared ? GNOMON_SHARED_SCENES : GNOMON_SCENES) / line.scene;
    if (colon != std::string::npos)
        scene = made(line.scene.substr(0, colon), std::stoull(line.scene.substr(colon + 1)));
    else if (line.scene == "sundial")
        scene = gnomon::scene::sundial();
    else if (line.is_shared && !std::filesystem::exists(file))
        return nullptr;
    else
        scene = gnomon::scene::load(file, {.decode_alpha = support::alpha_of_png});
    kept = line.scene;
    return &scene;
}

// ---- The findings ---------------------------------------------------------------------------------------------------

/// FNV-1a of 64 bits over the values' bytes, one after the other.
class Hash {
public:
    template <typename Value>
    Hash& add(const std::vector<Value>& values) {
        const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
        for (std::size_t i = 0; i < values.size() * sizeof(Value); ++i) hash_ = (hash_ ^ bytes[i]) * 0x100000001b3u;
        return *this;
    }
    std::string text() const {
        char digits[17];
        std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash_));
        return digits;
    }

private:
    std::uint64_t hash_ = 0xcbf29ce484222325u;
};

struct Way {
    const char* name;
    bool prepare, clusters;
};
constexpr Way ways[] = {{"animated", false, false},
                        {"light prepared", true, false},
                        {"clusters kept", false, true},
                        {"light prepared and clusters kept", true, true}};

/// The oracle's: 1 in shadow.
std::vector<std::uint8_t> shadowed(const gnomon::scene::Scene& scene, const Question& question,
                                   const gnomon::PointsOnHost& points) {
    const reference::Masks masks = support::masks_of(scene);
    return reference::shadowed(scene.triangles, points.position, points.receiver, question.light.xyzw,
                               question.camera.eye, nullptr, scene.cut_outs.empty() ? nullptr : &masks);
}

/// Fails if the oracle's visibility of a point differs.
void expect_oracle(const gnomon::scene::Scene& scene, const Question& question, const gnomon::PointsOnHost& points,
                   const std::vector<float>& visibility) {
    const auto truth = shadowed(scene, question, points);
    ASSERT_EQ(truth.size(), visibility.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) wrong += visibility[i] != (truth[i] ? 0.0f : 1.0f);
    EXPECT_EQ(wrong, 0u) << "of " << truth.size() << " points: the oracle says otherwise";
}

/// Mean visibility of the samples; if `ask_oracle` is true, each sample's visibility is compared with the oracle's.
std::vector<float> mean_of(gnomon::Technique& technique, const gnomon::Device& device,
                           const gnomon::Triangles& triangles, const gnomon::View& view,
                           const gnomon::scene::Scene& scene, const Question& question, bool ask_oracle) {
    const gnomon::Visibility mean(device, view.points.count());
    gnomon::run_samples(technique, triangles, view, question.light, question.samples, mean);
    const std::vector<float> found = mean.read();
    if (!ask_oracle) return found;
    std::vector<std::uint32_t> lit(found.size());
    std::size_t samples = 0;
    const auto judge = [&](const gnomon::Points& points) {
        const auto truth = shadowed(scene, question, points.read(device));
        for (std::size_t i = 0; i < truth.size(); ++i) lit[(samples + i) % lit.size()] += truth[i] == 0;
        samples += truth.size();
    };
    gnomon::run_samples(technique, triangles, view, question.light, question.samples, mean, judge);
    EXPECT_EQ(samples, found.size() * question.samples);
    EXPECT_EQ(mean.read(), found) << "handing out the samples changed the answer";
    std::size_t wrong = 0;
    // The number of samples is a power of two: the mean is exact.
    for (std::size_t i = 0; i < found.size(); ++i)
        wrong += found[i] != static_cast<float>(lit[i]) / static_cast<float>(question.samples);
    EXPECT_EQ(wrong, 0u) << "of " << found.size() << " pixels: the oracle says otherwise about their samples";
    return found;
}

/// The library's results in one of the ways, in a line's form. A prepared light decides some points by its map before
/// it tests whether they are backfacing. So it does not count all backfacing points, and that count is left out.
std::string findings_of(const gnomon::Device& device, const gnomon::scene::Scene& scene, const Question& question,
                        const Way& way, bool ask_oracle) {
    auto triangles = gnomon::scene::upload(device, scene);
    if (way.clusters) triangles.keep_clusters(device);
    const gnomon::View view = gnomon::look(device, triangles, question.camera, question.width, question.height);
    const auto technique = gnomon::make_technique("frustum-traced", device);
    if (way.prepare) technique->prepare(triangles, question.light);
    const gnomon::Visibility result(device, view.points.count());
    const gnomon::Statistics statistics = technique->run(triangles, view.points, question.light, result);
    const std::vector<float> visibility = result.read();
    // Sky has the position 0 here, whatever NaN the device wrote.
    const gnomon::ViewOnHost host = view.read(device, triangles);

    std::uint64_t dark = 0;
    for (const float value : visibility) dark += value == 0;
    EXPECT_EQ(dark, statistics.count("points_in_shadow")) << "the mask and the statistics differ, " << way.name;
    std::ostringstream text;
    text << "triangles " << scene.triangle_count() << " scene " << Hash().add(scene.triangles).text() << " points "
         << statistics.count("points") << " absent " << statistics.count("points_absent");
    if (!way.prepare) text << " facing_away " << statistics.count("points_facing_away");
    text << " in_shadow " << statistics.count("points_in_shadow") << " camera "
         << Hash().add(host.position).add(host.receiver).text() << " visibility " << Hash().add(visibility).text();
    if (question.samples > 1) {
        const auto mean = mean_of(*technique, device, triangles, view, scene, question, ask_oracle);
        text << " mean " << Hash().add(mean).text();
    }
    if (ask_oracle) expect_oracle(scene, question, view.points.read(device), visibility);
    return text.str();
}

std::string without_facing_away(const std::string& findings) {
    const std::size_t first = findings.find("facing_away "), next = findings.find("in_shadow ");
    return first < next && next != std::string::npos ? findings.substr(0, first) + findings.substr(next) : findings;
}

/// The names of the values that differ, for a short message.
std::string differences(const std::string& recorded, const std::string& found) {
    std::istringstream old_words(recorded), new_words(found);
    std::string result;
    for (std::string name, was, other_name, is; new_words >> other_name >> is;) {
        if (!(old_words >> name >> was)) name.clear(), was.clear();
        if (name != other_name || was != is) result += (result.empty() ? "" : ", ") + other_name;
    }
    return result.empty() ? "something recorded is not found any more" : result;
}

// ---- The tests ------------------------------------------------------------------------------------------------------

class Golden : public testing::TestWithParam<Line> {};

TEST_P(Golden, IsWhatItWas) {
    const Line& line = GetParam();
    const gnomon::scene::Scene* scene = scene_of(line);
    if (!scene) GTEST_SKIP() << "NOT TESTED: " GNOMON_SHARED_SCENES "/" << line.scene << " is missing";
    static const gnomon::Device device;
    const Question question = question_of(line, *scene);
    const char* oracle = std::getenv("GNOMON_GOLDEN_ORACLE");
    std::string animated;
    for (const Way& way : ways) {
        const bool is_first = &way == &ways[0];
        const std::string found = findings_of(device, *scene, question, way, oracle && *oracle && is_first);
        if (is_first) animated = found;
        const std::string recorded = way.prepare ? without_facing_away(line.findings) : line.findings;
        EXPECT_EQ(found, recorded) << "differs, " << way.name << ": " << differences(recorded, found)
                                   << "\nto see it: " << command_of(line);
    }
    if (const char* file = std::getenv("GNOMON_GOLDEN_WRITE"); file && *file)
        std::ofstream(file, std::ios::app)
            << line.name << ": " << line.scene << " " << line.options << " => " << animated << "\n";
}

std::string name_of(const testing::TestParamInfo<Line>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(SharedScenes, Golden, testing::ValuesIn(lines_of("shared_scenes.txt", true)), name_of);
INSTANTIATE_TEST_SUITE_P(RealScenes, Golden, testing::ValuesIn(lines_of("real_scenes.txt", false)), name_of);
INSTANTIATE_TEST_SUITE_P(MadeScenes, Golden, testing::ValuesIn(lines_of("made_scenes.txt", false)), name_of);

// Without records no test would run, and none would fail.
TEST(GoldenRecord, IsThere) {
    EXPECT_GE(lines_of("shared_scenes.txt", true).size(), 8u);
    EXPECT_GE(lines_of("real_scenes.txt", false).size(), 34u);
    EXPECT_GE(lines_of("made_scenes.txt", false).size(), 80u);
}

}  // namespace
