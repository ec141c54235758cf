// SPDX-License-Identifier: MIT
// Weather files: EPW and TMY3 as they are and as they break; the irradiance of open planes beside pvlib's, hour by
// hour, and by closed forms.
#include "app/weather_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "support/temporary_folder.hpp"

namespace {

using namespace gnomon::app;
namespace fs = std::filesystem;

constexpr double radians = std::numbers::pi / 180;

/// An EPW file of whole days from 1 on, of one year, with the same irradiance in all hours.
struct MadeEpw {
    double latitude = 48.2, longitude = 16.4, zone = 1;
    int year = 2019;
    std::vector<std::pair<int, int>> days{{6, 21}};                 // month, day
    std::function<double(int hour)> dni = [](int) { return 500; };  // of the hours 1 to 24

    std::string text() const {
        std::ostringstream out;
        out << "LOCATION,Made Town,-,AUT,made,110350," << latitude << ',' << longitude << ',' << zone << ",170.0\n"
            << "DESIGN CONDITIONS,0\nTYPICAL/EXTREME PERIODS,0\nGROUND TEMPERATURES,0\n"
            << "HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\nCOMMENTS 1,\"a; b\"\nCOMMENTS 2,\nDATA "
               "PERIODS,1,1,Data,Sunday,1/1,12/31\n";
        for (const auto& [month, day] : days)
            for (int hour = 1; hour <= 24; ++hour)
                out << year << ',' << month << ',' << day << ',' << hour << ",60,?9?9E0,9.9,9,9,99999,0,0,0,100,"
                    << dni(hour) << ",50"
                    << ",0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n";
        return out.str();
    }
};

class WeatherFiles : public testing::Test {
protected:
    fs::path file(const std::string& text) const {
        std::ofstream(folder_ / "made.epw", std::ios::binary) << text;
        return folder_ / "made.epw";
    }
    WeatherFile read(const MadeEpw& made) const { return read_weather(file(made.text())); }
    /// Refused with a sentence that names the file.
    void expect_refused(std::string text, const std::string& sentence) const {
        try {
            read_weather(file(text));
            ADD_FAILURE() << "accepted, in place of: " << sentence;
        } catch (const gnomon::Error& error) {
            const std::string what = error.what();
            EXPECT_TRUE(what.starts_with((folder_ / "made.epw").string())) << what;
            EXPECT_NE(what.find(sentence), std::string::npos) << what;
            EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        }
    }

    const support::TemporaryFolder made_;
    const fs::path folder_ = made_.path();
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST_F(WeatherFiles, EpwHoursBeginOneBeforeTheirNumber) {
    const WeatherFile weather = read({.dni = [](int hour) { return 10.0 * hour; }});
    EXPECT_EQ(weather.name, "Made Town");
    EXPECT_EQ(weather.latitude_degrees, 48.2);
    EXPECT_EQ(weather.longitude_degrees, 16.4);
    EXPECT_EQ(weather.utc_offset_hours, 1);
    ASSERT_EQ(weather.hours.size(), 24u);
    EXPECT_EQ(weather.hours[0].begins, 0);
    EXPECT_EQ(weather.hours[12].begins, 12);
    EXPECT_EQ(weather.hours[12].direct_normal, 130) << "hour 13 is from 12 to 13 o'clock";
    EXPECT_EQ(weather.hours[23].day, (Days{2019, 6, 21}));
}

TEST_F(WeatherFiles, Tmy3DaysEndAt24Hours) {
    const WeatherFile weather = read_weather(GNOMON_TESTS "/command/weather_of_pvlib.csv");
    EXPECT_EQ(weather.name, "GREENSBORO PIEDMONT TRIAD INT");
    EXPECT_EQ(weather.utc_offset_hours, -5);
    ASSERT_EQ(weather.hours.size(), 72u);
    EXPECT_EQ(weather.hours[0].day, (Days{1988, 1, 2}));
    EXPECT_EQ(weather.hours[23].day, (Days{1988, 1, 2})) << "24:00 belongs to the day that it ends";
    EXPECT_EQ(weather.hours[23].begins, 23);
}

TEST_F(WeatherFiles, FilesMayHaveOtherLinesAndFewerColumns) {
    const std::string text = MadeEpw().text();
    const auto hours = [&](const std::string& other) { return read_weather(file(other)).hours.size(); };
    EXPECT_EQ(hours("\xef\xbb\xbf" + text), 24u);
    std::string windows, narrow;
    for (const char c : text) windows += c == '\n' ? "\r\n" : std::string(1, c);
    EXPECT_EQ(hours(windows), 24u);
    narrow = text;
    for (std::size_t at = 0; (at = narrow.find(",0,0,0\n", at)) != std::string::npos;) narrow.replace(at, 7, "\n");
    EXPECT_EQ(hours(narrow), 24u) << "32 columns";
}

TEST_F(WeatherFiles, ALeapDayCountsInALeapYearAlone) {
    MadeEpw leap{.year = 2020, .days = {{2, 28}, {2, 29}, {3, 1}}};
    const WeatherFile weather = read(leap);
    ASSERT_EQ(weather.hours.size(), 72u);
    EXPECT_EQ(weather.hours[47].day, (Days{2020, 2, 29}));
    leap.year = 2019;
    expect_refused(leap.text(), "line 33 has the day 2019-02-29, which is none of 1900 to 2100");
}

TEST_F(WeatherFiles, BrokenFilesAreOneSentence) {
    const std::string good = MadeEpw().text(), row = "2019,6,21,5,";
    expect_refused("", "names no place in its first line");
    expect_refused("\1\2 nothing\n", "so read as a TMY3 table): names no place in its first line");
    expect_refused("time,dni\n1,2\n", "names no place in its first line");
    expect_refused(replaced(good, "48.2", "north"), "line 1 has latitude = \"north\", which is no finite number");
    expect_refused(replaced(good, "48.2", "148.2"), "line 1 has latitude = 148.2, which is no latitude");
    expect_refused(replaced(good, ",1,170.0", ",19,170.0"), "line 1 has utc offset = 19, which is no time zone");
    expect_refused(replaced(good, row, "2019,6,21,6,"), "line 13 has hour 6 in place of 5");
    expect_refused(replaced(good, row, "2019,6,22,5,"), "line 13 has the day 2019-06-22 before the last has 24 h");
    expect_refused(replaced(good, row, "2019,6,31,5,"), "line 13 has the day 2019-06-31");
    expect_refused(replaced(good, row, "2019,262,21,5,"), "line 13 has the day 2019-262-21");
    expect_refused(replaced(good, row, "2019,-6,21,5,"), "line 13 has month = -6, which is no part of a date");
    expect_refused(replaced(good, row, "1850,6,21,5,"),
                   "line 13 has the day 1850-06-21, which is none of 1900 to 2100");
    expect_refused(replaced(good, row, "2019,6,21.5,5,"), "line 13 has day = 21.5, which is no whole number");
    expect_refused(replaced(good, ",100,500,", ",100,9999,"), "line 9 has dni = 9999, which is no power of sunlight");
    expect_refused(replaced(good, ",100,500,", ",100,-1,"), "line 9 has dni = -1, which is no power of sunlight");
    expect_refused(replaced(good, ",100,500,", ",100,,"), "line 9 has no dni");
    expect_refused(replaced(good, ",100,500,", ",100,"), "line 10 has 35 columns in place of 34");
    expect_refused(good.substr(0, good.find("2019,6,21,24,")), "has 23 hours, which are not whole days");
    expect_refused(good.substr(0, good.find("2019,")), "has 0 hours, which are not whole days");
    expect_refused(good + good.substr(good.find("2019,")), "has the day 2019-06-21 twice");
    expect_refused("1,Made,AU,2,3,4,5\nDate (MM/DD/YYYY),Time (HH:MM),GHI (W/m^2)\n",
                   "so read as a TMY3 table): needs the columns date, time and DNI");
    expect_refused("1,Made,AU,2,3,4,5\nDate,Time,DNI\n06/21/2019,01:30,5\n", "which is not MM/DD/YYYY HH:00");
    EXPECT_THROW(read_weather(folder_ / "none.epw"), gnomon::Error);
}

#ifdef GNOMON_HAS_ERFA
double power_on(const Sun& sun, const std::array<double, 3>& normal) {
    double cosine = 0;
    for (std::size_t c = 0; c < 3; ++c) cosine -= double(sun.direction[c]) * normal[c];
    return double(sun.weight) * std::max(cosine, 0.0);
}

std::array<double, 3> plane(double tilt, double azimuth) {
    const double level = std::sin(tilt * radians);
    return {level * std::sin(azimuth * radians), std::cos(tilt * radians), -level * std::cos(azimuth * radians)};
}

/// kWh/m2 of an open plane.
double energy_on(const SunTable& table, const std::array<double, 3>& normal) {
    double sum = 0;
    for (const Sun& sun : table.suns) sum += power_on(sun, normal);
    return sum / table.weights_per_unit();
}

TEST_F(WeatherFiles, OpenPlanesGetWhatPvlibSays) {
    const auto theirs = nlohmann::json::parse(std::ifstream(GNOMON_TESTS "/command/weather_of_pvlib.json"));
    const SunTable table = suns_of_weather(read_weather(GNOMON_TESTS "/command/weather_of_pvlib.csv"), 0);
    EXPECT_EQ(table.facts, "GREENSBORO PIEDMONT TRIAD INT (36.1, -79.95), months of 1980 to 1989, UTC-5");
    std::size_t row = 0;
    for (const auto& hour : theirs["hours"]) {
        if (row == table.suns.size() || table.suns[row].time != hour["time"].get<std::string>()) {
            for (const double beam : hour["beam"]) EXPECT_LT(beam, 1) << "an hour whose sun is not up in its middle";
            continue;
        }
        const Sun& sun = table.suns[row++];
        EXPECT_EQ(sun.weight, hour["dni"].get<float>());
        for (std::size_t p = 0; p < theirs["planes"].size(); ++p) {
            const std::array<double, 2> at = theirs["planes"][p];
            EXPECT_NEAR(power_on(sun, plane(at[0], at[1])), hour["beam"][p].get<double>(), 0.02)
                << sun.time << ' ' << p;
        }
    }
    EXPECT_EQ(row, table.suns.size());
    EXPECT_EQ(row + table.below_horizon, theirs["hours"].size());
}

// Whatever the Sun's way: the squares of what six walls of a cube get are the square of the beam.
TEST_F(WeatherFiles, ACubeGetsTheWholeBeam) {
    for (const double zone : {1.0, 5.75, -9.5}) {
        MadeEpw made{.longitude = 15 * zone, .zone = zone, .dni = [](int hour) { return hour == 13 ? 700.0 : 0.0; }};
        const SunTable table = suns_of_weather(read(made), 30);
        ASSERT_EQ(table.suns.size(), 1u);
        double squares = 0;
        for (std::size_t c = 0; c < 3; ++c)
            for (const double side : {-1.0, 1.0}) {
                std::array<double, 3> normal{};
                normal[c] = side;
                squares += std::pow(energy_on(table, normal), 2);
            }
        EXPECT_NEAR(std::sqrt(squares), 0.7, 1e-7);
        EXPECT_NE(table.suns[0].time.find("T12:30:00"), std::string::npos) << table.suns[0].time;
    }
}

// At the poles the Sun of the solstice stands 23.44 degrees high and goes round evenly: the floor gets 24 times its
// sine, each of four walls its cosine times the sum of the positive cosines of 24 azimuths 15 degrees apart. Where
// these begin changes that sum by less than 1 %.
TEST_F(WeatherFiles, DaysAtThePoles) {
    const double height = 23.44 * radians;
    for (const auto& [latitude, month] : {std::pair{90.0, 6}, std::pair{-90.0, 12}}) {
        const SunTable table =
            suns_of_weather(read({.latitude = latitude, .longitude = 0, .zone = 0, .days = {{month, 21}}}), 0);
        EXPECT_EQ(table.suns.size(), 24u);
        EXPECT_NEAR(energy_on(table, {0, 1, 0}), 0.5 * 24 * std::sin(height), 0.003);
        for (const double azimuth : {0, 90, 180, 270})
            EXPECT_NEAR(energy_on(table, plane(90, azimuth)), 0.5 * std::cos(height) / std::sin(7.5 * radians), 0.03);
        const SunTable winter =
            suns_of_weather(read({.latitude = -latitude, .longitude = 0, .zone = 0, .days = {{month, 21}}}), 0);
        EXPECT_TRUE(winter.suns.empty());
        EXPECT_EQ(winter.below_horizon, 24u);
        EXPECT_EQ(winter.left_out, 24 * 500);
    }
}

TEST_F(WeatherFiles, ASouthernNoonIsInTheNorth) {
    MadeEpw made{.latitude = -33.9, .longitude = 18.4, .zone = 2, .days = {{6, 21}}};
    made.dni = [](int hour) { return hour == 13 ? 1000.0 : 0.0; };
    const SunTable table = suns_of_weather(read(made), 0);
    EXPECT_GT(energy_on(table, {0, 0, -1}), 0.8) << "a wall that looks north, to -z";
    EXPECT_EQ(energy_on(table, {0, 0, 1}), 0);
}
#endif

}  // namespace
