// SPDX-License-Identifier: MIT
#include "shafts/shaft_trace.hpp"

namespace gnomon {
namespace {

// A sample on a CPU has so many points, but no more than one in so many, nor fewer than are worth measuring.
constexpr std::size_t sample_points = 16384, sample_share = 32, fewest_points = 512;
// Packets are measured on so many bundles at most.
constexpr std::size_t bundles_of_sample = 8;
// On a GPU one point in so many is measured, and, for what a launch takes beside its work, one in so many times as
// many. Points of a picture are more, and more alike: of a million points on a town's faces one in 128 does not fill an
// H100, and seemed to take more than twice the time.
constexpr std::size_t share_of_picture = 128, share_of_points = 16, launch_share = 8;

// A sample's longest work-groups take much of its time on a GPU, so what more points take is the difference of two
// samples. (They differ: a run that is measured has 2^14 points or more.)
double estimated_on_gpu_ms(const TreeRun& run, const LightBundles& bundles, Statistics& statistics) {
    const std::size_t share = run.points.camera() ? share_of_picture : share_of_points;
    const SampledRun few(run, share * launch_share), more(run, share);
    const auto warm_ms = [&](const TreeRun& sample) {
        ShaftPasses passes(sample, bundles, statistics);
        passes.timed_ms(ShaftShape::block);  // first launches load kernels, and the queue grows
        return passes.timed_ms(ShaftShape::block);
    };
    const double few_ms = warm_ms(few.run()), more_ms = warm_ms(more.run());
    return more_ms + std::max(more_ms - few_ms, 0.0) / double(more.count() - few.count()) *
                         double(run.points.count() - more.count());
}

}  // namespace

static const char* kernel_of(ShaftShape shape) {
    return shape == ShaftShape::point ? "point_shaft_trace" : "shaft_trace";
}

static const char* stage_of(ShaftShape shape) { return shape == ShaftShape::packet ? "ray_packets" : kernel_of(shape); }

ShaftPasses::ShaftPasses(const TreeRun& run, const LightBundles& bundles, Statistics& statistics,
                         const BuiltHeightField* field)
    : run_(run),
      session_(session_of(run.device)),
      statistics_(statistics),
      masks_(run, bundles, statistics, field != nullptr) {
    if (field != nullptr) horizons_.emplace(run, run.sorted, *field, bundles, statistics);
    // As many pairs as take some tenths of a second. At the end of each part a GPU waits for the work-groups that have
    // most to do (Sponza, 2^26 pairs a part: 1.7 G pairs/s in place of 4.2).
    const std::size_t pairs = session_.is_cpu() ? std::size_t(1) << 24 : std::size_t(1) << 30;
    masks_.reserve(std::min(pairs / run_.lights.count(), most_mask_bytes(session_) / masks_.bytes_per_point()));
}

void ShaftPasses::run(ShaftShape shape) {
    const std::size_t count = run_.points.count();
    LightSums sums(run_, masks_.slots(), &run_.sorted);
    for (PointPart part{0, 0}; part.first < count; part.first += part.count) {
        part.count = std::min(masks_.most_points(), count - part.first);
        decide(part, shape);
        masks_.add_to(sums, part);
        report_progress(run_.options, double(part.first + part.count) / double(count));
    }
    sums.finish();
    masks_.describe(statistics_.counts);
}

double ShaftPasses::timed_ms(ShaftShape shape) {
    const std::size_t count = run_.points.count();
    const double builds_ms = session_.build_ms();
    session_.finish();
    const auto start = cl::Clock::now();
    for (PointPart part{0, 0}; part.first < count; part.first += part.count) {
        part.count = std::min(masks_.most_points(), count - part.first);
        decide(part, shape);
    }
    session_.finish();
    return cl::ms_since(start) - (session_.build_ms() - builds_ms);
}

// The masks of a part of the points.
void ShaftPasses::decide(const PointPart& part, ShaftShape shape) {
    masks_.face(part);
    const PointsLayout points = run_.sorted.part(part.first, part.count);
    if (horizons_) horizons_->decide(points, masks_.for_horizons());
    masks_.trace(part, stage_of(shape), [&] { launch(part, shape); });
    if (horizons_) horizons_->join(points, masks_.for_horizons());
}

void ShaftPasses::launch(const ShaftParams& params, std::size_t tasks, const char* kernel) {
    const TriangleInputs triangles = triangle_inputs(run_.triangles);
    const SortedPoints& points = run_.sorted;
    const std::string file = "shafts/" + std::string(kernel) + ".cl";
    session_.launch(triangles.kernel_of_lights(file.c_str(), kernel, masks_.are_positions()),
                    shaft_range(session_, tasks), params, masks_.bundles(), run_.tree.nodes(), run_.tree.leaves(),
                    run_.tree.ids(), points.positions(), points.receivers(),
                    horizons_ ? masks_.for_horizons().begins : points.surface_normals(), masks_.masks(), masks_.queue(),
                    masks_.counters(), cl::LocalBytes{SHAFT_LOCAL_WORDS * sizeof(cl_uint)});
}

// On a GPU the tasks that blocks gave up follow.
void ShaftPasses::launch(const PointPart& part, ShaftShape shape) {
    const bool is_cpu = session_.is_cpu();
    const std::size_t tasks = masks_.tasks_of(part.count), groups_of_points = is_cpu ? 1 : POINT_GROUPS_ON_GPU;
    ShaftParams params = masks_.params_of(part);
    params.are_packets = shape == ShaftShape::packet ? 1u : 0u;
    launch(params, shape == ShaftShape::point ? tasks * groups_of_points : tasks, kernel_of(shape));
    if (is_cpu || shape != ShaftShape::block) return;
    params.listed_tasks = session_.read_value<ShaftCounters>(masks_.counters()).left_to_points;
    if (params.listed_tasks != 0) launch(params, params.listed_tasks * groups_of_points, kernel_of(ShaftShape::point));
}

// One point in so many on a CPU, and no fewer than are worth measuring.
static std::size_t share_of_sample(std::size_t count) {
    return std::max<std::size_t>(std::min(std::max(count / sample_points, sample_share), count / fewest_points), 1);
}

static double estimated_on_cpu_ms(const TreeRun& run, const LightBundles& bundles, ShaftShape shape,
                                  const BuiltHeightField* field, Statistics& statistics) {
    const std::size_t count = run.points.count();
    const SampledRun sample(run, share_of_sample(count));
    return ShaftPasses(sample.run(), bundles, statistics, field).timed_ms(shape) * double(count) /
           double(sample.count());
}

double estimated_shafts_ms(const TreeRun& run, const LightBundles& bundles, Statistics& statistics) {
    if (!session_of(run.device).is_cpu()) return estimated_on_gpu_ms(run, bundles, statistics);
    return estimated_on_cpu_ms(run, bundles, ShaftShape::block, nullptr, statistics);
}

double estimated_horizons_ms(const TreeRun& run, const LightBundles& sectors, const BuiltHeightField& field,
                             Statistics& statistics) {
    return estimated_on_cpu_ms(run, sectors, ShaftShape::point, &field, statistics);
}

double estimated_packets_ms(const TreeRun& run, const LightBundles& plain, Statistics& statistics) {
    // A bundle's lights share what they read, so the sample has whole bundles.
    std::vector<std::uint32_t> lights;
    const std::size_t bundles = plain.bundles.size(), some = std::min(bundles, bundles_of_sample);
    for (std::size_t k = 0; k < some; ++k) {
        const std::size_t bundle = k * bundles / some;
        const auto first = plain.lights.begin() + std::ptrdiff_t(bundle * MOST_BUNDLE_LIGHTS);
        lights.insert(lights.end(), first, first + plain.bundles[bundle].light_count);
    }
    const SampledRun sample(run, share_of_sample(run.points.count()), lights);
    const auto of_sample = make_plain_bundles(sample.run().lights.lights());
    const double ms = ShaftPasses(sample.run(), *of_sample, statistics).timed_ms(ShaftShape::packet);
    return ms * double(run.points.count()) / double(sample.count()) * double(run.lights.count()) /
           double(lights.size());
}

}  // namespace gnomon
