// SPDX-License-Identifier: MIT
// bench: how long the shadows of a scene's views take, with the hash of what they were.
//
// Times are from resident triangles and points to the resident mask: median and spread of N runs after warm-up, wall
// clock on a queue that does not profile; the stage breakdown comes from a second device object that does. Every row
// carries the hash of its mask and of its shading points, so a time is never seen without its result.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <span>

#include "gnomon.hpp"
#include "scene/scene.hpp"

namespace {

using Json = nlohmann::ordered_json;

struct Options {
    std::vector<std::string> scenes;
    std::string views_file, json_file, device;
    std::vector<std::string> sizes{"1920x1080"};
    std::vector<std::string> settings;
    std::vector<float> light_position;
    std::string technique = "frustum-traced";
    std::string only;
    int runs = 15;
    bool stages = false;
};

struct Case {
    std::string scene, view, light_name;
    gnomon::Camera camera;
    gnomon::Light light;
};

template <typename Value>
std::uint64_t hash_of(std::span<const Value> values) {
    std::uint64_t hash = 14695981039346656037ull;
    for (const unsigned char byte :
         std::span(reinterpret_cast<const unsigned char*>(values.data()), values.size_bytes()))
        hash = (hash ^ byte) * 1099511628211ull;
    return hash;
}

std::string hex(std::uint64_t value) {
    char text[17];
    std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(value));
    return text;
}

gnomon::Float3 float3_of(const Json& json) { return {json.at(0), json.at(1), json.at(2)}; }

// Views and lights of a views.json (see ../shared/scenes) by the scene's stem, else the scene's own.
std::vector<Case> cases_of_scene(const std::string& stem, const gnomon::scene::Scene& scene, const Json& views) {
    std::vector<Case> cases;
    if (views.contains(stem)) {
        for (const Json& view : views[stem]["views"]) {
            const auto camera = gnomon::Camera::look_at(float3_of(view["eye"]), float3_of(view["target"]),
                                                        float3_of(view["up"]), view["fov_y"]);
            for (const Json& light : views[stem]["lights"])
                cases.push_back({stem, view["name"], light["name"], camera,
                                 gnomon::Light::directional(float3_of(light["direction"]))});
        }
        return cases;
    }
    for (const auto& camera : scene.cameras)
        for (const auto& light : scene.lights)
            cases.push_back({stem, camera.name, light.name, camera.camera, light.light});
    if (cases.empty())
        cases.push_back(
            {stem, "framing", "default", gnomon::scene::framing_camera(scene), gnomon::scene::default_light()});
    return cases;
}

// With --light-position each view is lit from there instead.
std::vector<Case> cases_of(const Options& options, const std::string& stem, const gnomon::scene::Scene& scene,
                           const Json& views) {
    std::vector<Case> cases = cases_of_scene(stem, scene, views);
    if (options.light_position.empty()) return cases;
    std::vector<Case> lit;
    for (Case& c : cases) {
        if (!lit.empty() && lit.back().view == c.view) continue;
        c.light_name = "position";
        c.light = gnomon::Light::positional(
            {options.light_position[0], options.light_position[1], options.light_position[2]});
        lit.push_back(c);
    }
    return lit;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

std::unique_ptr<gnomon::Technique> make(const Options& options, const gnomon::Device& device) {
    auto technique = gnomon::make_technique(options.technique, device);
    for (const std::string& setting : options.settings) {
        const std::size_t equals = setting.find('=');
        if (equals == std::string::npos)
            throw gnomon::InvalidArgument("--set takes key=value, not \"" + setting + "\"");
        technique->set(setting.substr(0, equals), setting.substr(equals + 1));
    }
    return technique;
}

Json run_case(const Options& options, const Case& c, const gnomon::scene::Scene& scene, std::uint32_t width,
              std::uint32_t height, bool profile) {
    gnomon::DeviceOptions device_options;
    device_options.profile = profile;
    const gnomon::Device device(options.device, device_options);
    const auto triangles = gnomon::Triangles::upload(device, scene.triangles);
    const auto technique = make(options, device);
    gnomon::View view;
    std::vector<double> camera_ms, ms;
    std::vector<gnomon::Statistics> statistics;
    const gnomon::Visibility visibility(device, std::size_t(width) * height);
    for (int run = -2; run < options.runs; ++run) {
        if (run < 3) {
            view = gnomon::look(device, triangles, c.camera, width, height);
            if (run >= 0) camera_ms.push_back(view.statistics.total_wall_ms);
        }
        const auto start = std::chrono::steady_clock::now();
        gnomon::Statistics s = technique->run(triangles, view.points, c.light, visibility);
        clFinish(device.queue());
        if (run < 0) continue;
        ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        statistics.push_back(std::move(s));
    }
    const std::vector<float> mask = visibility.read();
    const auto host = gnomon::read(device, triangles, view);

    Json row{{"scene", c.scene},
             {"view", c.view},
             {"light", c.light_name},
             {"width", width},
             {"height", height},
             {"technique", options.technique},
             {"settings", options.settings},
             {"device", device.description().name},
             {"driver", device.description().driver_version},
             {"triangles", triangles.count()},
             {"mask_hash", hex(hash_of(std::span<const float>(mask)))},
             {"points_hash", hex(hash_of(std::span<const float>(host.position)))},
             {"profiled", profile},
             {"median_ms", median(ms)},
             {"least_ms", *std::min_element(ms.begin(), ms.end())},
             {"most_ms", *std::max_element(ms.begin(), ms.end())},
             {"camera_ms", median(camera_ms)},
             {"device_memory_bytes", statistics.back().device_memory_bytes}};
    for (std::size_t i = 0; i < statistics.back().stages.size(); ++i) {
        std::vector<double> stage_ms;
        for (const auto& s : statistics)
            if (i < s.stages.size()) stage_ms.push_back(profile ? s.stages[i].device_ms : s.stages[i].wall_ms);
        row["stages"][statistics.back().stages[i].name] = median(stage_ms);
    }
    for (const auto& stage : view.statistics.stages)
        row["stages"][stage.name] = profile ? stage.device_ms : stage.wall_ms;
    for (const auto& [name, count] : statistics.back().counts) row["counts"][name] = count;
    return row;
}

void print_row(const Json& row) {
    std::printf("%-16s %-14s %-14s %5ux%-5u %9.3f ms (%.3f .. %.3f)  camera %8.3f ms  mask %s points %s\n",
                row["scene"].get<std::string>().c_str(), row["view"].get<std::string>().c_str(),
                row["light"].get<std::string>().c_str(), row["width"].get<unsigned>(), row["height"].get<unsigned>(),
                row["median_ms"].get<double>(), row["least_ms"].get<double>(), row["most_ms"].get<double>(),
                row["camera_ms"].get<double>(), row["mask_hash"].get<std::string>().c_str(),
                row["points_hash"].get<std::string>().c_str());
    if (row["profiled"]) {
        for (const auto& [name, ms] : row["stages"].items())
            std::printf("    %-18s %8.3f\n", name.c_str(), ms.get<double>());
        for (const auto& [name, count] : row["counts"].items())
            std::printf("    %-26s %12llu\n", name.c_str(),
                        static_cast<unsigned long long>(count.get<std::uint64_t>()));
    }
    std::fflush(stdout);
}

int run(const Options& options) {
    Json views = Json::object(), rows = Json::array();
    if (!options.views_file.empty()) {
        std::ifstream stream(options.views_file);
        if (!stream) throw gnomon::InvalidArgument("cannot read the views in " + options.views_file);
        views = Json::parse(stream);
    }
    for (const std::string& file : options.scenes) {
        const gnomon::scene::Scene scene = gnomon::scene::load(file);
        for (const Case& c : cases_of(options, std::filesystem::path(file).stem().string(), scene, views)) {
            if (!options.only.empty() && (c.view + "." + c.light_name).find(options.only) == std::string::npos)
                continue;
            for (const std::string& size : options.sizes) {
                unsigned width = 0, height = 0;
                if (std::sscanf(size.c_str(), "%ux%u", &width, &height) != 2)
                    throw gnomon::InvalidArgument("--size takes WIDTHxHEIGHT, not \"" + size + "\"");
                rows.push_back(run_case(options, c, scene, width, height, false));
                print_row(rows.back());
                if (!options.stages) continue;
                rows.push_back(run_case(options, c, scene, width, height, true));
                print_row(rows.back());
            }
        }
    }
    if (!options.json_file.empty()) {
        std::ofstream stream(options.json_file);
        stream << rows.dump(1) << '\n';
        if (!stream) throw gnomon::Error("cannot write " + options.json_file);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    CLI::App app{"Times the shadows of a scene's views; each time with the hash of its mask."};
    app.add_option("scenes", options.scenes, "glTF files")->required();
    app.add_option("--views", options.views_file, "views and lights by scene, as in ../shared/scenes/views.json");
    app.add_option("--only", options.only, "only cases whose VIEW.LIGHT contains this");
    app.add_option("--size", options.sizes, "WIDTHxHEIGHT, repeatable")->capture_default_str();
    app.add_option("--technique", options.technique, "as in gnomon techniques")->capture_default_str();
    app.add_option("--set", options.settings, "key=value of the technique, repeatable");
    app.add_option("--light-position", options.light_position, "light every view from this point: X Y Z")->expected(3);
    app.add_option("--runs", options.runs, "timed runs per case")->capture_default_str()->check(CLI::Range(1, 100000));
    app.add_option("--device", options.device, "as in gnomon devices");
    app.add_option("--json", options.json_file, "write all rows there");
    app.add_flag("--stages", options.stages, "also run with profiling and print each stage's time and the counts");
    CLI11_PARSE(app, argc, argv);
    try {
        return run(options);
    } catch (const std::exception& error) {
        std::cerr << "bench: error: " << error.what() << '\n';
        return 1;
    }
}
