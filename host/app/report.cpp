// SPDX-License-Identifier: MIT
// stats.json and the terminal's table. A float32 becomes a JSON number through double, which holds it exactly.
#include "report.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <numbers>
#include <utility>

#include "terminal.hpp"

namespace gnomon::app {
namespace {

using nlohmann::ordered_json;

template <typename Pairs>
ordered_json object_of(const Pairs& pairs) {
    ordered_json object = ordered_json::object();
    for (const auto& [key, value] : pairs) object[key] = value;
    return object;
}

/// Times only where they were measured to the stage's end.
ordered_json stages_json(const Statistics& statistics, bool profiled) {
    ordered_json stages = ordered_json::array();
    for (const StageStatistics& stage : statistics.stages) {
        stages.push_back({{"name", stage.name}, {"skipped", stage.skipped}});
        if (profiled) stages.back().update({{"device_ms", stage.device_ms}, {"wall_ms", stage.wall_ms}});
    }
    return stages;
}

ordered_json statistics_part_json(const Statistics& statistics, bool profiled) {
    return {{"device_memory_bytes", statistics.device_memory_bytes},
            {"stages", stages_json(statistics, profiled)},
            {"counts", object_of(statistics.counts)}};
}

ordered_json camera_json(const ChosenCamera& chosen) {
    const Camera& camera = chosen.camera;
    return {{"source", chosen.source},
            {"eye", camera.eye},
            {"right", camera.right},
            {"up", camera.up},
            {"forward", camera.forward},
            {"fov_y_radians", camera.fov_y_radians},
            {"fov_y_degrees", camera.fov_y_radians * 180 / std::numbers::pi}};
}

ordered_json light_json(const ChosenLight& chosen) {
    const Light& light = chosen.light;
    ordered_json result{{"source", chosen.source}, {"option", light_option(chosen)}};
    if (const auto& area = chosen.area)
        result.update({{"type", "area"},
                       {"corner", area->corner},
                       {"edge_a", area->edge_a},
                       {"edge_b", area->edge_b},
                       {"radiance_w_per_m2_sr", 1}});
    else if (light.is_directional())
        result.update({{"type", "directional"}, {"direction", direction_of(light)}});
    else
        result.update({{"type", "positional"}, {"position", position_of(light)}});
    return result;
}

/// The report of one light.
ordered_json light_part_json(const LightReport& light, bool profiled) {
    return {{"light", light_json(light.chosen)},
            {"shadow_stages", statistics_part_json(light.statistics, profiled)},
            {"pixels",
             {{"lit", light.shares.lit}, {"in_shadow", light.shares.in_shadow}, {"partly", light.shares.partly}}}};
}

std::string scene_name(const RenderOptions& options) {
    return options.scene ? options.scene->string() : std::string("the built-in sundial");
}

ordered_json image_json(const RenderOptions& options) {
    ordered_json json{{"width", options.size.width}, {"height", options.size.height}, {"samples", options.samples}};
    if (options.sun_angle_degrees) json["sun_angle_degrees"] = *options.sun_angle_degrees;
    if (options.sun_angle_degrees) json["sun_samples"] = options.sun_samples.value_or(default_sun_samples);
    if (options.area_light) json["area_samples"] = options.area_samples.value_or(default_area_samples);
    return json;
}

ordered_json animation_json(const Report& report) {
    if (report.animations.shown.empty()) return nullptr;
    return {{"name", report.animations.shown}, {"time_s", report.options.time_s.value_or(0)}};
}

/// ", Walk at 0.5 s", or which animations there are.
std::string pose_text(const Report& report) {
    const auto& [all, shown] = report.animations;
    if (!shown.empty()) return fmt::format(", animation \"{}\" at {:g} s", shown, report.options.time_s.value_or(0));
    if (all.empty()) return "";
    std::string names;
    for (std::size_t i = 0; i < all.size() && i < 8; ++i) names += (i == 0 ? "" : ", ") + all[i];
    return ", at rest (--time shows: " + names + (all.size() > 8 ? ", ..." : "") + ")";
}

/// A line "label   text".
std::string fact(const char* label, const std::string& text) { return fmt::format("{:<9}{}\n", label, text); }

/// "  name   device ms   wall ms" for each stage of a part, under its heading.
std::string stages_text(const char* part, const Statistics& statistics) {
    std::string text = fmt::format("{:<30}{:>12}{:>12}\n", part, "device ms", "wall ms");
    for (const auto& [name, device_ms, wall_ms, skipped] : statistics.stages) {
        text += fmt::format("  {:<28}", name);
        text +=
            skipped.empty() ? fmt::format("{:12.2f}{:12.2f}\n", device_ms, wall_ms) : "  skipped: " + skipped + '\n';
    }
    return text;
}

/// The number of programs, and how many came from the cache.
std::string builds_text(const KernelBuilds& kernels) {
    const std::string programs = fmt::format("{} program{}", kernels.programs, kernels.programs == 1 ? "" : "s");
    if (kernels.from_cache == 0) return programs + " compiled, unless the driver's own cache had them";
    if (kernels.from_cache == kernels.programs) return programs + " from the cache";
    return fmt::format("{}, {} of them from the cache, the others compiled", programs, kernels.from_cache);
}

/// A line of the table of times.
std::string step_text(std::string name, double ms, const std::string& note) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return fmt::format("  {:<28}{:12.2f}{}\n", name, ms, note);
}

/// The steps, each to its end, and their sum.
std::string steps_text(const Report& report) {
    std::string text = fmt::format("{:<30}{:>12}\n", "time", "ms");
    for (const auto& [name, ms] : report.phases_ms)
        text += step_text(name, ms, name == "kernels" ? "  " + builds_text(report.kernels) : "");
    return text + step_text("total", report.total_ms, "");
}

/// All counts but zeros, as running text in lines that fit a terminal.
std::string counts_text(const Statistics& statistics) {
    constexpr std::size_t line_length = 100;
    std::string text, line;
    for (const auto& [name, count] : statistics.counts) {
        if (count == 0) continue;
        std::string item = name + " " + grouped(count);
        std::replace(item.begin(), item.end(), '_', ' ');
        if (!line.empty() && line.size() + item.size() > line_length) text += "  " + std::exchange(line, {}) + '\n';
        line += (line.empty() ? "" : " | ") + item;
    }
    return line.empty() ? text : text + "  " + line + '\n';
}

std::string shares_text(const Shares& shares) {
    const double all = double(std::max<std::uint64_t>(1, shares.lit + shares.in_shadow + shares.partly));
    std::string text = fmt::format("{:.1f} % of the pixels lit (or sky), {:.1f} % in shadow",
                                   100.0 * double(shares.lit) / all, 100.0 * double(shares.in_shadow) / all);
    if (shares.partly > 0) text += fmt::format(", {:.1f} % partly", 100.0 * double(shares.partly) / all);
    return text;
}

/// What to try where a picture may not be what was meant.
std::string hints(const Report& report) {
    std::string text;
    if (report.unused_lights != 0)
        text += fact("hint", fmt::format("{} other light{} of the scene {} unused: --light NAME, --light all",
                                         report.unused_lights, report.unused_lights == 1 ? "" : "s",
                                         report.unused_lights == 1 ? "is" : "are"));
    if (report.is_empty) text += fact("hint", hint_of_empty(report.triangles > report.non_finite_triangles));
    const bool is_dark = std::ranges::all_of(
        report.lights, [](const LightReport& light) { return light.shares.lit + light.shares.partly == 0; });
    if (is_dark && !report.lights.empty())
        text += fact("hint",
                     "no light reaches what the camera sees: a closed room or sky needs a light inside "
                     "(--light-position X,Y,Z), and a sun of another --light-direction may help");
    return text;
}

std::string file_list(const Report& report) {
    std::string text;
    for (const auto& [option, file] : outputs_of(report.options, report.lights.size()))
        text += (text.empty() ? "" : ", ") + file.string();
    return text;
}

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Times of that phase, of all frames but the first.
std::vector<double> later_times(const SequenceReport& sequence, const std::string& phase) {
    std::vector<double> times;
    for (std::size_t i = 1; i < sequence.frames.size(); ++i)
        for (const auto& [name, ms] : sequence.frames[i].phases_ms)
            if (name == phase) times.push_back(ms);
    return times;
}

}  // namespace

const char* hint_of_empty(bool has_triangles) {
    return has_triangles
               ? "the camera sees no triangle: --eye X,Y,Z --target X,Y,Z, another --camera, or a larger --size "
                 "where they are thinner than a pixel"
               : "the scene has no triangles";
}

std::filesystem::path numbered(const std::filesystem::path& file, std::uint32_t frame, std::uint32_t count) {
    const std::size_t digits = std::max<std::size_t>(4, std::to_string(count - 1).size());
    std::string number = std::to_string(frame);
    number.insert(0, digits - number.size(), '0');
    std::filesystem::path out = file.parent_path() / file.stem();
    return out.concat("_" + number).concat(file.extension().string());
}

std::string mask_name(std::size_t light, std::size_t light_count) {
    return light_count == 1 ? "mask" : fmt::format("mask_{}", light);
}

std::vector<std::pair<std::string, std::filesystem::path>> outputs_of(const RenderOptions& options,
                                                                      std::size_t light_count) {
    std::vector<std::pair<std::string, std::filesystem::path>> outputs;
    const auto add = [&](const std::string& option, const std::optional<std::filesystem::path>& file) {
        if (file) outputs.emplace_back(option, *file);
    };
    add("output", options.picture);
    for (std::size_t i = 0; options.mask && i < light_count; ++i) {
        std::filesystem::path file = options.mask->parent_path() / options.mask->stem();
        if (light_count != 1) file.concat("_").concat(std::to_string(i));
        add(mask_name(i, light_count), file += options.mask->extension());
    }
    add("aov", options.aov);
    add("dump-triangles", options.triangle_dump);
    add("dump-points", options.point_dump);
    add("stats", options.statistics);
    return outputs;
}

nlohmann::ordered_json device_json(const DeviceDescription& device) {
    return {{"selector", device.selector},
            {"name", device.name},
            {"platform", device.platform},
            {"vendor", device.vendor},
            {"driver_version", device.driver_version},
            {"opencl_version", device.opencl_version},
            {"opencl_c_version", device.opencl_c_version},
            {"type", device.type},
            {"compute_units", device.compute_units},
            {"global_memory_bytes", device.global_memory_bytes},
            {"largest_allocation_bytes", device.largest_allocation_bytes},
            {"has_fp64", device.has_fp64},
            {"shares_host_memory", device.shares_host_memory},
            {"note", device.note}};
}

nlohmann::ordered_json statistics_json(const Report& report) {
    const RenderOptions& options = report.options;
    ordered_json phases = object_of(report.phases_ms);
    phases["total"] = report.total_ms;
    ordered_json json{{"command", options.command_line},
                      {"version", std::string(version())},
                      {"scene", scene_name(options)},
                      {"triangles", report.triangles},
                      {"non_finite_triangles", report.non_finite_triangles},
                      {"warnings", report.warnings},
                      {"animation", animation_json(report)},
                      {"image", image_json(options)},
                      {"camera", camera_json(report.camera)},
                      {"technique", {{"name", options.technique}, {"settings", object_of(options.settings)}}},
                      {"device", device_json(report.device)},
                      {"camera_stages", statistics_part_json(report.camera_statistics, options.profile)}};
    if (report.lights.size() == 1)
        json.update(light_part_json(report.lights.front(), options.profile));
    else
        for (const LightReport& light : report.lights)
            json["lights"].push_back(light_part_json(light, options.profile));
    if (options.picture && !options.diagnostic) json["exposure_ev"] = report.exposure_ev.value_or(0);
    json.update({{"memory",
                  {{"device_bytes", report.device_memory_bytes},
                   {"device_peak_bytes", report.device_memory_peak_bytes},
                   {"texture_bytes", report.texture_bytes}}},
                 {"phases_ms", phases},
                 {"outputs", object_of(outputs_of(options, report.lights.size()))}});
    return json;
}

ordered_json frames_json(const SequenceReport& sequence) {
    ordered_json frames = ordered_json::array();
    for (const SequenceReport::Frame& frame : sequence.frames) {
        ordered_json phases = object_of(frame.phases_ms);
        phases["total"] = frame.total_ms;
        frames.push_back({{"time_s", frame.time_s}, {"phases_ms", std::move(phases)}});
    }
    return frames;
}

std::string frames_text(const SequenceReport& sequence) {
    const SequenceReport::Frame& first = sequence.frames.front();
    std::vector<double> totals;
    for (std::size_t i = 1; i < sequence.frames.size(); ++i) totals.push_back(sequence.frames[i].total_ms);
    std::string text =
        fmt::format("{:<30}{:>12}{:>12}\n", fmt::format("{} frames", sequence.frames.size()), "first ms", "median ms");
    for (auto [name, ms] : first.phases_ms) {
        const double later = median(later_times(sequence, name));
        std::replace(name.begin(), name.end(), '_', ' ');
        text += fmt::format("  {:<28}{:12.2f}{:12.2f}\n", name, ms, later);
    }
    return text + fmt::format("  {:<28}{:12.2f}{:12.2f}\n", "total", first.total_ms, median(totals));
}

std::string summary(const Report& report) {
    const RenderOptions& options = report.options;
    const auto& [width, height] = options.size;
    const DeviceDescription& device = report.device;
    const std::string triangles = grouped(report.triangles) + (report.triangles == 1 ? " triangle" : " triangles");
    std::string text = fact("device", device.name + " (" + device.platform + ", " + device.driver_version + ")");
    if (!device.note.empty()) text += fact("", device.note);
    text += fact("scene", scene_name(options) + ", " + triangles + pose_text(report));
    text += fact("camera", fmt::format("{}, {}x{}", report.camera.source, width, height)) + '\n';
    if (options.profile) text += stages_text("camera", report.camera_statistics);
    text += counts_text(report.camera_statistics);
    for (const auto& [chosen, statistics, shares] : report.lights) {
        text += '\n' + fact("light", light_option(chosen) + " (" + chosen.source + ")");
        if (options.profile) text += stages_text("shadow", statistics);
        text += counts_text(statistics) + fact("result", shares_text(shares));
    }
    text += hints(report);
    if (report.texture_bytes != 0) text += '\n' + fact("textures", bytes_for_people(report.texture_bytes));
    if (report.exposure_ev.value_or(0) != 0)
        text += fact("exposure",
                     fmt::format("--exposure {:.3g}", *report.exposure_ev) + (options.exposure_ev ? "" : " (metered)"));
    text += '\n' + fact("memory", bytes_for_people(report.device_memory_peak_bytes) + " on the device at most");
    return text + fact("wrote", file_list(report)) + '\n' + steps_text(report);
}

}  // namespace gnomon::app
