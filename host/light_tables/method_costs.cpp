// SPDX-License-Identifier: MIT
#include "light_tables/method_costs.hpp"

#include <algorithm>
#include <memory>
#include <vector>

namespace gnomon {
namespace {

constexpr const LightsTuning& tuning = lights_tuning;

/// A run like `run` over every share-th sequence of neighbouring points. It writes no outputs.
class SampledRun {
public:
    SampledRun(const BvhRun& whole, std::size_t share)
        : sorted_(whole.sorted.sample(share, whole)),
          points_(sorted_.as_points(whole.device, whole.points)),
          run_{{whole.device, whole.triangles, points_, whole.lights, whole.outputs, whole.options},
               sorted_,
               whole.tree} {}
    const BvhRun& run() const { return run_; }
    std::size_t count() const { return points_.count(); }

private:
    SortedPoints sorted_;
    Points points_;
    BvhRun run_;
};

const LightBundles& bundles_of(LightsMethod method, const TableRun& table) {
    if (method == LightsMethod::rays) return table.bundles.plain();
    if (method == LightsMethod::horizons) return table.bundles.sectors(table.field->field().axis);
    return table.bundles.coned();
}

/// One point in how many a CPU measures under these bundles.
std::size_t share_of_cpu_sample(std::size_t points, std::size_t bundles) {
    const std::size_t share = tuning.cpu_sample_share * std::min(bundles, tuning.cpu_sample_bundles) / bundles;
    return std::max<std::size_t>(
        std::min(std::max(points / tuning.cpu_sample_points, share), points / tuning.cpu_min_sample_points), 1);
}

/// At most `most` bundles of a table, from its whole length.
LightBundles sampled_bundles(const LightBundles& all, std::size_t most) {
    LightBundles sample;
    sample.are_positions = all.are_positions;
    const std::size_t count = all.bundles.size(), some = std::min(count, most);
    for (std::size_t k = 0; k < some; ++k) {
        const LightBundle& bundle = all.bundles[k * count / some];
        sample.add(bundle, std::span(all.lights).subspan(k * count / some * MAX_BUNDLE_LIGHTS, bundle.light_count));
    }
    return sample;
}

// The methods are timed on the same points and bundles, by turns: what else the machine does meets all of them, and the
// least of some times hardly any. A driver builds or loads a kernel at its first launch, and not all tell how long that
// took, so a pass over a few points comes first.
void measure_on_cpu(std::span<const LightsMethod> methods, const TableRun& table, LightsCosts& costs) {
    const std::size_t points = table.run.points.count();
    const SampledRun few(table.run, points);
    const SampledRun sample(table.run, share_of_cpu_sample(points, table.bundles.plain().bundles.size()));
    struct Sampled {
        LightsMethod method;
        double share;
        std::unique_ptr<BeamPasses> passes;
    };
    std::vector<Sampled> all;
    for (const LightsMethod method : methods)
        if_there_is_memory([&] {
            if (method == LightsMethod::one_by_one) return;
            const LightBundles some = sampled_bundles(bundles_of(method, table), tuning.cpu_sample_bundles);
            const double share =
                double(sample.count() * some.light_count()) / double(points * table.run.lights.count());
            passes_of(method, table, few.run(), &some).timed_ms();
            all.push_back({method, share,
                           std::unique_ptr<BeamPasses>(new BeamPasses(passes_of(method, table, sample.run(), &some)))});
        });
    for (std::size_t round = 0; round < tuning.cpu_sample_rounds; ++round)
        for (const Sampled& one : all)
            if_there_is_memory(
                [&] { costs[one.method] = std::min(costs[one.method], one.passes->timed_ms() / one.share); });
}

// On a GPU the slowest work-groups take much of a sample's time, so the time of more points is the difference of two
// samples. (Their sizes differ, since a measured run has 2^14 points or more.)
double measured_on_gpu_ms(LightsMethod method, const TableRun& table) {
    const std::size_t points = table.run.points.count();
    const std::size_t share = table.run.points.camera() ? tuning.gpu_picture_share : tuning.gpu_points_share;
    const SampledRun small(table.run, share * tuning.gpu_launch_share), large(table.run, share);
    const auto warm_ms = [&](const BvhRun& sample) {
        BeamPasses passes = passes_of(method, table, sample);
        passes.timed_ms();  // a first pass, not timed, loads the kernels and enlarges the queue
        return passes.timed_ms();
    };
    const double small_ms = warm_ms(small.run()), large_ms = warm_ms(large.run());
    return large_ms +
           std::max(large_ms - small_ms, 0.0) / double(large.count() - small.count()) * double(points - large.count());
}

/// The time in which the table's middle light is decided for all points, without the time of kernel builds.
double one_light_ms(const TableRun& table) {
    const LightsRun& run = table.run;
    cl::Session& session = session_of(run.device);
    const SortedPoints* sorted = table.order_of_one_light();
    const Points ordered = sorted != nullptr ? sorted->as_points(run.device, run.points) : run.points;
    const Visibility visibility(run.device, run.points.count());
    const Light& middle = run.lights.lights()[run.lights.count() / 2];
    const auto timed_ms = [&] {
        const double builds_ms = session.kernel_builds().ms;
        return Internals::run_light(table.one_light, run.triangles, ordered, middle, visibility).total_wall_ms -
               (session.kernel_builds().ms - builds_ms);
    };
    const double first_ms = timed_ms();
    if (session.is_cpu()) return first_ms;
    // On a GPU the first run takes many times as long as the next ones, since it allocates buffers and enlarges lists.
    // The next runs are short, so other work on the machine easily disturbs them.
    const double warm_ms = timed_ms();
    return run.lights.count() < tuning.gpu_lights_timed_thrice ? warm_ms : std::min({warm_ms, timed_ms(), timed_ms()});
}

}  // namespace

BeamPasses passes_of(LightsMethod method, const TableRun& table, const BvhRun& run, const LightBundles* some) {
    const bool has_field = method == LightsMethod::horizons;
    const bool are_points = method == LightsMethod::point_beams || has_field;
    const BeamShape shape = method == LightsMethod::rays ? BeamShape::packet
                            : are_points                 ? BeamShape::point
                                                         : BeamShape::block;
    const DecidedBefore before{.field = has_field ? table.field : nullptr};
    return {run, some != nullptr ? *some : bundles_of(method, table), shape, table.statistics, before};
}

// Of the answers that sweeps keep at a time. A GPU waits at the end of each launch for its longest strips.
std::size_t max_answer_bytes(const cl::Session& session) {
    return session.is_cpu() ? std::size_t(1) << 26 : max_mask_bytes(session);
}

void run_sweeps(const TableRun& table) {
    const cl::Session& session = session_of(table.run.device);
    const LightBundles& all = session.is_cpu() ? table.bundles.plain() : table.bundles.coned();
    const BeamShape shape = session.is_cpu() ? BeamShape::packet : BeamShape::point;
    LightSums sums(table.run, all.lights, &table.run.sorted);
    const std::size_t room = max_answer_bytes(session) / Sweeps::bytes_of_light(*table.raster, session);
    Sweeps sweeps(table.run, *table.raster, table.at, table.statistics);
    std::optional<BeamPasses> passes;
    for (std::size_t first = 0, end = 0; first < all.bundles.size(); first = end) {
        LightBundles group;
        while (end < all.bundles.size() &&
               (end == first || group.light_count() + all.bundles[end].light_count <= room)) {
            const LightBundle& bundle = all.bundles[end];
            group.add(bundle, std::span(all.lights).subspan(end++ * MAX_BUNDLE_LIGHTS, bundle.light_count));
        }
        sweeps.sweep(group);
        if (passes)
            passes->set_bundles(group);
        else
            passes.emplace(table.run, group, shape, table.statistics, DecidedBefore{.sweeps = &sweeps});
        const auto count = double(all.bundles.size());
        passes->run_into(sums, static_cast<std::uint32_t>(first), double(first) / count, double(end - first) / count);
    }
    sums.finish();
}

LightsCosts measured_costs(std::span<const LightsMethod> methods, const TableRun& table) {
    LightsCosts costs;
    const bool is_cpu = session_of(table.run.device).is_cpu();
    for (const LightsMethod method : methods)
        if_there_is_memory([&] {
            if (method == LightsMethod::one_by_one)
                costs[method] = one_light_ms(table) * double(table.run.lights.count());
            else if (!is_cpu)
                costs[method] = measured_on_gpu_ms(method, table);
        });
    if (is_cpu && !methods.empty()) if_there_is_memory([&] { measure_on_cpu(methods, table, costs); });
    return costs;
}

}  // namespace gnomon
