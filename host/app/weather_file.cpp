// SPDX-License-Identifier: MIT
#include "weather_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <set>

#include "scene/number_table.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

using scene::NumberTable;

constexpr std::size_t hours_per_day = 24;
// W/m2, more than the Sun gives outside the air; files write 9999 for what is missing.
constexpr double most_power = 1500;

/// The beginning of the line that follows the first `count` ones.
std::size_t line_after(std::string_view text, std::size_t count) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < count && at < text.size(); ++i) at = std::min(text.find('\n', at), text.size() - 1) + 1;
    return at;
}

/// The text with its first lines empty, so that the others keep their numbers.
std::string without_lines(std::string_view text, std::size_t count) {
    return std::string(count, '\n').append(text.substr(line_after(text, count)));
}

double number_within(const NumberTable& table, std::size_t row, const char* column, double least, double most,
                     const char* what) {
    const double number = table.number(row, column);
    if (number < least || number > most)
        table.refuse(row, fmt::format("{} = {}, which is no {}", column, number, what));
    return number;
}

/// The place in a file's first line, whose cells these are.
WeatherFile place_of(std::string_view text, const std::string& file, const std::vector<std::string>& cells) {
    const NumberTable head(text.substr(0, line_after(text, 1)), file, {{cells}});
    head.require({"latitude"}, "names no place in its first line");
    if (head.rows() != 1) throw Error(file + ": names no place in its first line");
    WeatherFile weather;
    weather.name = head.text(0, "name");
    weather.latitude_degrees = number_within(head, 0, "latitude", -90, 90, "latitude");
    weather.longitude_degrees = number_within(head, 0, "longitude", -180, 180, "longitude");
    weather.utc_offset_hours = number_within(head, 0, "utc offset", -14, 14, "time zone");
    weather.elevation_metres = number_within(head, 0, "elevation", -500, 9000, "elevation");
    return weather;
}

/// Appends an hour. The file counts hours from 1 on, and gives each at its end.
void add_hour(WeatherFile& weather, const NumberTable& table, std::size_t row, const Days& day, int hour,
              bool wants_diffuse) {
    using namespace std::chrono;
    const std::size_t of_day = row % hours_per_day;
    const year_month_day date{year(day.year), month(unsigned(day.month)), std::chrono::day(unsigned(day.day))};
    const std::string text = fmt::format("{:04}-{:02}-{:02}", day.year, day.month, day.day);
    if (!date.ok() || day.month > 12 || day.day > 31 || day.year < first_year || day.year > last_year)
        table.refuse(row, fmt::format("the day {}, which is none of {} to {}", text, first_year, last_year));
    if (hour != int(of_day) + 1) table.refuse(row, fmt::format("hour {} in place of {}", hour, of_day + 1));
    if (of_day != 0 && day != weather.hours.back().day)
        table.refuse(row, "the day " + text + " before the last has 24 h");
    const auto power = [&](const char* column) {
        return number_within(table, row, column, 0, most_power, "power of sunlight in W/m2");
    };
    weather.hours.push_back({day, hour - 1, power("dni"), wants_diffuse ? power("dhi") : 0});
}

int whole_number(const NumberTable& table, std::size_t row, const char* column) {
    const double number = number_within(table, row, column, 0, 9999, "part of a date");
    if (number != std::floor(number))
        table.refuse(row, fmt::format("{} = {}, which is no whole number", column, number));
    return int(number);
}

/// Names for the columns of an EPW file, which has no headings: "" where a column does not matter.
std::vector<std::string> epw_columns(std::size_t count) {
    std::vector<std::string> names(count);
    names[0] = "year";
    names[1] = "month";
    names[2] = "day";
    names[3] = "hour";
    names[14] = "dni";
    names[15] = "dhi";
    return names;
}

WeatherFile read_epw(std::string_view text, const std::string& file, bool wants_diffuse) {
    if (text.find("COMMENTS 2,Irradiance Time Offset") != text.npos)
        throw Error(file +
                    " is of PVGIS, whose EPW files give hours of UTC another time zone: gnomon.weather in "
                    "Python reads its CSV and JSON files");
    constexpr std::size_t head_lines = 8;
    WeatherFile weather = place_of(text, file,
                                   {"location", "name", "state", "country", "source", "station", "latitude",
                                    "longitude", "utc offset", "elevation"});
    // Files of some years lack the last columns.
    const NumberTable table(without_lines(text, head_lines), file,
                            {{epw_columns(35), epw_columns(34), epw_columns(33), epw_columns(32)}});
    for (std::size_t row = 0; row < table.rows(); ++row) {
        const auto number = [&](const char* column) { return whole_number(table, row, column); };
        add_hour(weather, table, row, {number("year"), number("month"), number("day")}, number("hour"), wants_diffuse);
    }
    return weather;
}

WeatherFile read_tmy3(std::string_view text, const std::string& file, bool wants_diffuse) {
    WeatherFile weather =
        place_of(text, file, {"station", "name", "state", "utc offset", "latitude", "longitude", "elevation"});
    const NumberTable table(without_lines(text, 1), file, {});
    table.require({"date", "time", "dni"}, "needs the columns date, time and DNI");
    if (wants_diffuse) table.require({"dhi"}, "needs the column DHI");
    for (std::size_t row = 0; row < table.rows(); ++row) {
        Days day;
        int hour = 0, minute = 0, end = 0;
        const std::string date = table.text(row, "date") + " " + table.text(row, "time");
        const int found =
            std::sscanf(date.c_str(), "%2d/%2d/%4d %2d:%2d%n", &day.month, &day.day, &day.year, &hour, &minute, &end);
        if (found != 5 || std::size_t(end) != date.size() || minute != 0)
            table.refuse(row, "the time \"" + date + "\", which is not MM/DD/YYYY HH:00");
        add_hour(weather, table, row, day, hour, wants_diffuse);
    }
    return weather;
}

void require_whole_days(const WeatherFile& weather, const std::string& file) {
    if (weather.hours.empty() || weather.hours.size() % hours_per_day != 0)
        throw Error(fmt::format("{} has {} hours, which are not whole days", file, weather.hours.size()));
    std::set<Days> days;
    for (std::size_t hour = 0; hour < weather.hours.size(); hour += hours_per_day) {
        const Days& day = weather.hours[hour].day;
        if (!days.insert(day).second)
            throw Error(fmt::format("{} has the day {:04}-{:02}-{:02} twice", file, day.year, day.month, day.day));
    }
}

/// "Greensboro (36.1, -79.95), months of 1980 to 2003, UTC-5".
std::string facts_of(const WeatherFile& weather) {
    const auto [first, last] =
        std::ranges::minmax_element(weather.hours, {}, [](const WeatherHour& hour) { return hour.day.year; });
    const std::string years = first->day.year == last->day.year
                                  ? std::to_string(first->day.year)
                                  : fmt::format("months of {} to {}", first->day.year, last->day.year);
    return fmt::format("{} ({}, {}), {}, UTC{:+}", weather.name, weather.latitude_degrees, weather.longitude_degrees,
                       years, weather.utc_offset_hours);
}

}  // namespace

WeatherFile read_weather(const std::filesystem::path& file, bool wants_diffuse) {
    const std::string whole = table_file_text(file), name = file.string();
    std::string_view text = whole;
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    WeatherFile weather = text.starts_with("LOCATION,")
                              ? read_epw(text, name + " (read as an EPW file)", wants_diffuse)
                              : read_tmy3(text, name + " (no EPW file, so read as a TMY3 table)", wants_diffuse);
    require_whole_days(weather, name);
    return weather;
}

SunTable suns_of_weather(const WeatherFile& weather, double north_degrees) {
    SunTable table;
    table.is_irradiation = true;
    table.facts = facts_of(weather);
    SunsOfPlace place;
    place.latitude_degrees = weather.latitude_degrees;
    place.longitude_degrees = weather.longitude_degrees;
    place.utc_offset_hours = weather.utc_offset_hours;
    for (const WeatherHour& hour : weather.hours) {
        const double middle = first_day(hour.day) + (hour.begins + 0.5) / hours_per_day;
        if (hour.direct_normal != 0) add_sun(table, place, middle, float(hour.direct_normal), north_degrees);
    }
    return table;
}

}  // namespace gnomon::app
