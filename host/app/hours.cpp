// SPDX-License-Identifier: MIT
// gnomon hours: how many hours, or how much of any weight, of a table of suns reaches each pixel or point.
#include <fmt/core.h>
#include <algorithm>
#include <bit>
#include <cmath>

#include "options.hpp"
#include "output_files.hpp"
#include "picture.hpp"
#include "pictures.hpp"
#include "report.hpp"
#include "scene/extent.hpp"
#include "scene/number_table.hpp"
#include "setup.hpp"
#include "sky_matrix.hpp"
#include "sun_sums.hpp"
#include "terminal.hpp"
#include "values.hpp"
#include "weather_file.hpp"

namespace gnomon::app {
namespace {

struct OwnPoints {
    std::vector<float> positions, normals;  ///< 3 each; normals may be empty
    std::size_t moved_count = 0;            ///< points that float32 moves visibly
    double first_move = 0;                  ///< of the first of them
};

OwnPoints read_points(const std::filesystem::path& file, const scene::Extent& extent) {
    const std::vector<std::string> positions{"x", "y", "z"}, all{"x", "y", "z", "nx", "ny", "nz"};
    const scene::NumberTable rows(table_file_text(file), file.string(), {{positions, all}, scene::point_headings()});
    rows.require(positions, "points need the columns x, y, z, and nx, ny, nz for the side that they face");
    if (rows.rows() == 0) throw Error(file.string() + " has no points");
    rows.require_places(positions);
    rows.require_all_or_none({"nx", "ny", "nz"});
    const bool has_normals = rows.has("nx");
    OwnPoints points;
    for (std::size_t row = 0; row < rows.rows(); ++row) {
        for (std::size_t c = 0; c < (has_normals ? 6u : 3u); ++c)
            (c < 3 ? points.positions : points.normals).push_back(rows.float_number(row, all[c]));
        const double move = extent.visible_move({rows.number(row, "x"), rows.number(row, "y"), rows.number(row, "z")});
        if (move > 0 && points.moved_count++ == 0) points.first_move = move;
    }
    return points;
}

/// Makes normals as long as 1, which their cosines need. Those that float32 cannot bring nearer to it stay.
void make_unit(std::vector<float>& normals) {
    constexpr double rounding = 0x1p-21;  // of a square of three float32 values
    for (std::size_t i = 0; i + 3 <= normals.size(); i += 3) {
        const double x = normals[i], y = normals[i + 1], z = normals[i + 2];
        const double length = std::hypot(x, y, z);
        if (length == 0 || std::abs(length * length - 1) <= rounding) continue;
        for (std::size_t c = 0; c < 3; ++c) normals[i + c] = float(double(normals[i + c]) / length);
    }
}

/// The suns of a run, and the parts of the sky with --diffuse.
struct Lighting {
    SunTable suns;
    std::optional<SunTable> sky{};
};

Lighting lighting_of(const HoursOptions& options) {
    if (options.place) return {suns_of_place(*options.place, options.north_degrees)};
    if (options.weather) {
        const WeatherFile weather = read_weather(*options.weather, options.diffuse);
        Lighting lighting{suns_of_weather(weather, options.north_degrees)};
        if (options.diffuse) lighting.sky = sky_of_weather(weather, options.north_degrees);
        return lighting;
    }
    SunTable table = read_suns(*options.directions, options.north_degrees);
    if (table.suns.empty() && table.below_horizon == 0) throw Error(options.directions->string() + " has no suns");
    if (!table.note.empty()) warn_or_refuse(options, table.note);
    return {std::move(table)};
}

/// What of the lighting reaches points: its sum; with a sky the parts of the sum, else nothing.
struct Reached {
    SunSums sums;
    std::vector<double> direct{}, diffuse{};
};

/// Float64 values as NumPy's .npy (version 1.0): a column, or the sum and its two parts.
void write_npy(OutputFile& file, const Reached& reached) {
    static_assert(std::endian::native == std::endian::little);
    const std::size_t count = reached.sums.values.size();
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) {
        values.push_back(reached.sums.values[i]);
        if (!reached.direct.empty()) values.insert(values.end(), {reached.direct[i], reached.diffuse[i]});
    }
    const std::string shape = reached.direct.empty() ? fmt::format("({},)", count) : fmt::format("({}, 3)", count);
    std::string header = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': {}, }}", shape);
    constexpr std::size_t preamble = 10, aligned = 64;
    header.resize((preamble + header.size() + 1 + aligned - 1) / aligned * aligned - preamble - 1, ' ');
    header += '\n';
    const std::string start =
        std::string("\x93NUMPY\x01\x00", 8) + char(header.size() & 255u) + char(header.size() >> 8);
    file.write_all(start.data(), start.size());
    file.write_all(header.data(), header.size());
    file.write_all(values.data(), values.size() * sizeof(double));
}

void write_csv(OutputFile& file, std::span<const float> positions, const Reached& reached) {
    const bool has_parts = !reached.direct.empty();
    std::string text = has_parts ? "x,y,z,value,direct,diffuse\n" : "x,y,z,value\n";
    for (std::size_t i = 0; i < reached.sums.values.size(); ++i) {
        text += float3_text({positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}) +
                fmt::format(",{:.17g}", reached.sums.values[i]);
        if (has_parts) text += fmt::format(",{:.17g},{:.17g}", reached.direct[i], reached.diffuse[i]);
        text += '\n';
    }
    file.write_all(text.data(), text.size());
}

Reached compute(const HoursOptions& options, Technique& technique, const Triangles& triangles, const Points& points,
                const Lighting& lighting, cl_mem normals) {
    const std::size_t lights = lighting.suns.suns.size() + (lighting.sky ? lighting.sky->suns.size() : 0);
    const ProgressLine progress(grouped(points.count()) + " points x " + grouped(lights) + " suns",
                                !options.quiet && lights != 0);
    const RunOptions run{.facing = normals != nullptr ? Facing::normals(normals) : Facing::automatic()};
    Reached reached{sun_sums(options, technique, triangles, points, lighting.suns, run)};
    if (!lighting.sky) return reached;
    SunSums of_sky = sun_sums(options, technique, triangles, points, *lighting.sky, run);
    reached.direct = reached.sums.values;
    reached.diffuse = std::move(of_sky.values);
    for (std::size_t i = 0; i < reached.direct.size(); ++i) reached.sums.values[i] += reached.diffuse[i];
    reached.sums.statistics.total_wall_ms += of_sky.statistics.total_wall_ms;
    return reached;
}

/// The mean of the values that are no sky, and their number.
std::pair<double, std::size_t> mean_of(std::span<const double> values) {
    std::size_t count = 0;
    double sum = 0;
    for (const double value : values)
        if (!std::isnan(value)) ++count, sum += value;
    return {count != 0 ? sum / double(count) : 0, count};
}

std::string summary(const HoursOptions& options, const scene::Scene& scene, const Lighting& lighting,
                    const Reached& reached) {
    const SunTable& table = lighting.suns;
    const auto [mean, count] = mean_of(reached.sums.values);
    std::string text =
        fmt::format("{} suns, {:.6g} {}", grouped(table.suns.size()), table.sum_of_weights(), options.unit);
    if (table.below_horizon != 0) text += "; " + grouped(table.below_horizon) + " below the horizon left out";
    if (table.left_out != 0 && options.weather)
        text += fmt::format(" ({:.3g} {})", table.left_out / table.weights_per_unit(), options.unit);
    const auto negative = std::ranges::count_if(table.suns, [](const Sun& sun) { return sun.weight < 0; });
    if (negative != 0)
        text += fmt::format("; {} of a weight below 0, which lower sums", grouped(std::uint64_t(negative)));
    if (!options.directions)
        text += std::string("; positions by ERFA, elevations ") + (options.place && options.place->is_apparent
                                                                       ? "with refraction (Saemundsson, 1010 hPa, 10 C)"
                                                                       : "without refraction");
    if (options.weather) text += "\n" + table.facts + "; a sun in the middle of each hour; direct irradiation";
    if (options.weather) text += lighting.sky ? " and Perez' sky by gendaymtx" : " alone";
    text += fmt::format("\n{} points: on average {:.6g} {}, at most {:.6g}", grouped(count), mean, options.unit,
                        largest_of(reached.sums.values));
    if (lighting.sky)
        text += fmt::format("; direct {:.6g}, diffuse {:.6g}", mean_of(reached.direct).first,
                            mean_of(reached.diffuse).first);
    text += fmt::format("; {:.0f} ms\n", reached.sums.statistics.total_wall_ms);
    const auto has_sum = [](double value) { return value < 0 || value > 0; };  // the sky has none
    if (count != 0 && !table.suns.empty() && std::ranges::none_of(reached.sums.values, has_sum))
        text += "hint: no sun reaches any point: a closed room or sky keeps them out, and y points up in the scene\n";
    if (count != 0) return text;
    bool has_any = false;
    for (std::size_t i = 0; i < scene.triangle_count() && !has_any; ++i) has_any = scene.is_finite(i);
    return text + "hint: " + hint_of_empty(has_any) + "\n";
}

/// The outputs of a run. All are opened before the long work.
struct Outputs {
    explicit Outputs(const HoursOptions& options) {
        for (const auto* input : {&options.scene, &options.directions, &options.weather, &options.points})
            if (*input) files.protect(**input);
        if (options.aov) require_openimageio();
        const auto open = [&](const auto& path) { return path ? &files.open(*path) : nullptr; };
        result = open(options.result);
        aov = open(options.aov);
        suns = open(options.written_directions);
    }
    OutputFiles files;
    OutputFile *result, *aov, *suns;
};

Reached hours_of_points(const HoursOptions& options, const Device& device, Technique& technique,
                        const scene::Scene& scene, const Triangles& triangles, const Lighting& lighting,
                        Outputs& outputs) {
    OwnPoints own = read_points(*options.points, scene::Extent(scene));
    if (own.moved_count > 0)
        warn_or_refuse(options, fmt::format("{}: float32 moves {} {} far from the origin, the first by {:.2g} (move "
                                            "scene and points there, or take Python, which keeps doubles)",
                                            options.points->string(), grouped(own.moved_count),
                                            own.moved_count == 1 ? "point" : "points", own.first_move));
    if (options.cosines) make_unit(own.normals);
    const Points points = Points::upload(device, own.positions), normals = Points::upload(device, own.normals);
    if (options.cosines && own.normals.empty())
        throw Error(options.points->string() + (options.weather ? ": --epw" : ": --cosines") +
                    " needs the columns nx, ny, nz");
    const cl_mem sides = own.normals.empty() ? nullptr : normals.positions();
    Reached reached = compute(options, technique, triangles, points, lighting, sides);
    if (lower_extension(*options.result) == ".npy")
        write_npy(*outputs.result, reached);
    else
        write_csv(*outputs.result, own.positions, reached);
    return reached;
}

Reached hours_of_picture(const HoursOptions& options, const Device& device, Technique& technique,
                         const scene::Scene& scene, const Triangles& triangles, const Lighting& lighting,
                         Outputs& outputs) {
    const auto [width, height] = options.size;
    const ChosenCamera camera = choose_camera(options, scene);
    print_camera_note(options, scene, camera);
    const View seen = look(device, triangles, camera.camera, width, height);
    const ViewOnHost view = seen.read(device, triangles);
    Points points = seen.points;
    Points normals;
    if (options.cosines) {
        // The normals show the side that the eye sees, and decide facing as the eye would.
        normals = Points::upload(device, view.normal);
        points = Points::wrap(device, seen.points.positions(), seen.points.layout(), seen.points.count(),
                              seen.points.receivers());
    }
    Reached reached =
        compute(options, technique, triangles, points, lighting, options.cosines ? normals.positions() : nullptr);
    for (auto* const values : {&reached.sums.values, &reached.direct, &reached.diffuse})
        if (!values->empty()) leave_sky_out(view.receiver, *values);
    if (outputs.result) {
        const ColorScale scale = scale_of(options, reached.sums.values);
        std::vector<std::uint8_t> rgba = colored(scale, reached.sums.values);
        draw_legend(scale, width, height, rgba);
        write_picture(*outputs.result, width, height, rgba);
    }
    if (outputs.aov) {
        std::vector<float> values(reached.sums.values.begin(), reached.sums.values.end());
        for (float& value : values)
            if (std::isnan(value)) value = 0;
        write_aov(*outputs.aov, width, height, view, values, "value");
    }
    return reached;
}

}  // namespace

void hours(const HoursOptions& options) {
    Outputs outputs(options);
    const Lighting lighting = lighting_of(options);
    if (outputs.suns) {
        const std::string text = table_text(lighting.suns);
        outputs.suns->write_all(text.data(), text.size());
    }
    const Device device = open_device(options, false);
    const auto technique = make_technique(device, "frustum-traced", options.settings);
    const scene::Scene scene = load_scene(options);
    const Triangles triangles = upload_triangles(device, scene);
    const Reached reached = options.points
                                ? hours_of_points(options, device, *technique, scene, triangles, lighting, outputs)
                                : hours_of_picture(options, device, *technique, scene, triangles, lighting, outputs);
    outputs.files.commit();
    if (!options.quiet) print_result(summary(options, scene, lighting, reached));
}

}  // namespace gnomon::app
