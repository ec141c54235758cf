// SPDX-License-Identifier: MIT
// Weather files: the hours of a year, or of a part of it, at a place, with the Sun's power in each of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "suns.hpp"

namespace gnomon::app {

/// An hour of a weather file.
struct WeatherHour {
    Days day{};
    int begins = 0;                 ///< on the file's clock, 0 to 23
    double direct_normal = 0;       ///< mean direct normal irradiance, W/m2
    double diffuse_horizontal = 0;  ///< mean diffuse irradiance of level ground, W/m2, if it was wanted
};

/// Whole days of hours. Months of a typical year are of different years.
struct WeatherFile {
    std::string name;  ///< of the place
    double latitude_degrees = 0, longitude_degrees = 0;
    double utc_offset_hours = 0;
    double elevation_metres = 0;
    std::vector<WeatherHour> hours;
};

/// Reads an EPW file or a TMY3 table. Throws Error with the line's number and the column.
WeatherFile read_weather(const std::filesystem::path& file, bool wants_diffuse = false);

/// A sun in the middle of each hour that has direct irradiance; it weighs its Wh/m2.
SunTable suns_of_weather(const WeatherFile& weather, double north_degrees);

}  // namespace gnomon::app
