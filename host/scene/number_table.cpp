// SPDX-License-Identifier: MIT
#include "number_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <span>
#include <utility>

#include <gnomon.hpp>
#include "no_data.hpp"

namespace gnomon::scene {
namespace {

constexpr std::string_view no_break_space = "\xc2\xa0", minus_sign = "\xe2\x88\x92";

std::string joined(std::initializer_list<std::string_view> parts) {
    std::string all;
    for (const std::string_view part : parts) all.append(part);
    return all;
}

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
    std::string all;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t found = std::min(text.find(from, at), text.size());
        all.append(text.substr(at, found - at)).append(found < text.size() ? to : std::string_view());
        at = found + (found < text.size() ? from.size() : 1);
    }
    return all;
}

std::string trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(" \t") + 1 - first));
}

std::string lower_case(std::string text) {
    std::ranges::transform(text, text.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
    return text;
}

/// Whether the text is a number as a whole; its value may be no finite one.
template <typename Value>
std::optional<Value> number_of(const std::string& given) {
    const std::string text = replaced(given, minus_sign, "-");
    const char *first = text.data(), *const end = first + text.size();
    if (text.size() > 1 && *first == '+' && first[1] != '-') ++first;
    Value value = 0;
    const auto [stopped, error] = std::from_chars(first, end, value);
    if (stopped != end || first == end) return std::nullopt;
    if (error == std::errc::result_out_of_range) {  // too small is 0, too large is no finite number
        const auto wide = std::is_same_v<Value, float> ? number_of<double>(text) : std::nullopt;
        if (wide && std::fabs(*wide) < 1) return Value(*wide);
        return std::nullopt;
    }
    return error == std::errc{} && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

bool is_number(const std::string& text) { return number_of<double>(text).has_value(); }

/// Calls visit(character, whether it stands in quotes).
template <typename Visit>
void for_each_character(std::string_view line, const Visit& visit) {
    bool is_quoted = false;
    for (const char c : line) {
        if (c == '"') is_quoted = !is_quoted;
        visit(c, is_quoted);
    }
}

/// The separator of a line: ';', tab, ',' or ' ', the first of these that it has.
char separator_of(std::string_view line) {
    for (const char separator : {';', '\t', ','}) {
        bool is_there = false;
        for_each_character(line, [&](char c, bool is_quoted) { is_there |= c == separator && !is_quoted; });
        if (is_there) return separator;
    }
    return ' ';
}

/// The separator that a first line "sep=;" declares, as spreadsheets write it.
std::optional<char> declared_separator(std::string_view line) {
    const bool is_there = line.size() > 4 && lower_case(std::string(line.substr(0, 4))) == "sep=" &&
                          std::string_view(";,\t").find(line[4]) != std::string_view::npos &&
                          trimmed(line.substr(5)).empty();
    return is_there ? std::optional(line[4]) : std::nullopt;
}

/// A cell without its quotes; two quotes inside are one.
std::string unquoted(std::string_view raw) {
    std::string cell = trimmed(raw);
    if (cell.size() < 2 || cell.front() != '"' || cell.back() != '"') return cell;
    return trimmed(replaced(cell.substr(1, cell.size() - 2), "\"\"", "\""));
}

void add_cell(std::vector<std::string>& cells, const std::string& cell, char separator) {
    if (separator == ' ' && cell.empty()) return;
    const bool is_unit = separator == ' ' && !cells.empty() && (cell.front() == '[' || cell.front() == '(');
    if (is_unit)
        cells.back() += cell;
    else
        cells.push_back(unquoted(cell));
}

std::vector<std::string> cells_of(std::string_view line, char separator) {
    std::vector<std::string> cells;
    std::string cell;
    for_each_character(line, [&](char c, bool is_quoted) {
        const bool ends = !is_quoted && (c == separator || (separator == ' ' && c == '\t'));
        if (!ends) {
            cell += c;
        } else {
            add_cell(cells, cell, separator);
            cell.clear();
        }
    });
    add_cell(cells, cell, separator);
    return cells;
}

/// The line from `at` on, which moves behind its end: \n, \r\n or \r.
std::string_view next_line(std::string_view text, std::size_t& at) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    const std::string_view line = text.substr(at, end - at);
    at = end + (text.substr(end, 2) == "\r\n" ? 2 : 1);
    return line;
}

enum class Quotes { closed, open, torn };

/// Of the cells that begin with a quote: open if the last one goes on behind the line's end; torn if text stands behind
/// the second quote of one.
Quotes quotes_of(std::string_view line) {
    bool is_quoted = false, is_start = true, is_end = false, is_torn = false;
    for (const char c : line) {
        if (c == '"' && (is_quoted || is_start || is_end)) {  // behind an end: one of the two that mean a quote
            is_end = is_quoted;
            is_quoted = !is_quoted;
            is_start = false;
        } else if (!is_quoted) {
            const bool is_separator = c == ';' || c == ',' || c == '\t', is_blank = c == ' ';
            is_torn |= is_end && !is_separator && !is_blank;
            is_start = is_separator || (is_start && is_blank);
            is_end = is_end && is_blank;
        }
    }
    return is_quoted ? Quotes::open : is_torn ? Quotes::torn : Quotes::closed;
}

/// The line from `at` on with those that its last cell goes on in, with blanks for their breaks; counts them.
std::string next_row(std::string_view text, std::size_t& at, std::size_t& number, const std::string& file) {
    std::string row(next_line(text, at));
    const std::size_t first = ++number;
    if (trimmed(row).starts_with('#')) return row;
    constexpr std::size_t most_lines = 100;
    for (; quotes_of(row) == Quotes::open && at < text.size() && number - first < most_lines; ++number)
        row.append(" ").append(next_line(text, at));
    const Quotes quotes = quotes_of(row);
    if (quotes == Quotes::open || (quotes == Quotes::torn && number > first))
        throw InvalidArgument(joined({file, ", line ", std::to_string(first),
                                      " has a cell whose quotes do not end: close them, or leave them out"}));
    return row;
}

/// What files are that people take for tables, by their first bytes; and how each becomes one.
constexpr std::array<std::array<std::string_view, 3>, 11> no_tables{{
    {"\xff\xfe", "UTF-16 text", "save it as UTF-8 (\"CSV UTF-8\" in spreadsheets)"},
    {"\xfe\xff", "UTF-16 text", "save it as UTF-8 (\"CSV UTF-8\" in spreadsheets)"},
    {"PK\x03\x04", "a spreadsheet or a zip archive", "save it as CSV, or unpack it (unzip)"},
    {"\xd0\xcf\x11\xe0", "a spreadsheet", "save it as CSV"},
    {"PAR1", "a table of Parquet", "pandas.read_parquet(name).to_csv('table.csv', index=False) writes it as CSV"},
    {"ARROW1", "a table of Arrow", "pandas.read_feather(name).to_csv('table.csv', index=False) writes it as CSV"},
    {"BZh", "packed by bzip2", "unpack it (bunzip2), or pack it with gzip"},
    {"\xfd"
     "7zXZ",
     "packed by xz", "unpack it (unxz), or pack it with gzip"},
    {"\x28\xb5\x2f\xfd", "packed by zstd", "unpack it (unzstd), or pack it with gzip"},
    {"\x93NUMPY", "an array of NumPy", "numpy.savetxt('table.csv', numpy.load(name), delimiter=',') writes it as CSV"},
    {"SQLite format 3", "a database", "write its table as CSV (sqlite3 -header -csv NAME 'select * from ...')"},
}};

void require_text(std::string_view text, const std::string& file) {
    for (const auto& [begins, what, remedy] : no_tables)
        if (text.starts_with(begins)) throw InvalidArgument(joined({file, ": is ", what, ": ", remedy}));
    if (text.find('\0') != std::string_view::npos)
        throw InvalidArgument(file + ": is no text: write it as CSV, a line of numbers for each row");
}

struct Heading {
    std::string name, unit;
};

/// "X [m]" is x in m.
Heading heading_of(const std::string& cell) {
    const std::string name = lower_case(cell);
    const std::size_t open = name.find_first_of("([");
    if (open == std::string::npos || open == 0 || name.find_first_of(")]", open) == std::string::npos)
        return {name, {}};
    return {trimmed(std::string_view(name).substr(0, open)),
            trimmed(std::string_view(name).substr(open + 1, name.find_first_of(")]", open) - open - 1))};
}

bool is_coordinate(std::string_view name) { return name == "x" || name == "y" || name == "z"; }

bool is_angle(std::string_view name) { return name == "azimuth" || name == "elevation"; }

bool is_degrees(std::string_view unit) {
    constexpr std::array degrees{"", "deg", "degs", "degree", "degrees", "\u00b0"};
    return std::ranges::find(degrees, unit) != degrees.end();
}

/// Words of headings for what people weigh suns by.
constexpr std::string_view words_of_weights =
    " bni diffuse direct dhi dni dt duration energy factor flux gb gd ghi global hours illuminance insolation "
    "intensity irradiance irradiation kwh luminance minutes poa power probability radiance radiation seconds share w "
    "weight weights wh ";

/// By a word of the heading's name, or by watts.
bool speaks_of_weights(const std::string& name, std::string_view unit) {
    std::string words = " " + name + " ";
    std::ranges::replace_if(
        words, [](char c) { return c < 'a' || c > 'z'; }, ' ');
    bool is_weight = unit.starts_with("w") || unit.starts_with("kw");
    for (std::size_t at = 0, end = 0; (end = words.find(' ', at + 1)) != std::string::npos; at = end)
        is_weight |= end > at + 1 && words_of_weights.find(words.substr(at, end + 1 - at)) != std::string_view::npos;
    return is_weight;
}

constexpr double largest_azimuth = 6.3, largest_elevation = 1.6;  // radians, rounded up as tables may round them

bool is_metres(std::string_view unit) {
    constexpr std::array metres{"", "m", "metre", "metres", "meter", "meters"};
    return std::ranges::find(metres, unit) != metres.end();
}

}  // namespace

std::map<std::string, std::string> point_headings() {
    return {{"easting", "x"},   {"east", "x"},     {"northing", "y"},  {"north", "y"},     {"height", "z"},
            {"elevation", "z"}, {"altitude", "z"}, {"normal_x", "nx"}, {"normal_y", "ny"}, {"normal_z", "nz"}};
}

std::map<std::string, std::string> sun_headings() { return {{"weights", "weight"}}; }

NumberTable::NumberTable(std::string_view text, std::string file, const TableColumns& columns)
    : file_(std::move(file)) {
    require_text(text, file_);
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    std::optional<char> separator;
    std::size_t number = 0;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t first = number + 1;
        const std::string line = replaced(next_row(text, at, number, file_), no_break_space, " ");
        if (trimmed(line).starts_with('#') || line.find_first_not_of(",;\t \"") == std::string::npos) continue;
        if (first == 1 && (separator = declared_separator(line))) continue;
        if (!separator) separator = separator_of(line);
        const bool is_one_column =
            std::ranges::any_of(columns.unnamed, [](const auto& names) { return names.size() == 1; });
        if (separator == ' ' && is_one_column) separator = '\n';  // its heading may be words
        take_line(first, cells_of(line, *separator), columns);
    }
}

void NumberTable::take_line(std::size_t number, std::vector<std::string> cells, const TableColumns& columns) {
    if (names_.empty()) {
        while (cells.size() > 1 && cells.back().empty()) cells.pop_back();  // a separator at the end
        if (std::ranges::none_of(cells, is_number)) return take_headings(std::move(cells), columns);
        for (const auto& names : columns.unnamed)
            if (names.size() == cells.size()) names_ = names;
        units_.resize(names_.size());
        if (names_.empty()) {
            std::string counts;
            for (const auto& names : columns.unnamed)
                counts.append(counts.empty() ? "" : " or ").append(std::to_string(names.size()));
            const std::string count = std::to_string(cells.size());
            throw InvalidArgument(joined({file_, ": must have ", counts, " columns, or names for its ", count}));
        }
    }
    lines_.push_back(number);
    while (cells.size() > names_.size() && cells.back().empty()) cells.pop_back();
    if (cells.size() != names_.size())
        refuse(rows() - 1,
               joined({std::to_string(cells.size()), " columns in place of ", std::to_string(names_.size())}));
    std::ranges::move(cells, std::back_inserter(cells_));
}

void NumberTable::take_headings(std::vector<std::string> cells, const TableColumns& columns) {
    std::vector<Heading> headings;
    for (const std::string& cell : cells) headings.push_back(heading_of(cell));
    for (Heading& heading : headings) {
        const auto other = columns.other_names.find(heading.name);
        if (other == columns.other_names.end()) continue;
        const bool is_taken = std::ranges::any_of(headings, [&](const auto& h) { return h.name == other->second; });
        if (!is_taken) heading.name = other->second;
    }
    for (std::size_t i = 0; i < headings.size(); ++i) {
        const Heading& heading = headings[i];
        if (is_coordinate(heading.name) && !is_metres(heading.unit))
            throw InvalidArgument(joined({file_, ": the column \"", cells[i], "\" must be in metres"}));
        if (is_angle(heading.name) && !is_degrees(heading.unit))
            throw InvalidArgument(joined({file_, ": the column \"", cells[i], "\" must be in degrees"}));
        if (!heading.name.empty() && std::ranges::find(names_, heading.name) != names_.end())
            throw InvalidArgument(joined({file_, ": has two columns \"", heading.name, "\""}));
        names_.push_back(heading.name);
        units_.push_back(heading.unit);
    }
}

bool NumberTable::has(std::string_view column) const { return std::ranges::find(names_, column) != names_.end(); }

void NumberTable::require(const std::vector<std::string>& columns, const std::string& what) const {
    if (std::ranges::all_of(columns, [&](const auto& name) { return has(name); })) return;
    std::string there;
    for (const std::string& name : names_) there.append(there.empty() ? "; it has " : ", ").append(name);
    throw InvalidArgument(joined({file_, ": ", what, there.empty() ? "; it is empty" : there}));
}

void NumberTable::require_degrees(const std::vector<double>& azimuths, const std::vector<double>& elevations) const {
    if (!units_[column("azimuth")].empty() || !units_[column("elevation")].empty()) return;
    const auto are_within = [](const std::vector<double>& values, double most) {
        return std::ranges::all_of(values, [most](double value) { return std::fabs(value) <= most; });
    };
    const bool has_sun = std::ranges::any_of(elevations, [](double elevation) { return elevation > 0; });
    if (has_sun && are_within(elevations, largest_elevation) && are_within(azimuths, largest_azimuth))
        throw InvalidArgument(
            file_ +
            ": its azimuths and elevations are as small as radians, and must be degrees: turn them into "
            "degrees, or write \"azimuth [deg]\" and \"elevation [deg]\" above them if that is what they are");
}

std::size_t NumberTable::column(std::string_view name) const {
    return std::size_t(std::ranges::find(names_, name) - names_.begin());
}

const std::string& NumberTable::text(std::size_t row, std::string_view name) const {
    return cells_[row * names_.size() + column(name)];
}

template <typename Value>
Value NumberTable::value(std::size_t row, std::string_view name) const {
    const std::string& cell = text(row, name);
    if (const auto value = number_of<Value>(cell)) return *value;
    if (cell.empty()) refuse(row, joined({"no ", name}));
    const bool has_comma = std::ranges::count(cell, ',') == 1 && is_number(replaced(cell, ",", "."));
    const bool may_be_thousands = has_comma && cell.size() - cell.find(',') == 4 && cell.find(',') > 0;
    const std::string why = may_be_thousands ? "whose comma may be either: write " + replaced(cell, ",", ".") +
                                                   ", or " + replaced(cell, ",", "") + " if the comma parts thousands"
                            : has_comma       ? "a decimal comma: write " + replaced(cell, ",", ".")
                            : is_number(cell) ? "which is beyond float32"
                                              : "which is no finite number";
    refuse(row, joined({name, " = \"", cell, "\", ", why}));
}

double NumberTable::number(std::size_t row, std::string_view name) const { return value<double>(row, name); }
float NumberTable::float_number(std::size_t row, std::string_view name) const { return value<float>(row, name); }

std::vector<double> NumberTable::numbers(std::string_view name) const {
    std::vector<double> values(rows());
    for (std::size_t row = 0; row < rows(); ++row) values[row] = number(row, name);
    return values;
}

std::vector<float> NumberTable::float_numbers(std::string_view name) const {
    std::vector<float> values(rows());
    for (std::size_t row = 0; row < rows(); ++row) values[row] = float_number(row, name);
    return values;
}

void NumberTable::require_places(const std::vector<std::string>& columns) const {
    std::vector<double> values;
    for (std::size_t row = 0; row < rows(); ++row)
        for (const std::string& name : columns) values.push_back(number(row, name));
    const auto found = first_absent_place<double>(values, columns.size());
    if (!found) return;
    const std::string& name = columns[found->column];
    refuse(found->row,
           joined({name, " = \"", text(found->row, name),
                   "\", which stands for no data: leave the row out, or move it a little if it is a place"}));
}

void NumberTable::require_weights(const std::string& column) const {
    if (const auto row = first_absent_weight(numbers(column)))
        refuse(*row, joined({column, " = \"", text(*row, column), "\", which stands for no data: write 0"}));
}

void NumberTable::require_all_or_none(const std::vector<std::string>& columns) const {
    std::string there, missing;
    for (const std::string& name : columns) (has(name) ? there : missing).append(" ").append(name);
    if (there.empty() || missing.empty()) return;
    throw InvalidArgument(joined({file_, ": has", there, ", and lacks", missing, ": give all of them, or none"}));
}

std::string NumberTable::unread_weights() const {
    std::vector<std::string> unread;
    for (std::size_t i = 0; i < names_.size() && !has("weight"); ++i)
        if (speaks_of_weights(names_[i], units_[i])) unread.push_back("\"" + names_[i] + "\"");
    if (unread.empty()) return {};
    std::string text = file_ + ": ";
    for (const std::string& column : unread) text.append(column).append(&column == &unread.back() ? "" : ", ");
    return joined({text, ": not read, and every sun weighs 1: the heading \"weight\" in place of ", unread.front(),
                   " makes it the weights"});
}

void NumberTable::refuse(std::size_t row, const std::string& reason) const {
    throw InvalidArgument(joined({file_, ", line ", std::to_string(lines_[row]), " has ", reason}));
}

}  // namespace gnomon::scene
