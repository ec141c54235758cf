// SPDX-License-Identifier: MIT
#include "sweep.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <gnomon.hpp>

namespace gnomon::bench {

namespace {

/// Every combination of the values, one setting after the other.
struct Sweep {
    const char* technique;
    std::vector<std::pair<std::string, std::vector<std::string>>> values;
};

// A technique may stand here more than once. Besides these, each technique runs with its defaults.
std::vector<Sweep> sweeps() {
    return {
        {"frustum-traced", {{"conservative-map", {"on", "off"}}}},
        // The basic map (Williams 1978): no bias at all, a constant one, and the default, scaled by the slope.
        {"shadow-map", {{"size", {"512", "1024", "4096", "8192"}}}},
        {"shadow-map", {{"constant-bias", {"0", "0.001"}}, {"slope-bias", {"0"}}, {"size", {"512", "2048", "8192"}}}},
        // The 12-tap soft map, with the bias of its source.
        {"gaussian-12-tap",
         {{"slope-bias", {"0"}}, {"constant-bias", {"0.003"}}, {"size", {"512", "1024", "2048", "4096", "8192"}}}},
        {"pcf", {{"size", {"512", "4096"}}}},
        {"msm64", {{"size", {"512", "4096"}}}},
        {"lispsm", {{"size", {"512", "4096"}}}},
        {"logpsm", {{"size", {"512", "4096"}}}},
        {"vsm-mip", {{"size", {"512", "4096"}}}},
        {"rtw", {{"size", {"512", "4096"}}}},
        {"sdsm", {{"size", {"512", "4096"}}}},
        {"sdsm", {{"blend", {"on"}}}},
        {"stabilised-cascades", {{"blend", {"on"}}}},
        {"pssm", {{"fit", {"frustum"}}}},
        {"sub-pixel", {{"map-size", {"512", "1024", "4096"}}}},
        {"conservative-map", {{"map-size", {"512", "1024", "4096"}}}},
        {"virtual-shadow-map", {{"detail", {"0.5", "2", "4"}}}},
    };
}

// Every kind of bias, from none to too much.
std::vector<Sweep> bias_sweeps() {
    return {
        {"shadow-map", {{"slope-bias", {"0"}}, {"constant-bias", {"0", "0.0001", "0.001", "0.01"}}}},
        {"shadow-map", {{"slope-bias", {"0.5", "1.5", "5", "20"}}}},
        {"adaptive-bias", {{"constant-bias", {"0", "0.0001", "0.001", "0.01"}}}},
        {"dual-layer", {{"dual-limit", {"0.001", "0.05", "1"}}, {"constant-bias", {"0", "0.00001", "0.001"}}}},
    };
}

TechniqueDescription description_of(const Configuration& configuration) {
    for (const TechniqueDescription& technique : techniques())
        if (technique.name == configuration.technique) return technique;
    throw InvalidArgument("there is no technique " + configuration.technique);
}

/// A setting's value, or its default; empty where the technique has no such setting.
std::string value_of(const Configuration& configuration, const std::string& name) {
    for (const auto& [key, value] : configuration.settings)
        if (key == name) return value;
    for (const SettingDescription& setting : description_of(configuration).settings)
        if (setting.name == name) return setting.default_value;
    return {};
}

bool is_asked(const Configuration& configuration, const std::string& name) {
    return std::ranges::any_of(configuration.settings, [&](const auto& setting) { return setting.first == name; });
}

std::uint32_t map_count(const Configuration& configuration, bool is_point_light) {
    if (is_point_light || value_of(configuration, "partition") == "faces") return 6;
    const std::string cascades = value_of(configuration, "cascades");
    return cascades.empty() ? 1 : static_cast<std::uint32_t>(std::stoul(cascades));
}

std::vector<Settings> combinations(const Sweep& sweep) {
    std::vector<Settings> all{{}};
    for (const auto& [key, values] : sweep.values) {
        std::vector<Settings> longer;
        for (const Settings& settings : all)
            for (const std::string& value : values) {
                longer.push_back(settings);
                longer.back().emplace_back(key, value);
            }
        all = std::move(longer);
    }
    return all;
}

}  // namespace

std::vector<Configuration> default_configurations() {
    std::vector<Configuration> configurations{truth_configuration()};
    for (const TechniqueDescription& technique : techniques())
        if (technique.name != configurations.front().technique) configurations.push_back({technique.name, {}});
    return configurations;
}

std::vector<Configuration> swept_configurations(std::uint32_t largest_map) {
    std::vector<Configuration> configurations;
    std::vector<Sweep> table = sweeps();
    for (Sweep& sweep : table)
        for (auto& [key, values] : sweep.values)
            if (key == "size" || key == "map-size")
                std::erase_if(values, [&](const std::string& value) { return std::stoul(value) > largest_map; });
    for (const Configuration& technique : default_configurations()) {
        configurations.push_back(technique);
        for (const Sweep& sweep : table)
            if (technique.technique == sweep.technique)
                for (Settings& settings : combinations(sweep))
                    configurations.push_back({technique.technique, std::move(settings)});
    }
    return configurations;
}

void put_on_equal_terms(Configuration& configuration, std::uint32_t usual_size, bool is_point_light) {
    configuration.asked = configuration.settings;
    configuration.terms = "its own";
    const bool is_shadow_map = !value_of(configuration, "cascades").empty();
    const std::string size = is_shadow_map ? "size" : "map-size";
    if (description_of(configuration).exact || value_of(configuration, size).empty()) return;
    const std::uint32_t maps = map_count(configuration, is_point_light);
    const double whole = is_asked(configuration, size) ? std::stod(value_of(configuration, size)) : usual_size;
    const auto side = static_cast<std::uint32_t>(whole / std::sqrt(maps));
    std::erase_if(configuration.settings, [&](const auto& setting) { return setting.first == size; });
    configuration.settings.emplace_back(size, std::to_string(side));
    if (value_of(configuration, "fit") == "frustum" && !is_asked(configuration, "fit"))
        configuration.settings.emplace_back("fit", "receivers");
    configuration.terms = fmt::format("{}{}², {}", maps == 1 ? "" : fmt::format("{} x ", maps), side,
                                      is_shadow_map ? value_of(configuration, "fit") : "receivers");
}

std::vector<Configuration> many_lights_configurations(std::size_t lights, bool is_height_field) {
    std::vector<Configuration> configurations;
    for (const char* way : {"auto", "beams", "point-beams", "rays", "horizons", "one-by-one"}) {
        if (std::string(way) == "one-by-one" && lights > 1024) continue;
        if (std::string(way) == "horizons" && !is_height_field) continue;
        configurations.push_back({truth_configuration().technique, {{"many-lights", way}}});
    }
    return configurations;
}

std::vector<Configuration> bias_configurations() {
    std::vector<Configuration> configurations;
    for (const Sweep& sweep : bias_sweeps())
        for (Settings& settings : combinations(sweep)) configurations.push_back({sweep.technique, std::move(settings)});
    return configurations;
}

std::vector<Configuration> soft_configurations(double sun_angle_degrees, std::uint32_t sun_samples) {
    std::vector<Configuration> configurations(2, truth_configuration());
    configurations.front().sun_samples = sun_samples;
    for (const Family& family : families()) {
        if (family.name != "filtered maps") continue;
        for (const std::string& technique : family.techniques) configurations.push_back({technique, {}});
    }
    const std::string tangent = fmt::format("{:.9g}", std::tan(sun_angle_degrees * (std::numbers::pi / 180)));
    for (Configuration& configuration : configurations)
        if (configuration.technique == "pcss") configuration.settings.emplace_back("light-size", tangent);
    return configurations;
}

Configuration truth_configuration() {
    for (const TechniqueDescription& technique : techniques())
        if (technique.exact) return {technique.name, {}};
    throw Error("this build has no exact technique to measure the others against");
}

namespace {

// A technique that no family names is in the first one if it is exact, else in one of its own.
std::vector<Family> with_all_techniques(std::vector<Family> all) {
    for (const TechniqueDescription& technique : techniques()) {
        const bool is_named = std::ranges::any_of(all, [&](const Family& family) {
            return std::ranges::find(family.techniques, technique.name) != family.techniques.end();
        });
        if (is_named) continue;
        if (technique.exact)
            all.front().techniques.push_back(technique.name);
        else
            all.push_back({technique.name, {technique.name}});
    }
    return all;
}

}  // namespace

const std::vector<Family>& families() {
    static const std::vector<Family> all = with_all_techniques({
        {"exact", {}},
        {"hard shadow maps", {"shadow-map", "adaptive-bias", "dual-layer"}},
        {"filtered maps",
         {"pcf", "gaussian-12-tap", "fast-9x9", "pcss", "vsm", "vsm-remap", "vsm-edges", "vsm-mip", "layered-vsm",
          "convolution", "esm", "evsm2", "evsm4", "ewgf", "msm64", "msm128"}},
        {"warped maps", {"psm", "lispsm", "logpsm", "logpsm-faces", "rtw"}},
        {"cascades, virtual maps", {"pssm", "sdsm", "stabilised-cascades", "quantised-cascades", "virtual-shadow-map"}},
        {"maps of triangles, volumes", {"sub-pixel", "conservative-map", "shadow-volumes"}},
        {"Embree", {"embree"}},
    });
    return all;
}

}  // namespace gnomon::bench
