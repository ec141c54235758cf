// SPDX-License-Identifier: MIT
#include "runner.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <numbers>

#include "peers.hpp"
#include "reference/view.hpp"
#include "support/scene_masks.hpp"

namespace gnomon::bench {

namespace {

std::vector<Configuration> configurations_of(const Block& block, Size size) {
    std::vector<Configuration> configurations = block.configurations;
    if (block.more_settings)
        for (Configuration& configuration : configurations)
            for (auto& setting : block.more_settings(size)) configuration.settings.push_back(setting);
    return configurations;
}

// Some pixels' points, asked of the oracle in one go.
struct AskedPoints {
    std::vector<float> positions;
    std::vector<std::uint32_t> receivers;
    std::vector<std::size_t> pixels;  ///< of each point

    // Every k-th pixel's point, k as small as `most` pixels allow; not the sky's.
    void add(std::span<const float> position, std::span<const std::uint32_t> receiver, std::uint64_t most) {
        const std::size_t step = (receiver.size() + most - 1) / most;
        for (std::size_t i = 0; i < receiver.size(); i += step) {
            if (receiver[i] == no_receiver) continue;
            positions.insert(positions.end(), &position[3 * i], &position[3 * i] + 3);
            receivers.push_back(receiver[i]);
            pixels.push_back(i);
        }
    }
};

// The answers of the independent oracle: how many of each pixel's points are in shadow. Pixels without a point have
// none.
std::map<std::size_t, std::uint32_t> shadowed_by_oracle(const NamedScene& scene, const Case& c,
                                                        const AskedPoints& points) {
    const bool has_cut_outs = !scene.scene.cut_outs.empty();
    const reference::Masks masks = support::masks_of(scene.scene);
    const std::vector<std::uint8_t> shadowed =
        reference::shadowed(scene.scene.triangles, points.positions, points.receivers, c.light.xyzw, c.camera.eye,
                            nullptr, has_cut_outs ? &masks : nullptr);
    std::map<std::size_t, std::uint32_t> counts;
    for (std::size_t k = 0; k < shadowed.size(); ++k) counts[points.pixels[k]] += shadowed[k];
    return counts;
}

// The mask of the exact technique against the oracle. A sample without a point is lit, so the points in shadow are all
// that a pixel's mean lacks; it has no rounding.
OracleVerdict judged_by_oracle(const NamedScene& scene, const Case& c, const AskedPoints& points,
                               std::span<const float> mask, std::uint32_t samples) {
    OracleVerdict verdict;
    for (const auto& [pixel, shadowed] : shadowed_by_oracle(scene, c, points)) {
        ++verdict.points;
        verdict.wrong += mask[pixel] != float(samples - shadowed) / float(samples);
    }
    return verdict;
}

// Receivers and points of about `most` pixels, and of their samples, against the camera's own promises.
void judge_camera(const NamedScene& scene, const Seen& seen, const PointsOnHost& of_samples, std::uint32_t samples,
                  std::uint64_t most, OracleVerdict& verdict) {
    const bool has_cut_outs = !scene.scene.cut_outs.empty();
    const reference::Masks masks = support::masks_of(scene.scene);
    const Camera& ours = seen.c.camera;
    reference::PinholeCamera camera;
    camera.eye = ours.eye;
    camera.axes = {ours.right, ours.up, ours.forward};
    camera.fov_y_degrees = ours.fov_y_radians * 180 / std::numbers::pi;
    camera.width = seen.row.width;
    camera.height = seen.row.height;
    const reference::ViewReport report = reference::judge_view(
        scene.scene.triangles, camera, std::nullopt,
        {seen.host.position, {}, seen.host.receiver, {}, samples, of_samples.position, of_samples.receiver},
        {.camera_sample = most, .masks = has_cut_outs ? &masks : nullptr});
    verdict.rays = report.camera_pixels + report.samples_judged;
    verdict.wrong_rays = report.wrong();
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

/// What the masks of a view are measured against.
struct Runner::Truth {
    std::vector<float> mask;
    std::string hash;
    std::optional<OracleVerdict> oracle;
};

struct Runner::Entry {
    std::unique_ptr<Contestant> contestant;
    bool takes_turns = false;
    const Configuration* configuration = nullptr;  ///< null: a rival
    Row row;                                       ///< once it is finished
};

Runner::Runner(SceneShelf& shelf, RunOptions options, std::function<void(const Row&)> report)
    : shelf_(shelf), options_(std::move(options)), report_(std::move(report)) {}

Seen Runner::look(const Place& place, const Block& block, const Case& c, Size size) const {
    if (block.sun_angle_degrees && !c.light.is_directional())
        throw InvalidArgument("a sun's disk takes a directional light, and " + c.light_name + " is a point light");
    Seen seen = seen_in(place, c, size);
    seen.row.experiment = block.experiment;
    seen.sun_angle_degrees = block.sun_angle_degrees;
    return seen;
}

Runner::Truth Runner::truth_of(const Block& block, const Place& place, const Seen& seen) const {
    const auto technique = make(truth_configuration(), place.device);
    if (block.sun_angle_degrees)
        run_mean(*technique, place.triangles, seen.view.points, seen.sun(block.configurations.front()),
                 seen.visibility);
    else
        technique->run(place.triangles, seen.view.points, seen.c.light, seen.visibility);
    Truth truth{seen.visibility.read(), {}, {}};
    truth.hash = hash_of(std::span<const float>(truth.mask));
    if (block.oracle_points != 0) {
        AskedPoints points;
        points.add(seen.host.position, seen.host.receiver, block.oracle_points);
        truth.oracle = judged_by_oracle(place.scene, seen.c, points, truth.mask, 1);
        judge_camera(place.scene, seen, {}, 1, block.oracle_points, *truth.oracle);
    }
    return truth;
}

// Of several samples per pixel: each sample is a point of its own, as the camera made it.
OracleVerdict Runner::judge_samples(const Block& block, const Place& place, const Seen& seen, std::uint32_t samples,
                                    std::span<const float> mean) const {
    AskedPoints points;
    PointsOnHost all;
    const auto technique = make(truth_configuration(), place.device);
    run_samples(*technique, place.triangles, seen.view, seen.c.light, samples, seen.visibility,
                [&](const Points& of_samples) {
                    const PointsOnHost host = of_samples.read(place.device);
                    const std::size_t pixels = mean.size();
                    all.position.insert(all.position.end(), host.position.begin(), host.position.end());
                    all.receiver.insert(all.receiver.end(), host.receiver.begin(), host.receiver.end());
                    for (std::size_t first = 0; first < host.receiver.size(); first += pixels)
                        points.add(std::span(host.position).subspan(3 * first, 3 * pixels),
                                   std::span(host.receiver).subspan(first, pixels), block.oracle_points);
                });
    OracleVerdict verdict = judged_by_oracle(place.scene, seen.c, points, mean, samples);
    judge_camera(place.scene, seen, all, samples, block.oracle_points, verdict);
    return verdict;
}

void Runner::judge(const Block& block, const Seen& seen, const Truth& truth, std::span<const float> mask, Row& row) {
    if (!row.failed.empty()) return;
    row.errors = measure::visibility_errors(mask, truth.mask, row.width, row.height);
    // The oracle was asked about these very bits.
    if (row.mask_hash == truth.hash) row.oracle = truth.oracle;
    if (block.pictures) row.picture = reduced_mask(mask, truth.mask, seen.host.receiver, row.width, row.height);
}

void Runner::finish(const Block& block, const Place& place, const Seen& seen, const std::optional<Truth>& truth,
                    Entry& entry, std::map<std::uint32_t, std::vector<float>>& means) {
    const std::uint32_t samples = entry.contestant->samples();
    auto [row, mask] = entry.contestant->finish();
    const bool is_rival = entry.configuration == nullptr;
    if (samples == 1) {
        if (truth) judge(block, seen, *truth, mask, row);
    } else if (!is_rival && row.exact && row.failed.empty()) {
        if (block.oracle_points != 0) row.oracle = judge_samples(block, place, seen, samples, mask);
        means.try_emplace(samples, std::move(mask));
    } else if (is_rival && row.failed.empty() && means.contains(samples)) {
        row.errors = measure::visibility_errors(mask, means.at(samples), row.width, row.height);
    }
    if (!block.stages || is_rival) report_(row);
    entry.row = std::move(row);
}

void Runner::run_entries(const Block& block, const Place& place, const Seen& seen, const std::optional<Truth>& truth,
                         std::vector<Entry>& entries) {
    std::map<std::uint32_t, std::vector<float>> means;  // exact, by samples per pixel
    // Those that take turns share one clock, and come first; the others run alone.
    std::ranges::stable_partition(entries, &Entry::takes_turns);
    for (std::size_t first = 0; first < entries.size();) {
        const auto in_turn = static_cast<std::size_t>(std::ranges::count_if(entries, &Entry::takes_turns));
        const std::span turn = std::span(entries).subspan(first, first < in_turn ? in_turn : 1);
        for (Entry& entry : turn) entry.contestant->warm_up();
        const Clock clock;
        for (int run = 0; options_.rule.goes_on(run, clock.elapsed_ms() / double(turn.size())); ++run)
            for (Entry& entry : turn) entry.contestant->run_timed();
        for (Entry& entry : turn) {
            finish(block, place, seen, truth, entry, means);
            entry.contestant.reset();
        }
        first += turn.size();
    }
}

std::vector<Runner::Entry> Runner::entries_of(const Block& block, const Place& place, const Seen& seen,
                                              std::span<const Configuration> configurations, bool has_peers) const {
    std::vector<Entry> entries;
    std::uint32_t samples = 1;
    for (const Configuration& configuration : configurations) {
        samples = std::max(samples, configuration.samples);
        entries.push_back({std::make_unique<OwnContestant>(configuration, place, seen, block.frames),
                           block.take_turns,
                           &configuration,
                           {}});
    }
    if (!has_peers) return entries;
    for (Peer& peer : make_peers({place, seen, samples, options_.threads, block.errors}))
        entries.push_back({std::move(peer.contestant), block.take_turns && peer.takes_turns, nullptr, {}});
    return entries;
}

void Runner::run_case(const Block& block, const NamedScene& scene, const Case& c, Size size) {
    std::optional<Truth> truth;  // of the first device: the answer is the same on every one
    for (const std::string& selector : options_.devices) {
        const bool is_first = selector == options_.devices.front();
        const std::vector<Configuration> configurations = configurations_of(block, size);
        std::vector<Entry> entries;
        {
            const Place place(selector, scene, false);
            const Seen seen = look(place, block, c, size);
            if (block.errors && is_first) truth = truth_of(block, place, seen);
            entries = entries_of(block, place, seen, configurations, block.peers && is_first);
            run_entries(block, place, seen, truth, entries);
        }
        if (block.stages) add_stages(block, selector, scene, c, size, entries);
        // gnomon's rows before the rivals', in the order of the configurations.
        std::ranges::stable_partition(entries, [](const Entry& entry) { return entry.configuration != nullptr; });
        for (Entry& entry : entries) rows_.push_back(std::move(entry.row));
    }
}

void Runner::add_stages(const Block& block, const std::string& selector, const NamedScene& scene, const Case& c,
                        Size size, std::vector<Entry>& entries) const {
    const Place place(selector, scene, true);
    const Seen seen = look(place, block, c, size);
    for (Entry& entry : entries) {
        if (entry.configuration == nullptr) continue;
        if (entry.row.failed.empty())
            entry.row.stages = OwnContestant(*entry.configuration, place, seen, false).profile();
        report_(entry.row);
    }
}

// All take turns, since a machine's speed drifts.
void Runner::run_many_lights(const Block& block, const NamedScene& scene) {
    for (const std::string& selector : options_.devices) {
        const Place place(selector, scene, false);
        const LightsQuestion question(place, *block.many_lights);
        std::vector<std::unique_ptr<LightsContestant>> contestants;
        const bool is_height_field = is_terrain_scene(scene);
        const std::vector<Configuration> configurations =
            block.many_lights->every_way ? many_lights_configurations(question.lights.count(), is_height_field)
                                         : block.configurations;
        for (const Configuration& configuration : configurations)
            contestants.push_back(make_own_contestant(question, place, configuration));
        if (is_height_field && question.are_vertices() && !block.many_lights->every_way)
            for (const Configuration& configuration : configurations)
                contestants.push_back(make_raster_contestant(question, place, configuration));
        if (block.peers && selector == options_.devices.front())
            std::ranges::move(make_light_peers(question, options_.threads), std::back_inserter(contestants));
        for (Row& row : run_contestants(question, contestants, options_.rule)) {
            row.experiment = block.experiment;
            report_(row);
            rows_.push_back(std::move(row));
        }
    }
}

void Runner::run(const Block& block) {
    const NamedScene& scene = shelf_.get(block.scene);
    if (block.many_lights) return run_many_lights(block, scene);
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
