// SPDX-License-Identifier: MIT
// The outline of `gnomon gallery`: gallery(), at the end, reads top to bottom.
#include "options.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "measure/visibility_errors.hpp"
#include "output_files.hpp"
#include "pictures.hpp"
#include "setup.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

using nlohmann::ordered_json;
using Settings = std::vector<std::pair<std::string, std::string>>;
const char* const truth_name = "frustum-traced";

/// One technique of the page, with its settings.
struct Chosen {
    TechniqueDescription technique;
    Settings settings;
    bool is_soft_truth = false;
};

TechniqueDescription described(const std::string& name) {
    try {
        return describe_technique(name);
    } catch (const Error& error) {
        throw UsageError(std::string("--technique: ") + error.what());
    }
}

/// "NAME" or "NAME:KEY=VALUE,KEY=VALUE".
Chosen parse_technique(const std::string& text) {
    const std::size_t colon = text.find(':');
    Chosen chosen{described(text.substr(0, colon)), {}};
    for (std::size_t at = colon; at != std::string::npos;) {
        const std::size_t comma = text.find(',', at + 1);
        const auto read = setting().read(text.substr(at + 1, comma - at - 1));
        if (!read) throw UsageError("--technique needs " + setting().needs + " behind the colon, not \"" + text + "\"");
        chosen.settings.push_back(*read);
        at = comma;
    }
    return chosen;
}

void set_unless_asked(Chosen& chosen, const std::string& name, const std::string& value) {
    const bool is_asked = std::ranges::any_of(chosen.settings, [&](const auto& asked) { return asked.first == name; });
    if (!is_asked) chosen.settings.emplace_back(name, value);
}

/// Comparisons on equal terms: pcss has the size of the disk, and maps fit the receivers, as in the benchmark.
void put_on_equal_terms(const GalleryOptions& options, Chosen& chosen) {
    if (chosen.technique.name == "pcss" && options.sun_angle_degrees) {
        const double tangent = std::tan(double(*options.sun_angle_degrees) * (std::numbers::pi / 180));
        set_unless_asked(chosen, "light-size", float_text(float(tangent)));
    }
    for (const SettingDescription& setting : chosen.technique.settings)
        if (setting.name == "fit" && setting.default_value == "frustum") set_unless_asked(chosen, "fit", "receivers");
}

/// The truth first (with a disk also the hard shadow), then the techniques of the options, or every other technique.
std::vector<Chosen> choose_techniques(const GalleryOptions& options) {
    std::vector<Chosen> all{{described(truth_name), {}}};
    if (options.sun_angle_degrees) all.insert(all.begin(), {described(truth_name), {}, true});
    if (options.techniques.empty())
        for (TechniqueDescription& technique : techniques())
            if (technique.name != truth_name) all.push_back({std::move(technique), {}});
    for (const std::string& text : options.techniques)
        if (text != truth_name) all.push_back(parse_technique(text));
    for (Chosen& chosen : all) put_on_equal_terms(options, chosen);
    return all;
}

std::string settings_text(const Settings& settings) {
    std::string text;
    for (const auto& [key, value] : settings) text += (text.empty() ? "" : " ") + key + "=" + value;
    return text;
}

/// One view with its light, on the device, and its truth, once known.
struct Hall {
    const Device& device;
    const scene::Scene& scene;
    Triangles triangles;
    View view;
    Surfaces surfaces;
    Light light;
    std::optional<Lights> sun;  ///< the disk that the light is, if the truth is soft
    std::vector<float> truth;
};

double run_ms(const Hall& hall, Technique& technique, bool is_soft_truth, const Visibility& visibility,
              Statistics& statistics) {
    const auto start = std::chrono::steady_clock::now();
    statistics = is_soft_truth ? run_mean(technique, hall.triangles, hall.view.points, *hall.sun, visibility)
                               : technique.run(hall.triangles, hall.view.points, hall.light, visibility);
    hall.device.finish();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Runs one technique; its times, errors and pictures. The first technique gives the truth.
ordered_json results(Hall& hall, const Chosen& chosen, std::uint32_t runs) {
    const auto technique = make_technique(hall.device, chosen.technique.name, chosen.settings);
    const Visibility visibility(hall.device, hall.view.points.count());
    Statistics statistics;
    const auto run_once = [&] { return run_ms(hall, *technique, chosen.is_soft_truth, visibility, statistics); };
    run_once();  // compiles kernels and grows lists
    std::vector<double> ms;
    for (std::uint32_t run = 0; run < runs; ++run) ms.push_back(run_once());
    std::sort(ms.begin(), ms.end());

    const std::vector<float> visible = visibility.read();
    if (hall.truth.empty()) hall.truth = visible;
    const std::uint32_t width = hall.view.width, height = hall.view.height;
    const measure::VisibilityErrors errors = measure::visibility_errors(visible, hall.truth, width, height);
    const Picture shaded = shade(hall.surfaces, {&visibility, 1}, {&hall.light, 1});
    ordered_json diagnostics = ordered_json::array();
    for (const auto& [name, meaning] : chosen.technique.diagnostics) {
        const auto drawn = technique->diagnose(name, hall.triangles, hall.view.points, hall.light);
        const std::string picture = short_data_uri(width, height, drawn);
        diagnostics.push_back({{"name", name}, {"meaning", meaning}, {"picture", picture}});
    }
    return {{"median_ms", (ms[(ms.size() - 1) / 2] + ms[ms.size() / 2]) / 2},
            {"least_ms", ms.front()},
            {"most_ms", ms.back()},
            {"memory_bytes", statistics.device_memory_bytes},
            {"points", errors.points},
            {"wrongly_lit", errors.wrongly_lit},
            {"wrongly_shadowed", errors.wrongly_shadowed},
            {"mean_absolute", errors.mean_absolute},
            {"worst_tile", errors.worst_tile},
            {"ssim", errors.ssim},
            {"penumbra_points", errors.penumbra_points},
            {"penumbra_mean_absolute", errors.penumbra_mean_absolute},
            {"picture", data_uri("jpeg", width, height, shaded.rgba)},
            {"difference", data_uri("png", width, height, measure::difference_picture(visible, hall.truth))},
            {"diagnostics", diagnostics}};
}

/// A technique with its results. An error becomes a sentence in their place (unless `strict`), so that the other
/// techniques are still shown.
ordered_json exhibit(Hall& hall, const Chosen& chosen, std::uint32_t runs, bool strict) {
    const std::string samples =
        chosen.is_soft_truth ? "soft: " + grouped(hall.sun->count()) + " lights on the disk" : std::string();
    ordered_json json{{"name", chosen.technique.name},
                      {"settings", samples + settings_text(chosen.settings)},
                      {"summary", chosen.technique.summary},
                      {"exact", chosen.technique.exact && chosen.is_soft_truth == hall.sun.has_value()}};
    try {
        json.update(results(hall, chosen, runs));
    } catch (const Error& error) {
        if (hall.truth.empty() || strict) throw;  // without truth there is nothing to compare with
        json["failure"] = error.what();
        print_warning(chosen.technique.name + ": " + error.what());
    }
    return json;
}

/// The data of the page, without exhibits.
ordered_json page_json(const GalleryOptions& options, const Device& device, const scene::Scene& scene,
                       const ChosenCamera& camera, const ChosenLight& light) {
    const std::string name = options.scene ? options.scene->filename().string() : "the built-in sundial";
    const DeviceDescription& d = device.description();
    const auto [width, height] = options.size;
    const std::string disk =
        options.sun_angle_degrees ? ", a disk of " + float_text(*options.sun_angle_degrees) + " degrees" : "";
    return {
        {"title", "gnomon: " + name},
        {"width", width},
        {"height", height},
        {"facts", ordered_json::array({{"scene", name + ", " + grouped(scene.triangle_count()) + " triangles"},
                                       {"camera", camera.source},
                                       {"light", light_option(light) + " (" + light.source + ")" + disk},
                                       {"picture", fmt::format("{} x {}", width, height)},
                                       {"device", d.name + " (" + d.platform + ", " + d.driver_version + ")"},
                                       {"timed runs", fmt::format("{} of each, after one to warm up", options.runs)},
                                       {"made by", "gnomon " + std::string(version())}})}};
}

/// gallery_page.html with the data in place of {{data}}. Inside a script element "</script" and "<!--" have a meaning:
/// in JSON, "<" stands only in strings, where its number can replace it.
std::string html_of(const ordered_json& data) {
    constexpr std::string_view slot = "{{data}}";
    std::string json = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;) json.replace(at, 1, "\\u003c");
    std::string html(text_file("gallery_page.html"));
    return html.replace(html.find(slot), slot.size(), json);
}

}  // namespace

void gallery(const GalleryOptions& options) {
    const std::vector<Chosen> all = choose_techniques(options);
    OutputFiles files;
    if (options.scene) files.protect(*options.scene);
    OutputFile& file = files.open(options.page);
    const Device device = open_device(options, false);
    // A wrong setting is refused before the long work.
    for (const Chosen& one : all) make_technique(device, one.technique.name, one.settings);
    const scene::Scene scene = load_scene(options, true);
    const ChosenCamera camera = choose_camera(options, scene);
    print_camera_note(options, scene, camera);
    const ChosenLight light = choose_light(options, scene);

    const Triangles triangles = upload_triangles(device, scene);
    const View view = look(device, triangles, camera.camera, options.size.width, options.size.height);
    const scene::SurfaceDetailView detail(scene);
    Hall hall{device,      scene, triangles, view, {device, triangles, view, scene.materials, detail.get()},
              light.light, {},    {}};
    if (options.sun_angle_degrees) hall.sun = sun_of(options, light, truth_sun_samples);
    ordered_json page = page_json(options, device, scene, camera, light);
    for (const Chosen& one : all) {
        const ProgressLine progress(one.technique.name + " " + settings_text(one.settings), !options.quiet);
        page["exhibits"].push_back(exhibit(hall, one, options.runs, options.strict));
    }
    const std::string html = html_of(page);
    file.write_all(html.data(), html.size());
    files.commit();
    if (!options.quiet)
        print_result(fmt::format("wrote {}: {} techniques, {}\n", options.page.string(), page["exhibits"].size(),
                                 bytes_for_people(html.size())));
}

}  // namespace gnomon::app
