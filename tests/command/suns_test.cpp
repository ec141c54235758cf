// SPDX-License-Identifier: MIT
// Tables of suns: the sun's positions beside pvlib's SPA, directions in the scene, files that go round with the same
// bits, and what is refused.
#include "app/suns.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "scene/number_table.hpp"
#include "support/temporary_folder.hpp"

namespace {

using namespace gnomon::app;
namespace fs = std::filesystem;

constexpr double radians = std::numbers::pi / 180;

class Suns : public testing::Test {
protected:
    fs::path file(const std::string& text) const {
        std::ofstream(folder_ / "suns.csv") << text;
        return folder_ / "suns.csv";
    }
    void expect_refused(const std::string& text, const std::string& sentence) const {
        try {
            read_suns(file(text), 0);
            ADD_FAILURE() << "accepted: " << text;
        } catch (const gnomon::Error& error) {
            EXPECT_NE(std::string(error.what()).find(sentence), std::string::npos) << error.what();
        }
    }

    const support::TemporaryFolder made_;
    const fs::path folder_ = made_.path();
};

/// "2026-06-21T11:35Z" as a Julian day: 2440587.5 is 1970-01-01T00:00Z.
double julian_day(const std::string& text) {
    using namespace std::chrono;
    int y = 0, m = 0, d = 0, hours_of_day = 0, minutes_of_hour = 0;
    std::sscanf(text.c_str(), "%d-%d-%dT%d:%dZ", &y, &m, &d, &hours_of_day, &minutes_of_hour);
    const sys_days days = year(y) / month(unsigned(m)) / day(unsigned(d));
    return 2440587.5 + days.time_since_epoch().count() + (hours_of_day + minutes_of_hour / 60.0) / 24;
}

std::array<double, 3> towards(double azimuth, double elevation) {
    return {std::cos(elevation * radians) * std::sin(azimuth * radians),
            std::cos(elevation * radians) * std::cos(azimuth * radians), std::sin(elevation * radians)};
}

#ifdef GNOMON_HAS_ERFA
TEST_F(Suns, PositionsAreThoseOfPvlib) {
    std::ifstream table(GNOMON_TESTS "/command/suns_of_pvlib.csv");
    std::string line;
    std::getline(table, line);
    double worst = 0, worst_apparent = 0;
    std::size_t rows = 0;
    while (std::getline(table, line)) {
        std::istringstream cells(line);
        std::string latitude, longitude, time, azimuth, elevation, apparent;
        for (std::string* cell : {&latitude, &longitude, &time, &azimuth, &elevation, &apparent})
            std::getline(cells, *cell, ',');
        const SunPosition sun = sun_position(std::stod(latitude), std::stod(longitude), julian_day(time));
        const auto mine = towards(sun.azimuth_degrees, sun.elevation_degrees);
        const auto theirs = towards(std::stod(azimuth), std::stod(elevation));
        double squares = 0;
        for (std::size_t c = 0; c < 3; ++c) squares += (mine[c] - theirs[c]) * (mine[c] - theirs[c]);
        const double apart = std::sqrt(squares) / radians;
        EXPECT_LT(apart, 0.001) << line;
        worst = std::max(worst, apart);
        if (sun.elevation_degrees > 0) {
            const double mine_apparent = sun.elevation_degrees + refraction_degrees(sun.elevation_degrees);
            worst_apparent = std::max(worst_apparent, std::abs(mine_apparent - std::stod(apparent)));
            EXPECT_NEAR(mine_apparent, std::stod(apparent), 0.001) << line;
        }
        ++rows;
    }
    EXPECT_EQ(rows, 81u);
    RecordProperty("worst_degrees", std::to_string(worst) + " " + std::to_string(worst_apparent));
}

TEST_F(Suns, ADayOnTheEquatorHasTwelveHours) {
    const SunTable day = suns_of_place({0, 0, {2026, 3, 20}, 5, 0, false}, 0);
    EXPECT_EQ(day.suns.size() + day.below_horizon, 288u);
    EXPECT_NEAR(double(day.suns.size()), 144, 2);
    EXPECT_EQ(day.suns.front().weight, 5.0f / 60);
    const auto highest = std::ranges::max_element(day.suns, {}, [](const Sun& sun) { return *sun.elevation_degrees; });
    EXPECT_GT(*highest->elevation_degrees, 88);
    EXPECT_EQ(highest->time.substr(0, 13), "2026-03-20T12");
    for (const Sun& sun : day.suns) EXPECT_LT(sun.direction[1], 0) << "light falls";
    // The sun rises in the east (+x), so that its light travels to the west.
    EXPECT_LT(day.suns.front().direction[0], -0.99f);
    EXPECT_GT(day.suns.back().direction[0], 0.99f);
}

TEST_F(Suns, AYearHasItsDaysAndRefractionAddsSome) {
    SunsOfPlace place{52, 0, {2024, 0, 0}, 60, 0, false};
    const SunTable year = suns_of_place(place, 0);
    EXPECT_EQ(year.suns.size() + year.below_horizon, 366u * 24);
    EXPECT_EQ(year.suns.front().time.substr(0, 10), "2024-01-01");
    EXPECT_EQ(year.suns.back().time.substr(0, 10), "2024-12-31");
    place.is_apparent = true;
    EXPECT_GT(suns_of_place(place, 0).suns.size(), year.suns.size());
    EXPECT_TRUE(suns_of_place({90, 0, {2026, 12, 21}, 60, 0, false}, 0).suns.empty()) << "polar night";
    EXPECT_EQ(suns_of_place({90, 0, {2026, 6, 21}, 60, 0, false}, 0).suns.size(), 24u);
}

// The table of the benchmark was written by gnomon hours --place 52,0 --year 2026 --step 60. A C library's sine may
// differ in its last bit.
TEST_F(Suns, TheTableOfTheBenchmarkIsThatOfItsPlace) {
    const SunTable table = read_suns(GNOMON_TESTS "/../tools/bench/suns_of_latitude_52.csv", 0);
    const SunTable made = suns_of_place({52, 0, {2026, 0, 0}, 60}, 0);
    ASSERT_EQ(table.suns.size(), 4408u);
    ASSERT_EQ(made.suns.size(), table.suns.size());
    for (std::size_t i = 0; i < made.suns.size(); ++i) {
        EXPECT_EQ(made.suns[i].time.substr(5, 11), table.suns[i].time);
        EXPECT_LT(table.suns[i].direction[1], 0);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(made.suns[i].direction[c], table.suns[i].direction[c], 2e-7);
    }
}

TEST_F(Suns, ATableGoesRoundWithTheSameBits) {
    const SunTable made = suns_of_place({48.2, 16.4, {2026, 6, 21}, 10, 1.5, true}, 33);
    const SunTable read = read_suns(file(table_text(made)), 90);  // x, y, z decide, not the angles and north
    ASSERT_EQ(read.suns.size(), made.suns.size());
    for (std::size_t i = 0; i < made.suns.size(); ++i) {
        EXPECT_EQ(read.suns[i].direction, made.suns[i].direction);
        EXPECT_EQ(read.suns[i].weight, made.suns[i].weight);
        EXPECT_EQ(read.suns[i].time, made.suns[i].time);
    }
    EXPECT_EQ(table_text(read), table_text(made));
    EXPECT_NE(made.suns.front().time.find("+01:30"), std::string::npos);
}
#endif

TEST_F(Suns, DirectionsInTheScene) {
    const auto expect = [](const gnomon::Float3& got, const gnomon::Float3& wanted) {
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 1e-6f);
    };
    expect(travel_direction(0, 0, 0), {0, 0, 1});    // from the north, -z
    expect(travel_direction(90, 0, 0), {-1, 0, 0});  // from the east, +x
    expect(travel_direction(0, 90, 0), {0, -1, 0});
    expect(travel_direction(0, 0, 90), {-1, 0, 0});  // north is +x
    expect(travel_direction(180, 30, 0), {0, -0.5f, -std::sqrt(0.75f)});
}

TEST_F(Suns, TablesOfAllKinds) {
    const SunTable bare = read_suns(file("0.1,-1,0.25\n\n# a comment\n0,-1,0\n"), 0);
    ASSERT_EQ(bare.suns.size(), 2u);
    EXPECT_EQ(bare.suns[0].direction, (gnomon::Float3{0.1f, -1, 0.25f}));
    EXPECT_EQ(bare.suns[0].weight, 1);
    EXPECT_EQ(read_suns(file("0,-1,0,2.5\n"), 0).suns[0].weight, 2.5f);
    const SunTable angles =
        read_suns(file("Weights,elevation,note,azimuth\r\n1,45,\"a\",90\r\n2,-3,b,0\r\n0.5,0,c,0\r\n"), 0);
    ASSERT_EQ(angles.suns.size(), 1u);
    EXPECT_EQ(angles.below_horizon, 2u);
    EXPECT_EQ(angles.suns[0].direction, travel_direction(90, 45, 0));
    EXPECT_EQ(read_suns(file("x,y,z,weight\n0,-1,0,-7\n"), 0).suns[0].weight, -7) << "negative weights are fine";
    EXPECT_TRUE(read_suns(file("x,y,z\n"), 0).suns.empty());
}

// suns_of_hours.csv and suns_of_study.csv are made by hand: two suns, in a scene whose y points up and in one whose z
// does. tests/python/study/test_sun_tables.py has the other half.
TEST_F(Suns, WeightsUnderOtherHeadingsAreTold) {
    EXPECT_NE(read_suns(file("azimuth,elevation,DNI [W/m2]\n180,45,700\n"), 0).note.find("\"dni\": not read"),
              std::string::npos);
    EXPECT_EQ(read_suns(file("azimuth,elevation,dni,weight\n180,45,700,2\n"), 0).note, "");
    EXPECT_EQ(read_suns(file("azimuth,elevation,note,zenith\n180,45,a,45\n"), 0).note, "");
}

TEST_F(Suns, OneTableServesHoursAndStudies) {
    const fs::path of_hours = GNOMON_TESTS "/command/suns_of_hours.csv";
    const fs::path of_study = GNOMON_TESTS "/command/suns_of_study.csv";
    for (const fs::path& path : {of_hours, of_study}) {
        const SunTable table = read_suns(path, 90);  // x, y, z decide, not the angles and north
        ASSERT_EQ(table.suns.size(), 2u) << path;
        EXPECT_EQ(table.suns[0].direction, (gnomon::Float3{-0.6f, -0.8f, 0})) << path;
        EXPECT_EQ(table.suns[1].direction, (gnomon::Float3{0.5f, -0.25f, -0.75f})) << path;
        EXPECT_EQ(table.suns[0].weight, 0.5f) << path;
        EXPECT_EQ(table.suns[1].weight, 2) << path;
    }
    std::ostringstream text;
    text << std::ifstream(of_hours).rdbuf();
    EXPECT_EQ(table_text(read_suns(of_hours, 0)), text.str());
    EXPECT_FALSE(std::signbit(read_suns(file("x,y,z,up\n1,0,-1,z\n"), 0).suns[0].direction[2])) << "no minus zero";
}

TEST_F(Suns, RefusesWhatItCannotRead) {
    expect_refused("a,b,c\n1,2,3\n", "needs the columns x, y, z or azimuth, elevation");
    expect_refused("x,y,z\n1,2\n", "line 2 has 2 columns in place of 3");
    expect_refused("# text\nx,y,z\n\n1,2,nan\n", "line 4 has z = \"nan\"");
    expect_refused("x,y,z\n1,2,3x\n", "which is no finite number");
    expect_refused("x,y,z\n0,0,0\n", "line 2 has the direction 0,0,0");
    expect_refused("azimuth,elevation\n10,91\n", "an elevation beyond 90 degrees");
    expect_refused("azimuth,elevation\n-9999,9\n", "line 2 has an azimuth beyond 360 degrees");
    expect_refused("azimuth,elevation,weight\n180,45,3\n90,45,-9999\n",
                   "line 3 has weight = \"-9999\", which stands for no data");
    expect_refused("x,y,z,weight\n1,2,3,1e39\n", "line 2 has weight = \"1e39\", which is beyond float32");
    expect_refused("up,x,y,z\ny,1,-2,3\nx,1,-2,3\n", "line 3 has up = \"x\", which is neither y nor z");
    EXPECT_THROW(read_suns(folder_ / "none.csv", 0), gnomon::Error);
}

// tests/python/study/test_sun_tables.py has the same.
TEST_F(Suns, AnglesThatMayBeRadiansMustSayThatTheyAreDegrees) {
    for (const char* rows : {"1.57,0.2\n3.14,1.05\n-6.2832,-1.5708\n", "4.71,0.001\n", "0,1.6\n6.3,-1\n"}) {
        expect_refused(std::string("azimuth,elevation\n") + rows,
                       "as small as radians, and must be degrees: turn them into degrees, or write \"azimuth [deg]\" "
                       "and \"elevation [deg]\" above them");
        EXPECT_GE(read_suns(file(std::string("azimuth [deg],elevation [deg]\n") + rows), 0).suns.size(), 1u);
    }
    for (const char* rows : {"90,0.5\n", "0,2\n", "0,-1\n", "1,1\n100,-20\n", "0,0\n"})
        EXPECT_NO_THROW(read_suns(file(std::string("azimuth,elevation\n") + rows), 0)) << rows;
}

// tests/python/study/test_sun_tables.py reads the same tables.
TEST(NumberTable, ReadsTablesAsPeopleHaveThem) {
    const auto cases = nlohmann::json::parse(std::ifstream(GNOMON_TESTS "/command/tables_of_points.json"));
    const std::vector<std::string> names{"x", "y", "z"};
    const gnomon::scene::TableColumns columns{{names, {"x", "y", "z", "nx", "ny", "nz"}},
                                              gnomon::scene::point_headings()};
    for (const auto& one : cases["read"]) {
        const gnomon::scene::NumberTable table(one["text"].get<std::string>(), "t.csv", columns);
        ASSERT_EQ(table.rows(), 2u) << one["name"];
        for (std::size_t row = 0; row < 2; ++row)
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_EQ(table.number(row, names[c]), cases["points"][row][c].get<double>()) << one["name"];
                EXPECT_EQ(table.float_number(row, names[c]), cases["points"][row][c].get<float>()) << one["name"];
            }
    }
    for (const auto& one : cases["refused"]) try {
            const gnomon::scene::NumberTable table(one["text"].get<std::string>(), "t.csv", columns);
            table.require(names, "points need the columns x, y, z");
            for (const std::string& name : names) table.numbers(name);
            ADD_FAILURE() << "accepted: " << one["name"];
        } catch (const gnomon::InvalidArgument& error) {
            const std::string why = one["why"];
            EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << one["name"] << ": " << error.what();
            EXPECT_TRUE(std::string(error.what()).starts_with("t.csv")) << error.what();
        }
}

// The text lies a little above the middle of two floats, and its double on it. By way of the double it would be 1.
TEST(NumberTable, AFloatIsRoundedOnce) {
    const std::string text = "1.000000059604644776";  // 1 + 2^-24 + 1e-19, a tie for its double
    const gnomon::scene::NumberTable table(text + "\n", "t.csv", {{{"x"}}});
    EXPECT_EQ(float(table.number(0, "x")), 1.0f);
    EXPECT_EQ(table.float_number(0, "x"), std::nextafter(1.0f, 2.0f));
}

TEST_F(Suns, TablesMayBePacked) {
    const std::string text = "x,y,z,weight\n0,-1,0,2\n";
    const fs::path packed = folder_ / "suns.csv.gz";
    const gzFile out = gzopen(packed.c_str(), "wb");
    gzwrite(out, text.data(), unsigned(text.size()));
    gzclose(out);
    EXPECT_EQ(read_suns(packed, 0).suns.at(0).weight, 2);
    EXPECT_EQ(table_file_text(packed), text);
}

// 144 x 10 minutes are 24 hours: a sixth of an hour is no float, so that its sums would not be.
#ifdef GNOMON_HAS_ERFA
TEST_F(Suns, SumsOfStepsAreExact) {
    const SunTable day = suns_of_place({80, 0, {2026, 6, 21}, 10, 0, false}, 0);
    EXPECT_EQ(day.suns.size(), 144u);
    EXPECT_EQ(day.sum_of_weights(), 24);
    const gnomon::Lights lights = day.lights();
    std::int64_t whole = 0;
    for (const std::int64_t weight : lights.whole_weights()) whole += weight;
    EXPECT_EQ(std::ldexp(double(whole), lights.exponent()) / day.weights_per_unit(), 24);
}
#endif

}  // namespace
