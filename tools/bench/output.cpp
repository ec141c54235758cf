// SPDX-License-Identifier: MIT
#include "output.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <gnomon.hpp>
#include "published.hpp"

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

// Paths into a row's JSON: the columns of the CSV.
constexpr const char* columns[] = {"experiment",
                                   "scene",
                                   "view",
                                   "light",
                                   "width",
                                   "height",
                                   "triangles",
                                   "technique",
                                   "settings",
                                   "exact",
                                   "mode",
                                   "device",
                                   "driver",
                                   "ms/median",
                                   "ms/least",
                                   "ms/most",
                                   "ms/spread",
                                   "ms/runs",
                                   "camera_ms/median",
                                   "shade_ms/median",
                                   "frame_ms/median",
                                   "build_ms/median",
                                   "device_memory_bytes",
                                   "errors/points",
                                   "errors/wrong",
                                   "errors/wrongly_lit",
                                   "errors/wrongly_shadowed",
                                   "errors/mean_absolute",
                                   "errors/ssim",
                                   "errors/penumbra_points",
                                   "errors/penumbra_mean_absolute",
                                   "errors/worst_tile",
                                   "oracle/points",
                                   "oracle/wrong",
                                   "oracle/rays",
                                   "oracle/wrong_rays",
                                   "pairs/points",
                                   "pairs/lights",
                                   "pairs/facing",
                                   "pairs/lit",
                                   "pairs/differing",
                                   "pairs/facing_per_second",
                                   "pairs/ms_per_light",
                                   "mask_hash",
                                   "points_hash",
                                   "failed"};

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
    for (const char* column : columns) {
        const Json::json_pointer path(std::string("/").append(column));
        if (!line.empty() || column != columns[0]) line += ',';
        if (row.contains(path)) line += csv_field(row.at(path));
    }
    return line + "\n";
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
    return json;
}

Json report_json(const Json& machine, std::span<const Row> rows) {
    Json json{{"machine", machine}, {"published", published()}, {"rows", Json::array()}};
    for (const Row& row : rows) json["rows"].push_back(to_json(row));
    return json;
}

std::string report_csv(const Json& machine, std::span<const Row> rows) {
    std::string text;
    for (const auto& [key, value] : machine.items())
        text.append("# ").append(key).append(": ").append(value.dump()).append("\n");
    std::string head;
    for (const char* column : columns) head.append(head.empty() ? "" : ",").append(column);
    text += head + "\n";
    for (const Row& row : rows) text += csv_line(to_json(row));
    return text;
}

void print(const Row& row) {
    const std::string name = row.name();
    std::printf("%-16s %-14s %-14s %5ux%-5u ", row.scene.c_str(), row.view.c_str(), row.light.c_str(), row.width,
                row.height);
    if (!row.failed.empty()) {
        std::printf("%s failed: %s\n", name.c_str(), row.failed.c_str());
        return;
    }
    std::printf("%9.3f ms (%.3f .. %.3f)", row.total.median_ms, row.total.least_ms, row.total.most_ms);
    if (row.camera) std::printf("  camera %8.3f ms", row.camera->median_ms);
    if (row.frame) std::printf("  frame %8.3f ms", row.frame->median_ms);
    if (row.build) std::printf("  build %9.3f ms", row.build->median_ms);
    std::printf("  memory %.1f MB", double(row.device_memory_bytes) / 1e6);
    std::printf("  mask %s points %s  %s (%s)", row.mask_hash.c_str(), row.points_hash.c_str(), name.c_str(),
                row.mode.c_str());
    if (row.pairs)
        std::printf("  %.1f M pairs/s  %.3f ms a light  differing %llu of %.1f M",
                    double(row.pairs->facing) / row.total.median_ms / 1e3,
                    row.total.median_ms / double(row.pairs->lights),
                    static_cast<unsigned long long>(row.pairs->differing), double(row.pairs->facing) / 1e6);
    if (row.errors) std::printf("  wrong %llu", static_cast<unsigned long long>(row.errors->wrong()));
    if (row.oracle)
        std::printf("  oracle: %llu of %llu wrong", static_cast<unsigned long long>(row.oracle->wrong),
                    static_cast<unsigned long long>(row.oracle->points));
    std::printf("\n");
    if (!row.stages.empty()) {
        for (const auto& [stage, ms] : row.stages) std::printf("    %-18s %8.3f\n", stage.c_str(), ms);
        for (const auto& [count, value] : row.counts)
            std::printf("    %-26s %12llu\n", count.c_str(), static_cast<unsigned long long>(value));
    }
    std::fflush(stdout);
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
