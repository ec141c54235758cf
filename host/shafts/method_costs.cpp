// SPDX-License-Identifier: MIT
#include "shafts/method_costs.hpp"

namespace gnomon {
namespace {

constexpr const LightsTuning& tuning = lights_tuning;

/// The same run over every share-th run of neighbouring points. It writes no outputs.
class SampledRun {
public:
    SampledRun(const TableRun& whole, std::size_t share)
        : sorted_(sampled_points(whole, whole.sorted, share)),
          points_(sorted_.as_points(whole.device, whole.points)),
          run_{{{whole.device, whole.triangles, points_, whole.lights, whole.outputs, whole.options},
                sorted_,
                whole.tree},
               whole.given,
               whole.bundles,
               whole.one_light,
               whole.statistics,
               whole.field} {}
    const TableRun& run() const { return run_; }
    std::size_t count() const { return points_.count(); }

private:
    SortedPoints sorted_;
    Points points_;
    TableRun run_;
};

std::size_t share_of_cpu_sample(std::size_t points) {
    const std::size_t share = std::max(points / tuning.cpu_sample_points, tuning.cpu_sample_share);
    return std::max<std::size_t>(std::min(share, points / tuning.cpu_min_sample_points), 1);
}

/// Some bundles of a table.
LightBundles sampled_bundles(const LightBundles& all, std::size_t most) {
    LightBundles sample;
    sample.are_positions = all.are_positions;
    const std::size_t count = all.bundles.size(), some = std::min(count, most);
    for (std::size_t k = 0; k < some; ++k) {
        const std::size_t bundle = k * count / some;
        sample.add(all.bundles[bundle],
                   std::span(all.lights).subspan(bundle * MOST_BUNDLE_LIGHTS, all.bundles[bundle].light_count));
    }
    return sample;
}

double measured_on_cpu_ms(const TableRun& run, LightsMethod method) {
    const SampledRun sample(run, share_of_cpu_sample(run.points.count()));
    const double points_per_sample = double(run.points.count()) / double(sample.count());
    if (method != LightsMethod::rays) return passes_of(sample.run(), method).timed_ms() * points_per_sample;
    const LightBundles bundles = sampled_bundles(run.bundles.plain(), tuning.cpu_sample_bundles);
    return ShaftPasses(sample.run(), bundles, ShaftShape::packet, run.statistics).timed_ms() * points_per_sample *
           double(run.lights.count()) / double(bundles.light_count());
}

// A sample's longest work-groups take much of its time on a GPU, so what more points take is the difference of two
// samples. (They differ: a run that is measured has 2^14 points or more.)
double measured_on_gpu_ms(const TableRun& run, LightsMethod method) {
    const std::size_t share = run.points.camera() ? tuning.gpu_picture_share : tuning.gpu_points_share;
    const SampledRun small(run, share * tuning.gpu_launch_share), large(run, share);
    const auto warm_ms = [&](const TableRun& sample) {
        ShaftPasses passes = passes_of(sample, method);
        passes.timed_ms();  // first launches load kernels, and the queue grows
        return passes.timed_ms();
    };
    const double small_ms = warm_ms(small.run()), large_ms = warm_ms(large.run());
    return large_ms + std::max(large_ms - small_ms, 0.0) / double(large.count() - small.count()) *
                          double(run.points.count() - large.count());
}

}  // namespace

ShaftPasses passes_of(const TableRun& run, LightsMethod method) {
    switch (method) {
        case LightsMethod::rays:
            return {run, run.bundles.plain(), ShaftShape::packet, run.statistics};
        case LightsMethod::horizons:
            return {run, run.bundles.sectors(run.field->field().axis), ShaftShape::point, run.statistics, run.field};
        case LightsMethod::point_shafts:
            return {run, run.bundles.coned(), ShaftShape::point, run.statistics};
        default:
            return {run, run.bundles.coned(), ShaftShape::block, run.statistics};
    }
}

double measured_ms(const TableRun& run, LightsMethod method) {
    try {
        if (method == LightsMethod::one_by_one)
            return time_of_one_light(run.one_light, run, run.order_of_one_light()) * double(run.lights.count());
        return session_of(run.device).is_cpu() ? measured_on_cpu_ms(run, method) : measured_on_gpu_ms(run, method);
    } catch (const OutOfDeviceMemory&) {
        return LightsCosts::infinite;
    }
}

}  // namespace gnomon
