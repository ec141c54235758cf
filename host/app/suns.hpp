// SPDX-License-Identifier: MIT
// Tables of suns: directional lights with a weight each, from a CSV file or from the sun's way over a place.
#pragma once

#include <compare>
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
    std::size_t below_horizon = 0;   ///< rows or times that were left out
    double left_out = 0;             ///< sum of weights of those
    std::uint32_t step_minutes = 0;  ///< of suns_of_place(): each sun's exact weight; 0: their own weights count
    bool is_irradiation = false;     ///< of suns_of_weather(): weights are Wh/m2, sums kWh/m2
    std::string facts{};             ///< what the weather file says of itself, for people
    std::string note{};              ///< a sentence about columns that were not read

    /// Their weights are in units of 1 / weights_per_unit(), so that sums of steps are exact: 144 x 10 minutes are 24
    /// h.
    Lights lights() const;
    double weights_per_unit() const { return step_minutes != 0 ? 60 : is_irradiation ? 1000 : 1; }
    /// Of all suns.
    double sum_of_weights() const;
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
    auto operator<=>(const Days&) const = default;
};
constexpr int first_year = 1900, last_year = 2100;  ///< of the sun's positions
/// Days since 2000-01-01T00:00 at the first moment of the days, on their clock.
double first_day(const Days& days);

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

/// Adds the sun at a moment, in days since 2000-01-01T00:00 on the place's clock, if its centre is above the horizon.
void add_sun(SunTable& table, const SunsOfPlace& place, double moment, float weight, double north_degrees);

/// One sun in the middle of each step; its weight is the step in hours. Suns whose centre is not above the horizon are
/// left out.
SunTable suns_of_place(const SunsOfPlace& place, double north_degrees);

/// Reads a table of suns; docs/studies.md has its format ("The table of suns"), which studies of the Python package
/// share. Suns with an elevation of at most 0 are left out. Throws Error with the line's number and the column.
SunTable read_suns(const std::filesystem::path& file, double north_degrees);

/// A table that read_suns() takes back with the same bits, and so does a study, whose z points up.
std::string table_text(const SunTable& table);

/// The text of a file, unpacked if it is gzip's. Throws Error.
std::string table_file_text(const std::filesystem::path& file);

}  // namespace gnomon::app
