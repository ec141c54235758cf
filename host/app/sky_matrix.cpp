// SPDX-License-Identifier: MIT
#include "sky_matrix.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "output_files.hpp"

extern char** environ;

namespace gnomon::app {
namespace {

namespace fs = std::filesystem;

constexpr double pi = std::numbers::pi;
/// Tregenza's sky: the patches of each of its rows, from the horizon up. A row is 12 degrees high, the last one patch.
constexpr std::array<std::size_t, 8> patches_of_rows{30, 30, 24, 24, 18, 12, 6, 1};
constexpr std::size_t patch_count = 145, parts_on_a_side = 2, parts_around_zenith = 6;
/// gendaymtx' matrix: a row for the ground, then one a patch; three equal colours an hour.
constexpr std::size_t matrix_rows = patch_count + 1, colors = 3;

/// A part of a patch. A plane in front of it gets its radiance times the part's length times the cosine to its middle.
struct Part {
    std::size_t patch;
    double azimuth, elevation, length;  ///< of the integral of the unit vectors to it, radians
};

/// The parts, in the order of gendaymtx' patches: row by row from the horizon, clockwise from north.
std::vector<Part> parts_of_sky() {
    std::vector<Part> parts;
    std::size_t first = 0;
    for (std::size_t row = 0; row < patches_of_rows.size(); ++row) {
        const std::size_t count = patches_of_rows[row];
        const bool is_zenith = count == 1;
        const std::size_t around = is_zenith ? parts_around_zenith : count * parts_on_a_side;
        const double low = double(row) * 12, height = std::min(12.0, 90 - low) / parts_on_a_side;
        for (std::size_t ring = 0; ring < parts_on_a_side; ++ring) {
            const double from = (low + double(ring) * height) * pi / 180, to = from + height * pi / 180;
            const double upwards = pi / double(around) * (std::pow(std::sin(to), 2) - std::pow(std::sin(from), 2));
            const double outwards =
                ((to - from) / 2 + (std::sin(2 * to) - std::sin(2 * from)) / 4) * 2 * std::sin(pi / double(around));
            for (std::size_t k = 0; k < around; ++k) {
                const double turn = (double(k) + 0.5) / double(around) - (is_zenith ? 0 : 0.5 / double(count));
                parts.push_back({first + k * count / around, 2 * pi * turn, std::atan2(upwards, outwards),
                                 std::hypot(upwards, outwards)});
            }
        }
        first += count;
    }
    return parts;
}

/// A temporary folder for the program's files, removed at the end.
struct Folder {
    Folder() {
        std::string name = (temporary_folder() / "gnomon-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw Error("cannot make a folder in " + name);
        path = name;
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    fs::path path;
};

/// The weather in the form that gendaymtx reads: west and west of Greenwich are positive.
std::string wea_of(const WeatherFile& weather) {
    std::string text = fmt::format(
        "place gnomon\nlatitude {}\nlongitude {}\ntime_zone {}\nsite_elevation {}\nweather_data_file_units 1\n",
        weather.latitude_degrees, -weather.longitude_degrees, -15 * weather.utc_offset_hours, weather.elevation_metres);
    for (const WeatherHour& hour : weather.hours)
        text += fmt::format("{} {} {:.6f} {:.9g} {:.9g}\n", hour.day.month, hour.day.day, hour.begins + 0.5,
                            hour.direct_normal, hour.diffuse_horizontal);
    return text;
}

/// Runs gendaymtx, files in place of its streams. Returns its exit code.
int run_gendaymtx(const fs::path& in, const fs::path& out, const fs::path& errors) {
    // The sky alone, total solar radiance, white, black ground, floats without a header.
    std::array<const char*, 16> words{"gendaymtx", "-h", "-m", "1",  "-s", "-O1", "-of", "-c",
                                      "1",         "1",  "1",  "-g", "0",  "0",   "0",   nullptr};
    posix_spawn_file_actions_t streams;
    posix_spawn_file_actions_init(&streams);
    posix_spawn_file_actions_addopen(&streams, STDIN_FILENO, in.c_str(), O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&streams, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addopen(&streams, STDERR_FILENO, errors.c_str(), O_WRONLY | O_CREAT, 0600);
    pid_t child = 0;
    const int failed =
        posix_spawnp(&child, words[0], &streams, nullptr, const_cast<char* const*>(words.data()), environ);
    posix_spawn_file_actions_destroy(&streams);
    if (failed == ENOENT || failed == EACCES)
        throw Error(
            "--diffuse needs Radiance's program gendaymtx, which is not on the PATH: pip install pyradiance, then put "
            "the folder bin of that package on the PATH");
    if (failed != 0) throw Error(std::string("cannot run gendaymtx: ") + std::strerror(failed));
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) throw Error(std::string("cannot wait for gendaymtx: ") + std::strerror(errno));
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string text_of(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

/// W/(m2 sr) by row of gendaymtx' matrix and hour.
std::vector<float> sky_matrix(const WeatherFile& weather) {
    static_assert(std::endian::native == std::endian::little);
    const Folder folder;
    const fs::path in = folder.path / "hours.wea", out = folder.path / "sky.mtx", errors = folder.path / "errors";
    std::ofstream(in, std::ios::binary) << wea_of(weather);
    const int code = run_gendaymtx(in, out, errors);
    const std::string bytes = text_of(out), said = text_of(errors);
    const std::size_t hours = weather.hours.size(), values = matrix_rows * hours * colors;
    if (code != 0 || bytes.size() != values * sizeof(float))
        throw Error(fmt::format("gendaymtx ended with code {} and {} of {} bytes: {}", code, bytes.size(),
                                values * sizeof(float), said.substr(0, said.find('\n'))));
    std::vector<float> radiance(matrix_rows * hours);
    for (std::size_t i = 0; i < radiance.size(); ++i)
        std::memcpy(&radiance[i], bytes.data() + i * colors * sizeof(float), sizeof(float));
    return radiance;
}

}  // namespace

SunTable sky_of_weather(const WeatherFile& weather, double north_degrees) {
    const std::vector<Part> parts = parts_of_sky();
    const std::vector<float> radiance = sky_matrix(weather);
    std::array<double, patch_count> horizontal{}, energy{};
    for (const Part& part : parts) horizontal[part.patch] += part.length * std::sin(part.elevation);
    const std::size_t hours = weather.hours.size();
    for (std::size_t hour = 0; hour < hours; ++hour) {
        const auto of_patch = [&](std::size_t patch) { return double(radiance[(patch + 1) * hours + hour]); };
        // gendaymtx takes the cosines of the patches' centres; with their integrals level ground gets what the file
        // says.
        double level = 0;
        for (std::size_t patch = 0; patch < patch_count; ++patch) level += horizontal[patch] * of_patch(patch);
        if (!(level > 0)) continue;
        for (std::size_t patch = 0; patch < patch_count; ++patch)
            energy[patch] += of_patch(patch) * weather.hours[hour].diffuse_horizontal / level;
    }
    SunTable table;
    table.is_irradiation = true;
    for (const Part& part : parts) {
        const double azimuth = part.azimuth * 180 / pi, elevation = part.elevation * 180 / pi;
        table.suns.push_back({"", azimuth, elevation, travel_direction(azimuth, elevation, north_degrees),
                              float(energy[part.patch] * part.length)});
    }
    return table;
}

}  // namespace gnomon::app
