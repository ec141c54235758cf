// SPDX-License-Identifier: MIT
// Rows as JSON and as CSV, which is made from JSON, so the two agree. tools/report.py reads the JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "row.hpp"

namespace gnomon::bench {

nlohmann::ordered_json to_json(const Row& row);

/// {"machine": {...}, "experiments": [{"name", "title", "idea"}], "families": {NAME: [TECHNIQUE]}, "rows": [...]}
nlohmann::ordered_json report_json(const nlohmann::ordered_json& machine, std::span<const Row> rows);

/// One line per row after a head line; counts, stages and pictures are left to JSON. The machine stands in lines before
/// the head that begin with "# ".
std::string report_csv(const nlohmann::ordered_json& machine, std::span<const Row> rows);

/// Writes all of `text` or throws; an older file of that name stays until the new one is complete.
void write_file(const std::string& file, const std::string& text);

}  // namespace gnomon::bench
