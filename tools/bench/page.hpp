// SPDX-License-Identifier: MIT
// The benchmark as one self-contained HTML page (charts, pictures and tables, no script and nothing to load), its
// tables alone as Markdown, and charts alone as SVG.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "row.hpp"

namespace gnomon::bench {

/// Well-formed XML as well, so that any parser can check it.
std::string page(const nlohmann::ordered_json& machine, std::span<const Row> rows);

/// Machine, versions and date, then the tables: what docs/performance.md shows.
std::string markdown_report(const nlohmann::ordered_json& machine, std::span<const Row> rows);

/// Run time against error for each scene of the experiment "techniques": the scene's name and an SVG file's text.
std::vector<std::pair<std::string, std::string>> chart_files(std::span<const Row> rows);

}  // namespace gnomon::bench
