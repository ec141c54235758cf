// SPDX-License-Identifier: MIT
#include "sweep.hpp"

#include <algorithm>

#include "gnomon.hpp"

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
    };
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

std::vector<Configuration> swept_configurations() {
    std::vector<Configuration> configurations{truth_configuration()};
    const std::vector<Sweep> table = sweeps();
    for (const TechniqueDescription& technique : techniques()) {
        if (technique.name != configurations.front().technique) configurations.push_back({technique.name, {}});
        for (const Sweep& sweep : table)
            if (technique.name == sweep.technique)
                for (Settings& settings : combinations(sweep))
                    configurations.push_back({technique.name, std::move(settings)});
    }
    return configurations;
}

Configuration truth_configuration() {
    for (const TechniqueDescription& technique : techniques())
        if (technique.exact) return {technique.name, {}};
    throw Error("this build has no exact technique to measure the others against");
}

bool has_setting(const std::string& technique, const std::string& setting) {
    for (const TechniqueDescription& description : techniques())
        if (description.name == technique)
            return std::ranges::any_of(description.settings, [&](const auto& s) { return s.name == setting; });
    return false;
}

}  // namespace gnomon::bench
