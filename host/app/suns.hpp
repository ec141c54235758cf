// SPDX-License-Identifier: MIT
// Tables of suns: directional lights with a weight each, from a CSV file or from the sun's way over a place.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gnomon.hpp>

namespace gnomon::app {

struct Sun {
    std::string time{};                         ///< "2026-06-21T11:30+01:00", empty if it is not known
    std::optional<double> azimuth_degrees{};    ///< clockwise from north
    std::optional<double> elevation_degrees{};  ///< above the horizon
    Float3 direction{};                         ///< in which its light travels in the scene
    float weight = 1;
};

struct SunTable {
    std::vector<Sun> suns;
    std::size_t below_horizon = 0;  ///< rows or times that were left out

    Lights lights() const;
};

/// Where the sun stands for an observer at sea level: azimuth clockwise from north, elevation, both in degrees. The
/// elevation is true (without refraction), of the sun's centre, with the observer's parallax. By ERFA (IAU 2006/2000A).
struct SunPosition {
    double azimuth_degrees, elevation_degrees;
};
/// `julian_day` in universal time. Throws Error if this build has no ERFA.
SunPosition sun_position(double latitude_degrees, double longitude_degrees, double julian_day);
/// What refraction adds to a true elevation, in degrees, at 1010 hPa and 10 degrees Celsius (Saemundsson, "Atmospheric
/// refraction", 1986).
double refraction_degrees(double true_elevation_degrees);

/// A calendar day, or a whole year where month and day are 0.
struct Days {
    int year = 0, month = 0, day = 0;
};

struct SunsOfPlace {
    double latitude_degrees = 0, longitude_degrees = 0;
    Days days{};
    std::uint32_t step_minutes = 0;  ///< divides a day
    double utc_offset_hours = 0;     ///< of the clock that the days follow
    bool is_apparent = false;        ///< elevations with refraction
};

/// The direction in which the light of a sun travels in a scene whose y points up. `north_degrees`: the direction of
/// north, clockwise as seen from above, from -z.
Float3 travel_direction(double azimuth_degrees, double elevation_degrees, double north_degrees);

/// One sun in the middle of each step; its weight is the step in hours. Suns whose centre is not above the horizon are
/// left out.
SunTable suns_of_place(const SunsOfPlace& place, double north_degrees);

/// Reads a table of suns; docs/studies.md has its format ("The table of suns"), which studies of the Python package
/// share. Suns with an elevation of at most 0 are left out. Throws Error with the line's number and the column.
SunTable read_suns(const std::filesystem::path& file, double north_degrees);

/// A table that read_suns() takes back with the same bits, and so does a study, whose z points up.
std::string table_text(const SunTable& table);

/// Named columns of numbers in a CSV file. Used for suns and for points.
class NumberTable {
public:
    /// `unnamed`: the columns of a file without a line of names; its rows have from 3 of them on. Throws Error.
    NumberTable(const std::filesystem::path& file, const std::vector<std::string>& unnamed);
    bool has(const std::string& column) const;
    std::size_t rows() const { return rows_.size(); }
    const std::string& text(std::size_t row, const std::string& column) const;
    /// A finite number. Throws Error with the line.
    double number(std::size_t row, const std::string& column) const;
    [[noreturn]] void refuse(std::size_t row, const std::string& reason) const;

private:
    struct Row {
        std::size_t line;
        std::vector<std::string> cells;
    };
    std::filesystem::path file_;
    std::vector<std::string> names_;
    std::vector<Row> rows_;
};

}  // namespace gnomon::app
