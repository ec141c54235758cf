// SPDX-License-Identifier: MIT
#include "contestant.hpp"

#include <fmt/core.h>
#include <cstdio>

namespace gnomon::bench {

namespace {

constexpr int profiled_runs = 5;

bool is_exact(const std::string& technique) {
    for (const TechniqueDescription& description : techniques())
        if (description.name == technique) return description.exact;
    return false;
}

// Of a device that profiles: the median over the runs.
std::vector<std::pair<std::string, double>> stage_times(const std::vector<Statistics>& runs) {
    std::vector<std::pair<std::string, double>> stages;
    for (std::size_t i = 0; i < runs.back().stages.size(); ++i) {
        std::vector<double> ms;
        for (const Statistics& s : runs)
            if (i < s.stages.size()) ms.push_back(s.stages[i].device_ms);
        stages.emplace_back(runs.back().stages[i].name, times_of(ms).median_ms);
    }
    return stages;
}

Row row_of(const Configuration& configuration, const Seen& seen) {
    Row row = seen.row;
    row.technique = configuration.technique;
    row.settings = configuration.settings;
    if (configuration.samples != 1) row.settings.push_back(samples_setting(configuration.samples));
    if (configuration.sun_samples != 0)
        row.settings.emplace_back("sun-samples", std::to_string(configuration.sun_samples));
    // A hard shadow is no exact answer where the truth is soft.
    row.exact = is_exact(row.technique) && seen.sun_angle_degrees.has_value() == (configuration.sun_samples != 0);
    row.mode = configuration.mode;
    row.asked = configuration.asked;
    row.terms = configuration.terms;
    return row;
}

}  // namespace

template <typename Value>
std::string hash_of(std::span<const Value> values) {
    std::uint64_t hash = 14695981039346656037ull;  // FNV-1a
    for (const unsigned char byte :
         std::span(reinterpret_cast<const unsigned char*>(values.data()), values.size_bytes()))
        hash = (hash ^ byte) * 1099511628211ull;
    return fmt::format("{:016x}", hash);
}
template std::string hash_of(std::span<const float>);
template std::string hash_of(std::span<const std::uint32_t>);

Lights Seen::sun(const Configuration& configuration) const {
    const auto& d = c.light.xyzw;
    return sun_disk({-d[0], -d[1], -d[2]}, *sun_angle_degrees, configuration.sun_samples);
}

std::pair<std::string, std::string> samples_setting(std::uint32_t samples) {
    return {"samples", std::to_string(samples)};
}

std::unique_ptr<Technique> make(const Configuration& configuration, const Device& device) {
    auto technique = make_technique(configuration.technique, device);
    for (const auto& [key, value] : configuration.settings) technique->set(key, value);
    return technique;
}

Place::Place(const std::string& selector, const NamedScene& named, bool profile)
    : device(selector, DeviceOptions{.profile = profile}),
      scene(named),
      triangles(scene::upload(device, named.scene)) {}

Times Place::time_camera(const Triangles& seen, const Case& c, Size size) const {
    std::vector<double> ms;
    CameraPass pass(device);
    for (int run = 0; run < 3; ++run)
        ms.push_back(pass.look(seen, c.camera, size.width, size.height).statistics.total_wall_ms);
    return times_of(ms);
}

Seen seen_in(const Place& place, const Case& c, Size size) {
    const Times camera = place.time_camera(place.triangles, c, size);
    View view = look(place.device, place.triangles, c.camera, size.width, size.height);
    ViewOnHost host = view.read(place.device, place.triangles);
    Row row;
    row.scene = place.scene.name;
    row.view = c.view;
    row.light = c.light_name;
    row.width = size.width;
    row.height = size.height;
    row.triangles = place.triangles.count();
    row.device = place.device.description().name;
    row.driver = place.device.description().driver_version;
    row.camera = camera;
    row.points_hash = hash_of(std::span<const float>(host.position));
    Visibility visibility(place.device, std::size_t(size.width) * size.height);
    return {std::move(view), std::move(host), std::move(visibility), std::move(row), c, {}};
}

// ---- Contestant -----------------------------------------------------------------------------------------------------

void Contestant::warm_up() {
    guarded([&] {
        get_ready();
        // Of a very long run, one must do.
        if (time_ms([&] { run(); }) > long_run_ms) return;
        if (time_ms([&] { run(); }) < short_run_ms) run();
    });
}

void Contestant::run_timed() {
    guarded([&] { runs_.push_back(run()); });
}

Contestant::Result Contestant::finish() {
    Result result{row_, {}};
    guarded([&] {
        result.mask = describe(result.row);
        result.row.mask_hash = hash_of(std::span<const float>(result.mask));
        result.row.set_runs(std::move(runs_), has_frames_);
    });
    result.row.failed = failed_;
    free_memory();
    return result;
}

// ---- gnomon ---------------------------------------------------------------------------------------------------------

OwnContestant::OwnContestant(Configuration configuration, const Place& place, const Seen& seen, bool has_frames)
    : Contestant(row_of(configuration, seen), has_frames),
      configuration_(std::move(configuration)),
      place_(place),
      seen_(seen),
      triangles_(place.triangles) {}

void OwnContestant::get_ready() {
    technique_ = make(configuration_, place_.device);
    camera_.emplace(place_.device);
    if (has_frames()) {
        appearance_ = Appearance::upload(place_.device, place_.scene.scene.materials);
        picture_.emplace(place_.device, std::size_t(seen_.row.width) * seen_.row.height);
    }
    if (configuration_.mode != "animated") keep();
}

// A still scene keeps its clusters for the camera, and the prepared light. Thrice, since the first time compiles
// kernels and makes lists grow; of a very long one once must do.
void OwnContestant::keep() {
    const bool is_still = configuration_.mode == "static";
    for (int i = 0; i < 3 && (i == 0 || keep_ms_.back() < long_run_ms); ++i)
        keep_ms_.push_back(time_ms([&] {
            if (!is_still || has_frames()) triangles_.keep_clusters(place_.device);
            if (is_still) technique_->prepare(triangles_, seen_.c.light);
            place_.device.finish();
        }));
}

Statistics OwnContestant::run_shadows(const View& view) {
    if (configuration_.sun_samples != 0) {
        Statistics soft = run_mean(*technique_, triangles_, view.points, seen_.sun(configuration_), seen_.visibility);
        place_.device.finish();
        return soft;
    }
    Statistics statistics =
        configuration_.samples == 1
            ? technique_->run(triangles_, view.points, seen_.c.light, seen_.visibility)
            : run_samples(*technique_, triangles_, view, seen_.c.light, configuration_.samples, seen_.visibility);
    place_.device.finish();
    return statistics;
}

FrameTimes OwnContestant::run() {
    FrameTimes times;
    if (!has_frames()) {
        times.shadow = time_run([&] { run_shadows(seen_.view); });
        return times;
    }
    times.camera = time_run([&] {
        view_.reset();  // the pass uses its buffers again
        view_ = camera_->look(triangles_, seen_.c.camera, seen_.row.width, seen_.row.height);
        place_.device.finish();
    });
    times.shadow = time_run([&] { run_shadows(*view_); });
    times.shade = time_run([&] {
        shade_into(picture_->buffer(), appearance_->surfaces(triangles_, *view_), {&seen_.visibility, 1},
                   {&seen_.c.light, 1});
        place_.device.finish();
    });
    return times;
}

void OwnContestant::require_same_points(const View& view) const {
    const ViewOnHost host = view.read(place_.device, triangles_);
    if (hash_of(std::span<const float>(host.position)) != seen_.row.points_hash || host.receiver != seen_.host.receiver)
        throw Error("the camera made other points than before");
}

std::vector<float> OwnContestant::describe(Row& row) {
    const Statistics statistics = run_shadows(view_ ? *view_ : seen_.view);
    if (view_) require_same_points(*view_);
    if (!keep_ms_.empty()) row.build = times_of(keep_ms_);
    row.device_memory_bytes = statistics.device_memory_bytes;
    row.counts = statistics.counts;
    for (const StageStatistics& stage : statistics.stages)
        if (!stage.skipped.empty()) row.skipped.emplace_back(stage.name, stage.skipped);
    if (configuration_.mode == "moving" && !has_frames())
        row.camera = place_.time_camera(triangles_, seen_.c, {row.width, row.height});
    return seen_.visibility.read();
}

void OwnContestant::free_memory() {
    technique_.reset();
    view_.reset();
    camera_.reset();
    appearance_.reset();
    picture_.reset();
}

std::vector<std::pair<std::string, double>> OwnContestant::profile() {
    std::vector<Statistics> runs;
    warm_up();
    for (int i = 0; i < profiled_runs; ++i) guarded([&] { runs.push_back(run_shadows(seen_.view)); });
    free_memory();
    return failed().empty() ? stage_times(runs) : std::vector<std::pair<std::string, double>>{};
}

}  // namespace gnomon::bench
