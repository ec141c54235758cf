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
#include "scene/extent.hpp"
#include "scene/number_table.hpp"
#include "setup.hpp"
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
    const bool has_normals = rows.has("nx") && rows.has("ny") && rows.has("nz");
    OwnPoints points;
    for (std::size_t row = 0; row < rows.rows(); ++row) {
        for (std::size_t c = 0; c < (has_normals ? 6u : 3u); ++c)
            (c < 3 ? points.positions : points.normals).push_back(rows.float_number(row, all[c]));
        const double move = extent.visible_move({rows.number(row, "x"), rows.number(row, "y"), rows.number(row, "z")});
        if (move > 0 && points.moved_count++ == 0) points.first_move = move;
    }
    return points;
}

SunTable suns_of(const HoursOptions& options) {
    if (options.place) return suns_of_place(*options.place, options.north_degrees);
    if (options.weather) return suns_of_weather(read_weather(*options.weather), options.north_degrees);
    SunTable table = read_suns(*options.directions, options.north_degrees);
    if (table.suns.empty() && table.below_horizon == 0) throw Error(options.directions->string() + " has no suns");
    return table;
}

/// Float64 values as NumPy's .npy (version 1.0).
void write_npy(OutputFile& file, std::span<const double> values) {
    static_assert(std::endian::native == std::endian::little);
    std::string header = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({},), }}", values.size());
    constexpr std::size_t preamble = 10, aligned = 64;
    header.resize((preamble + header.size() + 1 + aligned - 1) / aligned * aligned - preamble - 1, ' ');
    header += '\n';
    const std::string start =
        std::string("\x93NUMPY\x01\x00", 8) + char(header.size() & 255u) + char(header.size() >> 8);
    file.write_all(start.data(), start.size());
    file.write_all(header.data(), header.size());
    file.write_all(values.data(), values.size_bytes());
}

void write_csv(OutputFile& file, std::span<const float> positions, std::span<const double> values) {
    std::string text = "x,y,z,value\n";
    for (std::size_t i = 0; i < values.size(); ++i)
        text += float3_text({positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}) +
                fmt::format(",{:.17g}\n", values[i]);
    file.write_all(text.data(), text.size());
}

SunSums compute(const HoursOptions& options, Technique& technique, const Triangles& triangles, const Points& points,
                const SunTable& table, cl_mem normals) {
    const ProgressLine progress(grouped(points.count()) + " points x " + grouped(table.suns.size()) + " suns",
                                !options.quiet && !table.suns.empty());
    return sun_sums(options, technique, triangles, points, table,
                    {.facing = normals != nullptr ? Facing::normals(normals) : Facing::automatic()});
}

std::string summary(const HoursOptions& options, const SunTable& table, const SunSums& computed) {
    std::size_t count = 0;
    double sum = 0;
    for (const double value : computed.values)
        if (!std::isnan(value)) ++count, sum += value;
    std::string text =
        fmt::format("{} suns, {:.6g} {}", grouped(table.suns.size()), table.sum_of_weights(), options.unit);
    if (table.below_horizon != 0) text += "; " + grouped(table.below_horizon) + " below the horizon left out";
    if (table.left_out != 0 && options.weather)
        text += fmt::format(" ({:.3g} {})", table.left_out / table.weights_per_unit(), options.unit);
    if (!options.directions)
        text += std::string("; positions by ERFA, elevations ") + (options.place && options.place->is_apparent
                                                                       ? "with refraction (Saemundsson, 1010 hPa, 10 C)"
                                                                       : "without refraction");
    if (options.weather) text += "\n" + table.facts + "; a sun in the middle of each hour; direct irradiation alone";
    return text + fmt::format("\n{} points: on average {:.6g} {}, at most {:.6g}; {:.0f} ms\n", grouped(count),
                              count != 0 ? sum / double(count) : 0, options.unit, largest_of(computed.values),
                              computed.statistics.total_wall_ms);
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

SunSums hours_of_points(const HoursOptions& options, const Device& device, Technique& technique,
                        const scene::Scene& scene, const Triangles& triangles, const SunTable& table,
                        Outputs& outputs) {
    const OwnPoints own = read_points(*options.points, scene::Extent(scene));
    if (own.moved_count > 0)
        warn_or_refuse(options, fmt::format("{}: float32 moves {} {} far from the origin, the first by {:.2g} (move "
                                            "scene and points there, or take Python, which keeps doubles)",
                                            options.points->string(), grouped(own.moved_count),
                                            own.moved_count == 1 ? "point" : "points", own.first_move));
    const Points points = Points::upload(device, own.positions), normals = Points::upload(device, own.normals);
    if (options.cosines && own.normals.empty())
        throw Error(options.points->string() + (options.weather ? ": --epw" : ": --cosines") +
                    " needs the columns nx, ny, nz");
    const cl_mem sides = own.normals.empty() ? nullptr : normals.positions();
    SunSums computed = compute(options, technique, triangles, points, table, sides);
    if (lower_extension(*options.result) == ".npy")
        write_npy(*outputs.result, computed.values);
    else
        write_csv(*outputs.result, own.positions, computed.values);
    return computed;
}

SunSums hours_of_picture(const HoursOptions& options, const Device& device, Technique& technique,
                         const scene::Scene& scene, const Triangles& triangles, const SunTable& table,
                         Outputs& outputs) {
    const auto [width, height] = options.size;
    const View seen = look(device, triangles, choose_camera(options, scene).camera, width, height);
    const ViewOnHost view = seen.read(device, triangles);
    Points points = seen.points;
    Points normals;
    if (options.cosines) {
        // The normals show the side that the eye sees, and decide facing as the eye would.
        normals = Points::upload(device, view.normal);
        points = Points::wrap(device, seen.points.positions(), seen.points.layout(), seen.points.count(),
                              seen.points.receivers());
    }
    SunSums computed =
        compute(options, technique, triangles, points, table, options.cosines ? normals.positions() : nullptr);
    leave_sky_out(view.receiver, computed.values);
    if (outputs.result) {
        const ColorScale scale = scale_of(options, computed.values);
        std::vector<std::uint8_t> rgba = colored(scale, computed.values);
        draw_legend(scale, width, height, rgba);
        write_picture(*outputs.result, width, height, rgba);
    }
    if (outputs.aov) {
        std::vector<float> values(computed.values.begin(), computed.values.end());
        for (float& value : values)
            if (std::isnan(value)) value = 0;
        write_aov(*outputs.aov, width, height, view, values, "value");
    }
    return computed;
}

}  // namespace

void hours(const HoursOptions& options) {
    Outputs outputs(options);
    const SunTable table = suns_of(options);
    if (outputs.suns) {
        const std::string text = table_text(table);
        outputs.suns->write_all(text.data(), text.size());
    }
    const Device device = open_device(options, false);
    const auto technique = make_technique(device, "frustum-traced", options.settings);
    const scene::Scene scene = load_scene(options);
    const Triangles triangles = upload_triangles(device, scene);
    const SunSums computed = options.points
                                 ? hours_of_points(options, device, *technique, scene, triangles, table, outputs)
                                 : hours_of_picture(options, device, *technique, scene, triangles, table, outputs);
    outputs.files.commit();
    if (!options.quiet) print_result(summary(options, table, computed));
}

}  // namespace gnomon::app
