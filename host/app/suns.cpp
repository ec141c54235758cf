// SPDX-License-Identifier: MIT
#include "suns.hpp"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>

#ifdef GNOMON_HAS_ERFA
#include <erfa.h>
#endif

#include "output_files.hpp"
#include "scene/number_table.hpp"
#include "terminal.hpp"
#include "values.hpp"

namespace gnomon::app {
namespace {

using scene::NumberTable;

constexpr double radians = std::numbers::pi / 180;
constexpr std::uint32_t minutes_per_day = 1440;

std::string time_text(double days_since_2000, double utc_offset_hours) {
    using namespace std::chrono;
    // To the nearest second, so that 11:30 is not 11:29:59.
    const sys_seconds at = sys_days(year(2000) / January / 1) + seconds(std::llround(days_since_2000 * 86400));
    const year_month_day date(floor<days>(at));
    const hh_mm_ss time(at - floor<days>(at));
    const int minutes_ahead = int(std::lround(utc_offset_hours * 60));
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}{}{:02}:{:02}", int(date.year()), unsigned(date.month()),
                       unsigned(date.day()), time.hours().count(), time.minutes().count(), time.seconds().count(),
                       minutes_ahead < 0 ? '-' : '+', std::abs(minutes_ahead) / 60, std::abs(minutes_ahead) % 60);
}

/// The row's x, y, z in a scene whose y points up.
Float3 direction_in(const NumberTable& table, std::size_t row) {
    Float3 direction{};
    const char* const names[] = {"x", "y", "z"};
    for (std::size_t c = 0; c < 3; ++c) direction[c] = table.float_number(row, names[c]);
    if (direction == Float3{0, 0, 0}) table.refuse(row, "the direction 0,0,0");
    const std::string up = table.has("up") ? table.text(row, "up") : "y";
    if (up != "y" && up != "z") table.refuse(row, "up = \"" + up + "\", which is neither y nor z");
    if (up == "z") return {direction[0], direction[2], 0 - direction[1]};  // 0 - y: no minus zero
    return direction;
}

}  // namespace

double first_day(const Days& days) {
    using namespace std::chrono;
    const sys_days first =
        year(days.year) / month(unsigned(std::max(days.month, 1))) / day(unsigned(std::max(days.day, 1)));
    return double((first - sys_days(year(2000) / January / 1)).count());
}

Lights SunTable::lights() const {
    std::vector<Light> lights;
    std::vector<float> weights;
    for (const Sun& sun : suns) {
        lights.push_back(Light::directional(sun.direction));
        weights.push_back(step_minutes != 0 ? float(step_minutes) : sun.weight);
    }
    return Lights(std::move(lights), std::move(weights));
}

double SunTable::sum_of_weights() const {
    if (step_minutes != 0) return double(suns.size()) * step_minutes / weights_per_unit();
    double sum = 0;
    for (const Sun& sun : suns) sum += double(sun.weight);
    return sum / weights_per_unit();
}

#ifdef GNOMON_HAS_ERFA
SunPosition sun_position(double latitude_degrees, double longitude_degrees, double julian_day) {
    // The clock's time is UT1: it turns the earth. The other times follow from it, to some seconds, which matter
    // little.
    const double day = std::floor(julian_day), part = julian_day - day;
    eraASTROM observer;
    double origins = 0;
    eraApco13(day, part, 0, longitude_degrees * radians, latitude_degrees * radians, 0, 0, 0, 0, 0, 0, 0.55, &observer,
              &origins);
    double tai[2], tt[2], earth_from_sun[2][3], earth[2][3];
    eraUtctai(day, part, &tai[0], &tai[1]);
    eraTaitt(tai[0], tai[1], &tt[0], &tt[1]);
    eraEpv00(tt[0], tt[1], earth_from_sun, earth);
    // From the observer, not from the earth's centre: with parallax. (The sun hardly moves while its light travels.)
    double towards[3];
    for (int c = 0; c < 3; ++c) towards[c] = earth[0][c] - earth_from_sun[0][c] - observer.eb[c];
    double right_ascension = 0, declination = 0, azimuth = 0, zenith = 0, unused[3];
    eraC2s(towards, &right_ascension, &declination);
    eraAtciqz(right_ascension, declination, &observer, &right_ascension, &declination);
    eraAtioq(right_ascension, declination, &observer, &azimuth, &zenith, &unused[0], &unused[1], &unused[2]);
    return {azimuth / radians, 90 - zenith / radians};
}
#else
SunPosition sun_position(double, double, double) {
    throw Error(
        "this gnomon was built without ERFA (Debian: liberfa-dev), which knows the sun's positions: give "
        "--directions FILE.csv in place of --place or --epw");
}
#endif

double refraction_degrees(double true_elevation_degrees) {
    return 1.02 / 60 / std::tan((true_elevation_degrees + 10.3 / (true_elevation_degrees + 5.11)) * radians);
}

Float3 travel_direction(double azimuth_degrees, double elevation_degrees, double north_degrees) {
    const double turned = (azimuth_degrees + north_degrees) * radians, elevation = elevation_degrees * radians;
    const double level = std::cos(elevation);
    return {float(-level * std::sin(turned)), float(-std::sin(elevation)), float(level * std::cos(turned))};
}

void add_sun(SunTable& table, const SunsOfPlace& place, double moment, float weight, double north_degrees) {
    constexpr double julian_day_2000 = 2451544.5;
    const double utc_offset_days = place.utc_offset_hours / 24;
    SunPosition sun =
        sun_position(place.latitude_degrees, place.longitude_degrees, moment - utc_offset_days + julian_day_2000);
    if (place.is_apparent) sun.elevation_degrees += refraction_degrees(sun.elevation_degrees);
    if (!(sun.elevation_degrees > 0)) {
        ++table.below_horizon;
        table.left_out += double(weight);
        return;
    }
    table.suns.push_back({time_text(moment, place.utc_offset_hours), sun.azimuth_degrees, sun.elevation_degrees,
                          travel_direction(sun.azimuth_degrees, sun.elevation_degrees, north_degrees), weight});
}

SunTable suns_of_place(const SunsOfPlace& place, double north_degrees) {
    const double first = first_day(place.days);
    const double end = place.days.month == 0 ? first_day({place.days.year + 1, 1, 1}) : first + 1;
    const auto steps = std::size_t(std::llround((end - first) * minutes_per_day / place.step_minutes));
    SunTable table;
    table.step_minutes = place.step_minutes;
    for (std::size_t step = 0; step < steps; ++step) {
        const double moment = first + (double(step) + 0.5) * place.step_minutes / minutes_per_day;
        add_sun(table, place, moment, float(place.step_minutes) / 60, north_degrees);
    }
    return table;
}

SunTable read_suns(const std::filesystem::path& file, double north_degrees) {
    const NumberTable rows(table_file_text(file), file.string(),
                           {{{"x", "y", "z"}, {"x", "y", "z", "weight"}}, scene::sun_headings()});
    const bool has_direction = rows.has("x") && rows.has("y") && rows.has("z");
    const bool has_angles = rows.has("azimuth") && rows.has("elevation");
    if (!has_direction && !has_angles)
        rows.require({"x", "y", "z"}, "a table of suns needs the columns x, y, z or azimuth, elevation");
    if (!has_direction) rows.require_degrees(rows.numbers("azimuth"), rows.numbers("elevation"));
    SunTable table;
    for (std::size_t row = 0; row < rows.rows(); ++row) {
        Sun sun;
        if (rows.has("time")) sun.time = rows.text(row, "time");
        if (rows.has("weight")) sun.weight = rows.float_number(row, "weight");
        if (has_angles) {
            sun.azimuth_degrees = rows.number(row, "azimuth");
            sun.elevation_degrees = rows.number(row, "elevation");
            if (std::abs(*sun.azimuth_degrees) > 360) rows.refuse(row, "an azimuth beyond 360 degrees");
            if (std::abs(*sun.elevation_degrees) > 90) rows.refuse(row, "an elevation beyond 90 degrees");
            if (!(*sun.elevation_degrees > 0)) {
                ++table.below_horizon;
                continue;
            }
        }
        sun.direction = has_direction ? direction_in(rows, row)
                                      : travel_direction(*sun.azimuth_degrees, *sun.elevation_degrees, north_degrees);
        table.suns.push_back(std::move(sun));
    }
    if (rows.has("weight")) rows.require_weights("weight");
    table.note = rows.unread_weights();
    return table;
}

std::string table_text(const SunTable& table) {
    std::string text = "time,azimuth,elevation,x,y,z,up,weight\n";
    const bool has_angles =
        std::ranges::all_of(table.suns, [](const Sun& sun) { return sun.azimuth_degrees.has_value(); });
    if (!has_angles) text = "time,x,y,z,up,weight\n";
    for (const Sun& sun : table.suns) {
        text += sun.time + ",";
        if (has_angles) text += fmt::format("{:.9f},{:.9f},", *sun.azimuth_degrees, *sun.elevation_degrees);
        text += float3_text(sun.direction) + ",y," + float_text(sun.weight) + "\n";
    }
    return text;
}

std::string table_file_text(const std::filesystem::path& file) {
    const auto closed = [](gzFile opened) { gzclose(opened); };
    const std::unique_ptr<gzFile_s, decltype(closed)> in(gzopen(file.c_str(), "rb"));  // reads plain files as they are
    std::string text;
    std::array<char, 1 << 16> part;
    if (!in) refuse_input(file);
    int count = 0;
    while ((count = gzread(in.get(), part.data(), part.size())) > 0) text.append(part.data(), std::size_t(count));
    int state = Z_OK;
    gzerror(in.get(), &state);
    if (state == Z_ERRNO) refuse_input(file);
    if (state != Z_OK && state != Z_STREAM_END)
        throw Error("cannot read " + file.string() + ": it is packed with gzip, and cut off or damaged: pack it again");
    return text;
}

}  // namespace gnomon::app
