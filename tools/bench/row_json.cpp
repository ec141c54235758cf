// SPDX-License-Identifier: MIT
#include <algorithm>

#include "json.hpp"

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
    if (!row.terms.empty()) {
        json["asked"] = text_of(row.asked);
        json["terms"] = row.terms;
    }
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

}  // namespace gnomon::bench
