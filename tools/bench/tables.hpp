// SPDX-License-Identifier: MIT
// The tables of the page, which are also those of docs/performance.md: headings and cells, written as HTML or Markdown.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "charts.hpp"
#include "row.hpp"

namespace gnomon::bench {

struct Table {
    std::string title;  ///< may be empty
    std::string note;   ///< may be empty: below the table
    std::vector<std::string> heads;
    std::vector<std::vector<std::string>> lines;  ///< **bold** as in Markdown, a whole cell or none of it
};

/// Rows of one view at one size on one device: what may be compared.
struct Comparison {
    std::string title;
    std::vector<const Row*> rows;
};

/// "frustum-traced map-size=1024", and the mode if it is not animated
std::string name_of(const Row& row);
/// "sponza atrium_floor.noon_slant 1920x1080, DEVICE"
std::string view_of(const Row& row);

/// The rows of an experiment, view by view, in the order they were measured.
std::vector<Comparison> comparisons_of(std::span<const Row> rows, const std::string& experiment);

/// The view's rows that have errors. Their series are positions in families().
std::vector<Mark> marks_of(const Comparison& view);

/// The tables that belong to an experiment: ours, then those of others.
std::vector<Table> tables_of(std::span<const Row> rows, const std::string& experiment);

std::string html(const Table& table);
std::string markdown(const Table& table);

}  // namespace gnomon::bench
