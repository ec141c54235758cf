// SPDX-License-Identifier: MIT
#include "shafts/shaft_trace.hpp"

#include <limits>

namespace gnomon {
namespace {

// A sample has so many points, but no more than one in its share, nor fewer than are worth measuring.
constexpr std::size_t fewest_points = 256, rough_points = 1024, rough_share = 512, sample_points = 4096,
                      sample_share = 64;
// A GPU needs so many work-groups: with fewer, the longest one is what takes the time.
constexpr std::size_t groups_of_sample = std::size_t(1) << 14, least_share_on_gpu = 4;

}  // namespace

ShaftPasses::ShaftPasses(const TreeRun& run, const LightBundles& bundles, Statistics& statistics)
    : run_(run), session_(session_of(run.device)), statistics_(statistics), masks_(run, bundles, statistics) {
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
    masks_.trace(part, shape == ShaftShape::point ? "point_shaft_trace" : "shaft_trace", [&] { launch(part, shape); });
}

void ShaftPasses::launch(const PointPart& part, ShaftShape shape) {
    const std::size_t width = shaft_width(session_), blocks = (part.count + width - 1) / width;
    const TriangleInputs triangles = triangle_inputs(run_.triangles);
    const SortedPoints& points = run_.sorted;
    session_.launch(shape == ShaftShape::point ? triangles.kernel("shafts/point_shaft_trace.cl", "point_shaft_trace")
                                               : triangles.kernel("shafts/shaft_trace.cl", "shaft_trace"),
                    shaft_range(session_, blocks * masks_.bundle_count()), masks_.params_of(part), masks_.bundles(),
                    run_.tree.nodes(), run_.tree.leaves(), run_.tree.ids(), points.positions(), points.receivers(),
                    points.surface_normals(), masks_.masks(), masks_.queue(), masks_.counters(),
                    cl::LocalBytes{SHAFT_LOCAL_WORDS * sizeof(cl_uint)});
}

ShaftEstimate estimated_shafts(const TreeRun& run, const LightBundles& bundles, double limit_ms,
                               Statistics& statistics) {
    const cl::Session& session = session_of(run.device);
    const std::size_t count = run.points.count();
    const auto sampled_ms = [&](std::size_t share, std::span<const ShaftShape> shapes) {
        const SampledRun sample(run, {0, count}, std::max<std::size_t>(share, 1));
        ShaftPasses passes(sample.run(), bundles, statistics);
        ShaftEstimate least{std::numeric_limits<double>::infinity(), shapes.front()};
        for (const ShaftShape shape : shapes) {
            const double ms = passes.timed_ms(shape) * double(count) / double(sample.count());
            if (ms < least.ms) least = {ms, shape};
        }
        return least;
    };
    constexpr ShaftShape blocks[] = {ShaftShape::block}, both[] = {ShaftShape::block, ShaftShape::point};
    if (!session.is_cpu()) {
        const std::size_t groups = count / shaft_width(session) * bundles.bundles.size();
        return sampled_ms(std::clamp(groups / groups_of_sample, least_share_on_gpu, sample_share), both);
    }
    const auto share_of = [&](std::size_t points, std::size_t share) {
        return std::min(std::max(count / points, share), count / fewest_points);
    };
    const ShaftEstimate rough = sampled_ms(share_of(rough_points, rough_share), blocks);
    if (rough.ms > 2 * limit_ms) return rough;
    return sampled_ms(share_of(sample_points, sample_share), blocks);
}

}  // namespace gnomon
