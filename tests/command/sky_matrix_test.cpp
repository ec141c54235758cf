// SPDX-License-Identifier: MIT
// The sky's light on the command line: matrices that a program in the place of gendaymtx writes, whose answers are
// known, and the program itself where it is on the PATH.
#include "app/sky_matrix.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

#include "support/environment.hpp"
#include "support/temporary_folder.hpp"

namespace {

using namespace gnomon::app;
namespace fs = std::filesystem;

constexpr double radians = std::numbers::pi / 180;
constexpr std::size_t patches = 145;

/// Two hours of one day with 100 and 300 W/m2 of diffuse light.
WeatherFile two_hours() {
    WeatherFile weather;
    weather.latitude_degrees = 48;
    weather.longitude_degrees = 15;
    weather.utc_offset_hours = 1;
    weather.hours = {{{2026, 6, 21}, 11, 0, 100}, {{2026, 6, 21}, 12, 500, 300}};
    return weather;
}

/// Puts a program `gendaymtx` first on the PATH, and takes it away at the end.
class SkyMatrix : public testing::Test {
protected:
    SkyMatrix() : path_(std::getenv("PATH")) {}
    ~SkyMatrix() override { setenv("PATH", path_.c_str(), 1); }

    void use_program(const std::string& script) {
        std::ofstream(folder_.path() / "gendaymtx") << "#!/bin/sh\n" << script;
        fs::permissions(folder_.path() / "gendaymtx", fs::perms::owner_all);
        setenv("PATH", (folder_.path().string() + ":" + path_).c_str(), 1);
    }
    /// A program that writes a matrix of two hours; both have the same radiance.
    void use_matrix(const std::vector<float>& radiance_of_rows) {
        std::ofstream matrix(folder_.path() / "made.mtx", std::ios::binary);
        for (const float radiance : radiance_of_rows)
            for (int i = 0; i < 2 * 3; ++i) matrix.write(reinterpret_cast<const char*>(&radiance), sizeof radiance);
        use_program("cat > '" + (folder_.path() / "read.wea").string() + "'\ncat '" +
                    (folder_.path() / "made.mtx").string() + "'\n");
    }
    std::string wea() const {
        std::ifstream file(folder_.path() / "read.wea");
        return {std::istreambuf_iterator<char>(file), {}};
    }
    void expect_refused(const std::string& sentence) const {
        try {
            sky_of_weather(two_hours(), 0);
            ADD_FAILURE() << "accepted, in place of: " << sentence;
        } catch (const gnomon::Error& error) {
            EXPECT_NE(std::string(error.what()).find(sentence), std::string::npos) << error.what();
        }
    }

    const support::TemporaryFolder folder_;
    const std::string path_;
};

/// Wh/m2 of an open plane whose front has this normal (y up, -z north).
double energy_on(const SunTable& sky, const std::array<double, 3>& normal) {
    double sum = 0;
    for (const Sun& part : sky.suns) {
        double cosine = 0;
        for (std::size_t c = 0; c < 3; ++c) cosine -= double(part.direction[c]) * normal[c];
        sum += double(part.weight) * std::max(cosine, 0.0);
    }
    return sum;
}

// An even sky: level ground has the file's diffuse light, a wall half of it, and a plane tilted by t (1 + cos t) / 2.
TEST_F(SkyMatrix, AnEvenSkyGivesClosedForms) {
    use_matrix(std::vector<float>(patches + 1, 7));
    const SunTable sky = sky_of_weather(two_hours(), 0);
    EXPECT_EQ(sky.suns.size(), 4 * 144 + 12u);
    for (const double tilt : {0.0, 30.0, 60.0, 90.0})
        for (const double azimuth : {0.0, 77.0, 180.0, 290.0}) {
            const double level = std::sin(tilt * radians);
            const double expected = 400 * (1 + std::cos(tilt * radians)) / 2;
            EXPECT_NEAR(energy_on(sky, {level * std::sin(azimuth * radians), std::cos(tilt * radians),
                                        -level * std::cos(azimuth * radians)}),
                        expected, 0.005 * expected)
                << tilt << ' ' << azimuth;
        }
    EXPECT_NEAR(energy_on(sky, {0, 1, 0}), 400, 1e-3);
    const std::string read = wea();
    EXPECT_NE(read.find("latitude 48\nlongitude -15\ntime_zone -15\n"), std::string::npos) << read;
    EXPECT_NE(read.find("\n6 21 11.500000 0 100\n6 21 12.500000 500 300\n"), std::string::npos) << read;
}

// One patch: all light comes from its 12 by 12 degrees. Patch 1 + 7 stands 84 degrees from north in the lowest row;
// Reinhart's order goes clockwise from north.
TEST_F(SkyMatrix, OnePatchShinesFromItsPlace) {
    std::vector<float> rows(patches + 1);
    rows[1 + 7] = 3;
    use_matrix(rows);
    for (const double north : {0.0, 40.0}) {
        std::size_t parts = 0;
        for (const Sun& part : sky_of_weather(two_hours(), north).suns) {
            if (part.weight == 0) continue;
            ++parts;
            EXPECT_NEAR(*part.azimuth_degrees, 84, 6);
            EXPECT_NEAR(*part.elevation_degrees, 6, 6);
            EXPECT_NEAR(std::atan2(-part.direction[0], part.direction[2]) / radians, *part.azimuth_degrees + north,
                        1e-4);
        }
        EXPECT_EQ(parts, 4u);
    }
    // A patch at the zenith, and one in the fourth row (30 + 30 + 24 before it), to the west.
    rows.assign(patches + 1, 0);
    rows[1 + 84 + 18] = 3;
    use_matrix(rows);
    const SunTable west = sky_of_weather(two_hours(), 0);
    EXPECT_NEAR(energy_on(west, {0, 1, 0}), 400, 1e-3);
    EXPECT_NEAR(energy_on(west, {-1, 0, 0}), 400 / std::tan(42 * radians), 4) << "the row of 36 to 48 degrees";
    EXPECT_EQ(energy_on(west, {1, 0, 0}), 0);
    rows.assign(patches + 1, 0);
    rows[patches] = 3;
    use_matrix(rows);
    EXPECT_GT(energy_on(sky_of_weather(two_hours(), 0), {0, 1, 0}), 399);
}

// Light from the ground, row 0 of the matrix, is not the sky's; an hour without light adds nothing.
TEST_F(SkyMatrix, GroundAndNightGiveNothing) {
    std::vector<float> rows(patches + 1);
    rows[0] = 9;
    use_matrix(rows);
    EXPECT_EQ(energy_on(sky_of_weather(two_hours(), 0), {0, 1, 0}), 0);
}

TEST_F(SkyMatrix, AnotherFolderServesWhereThatOfTmpdirIsMissing) {
    std::vector<float> rows(patches + 1, 1.0f);
    use_matrix(rows);
    const double energy = energy_on(sky_of_weather(two_hours(), 0), {0, 1, 0});
    const support::Environment missing("TMPDIR", "/proc/none");
    EXPECT_EQ(energy_on(sky_of_weather(two_hours(), 0), {0, 1, 0}), energy);
}

TEST_F(SkyMatrix, BrokenProgramsAreOneSentence) {
    use_program("echo 'gendaymtx: no hours' >&2\nexit 1\n");
    expect_refused("gendaymtx ended with code 1 and 0 of 3504 bytes: gendaymtx: no hours");
    use_program("cat > /dev/null\necho short\n");
    expect_refused("gendaymtx ended with code 0 and 6 of 3504 bytes");
    setenv("PATH", "/nowhere", 1);
    expect_refused("--diffuse needs Radiance's program gendaymtx, which is not on the PATH: pip install pyradiance");
}

}  // namespace
