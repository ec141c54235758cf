// SPDX-License-Identifier: MIT
// Which settings of which technique the scatter of run time against error shows.
#pragma once

#include <string>
#include <vector>

#include "row.hpp"

namespace gnomon::bench {

struct Configuration {
    std::string technique;
    Settings settings;
};

/// Every registered technique: with the settings of the table in sweep.cpp, else with its defaults alone. The first is
/// exact, with its defaults.
std::vector<Configuration> swept_configurations();

/// The technique whose answer the others are measured against, with its defaults.
Configuration truth_configuration();

/// Whether this build's technique has the setting.
bool has_setting(const std::string& technique, const std::string& setting);

}  // namespace gnomon::bench
