// SPDX-License-Identifier: MIT
#include "json.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include <gnomon.hpp>
#include "experiments.hpp"
#include "sweep.hpp"

namespace gnomon::bench {

namespace {

using Json = nlohmann::ordered_json;

Json times_json(const Times& times) {
    return {{"median", times.median_ms},
            {"least", times.least_ms},
            {"most", times.most_ms},
            {"spread", times.spread_ms},
            {"runs", times.runs}};
}

Json errors_json(const measure::VisibilityErrors& errors) {
    return {{"points", errors.points},
            {"wrong", errors.wrong()},
            {"wrong_share", errors.wrong_share()},
            {"wrongly_lit", errors.wrongly_lit},
            {"wrongly_shadowed", errors.wrongly_shadowed},
            {"mean_absolute", errors.mean_absolute},
            {"ssim", errors.ssim},
            {"penumbra_points", errors.penumbra_points},
            {"penumbra_mean_absolute", errors.penumbra_mean_absolute},
            {"worst_tile", errors.worst_tile},
            {"worst_tile_x", errors.worst_tile_x},
            {"worst_tile_y", errors.worst_tile_y}};
}

Json pairs_json(const LightPairs& pairs, const Times& total) {
    return {{"points", pairs.points},
            {"lights", pairs.lights},
            {"points_made", pairs.points_made},
            {"lights_hash", pairs.lights_hash},
            {"facing", pairs.facing},
            {"lit", pairs.lit},
            {"differing", pairs.differing},
            {"facing_per_second", double(pairs.facing) / total.median_ms * 1e3},
            {"ms_per_light", total.median_ms / double(pairs.lights)}};
}

// Each part of each run. Parts that never ran are left out.
Json runs_json(const Row& row) {
    Json json = Json::object();
    constexpr std::pair<const char*, RunTimes FrameTimes::*> parts[] = {{"build", &FrameTimes::build},
                                                                        {"camera", &FrameTimes::camera},
                                                                        {"shadow", &FrameTimes::shadow},
                                                                        {"shade", &FrameTimes::shade}};
    for (const auto& [name, part] : parts) {
        if (std::ranges::all_of(row.runs, [&](const FrameTimes& run) { return (run.*part).wall_ms == 0; })) continue;
        for (const FrameTimes& run : row.runs) {
            json[name]["wall_ms"].push_back((run.*part).wall_ms);
            json[name]["processor_ms"].push_back((run.*part).processor_ms);
        }
    }
    return json;
}

// "255*1200 -1 254*3": neighbours of a picture are mostly equal.
std::string run_lengths(const std::vector<int>& values) {
    std::string text;
    for (auto first = values.begin(); first != values.end();) {
        const auto end = std::find_if(first, values.end(), [&](int value) { return value != *first; });
        text.append(text.empty() ? "" : " ").append(std::to_string(*first));
        if (end - first > 1) text.append("*").append(std::to_string(end - first));
        first = end;
    }
    return text;
}

// The columns of the CSV: paths into a row's JSON.
constexpr std::string_view columns =
    "experiment,scene,view,light,width,height,triangles,technique,settings,exact,mode,device,driver,ms/median,"
    "ms/least,ms/most,ms/spread,ms/runs,camera_ms/median,shade_ms/median,frame_ms/median,build_ms/median,"
    "device_memory_bytes,errors/points,errors/wrong,errors/wrongly_lit,errors/wrongly_shadowed,errors/mean_absolute,"
    "errors/ssim,errors/penumbra_points,errors/penumbra_mean_absolute,errors/worst_tile,oracle/points,oracle/wrong,"
    "oracle/rays,oracle/wrong_rays,pairs/points,pairs/lights,pairs/facing,pairs/lit,pairs/differing,"
    "pairs/facing_per_second,pairs/ms_per_light,mask_hash,points_hash,failed";

std::string csv_field(const Json& value) {
    if (!value.is_string()) return value.dump();
    const std::string& text = value.get_ref<const std::string&>();
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string csv_line(const Json& row) {
    std::string line;
    std::istringstream paths{std::string(columns)};
    for (std::string path; std::getline(paths, path, ',');) {
        const Json::json_pointer at("/" + path);
        line += (row.contains(at) ? csv_field(row.at(at)) : "") + ",";
    }
    line.back() = '\n';
    return line;
}

}  // namespace

Json to_json(const Row& row) {
    Json json{{"experiment", row.experiment},
              {"scene", row.scene},
              {"view", row.view},
              {"light", row.light},
              {"width", row.width},
              {"height", row.height},
              {"triangles", row.triangles},
              {"technique", row.technique},
              {"settings", text_of(row.settings)},
              {"exact", row.exact},
              {"mode", row.mode},
              {"device", row.device},
              {"driver", row.driver},
              {"points_hash", row.points_hash}};
    if (row.camera) json["camera_ms"] = times_json(*row.camera);
    if (!row.failed.empty()) {
        json["failed"] = row.failed;
        return json;
    }
    json["mask_hash"] = row.mask_hash;
    json["ms"] = times_json(row.total);
    if (row.shade) json["shade_ms"] = times_json(*row.shade);
    if (row.frame) json["frame_ms"] = times_json(*row.frame);
    if (!row.runs.empty()) json["runs"] = runs_json(row);
    if (row.build) json["build_ms"] = times_json(*row.build);
    json["device_memory_bytes"] = row.device_memory_bytes;
    if (row.errors) json["errors"] = errors_json(*row.errors);
    if (row.oracle)
        json["oracle"] = {{"points", row.oracle->points},
                          {"wrong", row.oracle->wrong},
                          {"rays", row.oracle->rays},
                          {"wrong_rays", row.oracle->wrong_rays}};
    if (row.pairs) json["pairs"] = pairs_json(*row.pairs, row.total);
    for (const auto& [name, ms] : row.stages) json["stages_ms"][name] = ms;
    for (const auto& [name, count] : row.counts) json["counts"][name] = count;
    for (const auto& [stage, why] : row.skipped) json["skipped"][stage] = why;
    if (row.picture)
        json["picture"] = {{"width", row.picture->width},
                           {"height", row.picture->height},
                           {"mask", run_lengths(row.picture->mask)},
                           {"error", run_lengths(row.picture->error)}};
    return json;
}

Json report_json(const Json& machine, std::span<const Row> rows) {
    Json json{
        {"machine", machine}, {"experiments", Json::array()}, {"families", Json::object()}, {"rows", Json::array()}};
    for (const Experiment& experiment : experiments())
        json["experiments"].push_back(
            {{"name", experiment.name}, {"title", experiment.title}, {"idea", experiment.idea}});
    for (const Family& family : families()) json["families"][family.name] = family.techniques;
    for (const Row& row : rows) json["rows"].push_back(to_json(row));
    return json;
}

std::string report_csv(const Json& machine, std::span<const Row> rows) {
    std::string text;
    for (const auto& [key, value] : machine.items())
        text.append("# ").append(key).append(": ").append(value.dump()).append("\n");
    text.append(columns).append("\n");
    for (const Row& row : rows) text += csv_line(to_json(row));
    return text;
}

void write_file(const std::string& file, const std::string& text) {
    const std::string unfinished = file + ".unfinished";
    {
        std::ofstream stream(unfinished, std::ios::binary);
        stream << text;
        stream.flush();
        if (!stream) {
            std::error_code ignored;
            std::filesystem::remove(unfinished, ignored);
            throw Error("cannot write " + file +
                        ": is there such a folder, may you write there, and is the disk full?");
        }
    }
    std::filesystem::rename(unfinished, file);
}

}  // namespace gnomon::bench
