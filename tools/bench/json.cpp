// SPDX-License-Identifier: MIT
#include "json.hpp"

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
