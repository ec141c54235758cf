// SPDX-License-Identifier: MIT
// The outline of `gnomon gallery`: gallery(), at the end, reads top to bottom.
#include "gallery.hpp"

#include <algorithm>
#include <chrono>

#include "choice.hpp"
#include "gallery_page.hpp"
#include "output_files.hpp"
#include "pictures.hpp"
#include "setup.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;
const char* const truth_name = "frustum-traced";

/// One technique of the command line.
struct Asked {
    TechniqueDescription technique;
    Settings settings;
};

TechniqueDescription described(const std::string& name) {
    std::string names;
    for (TechniqueDescription& technique : techniques()) {
        if (technique.name == name) return std::move(technique);
        names += (names.empty() ? "" : ", ") + technique.name;
    }
    throw UsageError("--technique: there is no technique \"" + name + "\": these exist: " + names);
}

/// "NAME" or "NAME:KEY=VALUE,KEY=VALUE".
Asked parse_asked(const std::string& text) {
    const std::size_t colon = text.find(':');
    Asked asked{described(text.substr(0, colon)), {}};
    for (std::size_t at = colon; at != std::string::npos;) {
        const std::size_t comma = text.find(',', at + 1);
        asked.settings.push_back(parse_setting("--technique", text.substr(at + 1, comma - at - 1)));
        at = comma;
    }
    return asked;
}

/// The truth first, then the techniques of the options, or every other technique.
std::vector<Asked> all_asked(const GalleryOptions& options) {
    std::vector<Asked> all{{described(truth_name), {}}};
    if (options.techniques.empty())
        for (TechniqueDescription& technique : techniques())
            if (technique.name != truth_name) all.push_back({std::move(technique), {}});
    for (const std::string& text : options.techniques)
        if (text != truth_name) all.push_back(parse_asked(text));
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
    Light light;
    std::vector<float> truth;
};

double run_ms(const Hall& hall, Technique& technique, const Visibility& visibility, Statistics& statistics) {
    const auto start = std::chrono::steady_clock::now();
    statistics = technique.run(hall.triangles, hall.view.points, hall.light, visibility);
    clFinish(hall.device.queue());
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Runs one technique and fills its exhibit. The first exhibit gives the truth.
void exhibit(Hall& hall, const Asked& asked, std::uint32_t runs, Exhibit& result) {
    const auto technique = make_technique(hall.device, asked.technique.name, asked.settings);
    const Visibility visibility(hall.device, hall.view.points.count());
    Statistics statistics;
    run_ms(hall, *technique, visibility, statistics);  // compiles kernels and grows lists
    std::vector<double> ms;
    for (std::uint32_t run = 0; run < runs; ++run) ms.push_back(run_ms(hall, *technique, visibility, statistics));
    std::sort(ms.begin(), ms.end());
    result.median_ms = (ms[(ms.size() - 1) / 2] + ms[ms.size() / 2]) / 2;
    result.least_ms = ms.front();
    result.most_ms = ms.back();
    result.memory_bytes = statistics.device_memory_bytes;

    const std::vector<float> visible = visibility.read();
    if (hall.truth.empty()) hall.truth = visible;
    const std::uint32_t width = hall.view.width, height = hall.view.height;
    result.errors = measure::visibility_errors(visible, hall.truth, width, height);
    result.picture = jpeg_data_uri(
        width, height, shade(hall.device, hall.triangles, hall.view, visibility, hall.scene.materials, hall.light));
    result.difference = png_data_uri(width, height, measure::difference_picture(visible, hall.truth));
    for (const auto& [name, meaning] : asked.technique.diagnostics) {
        const auto drawn = technique->diagnose(name, hall.triangles, hall.view.points, hall.light);
        result.diagnostics.push_back({name, meaning, short_data_uri(width, height, drawn)});
    }
}

/// Like exhibit(), but an error becomes the exhibit's sentence (unless `strict`), so that the others are still shown.
Exhibit exhibit_or_failure(Hall& hall, const Asked& asked, std::uint32_t runs, bool strict) {
    Exhibit result;
    result.name = asked.technique.name;
    result.settings = settings_text(asked.settings);
    result.summary = asked.technique.summary;
    result.exact = asked.technique.exact;
    try {
        exhibit(hall, asked, runs, result);
    } catch (const Error& error) {
        if (hall.truth.empty() || strict) throw;  // without truth there is nothing to compare with
        result.failure = error.what();
        print_warning(result.name + ": " + result.failure);
    }
    return result;
}

GalleryPage described_page(const GalleryOptions& options, const Device& device, const scene::Scene& scene,
                           const ChosenCamera& camera, const ChosenLight& light) {
    const std::string name = options.scene ? options.scene->filename().string() : "the built-in sundial";
    const DeviceDescription& d = device.description();
    GalleryPage page;
    page.title = "gnomon: " + name;
    page.width = options.size.width;
    page.height = options.size.height;
    page.facts = {{"scene", name + ", " + grouped(scene.triangle_count()) + " triangles"},
                  {"camera", camera.source},
                  {"light", light_option(light.light) + " (" + light.source + ")"},
                  {"picture", std::to_string(page.width) + " x " + std::to_string(page.height)},
                  {"device", d.name + " (" + d.platform + ", " + d.driver_version + ")"},
                  {"timed runs", std::to_string(options.runs) + " of each, after one to warm up"},
                  {"made by", "gnomon " + std::string(version())}};
    return page;
}

}  // namespace

void gallery(const GalleryOptions& options) {
    const std::vector<Asked> asked = all_asked(options);
    OutputFiles files;
    if (options.scene) files.protect(*options.scene);
    OutputFile& file = files.open(options.page);
    require_openimageio();
    const Device device = open_device(options, false);
    // A wrong setting is refused before the long work.
    for (const Asked& one : asked) make_technique(device, one.technique.name, one.settings);
    const scene::Scene scene = load_scene(options);
    const ChosenCamera camera = choose_camera(options, scene);
    const ChosenLight light = choose_light(options, scene);

    const Triangles triangles = Triangles::upload(device, scene.triangles);
    Hall hall{device,      scene,
              triangles,   look(device, triangles, camera.camera, options.size.width, options.size.height),
              light.light, {}};
    GalleryPage page = described_page(options, device, scene, camera, light);
    for (const Asked& one : asked) {
        const ProgressLine progress(one.technique.name + " " + settings_text(one.settings), !options.quiet);
        page.exhibits.push_back(exhibit_or_failure(hall, one, options.runs, options.strict));
    }
    const std::string html = html_of(page);
    file.write(html.data(), html.size());
    file.check();
    files.commit();
    if (!options.quiet)
        print_result("wrote " + options.page.string() + ": " + std::to_string(page.exhibits.size()) + " techniques, " +
                     bytes_for_people(html.size()) + "\n");
}

}  // namespace gnomon::app
