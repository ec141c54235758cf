// SPDX-License-Identifier: MIT
// The page's charts as inline SVG, without a script. Colours are CSS classes of the page (s0, s1, ...), so that they
// follow its light and dark style. Every mark has a tooltip.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace gnomon::bench {

std::string escaped(const std::string& text);  ///< for HTML and XML text and attributes
std::string three_digits(double value);        ///< "0.0123", "12.3", "1230": three significant digits
std::string with_spaces(double count);         ///< "12 800 000"

/// A series' colour as a CSS class of the page, which has this many.
constexpr std::size_t colours = 12;
std::string class_of(std::size_t series);

/// One technique and setting: how long it takes and how wrong it is.
struct Mark {
    double error_share = 0, ms = 0;
    std::size_t series = 0;  ///< colour
    std::string tip;
    bool is_aside = false;  ///< hollow and never on the front: its time leaves out what the others' holds
};
/// The marks that no other one beats in both run time and error, from the fastest to the most accurate.
std::vector<std::size_t> pareto_front(const std::vector<Mark>& marks);
/// Run time against error, both logarithmic; no error at all has a band of its own on the left. Marks of the front are
/// numbered 1, 2, ... in the order of pareto_front and joined by a line.
std::string scatter(const std::vector<Mark>& marks);
/// The same as an SVG file of its own, which says without tooltips what colours and numbers mean. `legend`: names of up
/// to `colours` series.
std::string scatter_file(const std::string& title, const std::vector<Mark>& marks,
                         const std::vector<std::pair<std::size_t, std::string>>& legend);

struct Bar {
    std::string label, second_label;                    ///< above the bar, one below the other: they may be long
    std::vector<std::pair<std::size_t, double>> parts;  ///< series, ms
    std::vector<std::string> part_names;
};
/// Stacked bars, all to one scale that starts at 0.
std::string bars(const std::vector<Bar>& bars);

struct Line {
    std::string label;
    std::size_t series = 0;
    std::vector<std::pair<double, double>> points;  ///< x, ms; x ascending
};
/// Both axes logarithmic.
std::string lines(const std::vector<Line>& lines, const std::string& x_title);

}  // namespace gnomon::bench
