// SPDX-License-Identifier: MIT
// The outline of a run. render_picture() and render(), at the end, read top to bottom; the functions above are steps.
#include "options.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "compile_ahead.hpp"
#include "output_files.hpp"
#include "picture.hpp"
#include "pictures.hpp"
#include "report.hpp"
#include "setup.hpp"
#include "shading/received_light.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

constexpr double default_frames_per_s = 24;

double ms_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Runs the steps of one command: each is timed to its end on the device, and shown if it takes long. The time of
/// building kernels is subtracted from the step that waited for it.
class Steps {
public:
    explicit Steps(Report& report) : report_(report), start_(std::chrono::steady_clock::now()) {}

    /// `name` is for the statistics, `work_in_words` for the progress line.
    template <typename Work>
    auto run(const std::string& name, const std::string& work_in_words, Work&& work) {
        const ProgressLine progress(work_in_words, !report_.options.quiet);
        const Timer timer{*this, name, std::chrono::steady_clock::now()};
        return work();
    }
    /// The device of all steps from the latest one on.
    void set_device(const Device& device) {
        device_ = device;
        add_builds(report_.phases_ms.back().second);
    }
    /// The same for a device that is already open.
    void use_device(const Device& device) {
        device_ = device;
        known_builds_ms_ = device.kernel_builds().ms;
    }
    /// Ends the report's times.
    void finish() {
        double sum = 0;
        for (const auto& [name, ms] : report_.phases_ms) sum += ms;
        report_.total_ms = ms_since(start_);
        report_.kernels = device_->kernel_builds();
        report_.phases_ms.emplace_back("kernels", kernels_ms_);
        report_.phases_ms.emplace_back("other", std::max(0.0, report_.total_ms - sum - kernels_ms_));
    }

private:
    struct Timer {
        Steps& steps;
        std::string name;
        std::chrono::steady_clock::time_point start;
        ~Timer() {
            double ms = ms_since(start);
            try {
                if (steps.device_) steps.add_builds(ms);
            } catch (const Error&) {  // the step's own failure is already being thrown
            }
            steps.report_.phases_ms.emplace_back(name, ms);
        }
    };
    /// Subtracts the time of the builds since the last step from the step's time. (If the host compiled one program
    /// while a thread of the device compiled another, both waits were one.)
    void add_builds(double& step_ms) {
        const double all = device_->kernel_builds().ms, waited = std::min(all - known_builds_ms_, step_ms);
        known_builds_ms_ = all;
        kernels_ms_ += waited;
        step_ms -= waited;
    }

    Report& report_;
    std::chrono::steady_clock::time_point start_;
    std::optional<Device> device_;
    double known_builds_ms_ = 0, kernels_ms_ = 0;
};

/// The open files of a run, by their names in stats.json.
struct Outputs {
    explicit Outputs(const RenderOptions& options) {
        if (options.scene) files.protect(*options.scene);
        if (options.aov) require_openimageio();
        open(options, options.light == "all" ? 0 : 1);  // the scene gives the number of lights
    }
    /// Opens what is not yet open.
    void open(const RenderOptions& options, std::size_t light_count) {
        for (const auto& [name, path] : outputs_of(options, light_count))
            if (!opened.contains(name)) opened[name] = &files.open(path);
    }
    /// Null where the options name no such file.
    OutputFile* operator[](const std::string& name) const { return opened.contains(name) ? opened.at(name) : nullptr; }

    OutputFiles files;
    std::map<std::string, OutputFile*> opened;
};

Shares count_shares(std::span<const float> visibility) {
    Shares shares;
    for (const float v : visibility) ++(v == 1.0f ? shares.lit : v == 0.0f ? shares.in_shadow : shares.partly);
    return shares;
}

/// Appends points: x, y, z and receiver, 4 bytes each.
void write_points(OutputFile& file, const PointsOnHost& points) {
    struct Record {
        float position[3];
        std::uint32_t receiver;
    };
    static_assert(sizeof(Record) == 16 && std::endian::native == std::endian::little, "the files are little-endian");
    std::vector<Record> records(points.receiver.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
        std::copy_n(&points.position[3 * i], 3, records[i].position);
        records[i].receiver = points.receiver[i];
    }
    file.write_all(records.data(), records.size() * sizeof(Record));
}

/// What the device computed for one camera and its lights.
struct Seen {
    Triangles triangles;
    View view;
    std::vector<Visibility> visibilities;     ///< one for each light
    std::vector<std::vector<float>> visible;  ///< the same, on the host
    std::vector<std::uint32_t> ids;           ///< the triangles' ids in the scene; empty: they are all of it
    std::vector<float> irradiance{};          ///< of an area light, else empty
};

PictureLights lights_of(const Report& report) {
    PictureLights lights{report.options, {}};
    for (const LightReport& light : report.lights) lights.chosen.push_back(light.chosen);
    return lights;
}

std::vector<std::vector<float>> read_all(const std::vector<Visibility>& visibilities) {
    std::vector<std::vector<float>> visible;
    for (const Visibility& visibility : visibilities) visible.push_back(visibility.read());
    return visible;
}

/// The mask is the share of the area light that reaches a pixel; what is shaded is how bright it shines on it.
Seen see_area_light(Report& report, const Device& device, Technique& technique, const Triangles& triangles,
                    const View& view) {
    const AreaLight& source = *report.lights.front().chosen.area;
    const Lights lights = area_light(source.corner, source.edge_a, source.edge_b,
                                     report.options.area_samples.value_or(default_area_samples));
    const cl::Buffer bits(session_of(device), view.points.count() * ((lights.count() + 31) / 32) * sizeof(cl_uint));
    report.lights.front().statistics = technique.run_light_table(triangles, view.points, lights, {.bits = bits.get()});
    const ReceivedLight light = received_light(device, triangles, view, source.area_vector(), lights, bits.get());
    return {triangles, view, {light.brightness}, {light.share.read()}, {}, light.irradiance.read()};
}

/// What the frames of a sequence share: programs are compiled once, buffers keep their memory, the file is read once.
struct Shared {
    SceneSource source;
    std::optional<scene::Scene> first_scene;  ///< until the first frame takes it
    std::unique_ptr<CompileAhead> ahead;      ///< until the first frame is done
    Device device;
    std::unique_ptr<Technique> technique;
    std::optional<ChosenCamera> framing;  ///< the first frame's, for a scene without cameras
    std::optional<double> exposure_ev;    ///< the first frame's
    SurfaceTextures textures{};           ///< the last frame's
};

Seen see(Steps& steps, Report& report, Shared& shared, const scene::Scene& scene, OutputFile* point_dump) {
    const Device& device = shared.device;
    Technique& technique = *shared.technique;
    const auto [width, height] = report.options.size;
    const Triangles triangles = steps.run("upload_triangles", "copying the triangles to the device", [&] {
        Triangles uploaded = upload_triangles(device, scene);
        device.finish();
        return uploaded;
    });
    const View view = steps.run("camera", "camera (compiles kernels the first time)", [&] {
        if (shared.ahead) shared.ahead->wait_for_program_of_camera();
        return look(device, triangles, report.camera.camera, width, height);
    });
    report.camera_statistics = view.statistics;
    if (report.options.area_light) {
        if (point_dump) write_points(*point_dump, view.points.read(device));
        return steps.run("shadow", "shadows (compiles kernels the first time)",
                         [&] { return see_area_light(report, device, technique, triangles, view); });
    }
    std::vector<Visibility> visibilities = visibilities_for(device, view, report.lights.size());
    std::vector<std::vector<float>> visible = steps.run("shadow", "shadows (compiles kernels the first time)", [&] {
        bool is_dumped = false;  // every light has the same points
        const SampleSink dump = [&](const Points& points) {
            if (point_dump && !is_dumped) write_points(*point_dump, points.read(device));
        };
        if (report.options.sun_angle_degrees) {
            for (std::size_t i = 0; i < visibilities.size(); ++i) {
                LightReport& light = report.lights[i];
                light.statistics = run_samples_mean(technique, triangles, view,
                                                    sun_of(report.options, light.chosen, default_sun_samples),
                                                    report.options.samples, visibilities[i], dump);
                is_dumped = true;
            }
        } else if (report.options.samples == 1) {
            dump(view.points);
            const auto statistics =
                technique.run_each_light(triangles, view.points, lights_of(report).lights(), visibilities);
            for (std::size_t i = 0; i < statistics.size(); ++i) report.lights[i].statistics = statistics[i];
        } else {
            for (std::size_t i = 0; i < visibilities.size(); ++i) {
                LightReport& light = report.lights[i];
                light.statistics = run_samples(technique, triangles, view, light.chosen.light, report.options.samples,
                                               visibilities[i], dump);
                is_dumped = true;
            }
        }
        return read_all(visibilities);
    });
    return {triangles, view, std::move(visibilities), std::move(visible), {}};
}

/// The same bits with the triangles on the host, for a scene that the device cannot hold at once.
Seen see_in_parts(Steps& steps, Report& report, const Device& device, const scene::Scene& scene) {
    const scene::CutOutsView cut_outs(scene);
    const SceneOnHost on_host{scene.triangles, cut_outs.get()};
    const auto [width, height] = report.options.size;
    ViewOfParts looked = steps.run("camera_in_parts", "camera, in parts",
                                   [&] { return look_in_parts(device, on_host, report.camera.camera, width, height); });
    report.camera_statistics = looked.view.statistics;
    std::vector<Visibility> visibilities = visibilities_for(device, looked.view, report.lights.size());
    const auto make = [&] { return make_technique(device, report.options.technique, report.options.settings); };
    std::vector<std::vector<float>> visible = steps.run("shadow_in_parts", "shadows, in parts", [&] {
        for (std::size_t i = 0; i < visibilities.size(); ++i)
            report.lights[i].statistics = run_in_parts(make, device, on_host, looked.view.points, looked.ids,
                                                       report.lights[i].chosen.light, visibilities[i]);
        return read_all(visibilities);
    });
    return {looked.triangles, looked.view, std::move(visibilities), std::move(visible), std::move(looked.ids)};
}

/// An exact technique gives the whole's visibility from parts. Samples, dumped points and diagnostics are for scenes
/// that fit.
bool can_be_in_parts(const RenderOptions& options) {
    return options.samples == 1 && !options.sun_angle_degrees && !options.area_light && options.sky_division == 0 &&
           !options.point_dump && !options.diagnostic && describe_technique(options.technique).exact;
}

/// True if a file shows what light falls on.
bool shows_surfaces(const RenderOptions& options) { return (options.picture && !options.diagnostic) || options.aov; }

/// True if a file shows it at the pixels' centres.
bool shows_centres(const RenderOptions& options) {
    return shows_surfaces(options) && (options.samples == 1 || options.aov);
}

/// The entries of these triangles, `each` numbers per triangle. Nothing of nothing.
template <typename Value>
std::vector<Value> gathered(const std::vector<Value>& from, const std::vector<std::uint32_t>& ids, std::size_t each) {
    std::vector<Value> out;
    if (from.empty()) return out;
    out.reserve(ids.size() * each);
    for (const std::uint32_t id : ids)
        out.insert(out.end(), from.begin() + std::ptrdiff_t(each * id), from.begin() + std::ptrdiff_t(each * (id + 1)));
    return out;
}

/// What a picture shows of these triangles.
scene::Scene part_of(const scene::Scene& scene, const std::vector<std::uint32_t>& ids) {
    scene::Scene part;
    part.materials = {gathered(scene.materials.triangle_material, ids, 1), scene.materials.base_color};
    part.texture_coordinates = gathered(scene.texture_coordinates, ids, 6);
    part.colors = {scene.colors.texture_uses, scene.colors.images, gathered(scene.colors.corner_colors, ids, 9),
                   gathered(scene.colors.corner_normals, ids, 3)};
    return part;
}

/// What the camera sees.
struct SeenSurfaces {
    Surfaces surfaces;
    cl::Buffer sky_sums{};  ///< the sky's shares, float64 per pixel; no memory without a sky

    cl_mem sky() const { return sky_sums.get(); }
};

Surfaces surfaces_of(const Device& device, const scene::Scene& scene, const Seen& seen, SurfaceTextures* textures) {
    if (seen.ids.empty()) return SceneSurfaces(device, scene, textures).of(seen.triangles, seen.view);
    const scene::Scene part = part_of(scene, seen.ids);
    return Surfaces(device, seen.triangles, seen.view, part.materials, scene::SurfaceDetailView(part).get(), textures);
}

void report_textures(Report& report, const Surfaces& surfaces) {
    report.texture_bytes = surfaces.texture_bytes();
    const std::uint32_t levels = surfaces.left_out_levels();
    if (levels == 0) return;
    warn_or_refuse(report.options,
                   fmt::format("the textures do not fit into the device's memory: their {} finest level{} left out",
                               levels, levels == 1 ? " is" : "s are"));
}

std::unique_ptr<SeenSurfaces> surfaces_of(Report& report, const Device& device, const scene::Scene& scene,
                                          const Seen& seen, SurfaceTextures* textures) {
    auto made = std::make_unique<SeenSurfaces>(SeenSurfaces{surfaces_of(device, scene, seen, textures)});
    device.finish();
    report_textures(report, made->surfaces);
    return made;
}

/// The same on the host; empty without a sky.
std::vector<float> sky_shares_of(const Device& device, const SeenSurfaces& of) {
    if (of.sky() == nullptr) return {};
    const auto sums = session_of(device).read_values<double>(of.sky(), of.surfaces.count());
    return {sums.begin(), sums.end()};
}

ViewOnHost view_of(const Device& device, const Seen& seen) {
    ViewOnHost view = seen.view.read(device, seen.triangles);
    if (seen.ids.empty()) return view;
    for (std::uint32_t& receiver : view.receiver)
        if (receiver != no_receiver) receiver = seen.ids[receiver];
    return view;
}

std::vector<std::uint8_t> picture_of(Shared& shared, const scene::Scene& scene, Report& report, const Seen& seen,
                                     const SeenSurfaces* surfaces) {
    const RenderOptions& options = report.options;
    const PictureLights lights = lights_of(report);
    if (options.diagnostic) {
        const auto technique = make_technique(shared.device, options.technique, options.settings);
        return technique->diagnose(*options.diagnostic, seen.triangles, seen.view.points, lights.chosen.front().light);
    }
    SceneSurfaces scene_surfaces(shared.device, scene, &shared.textures);
    Picture made = options.samples > 1
                       ? smooth_picture(*shared.technique, scene_surfaces, lights, seen.triangles, seen.view,
                                        report.exposure_ev, [&](const Surfaces& of) { report_textures(report, of); })
                       : shade(surfaces->surfaces, seen.visibilities, lights.lights(),
                               {.exposure_ev = report.exposure_ev, .sky_sums = surfaces->sky()});
    report.exposure_ev = made.exposure_ev;
    return std::move(made.rgba);
}

/// Fills every file but the statistics.
void write_files(Steps& steps, const Outputs& outputs, Shared& shared, const scene::Scene& scene, Report& report,
                 const Seen& seen, const SeenSurfaces* surfaces) {
    const std::uint32_t width = seen.view.width, height = seen.view.height;
    if (OutputFile* const picture = outputs["output"]) {
        const auto rgba = steps.run("shade", "shading the picture",
                                    [&] { return picture_of(shared, scene, report, seen, surfaces); });
        steps.run("write_picture", "writing the picture", [&] { write_picture(*picture, width, height, rgba); });
    }
    if (report.options.mask)
        steps.run("write_mask", "writing the mask", [&] {
            for (std::size_t i = 0; i < seen.visible.size(); ++i)
                write_mask(*outputs[mask_name(i, seen.visible.size())], width, height, seen.visible[i]);
        });
    if (OutputFile* const aov = outputs["aov"])
        steps.run("write_aov", "writing the EXR", [&] {
            const ViewOnHost view = view_of(shared.device, seen);
            const SurfacesOnHost shown = surfaces->surfaces.read();
            const std::vector<float> sky_shares = sky_shares_of(shared.device, *surfaces);
            write_aov(*aov, width, height, view, seen.visible.front(), "visibility",
                      {&shown, sky_shares, seen.irradiance});
        });
    if (OutputFile* const dump = outputs["dump-triangles"])
        steps.run("write_triangles", "writing the triangles",
                  [&] { dump->write_all(scene.triangles.data(), scene.triangles.size() * sizeof(float)); });
}

/// Fills the parts of the report that are known only at the end.
void complete(Report& report, const Device& device, const scene::Scene& scene, const Seen& seen) {
    report.triangles = scene.triangle_count();
    for (std::size_t i = 0; i < scene.triangle_count(); ++i) report.non_finite_triangles += !scene.is_finite(i);
    report.warnings = scene.warnings;
    report.animations = {scene.animations, scene.animation};
    report.device = device.description();
    for (std::size_t i = 0; i < report.lights.size(); ++i) report.lights[i].shares = count_shares(seen.visible[i]);
    const bool is_default_light = !report.options.light && !report.options.light_direction &&
                                  !report.options.light_position && !report.options.area_light;
    if (is_default_light && !scene.lights.empty()) report.unused_lights = scene.lights.size() - 1;
    const bool is_all_lit = std::ranges::all_of(
        report.lights, [](const LightReport& light) { return light.shares.in_shadow + light.shares.partly == 0; });
    if (is_all_lit)
        report.is_empty = std::ranges::all_of(seen.view.points.read(device).receiver,
                                              [](std::uint32_t receiver) { return receiver == no_receiver; });
    report.device_memory_bytes = device.memory_bytes();
    report.device_memory_peak_bytes = device.peak_memory_bytes();
}

/// All checks that can refuse the request at once: the scene's file, the device, the technique. The first scene is
/// loaded before OpenCL is used, for CompileAhead.
Shared prepare(Steps& steps, const RenderOptions& options) {
    SceneSource source =
        steps.run("read_scene", "reading the scene", [&] { return SceneSource(options, shows_surfaces(options)); });
    scene::Scene scene = steps.run("load_scene", "loading the scene", [&] { return source.at(options.time_s); });
    auto ahead = std::make_unique<CompileAhead>(options, scene);
    const Device device =
        steps.run("open_device", "opening the device", [&] { return open_device(options, options.profile); });
    steps.set_device(device);
    auto technique = steps.run("prepare_technique", "preparing the technique (compiles kernels the first time)",
                               [&] { return make_technique(device, options.technique, options.settings); });
    return {std::move(source), std::move(scene), std::move(ahead), device, std::move(technique), {}, {}};
}

double frame_time(const RenderOptions& options, double first_s, std::uint32_t frame) {
    return first_s + frame / options.frames_per_s.value_or(default_frames_per_s);
}

ChosenCamera camera_of_frame(const RenderOptions& options, const scene::Scene& scene, Shared& shared) {
    if (shared.framing) return *shared.framing;
    const ChosenCamera chosen = choose_camera(options, scene, [&](scene::Framing& framing) {
        // The whole motion stays in the picture.
        for (std::uint32_t frame = 1; frame < options.frames && !scene.animation.empty(); ++frame)
            framing.add(shared.source.at(frame_time(options, *options.time_s, frame)));
    });
    print_camera_note(options, scene, chosen);
    if (scene.cameras.empty() && options.frames > 0) shared.framing = chosen;
    return chosen;
}

/// Renders report.options at its time, and commits the files. `steps` has the device.
void render_picture(Steps& steps, Report& report, Shared& shared, Outputs& outputs) {
    const RenderOptions& options = report.options;
    const Device& device = shared.device;
    const scene::Scene scene = shared.first_scene ? *std::exchange(shared.first_scene, std::nullopt)
                                                  : steps.run("load_scene", "loading the scene",
                                                              [&] { return shared.source.at(options.time_s); });
    require_exact_for_cut_outs(options, scene);
    report.camera = camera_of_frame(options, scene, shared);
    for (ChosenLight& light : choose_lights(options, scene)) report.lights.push_back({std::move(light), {}, {}});
    outputs.open(options, report.lights.size());
    if (!shared.technique) shared.technique = make_technique(device, options.technique, options.settings);

    // The camera's view, then the points that each light reaches.
    const Seen seen = [&] {
        try {
            return see(steps, report, shared, scene, outputs["dump-points"]);
        } catch (const OutOfDeviceMemory&) {
            if (!can_be_in_parts(options)) throw;
        }
        shared.technique.reset();  // frees memory for the next attempt
        shared.textures = {};
        return see_in_parts(steps, report, device, scene);
    }();
    std::unique_ptr<SeenSurfaces> surfaces;
    if (shows_centres(options))
        surfaces = steps.run("surfaces", "the surfaces' colours", [&] {
            return surfaces_of(report, device, scene, seen, options.frames > 0 ? &shared.textures : nullptr);
        });
    if (surfaces && options.sky_division != 0)
        surfaces->sky_sums = steps.run("sky", "the sky's light", [&] {
            return sky_sums_of(device, *shared.technique, seen.triangles, seen.view.points, surfaces->surfaces,
                               options.sky_division);
        });
    if (options.frames == 0 && options.samples == 1) shared.technique.reset();  // frees its memory for the pictures
    report.exposure_ev = shared.exposure_ev ? shared.exposure_ev : exposure_of(options, report.lights.size());

    // The files, each complete before the first appears.
    write_files(steps, outputs, shared, scene, report, seen, surfaces.get());
    if (const auto ahead = std::exchange(shared.ahead, nullptr)) ahead->note_picture();
    if (options.frames > 0) shared.exposure_ev = report.exposure_ev;
    complete(report, device, scene, seen);
    steps.finish();
}

void write_statistics(OutputFile& file, const nlohmann::ordered_json& statistics) {
    const std::string text = statistics.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    file.write_all(text.data(), text.size());
}

/// The options of one frame: its time, its numbered files, no statistics.
RenderOptions frame_options(const RenderOptions& options, std::uint32_t frame) {
    RenderOptions out = options;
    out.time_s = frame_time(options, options.time_s.value_or(0), frame);
    out.statistics.reset();
    for (auto* file : {&out.picture, &out.mask, &out.aov, &out.triangle_dump, &out.point_dump})
        if (*file) *file = numbered(**file, frame, options.frames);
    return out;
}

void render_sequence(const RenderOptions& options) {
    OutputFiles statistics_files;
    OutputFile* const statistics = options.statistics ? &statistics_files.open(*options.statistics) : nullptr;
    std::optional<Shared> shared;
    Report last;
    SequenceReport sequence;
    for (std::uint32_t frame = 0; frame < options.frames; ++frame) {
        Report report;
        report.options = frame_options(options, frame);
        Steps steps(report);
        Outputs outputs(report.options);
        if (shared)
            steps.use_device(shared->device);
        else
            shared.emplace(prepare(steps, report.options));
        render_picture(steps, report, *shared, outputs);
        outputs.files.commit();
        sequence.frames.push_back({*report.options.time_s, report.total_ms, report.phases_ms});
        last = std::move(report);
    }
    if (statistics) {
        nlohmann::ordered_json json = statistics_json(last);
        json["frames"] = frames_json(sequence);
        write_statistics(*statistics, json);
    }
    statistics_files.commit();
    if (!options.quiet) print_result(summary(last) + '\n' + frames_text(sequence));
}

}  // namespace

void render(const RenderOptions& options) {
    if (options.frames > 0) return render_sequence(options);
    Report report;
    report.options = options;
    Steps steps(report);
    Outputs outputs(options);
    Shared shared = prepare(steps, options);
    render_picture(steps, report, shared, outputs);
    if (OutputFile* const statistics = outputs["stats"]) write_statistics(*statistics, statistics_json(report));
    outputs.files.commit();
    if (!options.quiet) print_result(summary(report));
}

}  // namespace gnomon::app
