// SPDX-License-Identifier: MIT
// Tables of numbers as text: the one reader of `gnomon hours` and of the Python package's studies.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::scene {

/// How a table's columns are found.
struct TableColumns {
    /// Columns of a table without headings: the list that has as many.
    std::vector<std::vector<std::string>> unnamed;
    /// Other headings, in small letters, that mean a column.
    std::map<std::string, std::string> other_names{};
};

/// What surveyors call the coordinates of points.
std::map<std::string, std::string> point_headings();
/// Of tables of suns and of weights.
std::map<std::string, std::string> sun_headings();

/// Named columns of a CSV text, in any order. Columns are separated by commas, semicolons, tabs or blanks, whichever
/// the first line has; cells may stand in quotes, also over several lines. Empty lines, and lines that begin with #, do
/// not count. The first line names the columns unless one of its cells is a number. Headings are compared in small
/// letters; a unit in brackets after a heading is left out, but x, y and z must not be in another unit than metres.
class NumberTable {
public:
    /// `file`: for messages. Throws InvalidArgument, as all functions here do, with the line's number and the column.
    NumberTable(std::string_view text, std::string file, const TableColumns& columns);

    const std::vector<std::string>& names() const { return names_; }
    bool has(std::string_view column) const;
    std::size_t rows() const { return lines_.size(); }
    const std::string& text(std::size_t row, std::string_view column) const;
    /// A finite number. The float is rounded once, from the text.
    double number(std::size_t row, std::string_view column) const;
    float float_number(std::size_t row, std::string_view column) const;
    std::vector<double> numbers(std::string_view column) const;
    std::vector<float> float_numbers(std::string_view column) const;
    [[noreturn]] void refuse(std::size_t row, const std::string& reason) const;
    /// Throws unless the table has these columns; the message ends with those that it has.
    void require(const std::vector<std::string>& columns, const std::string& what) const;
    /// Throws for the first number that stands for no data (no_data.hpp): of these columns of coordinates, or of the
    /// column of weights.
    void require_places(const std::vector<std::string>& columns) const;
    void require_weights(const std::string& column) const;
    /// Throws if the table has some of these columns, and not all.
    void require_all_or_none(const std::vector<std::string>& columns) const;
    /// Of a table of suns without the column weight: a sentence about the columns whose headings speak of weights or of
    /// irradiance, which are not read; empty if there are none.
    std::string unread_weights() const;
    /// Of the values of the columns azimuth and elevation: throws if the headings name no unit and all values are as
    /// small as radians, with a sun above the horizon.
    void require_degrees(const std::vector<double>& azimuths, const std::vector<double>& elevations) const;

private:
    void take_line(std::size_t number, std::vector<std::string> cells, const TableColumns& columns);
    void take_headings(std::vector<std::string> cells, const TableColumns& columns);
    std::size_t column(std::string_view name) const;
    template <typename Value>
    Value value(std::size_t row, std::string_view column) const;

    std::string file_;
    std::vector<std::string> names_, units_;  ///< of the columns
    std::vector<std::size_t> lines_;          ///< of each row, from 1 on
    std::vector<std::string> cells_;          ///< names_.size() for each row
};

}  // namespace gnomon::scene
