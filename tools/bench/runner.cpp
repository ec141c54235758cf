// SPDX-License-Identifier: MIT
#include "runner.hpp"

#include <algorithm>
#include <cstdio>

#include "peers.hpp"
#include "pictures.hpp"
#include "reference/visibility.hpp"

namespace gnomon::bench {

namespace {

constexpr int profiled_runs = 5;
constexpr double short_run_ms = 100, long_run_ms = 3000;  // of warm-up runs

template <typename Value>
std::string hash_of(std::span<const Value> values) {
    std::uint64_t hash = 14695981039346656037ull;  // FNV-1a
    for (const unsigned char byte :
         std::span(reinterpret_cast<const unsigned char*>(values.data()), values.size_bytes()))
        hash = (hash ^ byte) * 1099511628211ull;
    char text[17];
    std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

std::unique_ptr<Technique> make(const Configuration& configuration, const Device& device) {
    auto technique = make_technique(configuration.technique, device);
    for (const auto& [key, value] : configuration.settings) technique->set(key, value);
    return technique;
}

std::pair<std::string, std::string> samples_setting(std::uint32_t samples) {
    return {"samples", std::to_string(samples)};
}

bool is_exact(const std::string& technique) {
    for (const TechniqueDescription& description : techniques())
        if (description.name == technique) return description.exact;
    return false;
}

// Device times of the stages, by events, on a device of its own that profiles: the median over the runs.
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

std::vector<Configuration> configurations_of(const Block& block, Size size) {
    std::vector<Configuration> configurations = block.configurations;
    if (block.more_settings)
        for (Configuration& configuration : configurations)
            for (auto& setting : block.more_settings(size)) configuration.settings.push_back(setting);
    return configurations;
}

// The exact technique's answers against the independent oracle: every k-th point, k as small as `most` allows.
OracleVerdict ask_oracle(const NamedScene& scene, const ViewOnHost& host, const Float3& eye, const Light& light,
                         std::span<const float> mask, std::uint64_t most) {
    const std::size_t step = (mask.size() + most - 1) / most;
    std::vector<float> positions;
    std::vector<std::uint32_t> receivers;
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < mask.size(); i += step) {
        if (host.receiver[i] == no_receiver) continue;
        for (std::size_t c = 0; c < 3; ++c) positions.push_back(host.position[3 * i + c]);
        receivers.push_back(host.receiver[i]);
        pixels.push_back(i);
    }
    const std::vector<std::uint8_t> shadowed =
        reference::shadowed(scene.scene.triangles, positions, receivers, light.xyzw, eye);
    OracleVerdict verdict{pixels.size(), 0};
    for (std::size_t k = 0; k < pixels.size(); ++k)
        verdict.wrong += mask[pixels[k]] != (shadowed[k] != 0 ? 0.0f : 1.0f);
    return verdict;
}

}  // namespace

Size parse_size(const std::string& text) {
    Size size;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%ux%u%c", &size.width, &size.height, &rest) != 2 || size.width == 0 ||
        size.height == 0)
        throw InvalidArgument("a size is WIDTHxHEIGHT, not \"" + text + "\"");
    return size;
}

/// A scene on a device.
struct Runner::Place {
    Place(const std::string& selector, const NamedScene& named, bool profile)
        : device(selector, DeviceOptions{.profile = profile}),
          scene(named),
          triangles(Triangles::upload(device, named.scene.triangles)) {}

    Times time_camera(const Triangles& seen, const Case& c, Size size) const {
        std::vector<double> ms;
        for (int run = 0; run < 3; ++run)
            ms.push_back(gnomon::look(device, seen, c.camera, size.width, size.height).statistics.total_wall_ms);
        return times_of(ms);
    }

    Device device;
    const NamedScene& scene;
    Triangles triangles;
};

/// A view of it, with everything that a row says about a view.
struct Runner::Seen {
    View view;
    ViewOnHost host;
    Visibility visibility;
    Row row;  ///< what all rows of this view share
    Case c;
};

/// A technique on its way through the runs of one view. One that fails says so in its row; the others go on.
class Runner::Contestant {
public:
    Contestant(Configuration configuration, const Place& place, const Seen& seen)
        : configuration_(std::move(configuration)), place_(place), seen_(seen), triangles_(place.triangles) {}

    void warm_up() {
        guarded([&] {
            technique_ = make(configuration_, place_.device);
            if (configuration_.mode != "animated") prepare();
            // The first run compiles kernels and makes lists grow; of a very long one that must do.
            if (time_ms([&] { run_once(); }) > long_run_ms) return;
            if (time_ms([&] { run_once(); }) < short_run_ms) run_once();
        });
    }
    void run_timed() {
        guarded([&] { runs_.push_back(time_run([&] { run_once(); })); });
    }
    /// The row without its errors, and the mask; ends the technique.
    std::pair<Row, std::vector<float>> finish() {
        Row row = seen_.row;
        row.technique = configuration_.technique;
        row.settings = configuration_.settings;
        if (configuration_.samples != 1) row.settings.push_back(samples_setting(configuration_.samples));
        row.exact = is_exact(row.technique);
        row.mode = configuration_.mode;
        std::vector<float> mask;
        guarded([&] {
            const Statistics statistics = run_once();
            mask = seen_.visibility.read();
            std::vector<double> wall_ms;
            for (const RunTimes& run : runs_) wall_ms.push_back(run.wall_ms);
            row.total = times_of(std::move(wall_ms));
            row.runs = runs_;
            if (!prepare_ms_.empty()) row.build = times_of(prepare_ms_);
            row.device_memory_bytes = statistics.device_memory_bytes;
            row.counts = statistics.counts;
            for (const StageStatistics& stage : statistics.stages)
                if (!stage.skipped.empty()) row.skipped.emplace_back(stage.name, stage.skipped);
            row.mask_hash = hash_of(std::span<const float>(mask));
            if (keeps_clusters()) row.camera = place_.time_camera(triangles_, seen_.c, {row.width, row.height});
        });
        row.failed = failed_;
        technique_.reset();
        return {std::move(row), std::move(mask)};
    }
    /// Device time of each stage, the median of a few runs; `place` must profile.
    std::vector<std::pair<std::string, double>> profile() {
        std::vector<Statistics> runs;
        warm_up();
        for (int run = 0; run < profiled_runs; ++run) guarded([&] { runs.push_back(run_once()); });
        technique_.reset();
        return failed_.empty() ? stage_times(runs) : std::vector<std::pair<std::string, double>>{};
    }
    bool has_failed() const { return !failed_.empty(); }
    std::uint32_t samples() const { return configuration_.samples; }

private:
    bool keeps_clusters() const { return configuration_.mode == "moving"; }
    // Thrice, since the first time compiles kernels and makes lists grow; of a very long one once must do.
    void prepare() {
        for (int i = 0; i < 3 && (i == 0 || prepare_ms_.back() < long_run_ms); ++i)
            prepare_ms_.push_back(time_ms([&] {
                if (keeps_clusters())
                    triangles_.keep_clusters(place_.device);
                else
                    technique_->prepare(triangles_, seen_.c.light);
                clFinish(place_.device.queue());
            }));
    }
    Statistics run_once() {
        Statistics statistics = configuration_.samples == 1
                                    ? technique_->run(triangles_, seen_.view.points, seen_.c.light, seen_.visibility)
                                    : run_samples(*technique_, place_.device, triangles_, seen_.view, seen_.c.light,
                                                  configuration_.samples, seen_.visibility);
        clFinish(place_.device.queue());
        return statistics;
    }
    template <typename Work>
    void guarded(Work&& work) {
        if (has_failed()) return;
        try {
            work();
        } catch (const Error& error) {
            failed_ = error.what();
        }
    }

    Configuration configuration_;
    const Place& place_;
    const Seen& seen_;
    Triangles triangles_;
    std::unique_ptr<Technique> technique_;
    std::vector<RunTimes> runs_;
    std::vector<double> prepare_ms_;
    std::string failed_;
};

/// What the masks of a view are measured against.
struct Runner::Truth {
    std::vector<float> mask;
    std::string hash;
    std::optional<OracleVerdict> oracle;
};

Runner::Runner(SceneShelf& shelf, RunOptions options, std::function<void(const Row&)> report)
    : shelf_(shelf), options_(std::move(options)), report_(std::move(report)) {}

void Runner::add(Row row, bool is_reported) {
    if (!is_reported) report_(row);
    rows_.push_back(std::move(row));
}

Runner::Seen Runner::look(const Place& place, const Block& block, const Case& c, Size size) const {
    const Times camera = place.time_camera(place.triangles, c, size);
    View view = gnomon::look(place.device, place.triangles, c.camera, size.width, size.height);
    ViewOnHost host = read(place.device, place.triangles, view);
    Row row;
    row.experiment = block.experiment;
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
    return {std::move(view), std::move(host), std::move(visibility), std::move(row), c};
}

Runner::Truth Runner::truth_of(const Block& block, const Place& place, const Seen& seen) const {
    make(truth_configuration(), place.device)->run(place.triangles, seen.view.points, seen.c.light, seen.visibility);
    Truth truth{seen.visibility.read(), {}, {}};
    truth.hash = hash_of(std::span<const float>(truth.mask));
    if (block.oracle_points != 0)
        truth.oracle =
            ask_oracle(place.scene, seen.host, seen.c.camera.eye, seen.c.light, truth.mask, block.oracle_points);
    return truth;
}

void Runner::judge(const Block& block, const Seen& seen, const Truth& truth, std::span<const float> mask, Row& row) {
    if (!row.failed.empty()) return;
    row.errors = measure::visibility_errors(mask, truth.mask, row.width, row.height);
    // The oracle was asked about these very bits.
    if (row.mask_hash == truth.hash) row.oracle = truth.oracle;
    if (!block.pictures) return;
    row.mask_picture = mask_picture(mask, seen.host.receiver, row.width, row.height);
    row.difference_picture = difference_picture(mask, truth.mask, row.width, row.height);
}

std::vector<Row> Runner::run_contestants(const Block& block, const Place& place, const Seen& seen,
                                         const std::optional<Truth>& truth) {
    std::vector<Contestant> contestants;
    for (const Configuration& configuration : configurations_of(block, {seen.row.width, seen.row.height}))
        contestants.emplace_back(configuration, place, seen);
    std::vector<Row> rows;
    const auto finish = [&](Contestant& contestant) {
        auto [row, mask] = contestant.finish();
        if (truth && contestant.samples() == 1) judge(block, seen, *truth, mask, row);
        if (!block.stages) report_(row);
        rows.push_back(std::move(row));
    };
    // Those that take turns share one clock.
    const std::size_t at_once = block.take_turns ? contestants.size() : 1;
    for (std::size_t first = 0; first < contestants.size(); first += at_once) {
        const std::span turn = std::span(contestants).subspan(first, at_once);
        for (Contestant& contestant : turn) contestant.warm_up();
        const Clock clock;
        for (int run = 0; options_.rule.goes_on(run, clock.elapsed_ms() / double(at_once)); ++run)
            for (Contestant& contestant : turn) contestant.run_timed();
        for (Contestant& contestant : turn) finish(contestant);
    }
    return rows;
}

void Runner::add_stages(const Block& block, const std::string& selector, const NamedScene& scene, const Case& c,
                        Size size, std::vector<Row>& rows) const {
    const Place place(selector, scene, true);
    const Seen seen = look(place, block, c, size);
    const std::vector<Configuration> configurations = configurations_of(block, size);
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i].failed.empty()) rows[i].stages = Contestant(configurations[i], place, seen).profile();
}

void Runner::add_peers(const Block& block, const Place& place, const Seen& seen, const std::optional<Truth>& truth) {
    std::uint32_t samples = 1;
    for (const Configuration& configuration : block.configurations) samples = std::max(samples, configuration.samples);
    ViewOnHost host_of_samples;
    std::vector<float> mean;
    if (samples != 1) {
        run_samples(*make(truth_configuration(), place.device), place.device, place.triangles, seen.view, seen.c.light,
                    samples, seen.visibility, [&](const Points& points) {
                        const PointsOnHost part = read(place.device, points);
                        std::ranges::copy(part.position, std::back_inserter(host_of_samples.position));
                        std::ranges::copy(part.receiver, std::back_inserter(host_of_samples.receiver));
                    });
        mean = seen.visibility.read();
    }
    const PeerTask task{place.scene.scene.triangles,
                        samples == 1 ? seen.host : host_of_samples,
                        seen.c.camera.eye,
                        seen.c.light,
                        seen.row.width,
                        seen.row.height,
                        samples,
                        options_.threads,
                        options_.rule};
    run_peers(task, [&](PeerResult&& result) {
        Row row = seen.row;
        row.technique = result.name;
        row.settings = std::move(result.settings);
        row.mode = std::move(result.mode);
        row.device = "CPU";
        row.driver = embree_version();
        row.camera.reset();
        row.total = result.total;
        row.build = result.build;
        row.device_memory_bytes = result.memory_bytes;
        row.mask_hash = hash_of(std::span<const float>(result.mask));
        if (samples != 1) {
            row.settings.push_back(samples_setting(samples));
            row.errors = measure::visibility_errors(result.mask, mean, row.width, row.height);
        } else if (truth) {
            judge(block, seen, *truth, result.mask, row);
        }
        add(std::move(row), false);
    });
}

void Runner::run_case(const Block& block, const NamedScene& scene, const Case& c, Size size) {
    std::optional<Truth> truth;  // of the first device: the answer is the same on every one
    for (const std::string& selector : options_.devices) {
        const bool is_first = selector == options_.devices.front();
        const Place place(selector, scene, false);
        const Seen seen = look(place, block, c, size);
        if (block.errors && is_first) truth = truth_of(block, place, seen);
        std::vector<Row> rows = run_contestants(block, place, seen, truth);
        if (block.stages) add_stages(block, selector, scene, c, size, rows);
        for (Row& row : rows) add(std::move(row), !block.stages);
        if (block.peers && is_first) add_peers(block, place, seen, truth);
    }
}

void Runner::run(const Block& block) {
    const NamedScene& scene = shelf_.get(block.scene);
    std::vector<std::string> seen;
    for (Case c : scene.cases) {
        if (block.light) {
            c.light_name = block.light->name;
            c.light = block.light->light;
        }
        if (block.view) {
            c.view = block.view->name;
            c.camera = block.view->camera;
        }
        const std::string name = c.view + "." + c.light_name;
        if (name.find(block.only) == std::string::npos || std::ranges::find(seen, name) != seen.end()) continue;
        seen.push_back(name);
        for (const Size size : block.sizes) run_case(block, scene, c, size);
    }
}

}  // namespace gnomon::bench
