// SPDX-License-Identifier: MIT
// The benchmark, run as a person runs it, on small scenes: its errors are right and its outputs agree. Never its times.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "bench/experiments.hpp"
#include "bench/json.hpp"
#include "bench/peers.hpp"
#include "bench/thread_table.hpp"

namespace gnomon::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string text_in(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// A folder of its own for each test, removed at its end.
class Bench : public testing::Test {
protected:
    Bench()
        : folder_(fs::temp_directory_path() / ("gnomon_bench_test_" + std::to_string(getpid()) + "_" +
                                               testing::UnitTest::GetInstance()->current_test_info()->name())) {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    ~Bench() override { fs::remove_all(folder_); }

    std::string path(const char* name) const { return (folder_ / name).string(); }
    int run(const std::string& arguments) const {
        const std::string command = GNOMON_BENCH " " + arguments + " >" + path("stdout") + " 2>" + path("stderr");
        return std::system(command.c_str());
    }
    std::string errors() const { return text_in(path("stderr")); }
    Json json(const char* name) const { return Json::parse(text_in(path(name))); }

private:
    fs::path folder_;
};

// ---- CSV, read without our own code ---------------------------------------------------------------------------------

std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
            fields.back() += line[i++];
        else if (line[i] == '"')
            quoted = !quoted;
        else if (line[i] == ',' && !quoted)
            fields.emplace_back();
        else
            fields.back() += line[i];
    }
    return fields;
}

std::vector<std::map<std::string, std::string>> csv_rows(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> heads;
    std::vector<std::map<std::string, std::string>> rows;
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with("# ")) continue;
        const std::vector<std::string> fields = fields_of(line);
        if (heads.empty()) {
            heads = fields;
            continue;
        }
        EXPECT_EQ(fields.size(), heads.size()) << line;
        rows.emplace_back();
        for (std::size_t i = 0; i < std::min(fields.size(), heads.size()); ++i) rows.back()[heads[i]] = fields[i];
    }
    return rows;
}

void expect_same(const Json& row, const std::map<std::string, std::string>& csv) {
    for (const auto& [head, text] : csv) {
        const Json::json_pointer at(std::string("/").append(head));
        if (!row.contains(at)) {
            EXPECT_EQ(text, "") << head;
        } else if (row.at(at).is_string()) {
            EXPECT_EQ(text, row.at(at).get<std::string>()) << head;
        } else if (row.at(at).is_boolean()) {
            EXPECT_EQ(text, row.at(at).get<bool>() ? "true" : "false") << head;
        } else {
            EXPECT_EQ(std::stod(text), row.at(at).get<double>()) << head;
        }
    }
}

// ---- The whole program ----------------------------------------------------------------------------------------------

TEST_F(Bench, ErrorsAndOutputsOfTheSundialAgreeExhaustive) {
    std::string arguments =
        "sundial --technique frustum-traced --technique shadow-map --peers --oracle 100000 --runs 1 --size 320x180 "
        "--stages --mode animated --mode static";
    for (const char* output : {"json", "csv"})
        arguments.append(" --").append(output).append(" ").append(path("all.")).append(output);
    ASSERT_EQ(run(arguments), 0) << errors();
    const Json all = json("all.json");
    for (const char* key : {"date", "processor", "system", "compiler", "gnomon", "commit", "opencl_devices"})
        EXPECT_TRUE(all["machine"].contains(key)) << key;
    EXPECT_EQ(all["experiments"].size(), experiments().size());
    EXPECT_EQ(all["families"].size(), families().size());

    int exact_rows = 0, approximate_rows = 0, rival_rows = 0, missed_nearby = 0;
    for (const Json& row : all["rows"]) {
        SCOPED_TRACE(row["technique"].get<std::string>() + " " + row["settings"].get<std::string>());
        ASSERT_FALSE(row.contains("failed"));
        const Json& e = row["errors"];
        EXPECT_EQ(e["points"], 320 * 180);
        EXPECT_EQ(e["wrong"].get<int>(), e["wrongly_lit"].get<int>() + e["wrongly_shadowed"].get<int>());
        EXPECT_EQ(row["ms"]["runs"], 1);
        EXPECT_EQ(row["picture"]["width"], 320);
        EXPECT_EQ(row["picture"]["error"] == "0*57600", e["wrong"] == 0);  // of hard shadows
        EXPECT_LE(row["ms"]["least"].get<double>(), row["ms"]["median"].get<double>());
        EXPECT_LE(row["ms"]["median"].get<double>(), row["ms"]["most"].get<double>());
        rival_rows += row["technique"] == "embree";
        // Rays that start 1e-4 of the scene along their way miss what stands nearer: their points are wrongly lit.
        if (row["settings"].get<std::string>().find(" offset=0.0001 ") != std::string::npos)
            missed_nearby += e["wrongly_lit"].get<int>();
        if (row["technique"] == "shadow-map") {
            ++approximate_rows;
            EXPECT_GT(e["wrong"], 0) << "a shadow map of 2048 texels is not exact";
            EXPECT_GT(e["mean_absolute"], 0);
        }
        if (!row["exact"].get<bool>()) continue;
        ++exact_rows;
        EXPECT_EQ(e["wrong"], 0);
        EXPECT_GT(row["oracle"]["points"].get<int>(), 10000);
        EXPECT_EQ(row["oracle"]["wrong"], 0);
        EXPECT_EQ(row["oracle"]["rays"], 320 * 180);
        EXPECT_EQ(row["oracle"]["wrong_rays"], 0);
        EXPECT_GT(row["counts"]["points_in_shadow"].get<int>(), 0);
        const bool is_still = row["mode"] == "static";
        EXPECT_EQ(row["counts"]["prepared"], is_still ? 1 : 0);
        EXPECT_EQ(row.contains("build_ms"), is_still);
        EXPECT_TRUE(row.contains("stages_ms"));
    }
    EXPECT_EQ(exact_rows, 2);        // animated and static
    EXPECT_EQ(approximate_rows, 2);  // which keeps nothing
    if (embree_version() != "not built in") {
        EXPECT_EQ(rival_rows, 17);
        EXPECT_GT(missed_nearby, 0);
    }

    const auto csv = csv_rows(text_in(path("all.csv")));
    ASSERT_EQ(csv.size(), all["rows"].size());
    for (std::size_t i = 0; i < csv.size(); ++i) expect_same(all["rows"][i], csv[i]);
}

// The oracle decides each sample's point by itself, and whether it is where its ray says; Embree finds the samples of
// gnomon's pattern by itself, or the means would not agree.
TEST_F(Bench, SamplesAgreeWithTheOracleAndWithEmbree) {
    ASSERT_EQ(run("sundial --samples 1 --samples 8 --samples 32 --oracle 2000 --runs 1 --size 80x45 --json " +
                  path("oracle.json")),
              0)
        << errors();
    const Json with_oracle = json("oracle.json");
    for (const Json& row : with_oracle["rows"]) {
        EXPECT_GT(row["oracle"]["points"].get<int>(), 500) << row["settings"];
        EXPECT_EQ(row["oracle"]["wrong"], 0) << row["settings"];
        EXPECT_GT(row["oracle"]["rays"].get<int>(), 500) << row["settings"];
        EXPECT_EQ(row["oracle"]["wrong_rays"], 0) << row["settings"];
    }
    ASSERT_EQ(run("sundial --samples 1 --samples 8 --peers --runs 1 --size 160x91 --json " + path("samples.json")), 0)
        << errors();
    const Json all = json("samples.json");
    std::vector<Json> ours, rivals;
    for (const Json& row : all["rows"]) (row["technique"] == "embree" ? rivals : ours).push_back(row);
    ASSERT_EQ(ours.size(), 2u);
    EXPECT_EQ(ours[0]["settings"], "");
    EXPECT_EQ(ours[1]["settings"], "samples=8");
    EXPECT_NE(ours[0]["mask_hash"], ours[1]["mask_hash"]);
    EXPECT_EQ(ours[1]["counts"]["points"], 8 * 160 * 91);
    if (embree_version() == "not built in") return;
    ASSERT_EQ(rivals.size(), 3u);  // trees of three qualities
    for (const Json& row : rivals) {
        SCOPED_TRACE(row["settings"].get<std::string>());
        EXPECT_TRUE(row["settings"].get<std::string>().ends_with("samples=8"));
        // Embree's samples lie on the triangle that is nearest, gnomon's on the pixel's receiver where their rays meet
        // it: .0111 at the edges of so small a picture. With the pattern upside down it is .0208.
        EXPECT_LT(row["errors"]["mean_absolute"].get<double>(), 0.015);
    }
}

// Every part of a frame has its time in every mode, and the frame is their sum, run by run.
TEST_F(Bench, FramesAreTheSumOfTheirParts) {
    ASSERT_EQ(run("sundial --mode animated --mode moving --mode static --peers --runs 2 --size 160x91 --threads 2 "
                  "--errors --json " +
                  path("frames.json")),
              0)
        << errors();
    const Json all = json("frames.json");
    std::map<std::string, int> rows_of_frames;
    for (const Json& row : all["rows"]) {
        if (!row.contains("frame_ms")) continue;
        SCOPED_TRACE(row["technique"].get<std::string>() + " " + row["mode"].get<std::string>());
        ++rows_of_frames[row["technique"]];
        const bool is_rebuilt = row["technique"] == "embree" && row["mode"] == "animated";
        EXPECT_EQ(row["runs"].contains("build"), is_rebuilt);
        std::vector<double> sums(2);
        for (const auto& [part, times] : row["runs"].items()) {
            ASSERT_EQ(times["wall_ms"].size(), 2u) << part;
            for (std::size_t i = 0; i < 2; ++i) sums[i] += times["wall_ms"][i].get<double>();
        }
        EXPECT_NEAR(row["frame_ms"]["median"].get<double>(), (sums[0] + sums[1]) / 2, 1e-9);
        EXPECT_GT(row["shade_ms"]["median"], 0);
        // Embree's floats see another triangle at some edges, never in many pixels.
        if (row["technique"] == "embree") {
            EXPECT_LT(row["counts"]["points_on_other_triangles"].get<int>(), 160 * 91 / 100);
        }
    }
    EXPECT_EQ(rows_of_frames["frustum-traced"], 3);
    if (embree_version() != "not built in") {
        EXPECT_EQ(rows_of_frames["embree"], 3);
    }
}

// What the experiment says is empty is empty: no point sees a triangle, or none faces the light.
TEST_F(Bench, SkipsShowViewsWithNothingToDo) {
    ASSERT_EQ(run("--experiment skips --largest-triangles 20000 --largest-points 57600 --runs 1 --json " +
                  path("skips.json")),
              0)
        << errors();
    const Json all = json("skips.json");
    int sky_rows = 0, unlit_rows = 0, busy_rows = 0;
    for (const Json& row : all["rows"]) {
        SCOPED_TRACE(row["view"].get<std::string>() + "." + row["light"].get<std::string>());
        const Json& counts = row["counts"];
        const int points = counts["points"], absent = counts["points_absent"], away = counts["points_facing_away"];
        EXPECT_EQ(points, 320 * 180);
        if (row["view"] == "sky") {
            ++sky_rows;
            EXPECT_EQ(absent, points);
        } else if (row["light"] == "from_below") {
            ++unlit_rows;
            EXPECT_GT(away, points / 2);
            EXPECT_EQ(absent + away, points);
        } else {
            ++busy_rows;
            EXPECT_LT(absent + away, points);
            EXPECT_FALSE(row.contains("skipped") && row["skipped"].contains("trace"));
            continue;
        }
        EXPECT_EQ(counts["tests"], 0);
        EXPECT_TRUE(row["skipped"].contains("trace"));
    }
    EXPECT_EQ(sky_rows, 4);  // two scenes, two modes
    EXPECT_EQ(unlit_rows, 2);
    EXPECT_EQ(busy_rows, 6);
}

// A technique that is wrong by a known amount: exact shadows, but of a light that is tilted so that the shadow of a
// roof 2 above the ground moves by 2 points. The roof is 25 by 21 points large, and no point lies under its edges.
TEST_F(Bench, AShiftedLightIsWrongInTwoColumnsOnEitherSide) {
    const std::vector<float> roof{15.5f, 2, 9.5f, 40.5f, 2, 9.5f,  40.5f, 2, 30.5f,
                                  15.5f, 2, 9.5f, 40.5f, 2, 30.5f, 15.5f, 2, 30.5f};
    constexpr std::uint32_t side = 64;
    std::vector<float> ground;
    for (std::uint32_t z = 0; z < side; ++z)
        for (std::uint32_t x = 0; x < side; ++x) ground.insert(ground.end(), {float(x), 0, float(z)});
    const Device device;
    const auto triangles = Triangles::upload(device, roof);
    const auto points = Points::upload(device, ground);
    const auto mask_of = [&](const Float3& direction) {
        const Visibility visibility(device, points.count());
        make_technique(truth_configuration().technique, device)
            ->run(triangles, points, Light::directional(direction), visibility);
        return visibility.read();
    };
    const auto errors = measure::visibility_errors(mask_of({1, -1, 0}), mask_of({0, -1, 0}), side, side);
    EXPECT_EQ(errors.points, side * side);
    EXPECT_EQ(errors.wrongly_lit, 2u * 21);
    EXPECT_EQ(errors.wrongly_shadowed, 2u * 21);
    EXPECT_EQ(errors.mean_absolute, 4.0 * 21 / (side * side));
    EXPECT_EQ(errors.worst_tile, 2.0 * 21 / (32 * 32));
}

TEST_F(Bench, SoftTruthsMeasurePenumbraeExhaustive) {
    ASSERT_EQ(run("sundial --sun-angle 3 --size 120x68 --runs 1 --json " + path("a.json")), 0) << errors();
    const Json report = json("a.json");
    std::set<std::string> names;
    for (const Json& row : report["rows"]) {
        names.insert(row["technique"]);
        const bool is_truth = row["settings"] == "sun-samples=1024";
        EXPECT_EQ(row["exact"], is_truth);
        EXPECT_GT(row["errors"]["penumbra_points"].get<double>(), 50);
        EXPECT_EQ(row["errors"]["penumbra_mean_absolute"] == 0, is_truth) << row["technique"];
    }
    for (const char* name : {"frustum-traced", "pcss", "pcf", "vsm", "msm64"})
        EXPECT_TRUE(names.contains(name)) << name;
}

// Four ways to the same bits, and a rival that errs in few. On faces the normals of a scene of closed solids show a sun
// or not; half of all directions are in front of a face, but suns are never below.
TEST_F(Bench, ManyLightsCountTheSameDecisions) {
    ASSERT_EQ(run("town:10000 --many-lights suns:40 --points 3000 --runs 2 --peers --technique frustum-traced "
                  "--technique izb --json " +
                  path("faces.json") + " --csv " + path("faces.csv")),
              0)
        << errors();
    ASSERT_EQ(run("town:10000 --many-lights suns:40 --points 3000 --runs 1 --set many-lights=beams --json " +
                  path("beams.json")),
              0)
        << errors();
    const Json faces = json("faces.json"), beams = json("beams.json");
    ASSERT_EQ(faces["rows"].size(), embree_version() == "not built in" ? 2u : 3u);
    const Json& ours = faces["rows"][0];
    EXPECT_EQ(ours["mask_hash"], beams["rows"][0]["mask_hash"]);
    EXPECT_EQ(ours["mask_hash"], faces["rows"][1]["mask_hash"]);
    const Json& pairs = ours["pairs"];
    EXPECT_EQ(pairs["points"], 3000);
    EXPECT_EQ(pairs["lights"], 40);
    EXPECT_EQ(pairs["differing"], 0);
    const auto facing = pairs["facing"].get<double>(), lit = pairs["lit"].get<double>();
    EXPECT_GT(facing, 3000 * 40 * 0.4);
    EXPECT_LT(facing, 3000 * 40 * 0.95);
    EXPECT_GT(lit, facing * 0.2);
    EXPECT_LT(lit, facing * 0.9);
    EXPECT_NEAR(pairs["facing_per_second"].get<double>(), facing / ours["ms"]["median"].get<double>() * 1e3, facing);
    const auto csv = csv_rows(text_in(path("faces.csv")));
    ASSERT_EQ(csv.size(), faces["rows"].size());
    for (std::size_t i = 0; i < csv.size(); ++i) expect_same(faces["rows"][i], csv[i]);
    if (faces["rows"].size() < 3) return;
    const Json& rival = faces["rows"][2];
    EXPECT_EQ(rival["technique"], "embree");
    EXPECT_EQ(rival["pairs"]["facing"], pairs["facing"]);
    EXPECT_LT(rival["pairs"]["differing"].get<double>(), 1e-3 * facing);
}

// All ways by turns, for the points of a picture; the tool fails where two exact masks differ.
TEST_F(Bench, ManyLightsTakeThePixelsOfAViewByEveryWay) {
    ASSERT_EQ(run("town:10000 --many-lights sky --pixels v0 --size 64x48 --sweep --runs 1 --peers --json " +
                  path("pixels.json")),
              0)
        << errors();
    const Json report = json("pixels.json");
    std::set<std::string> ways;
    for (const Json& row : report["rows"]) {
        EXPECT_EQ(row["view"], "v0");
        EXPECT_EQ(row["pairs"]["points"], 64 * 48);
        EXPECT_GT(row["pairs"]["lit"].get<double>(), 0.2 * row["pairs"]["facing"].get<double>());
        if (row["technique"] == "frustum-traced") ways.insert(row["settings"]);
    }
    EXPECT_EQ(ways, (std::set<std::string>{"many-lights=auto", "many-lights=one-by-one", "many-lights=point-beams",
                                           "many-lights=rays", "many-lights=beams"}));
}

TEST_F(Bench, ManyLightsTakeLamps) {
    for (const std::string lights : {"lamp:20", "lamps:20"}) {
        SCOPED_TRACE(lights);
        ASSERT_EQ(run("town:10000 --many-lights " + lights + " --points 900 --sweep --runs 1 --peers --json " +
                      path("lamps.json")),
                  0)
            << errors();
        const Json report = json("lamps.json");
        for (const Json& row : report["rows"]) {
            const Json& pairs = row["pairs"];
            EXPECT_EQ(pairs["lights"], 20);
            EXPECT_GT(pairs["facing"].get<double>(), 2000);
            EXPECT_GT(pairs["lit"].get<double>(), 0);
            EXPECT_LT(pairs["lit"].get<double>(), pairs["facing"].get<double>());
            EXPECT_LT(pairs["differing"].get<double>(), 1e-3 * pairs["facing"].get<double>());
        }
    }
}

TEST_F(Bench, ManyLightsTakeATerrainsVertices) {
    ASSERT_EQ(run("terrain:10000 --many-lights sky --points 700 --runs 1 --peers --json " + path("a.json")), 0)
        << errors();
    const Json report = json("a.json");
    for (const Json& row : report["rows"]) {
        EXPECT_EQ(row["view"], "vertices");
        EXPECT_EQ(row["pairs"]["points"], 700);
        EXPECT_EQ(row["pairs"]["lights"], 145);
        EXPECT_GT(row["pairs"]["lit"].get<double>(), 0.7 * row["pairs"]["facing"].get<double>());
        EXPECT_LT(row["pairs"]["differing"].get<double>(), 1e-3 * row["pairs"]["facing"].get<double>());
    }
}

TEST_F(Bench, ATerrainsRasterHasTheBitsOfItsTriangles) {
    ASSERT_EQ(run("terrain:10000 --many-lights suns:40 --points 700 --runs 1 --json " + path("a.json")), 0) << errors();
    const Json report = json("a.json");
    ASSERT_EQ(report["rows"].size(), 2u);
    const Json &triangles = report["rows"][0], &raster = report["rows"][1];
    EXPECT_EQ(triangles["settings"], "");
    EXPECT_EQ(raster["settings"], "triangles=raster");
    EXPECT_EQ(triangles["mask_hash"], raster["mask_hash"]);
    EXPECT_EQ(raster["pairs"]["differing"], 0);
    EXPECT_LT(raster["device_memory_bytes"].get<double>(), triangles["device_memory_bytes"].get<double>());
}

TEST_F(Bench, AnUnusableRequestFailsWithOneSentence) {
    EXPECT_NE(run(""), 0);
    EXPECT_NE(errors().find("--experiment"), std::string::npos) << errors();
    EXPECT_NE(run("sundial --size 0x10"), 0);
    EXPECT_NE(errors().find("WIDTHxHEIGHT"), std::string::npos) << errors();
    EXPECT_NE(run("nothing:1000"), 0);
    EXPECT_NE(errors().find("no recipe"), std::string::npos) << errors();
    EXPECT_NE(run("sundial --pixels v0"), 0);
    EXPECT_NE(errors().find("--many-lights"), std::string::npos) << errors();
    EXPECT_NE(run("sundial --many-lights sky --pixels nowhere"), 0);
    EXPECT_NE(errors().find("no view \"nowhere\""), std::string::npos) << errors();
    EXPECT_NE(run("sundial --many-lights moons --points 9"), 0);
    EXPECT_NE(errors().find("takes suns, suns:N, sky, sky:D, disk:N, lamp:N or lamps:N, not \"moons\""),
              std::string::npos)
        << errors();
    std::ofstream(path("views.json")) << "glTF";
    EXPECT_NE(run("sundial --views " + path("views.json")), 0);
    EXPECT_NE(errors().find("views.json are not JSON"), std::string::npos) << errors();
    EXPECT_NE(run("sundial --size 32x18 --set map-size=no"), 0) << "a technique that fails must fail the benchmark";
    EXPECT_NE(errors().find("map-size"), std::string::npos) << errors();
}

// ---- Its parts ------------------------------------------------------------------------------------------------------

TEST(BenchParts, TimesAreMedianExtremesAndQuartileDistance) {
    const Times times = times_of({5, 1, 9, 3, 7});
    EXPECT_EQ(times.median_ms, 5);
    EXPECT_EQ(times.least_ms, 1);
    EXPECT_EQ(times.most_ms, 9);
    EXPECT_EQ(times.spread_ms, 7 - 3);
    EXPECT_EQ(times.runs, 5u);
    EXPECT_EQ(times_of({2}).spread_ms, 0);
    EXPECT_EQ(times_of({4, 2}).median_ms, 3);
    EXPECT_EQ(times_of({4, 2}).spread_ms, 3.5 - 2.5);
}

TEST(BenchParts, RunsEndByNumberOrTime) {
    const RunRule rule{.most = 10, .seconds = 2};
    EXPECT_TRUE(rule.goes_on(0, 1e9)) << "one run at least";
    EXPECT_TRUE(rule.goes_on(9, 1999));
    EXPECT_FALSE(rule.goes_on(10, 1)) << "the most";
    EXPECT_FALSE(rule.goes_on(3, 2001)) << "time is spent";
    EXPECT_TRUE(rule.goes_on(2, 2001)) << "but not fewer than three";
    EXPECT_FALSE(rule.goes_on(2, 6001)) << "unless they take very long";
}

TEST(BenchParts, EveryTechniqueHasOneFamily) {
    std::vector<std::string> all{"embree"}, in_families;
    for (const TechniqueDescription& technique : techniques()) all.push_back(technique.name);
    for (const Family& family : families()) std::ranges::copy(family.techniques, std::back_inserter(in_families));
    std::ranges::sort(all);
    std::ranges::sort(in_families);
    EXPECT_EQ(all, in_families);
}

// By the statistics of the techniques themselves: all maps of a technique have the texels of one.
TEST(BenchParts, EqualTermsAreEqualTexelsAndOneFitExhaustive) {
    SceneShelf shelf("", "");
    const NamedScene& scene = shelf.get("sundial");
    const Place place("", scene, false);
    const Seen seen = seen_in(place, scene.cases.at(0), {96, 54});
    int several_maps = 0;
    for (const Light& light : {Light::directional({-0.4f, -1, -0.3f}), Light::point({1, 3, 2})})
        for (Configuration configuration : default_configurations()) {
            put_on_equal_terms(configuration, 64, !light.is_directional());
            SCOPED_TRACE(configuration.technique + ": " + configuration.terms);
            const Statistics statistics =
                make(configuration, place.device)->run(place.triangles, seen.view.points, light, seen.visibility);
            const bool shares_texels = configuration.technique == "logpsm-faces";  // which has room for its largest
            for (const auto& [name, count] : statistics.counts) {
                if (name == "map_views") several_maps += count > 1;
                if (name == "map_texels" && configuration.terms != "its own" && !shares_texels) {
                    EXPECT_NEAR(double(count), 64 * 64, 0.05 * 64 * 64);
                }
            }
            const bool has_own_fit = configuration.technique.find("ised-cascades") != std::string::npos;
            EXPECT_EQ(configuration.terms.ends_with(", receivers"), configuration.terms != "its own" && !has_own_fit);
            EXPECT_TRUE(configuration.asked.empty());
        }
    EXPECT_GT(several_maps, 30) << "the test would compare single maps alone";
    Configuration asked{"pssm", {{"size", "512"}, {"fit", "frustum"}}};
    put_on_equal_terms(asked, 64, false);
    EXPECT_EQ(asked.terms, "4 x 256², frustum");
}

// The sweep and the experiments name techniques and settings by hand: what they name must be there.
TEST(BenchParts, EverySettingThatIsSweptCanBeSet) {
    const Device device;
    std::vector<Configuration> all = swept_configurations();
    EXPECT_EQ(all.front().technique, truth_configuration().technique);
    EXPECT_TRUE(all.front().settings.empty());
    const SceneShelf shelf("", "");
    for (const Experiment& experiment : experiments())
        for (const Block& block : experiment.blocks(shelf, {})) {
            std::ranges::copy(block.configurations, std::back_inserter(all));
            EXPECT_EQ(block.sizes.empty(), block.many_lights.has_value()) << experiment.name;
            EXPECT_EQ(block.experiment, experiment.name);
            for (const Size size : block.sizes)
                if (block.more_settings) all.push_back({"frustum-traced", block.more_settings(size)});
        }
    for (const TechniqueDescription& technique : techniques())
        EXPECT_TRUE(std::ranges::any_of(all, [&](const auto& c) { return c.technique == technique.name; }))
            << technique.name << " is not in the sweep";
    for (const Configuration& configuration : all) {
        const auto technique = make_technique(configuration.technique, device);
        for (const auto& [key, value] : configuration.settings)
            EXPECT_NO_THROW(technique->set(key, value)) << configuration.technique << " " << key << "=" << value;
    }
}

TEST(BenchParts, ExperimentsStayWithinTheMachinesLimits) {
    const SceneShelf shelf("", "");
    for (const Limits& limits : {Limits{.largest_triangles = 200'000, .largest_points = 1'000'000}, small_limits})
        for (const Experiment& experiment : experiments()) {
            const std::vector<Block> blocks = experiment.blocks(shelf, limits);
            EXPECT_FALSE(blocks.empty()) << experiment.name;
            for (const Block& block : blocks) {
                const bool is_sweep = block.configurations.size() >= techniques().size();
                const std::size_t colon = block.scene.find(':');
                ASSERT_NE(colon, std::string::npos) << "without a folder all scenes are made ones";
                EXPECT_LE(std::stoull(block.scene.substr(colon + 1)),
                          is_sweep ? limits.swept_triangles : limits.largest_triangles);
                EXPECT_EQ(block.sizes.empty(), block.many_lights.has_value()) << experiment.name;
                if (block.many_lights) {
                    EXPECT_LE(block.many_lights->points, limits.largest_points);
                }
                for (const Size size : block.sizes)
                    EXPECT_LE(std::uint64_t(size.width) * size.height,
                              is_sweep ? limits.swept_points : limits.largest_points)
                        << experiment.name;
                for (const Configuration& configuration : block.configurations)
                    for (const auto& [key, value] : configuration.settings)
                        EXPECT_TRUE(!is_sweep || (key != "size" && key != "map-size") ||
                                    std::stoul(value) <= limits.swept_map)
                            << configuration.technique << " " << key << "=" << value;
            }
        }
}

// A tree that is built in each run counts in each part that needs it, and once in the frame.
TEST(BenchParts, TimesOfPartsHoldTheBuild) {
    Row row;
    row.set_runs({{.build = {2, 4}, .camera = {6, 6}, .shadow = {4, 4}, .shade = {2, 2}},
                  {.build = {4, 8}, .camera = {12, 12}, .shadow = {8, 8}, .shade = {4, 4}},
                  {.build = {2, 4}, .camera = {6, 6}, .shadow = {4, 4}, .shade = {2, 2}}},
                 true);
    EXPECT_EQ(row.build->median_ms, 2);
    EXPECT_EQ(row.camera->median_ms, 8);
    EXPECT_EQ(row.total.median_ms, 6);
    EXPECT_EQ(row.frame->median_ms, 14);
    EXPECT_EQ(to_json(row)["runs"]["camera"]["processor_ms"], Json({6, 12, 6}));
    Row still;
    still.set_runs({{{}, {5, 5}, {4, 4}, {2, 2}}}, true);
    EXPECT_FALSE(still.build.has_value());
    EXPECT_EQ(still.frame->median_ms, 11);
    EXPECT_FALSE(to_json(still)["runs"].contains("build"));
}

// A rival's settings hold its number of threads; rows of one name are told apart by their order.
TEST(BenchParts, ThreadTimesAreOfTheSameRowAndPart) {
    const auto row = [](const char* technique, const char* settings, double ms, Json stages) {
        Json json{{"scene", "s"},          {"view", "v"},      {"light", "l"},           {"width", 8},
                  {"height", 4},           {"mode", "static"}, {"technique", technique}, {"settings", settings},
                  {"ms", {{"median", ms}}}};
        if (!stages.is_null()) json["stages_ms"] = std::move(stages);
        return json;
    };
    const Json two{
        {"rows",
         {row("ours", "", 12, {{"facing", 3.0}, {"trace", 8.0}, {"clusters", 0.0}, {"once", 1.0}}),
          row("rival", "build=low threads=2", 20, nullptr), row("rival", "build=high threads=2", 10, nullptr)}}};
    const Json sixteen{
        {"rows",
         {row("ours", "", 3, {{"facing", 1.0}, {"trace", 2.0}, {"clusters", 0.0}}),
          row("rival", "build=low threads=16", 5, nullptr), row("rival", "build=high threads=16", 2, nullptr)}}};
    const std::vector<ThreadTimes> table = thread_times(std::vector<std::string>{two.dump(), sixteen.dump()});
    const std::vector<std::pair<std::string, std::vector<double>>> wanted = {
        {"shadow", {12, 3}}, {"  facing", {3, 1}}, {"  trace", {8, 2}}, {"shadow", {20, 5}}, {"shadow", {10, 2}}};
    ASSERT_EQ(table.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        EXPECT_EQ(table[i].part, wanted[i].first) << i;
        EXPECT_EQ(table[i].ms, wanted[i].second) << i;
    }
    EXPECT_EQ(table[4].row, "s v.l 8x4 rival (static) build=high threads=2");
}

TEST(BenchParts, AFailureHasNoFigures) {
    Row row;
    row.failed = "it broke, \"twice\"";
    EXPECT_EQ(to_json(row)["failed"], row.failed);
    EXPECT_FALSE(to_json(row).contains("ms"));
    const std::vector<Row> rows{row};
    const std::string csv = report_csv({{"date", "today"}}, rows);
    EXPECT_TRUE(csv.starts_with("# date: \"today\"\nexperiment,scene,")) << csv;
    EXPECT_EQ(csv_rows(csv).at(0).at("failed"), row.failed);
}

// 1300 columns become 434: the last of them holds one column of points.
TEST(BenchParts, ReducedMasksKeepTheWorstError) {
    constexpr std::uint32_t width = 1300, height = 4;
    std::vector<float> truth(width * height, 1.0f);
    std::vector<std::uint32_t> receivers(truth.size(), 0);
    std::vector<float> mask = truth;
    mask[0] = 0.001f;              // of 9 points of the first pixel, one
    mask[width + 4] = 0.9999f;     // the smallest error still shows
    mask[width * 3 + 1299] = NAN;  // as wrong as can be
    for (std::uint32_t y = 0; y < 3; ++y)
        for (std::uint32_t x = 6; x < 9; ++x) receivers[y * width + x] = no_receiver;
    const ReducedMask reduced = reduced_mask(mask, truth, receivers, width, height);
    ASSERT_EQ(reduced.width, 434u);
    ASSERT_EQ(reduced.height, 2u);
    ASSERT_EQ(reduced.mask.size(), 868u);
    EXPECT_EQ(std::vector(reduced.mask.begin(), reduced.mask.begin() + 4), (std::vector{227, 255, -1, 255}));
    EXPECT_EQ(std::vector(reduced.error.begin(), reduced.error.begin() + 4), (std::vector{-255, -1, 0, 0}));
    EXPECT_EQ(reduced.mask.back(), 0);
    EXPECT_EQ(reduced.error.back(), -255);

    Row row;
    row.picture = ReducedMask{3, 2, {255, 255, -1, 0, 0, 0}, {0, 0, 0, 0, -1, 7}};
    const Json picture = to_json(row)["picture"];
    EXPECT_EQ(picture["mask"], "255*2 -1 0*3");
    EXPECT_EQ(picture["error"], "0*4 -1 7");
}

}  // namespace
}  // namespace gnomon::bench
