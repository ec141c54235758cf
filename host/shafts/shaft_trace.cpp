// SPDX-License-Identifier: MIT
#include "shafts/shaft_trace.hpp"

#include <limits>

namespace gnomon {
namespace {

// The points that a way is measured on: so many, but no more than one in `share`, nor fewer than are worth a measure.
struct SampleSize {
    std::size_t points, share;

    std::size_t share_of(std::size_t count) const {
        constexpr std::size_t fewest_points = 256;
        return std::clamp<std::size_t>(count / fewest_points, 1, std::max(count / points, share));
    }
};
constexpr SampleSize rough_sample{1024, 512}, sample{4096, 64}, sample_of_parts{256, 128};
// A GPU needs so many work-groups: with fewer, the longest one is what takes the time.
constexpr std::size_t groups_of_sample = std::size_t(1) << 14, least_share_on_gpu = 4, most_share_on_gpu = 64;

// Neighbouring parts are alike and distant ones are not: on a CPU, where no shape takes so many times the other's time,
// the shapes are compared for every few parts.
constexpr std::size_t parts_of_a_choice = 8;
constexpr double clearly_faster = 1.3;

}  // namespace

ShaftPasses::ShaftPasses(const TreeRun& run, const LightBundles& bundles, std::optional<ShaftShape> shape,
                         Statistics& statistics)
    : run_(run),
      light_bundles_(bundles),
      session_(session_of(run.device)),
      statistics_(statistics),
      shape_(shape),
      masks_(run, bundles, statistics) {
    // As many pairs as take some tenths of a second. At the end of each part a GPU waits for the work-groups that have
    // most to do (Sponza, 2^26 pairs a part: 1.7 G pairs/s in place of 4.2).
    const std::size_t pairs = session_.is_cpu() ? std::size_t(1) << 24 : std::size_t(1) << 30;
    masks_.reserve(std::min(pairs / run_.lights.count(), most_mask_bytes(session_) / masks_.bytes_per_point()));
    if (shape_) return;
    // So that no part's time holds that of a build.
    for (const ShaftShape each : {ShaftShape::block, ShaftShape::point})
        decide({0, std::min<std::size_t>(run_.points.count(), 64)}, each);
}

ShaftPasses::Estimate ShaftPasses::estimate(double limit_ms) {
    const PointPart all{0, run_.points.count()};
    if (!session_.is_cpu()) {
        const std::size_t groups = all.count / shaft_width(session_) * masks_.bundle_count();
        const Faster faster =
            faster_shape(all, std::clamp(groups / groups_of_sample, least_share_on_gpu, most_share_on_gpu));
        return {faster.ms, faster.shape};
    }
    const Faster rough = faster_shape(all, rough_sample.share_of(all.count));
    if (rough.ms > 2 * limit_ms) return {rough.ms, rough.shape};
    const Faster faster = faster_shape(all, sample.share_of(all.count));
    return {faster.ms, faster.is_clear ? std::optional(faster.shape) : std::nullopt};
}

void ShaftPasses::run() {
    const std::size_t count = run_.points.count();
    LightSums sums(run_, masks_.slots(), &run_.sorted);
    ShaftShape shape = shape_.value_or(ShaftShape::point);
    std::size_t index = 0;
    for (PointPart part{0, 0}; part.first < count; part.first += part.count) {
        part.count = std::min(masks_.most_points(), count - part.first);
        if (!shape_ && index++ % parts_of_a_choice == 0) {
            const std::size_t next = std::min(parts_of_a_choice * masks_.most_points(), count - part.first);
            shape = faster_shape({part.first, next}, sample_of_parts.share_of(next)).shape;
        }
        decide(part, shape);
        if (shape == ShaftShape::point) points_in_point_shafts_ += part.count;
        masks_.add_to(sums, part);
        report_progress(run_.options, double(part.first + part.count) / double(count));
    }
    sums.finish();
    masks_.describe(statistics_.counts);
    statistics_.counts.emplace_back("points_in_point_shafts", points_in_point_shafts_);
}

// By a sample of a part of the points.
ShaftPasses::Faster ShaftPasses::faster_shape(const PointPart& part, std::size_t share) {
    const SampledRun sampled(run_, part, share);
    ShaftPasses passes(sampled.run(), light_bundles_, ShaftShape::point, statistics_);
    const double whole = double(part.count) / double(sampled.count());
    const double points_ms = passes.timed(ShaftShape::point, std::numeric_limits<double>::infinity());
    const double blocks_ms = passes.timed(ShaftShape::block, clearly_faster * points_ms);
    const double faster = std::min(points_ms, blocks_ms), slower = std::max(points_ms, blocks_ms);
    return {points_ms <= blocks_ms ? ShaftShape::point : ShaftShape::block, faster * whole,
            slower > clearly_faster * faster};
}

// The time that all points take, or some time above `limit_ms` if they take longer.
double ShaftPasses::timed(ShaftShape shape, double limit_ms) {
    const std::size_t count = run_.points.count();
    const std::size_t most = session_.is_cpu() ? (count / 8 / POINTS_OF_RUN + 1) * POINTS_OF_RUN : count;
    session_.finish();
    const auto start = cl::Clock::now();
    double ms = 0;
    for (PointPart part{0, 0}; part.first < count && ms <= limit_ms; part.first += part.count) {
        part.count = std::min({most, masks_.most_points(), count - part.first});
        decide(part, shape);
        session_.finish();
        ms = cl::ms_since(start);
    }
    return ms;
}

// The masks of a part of the points.
void ShaftPasses::decide(const PointPart& part, ShaftShape shape) {
    masks_.face(part);
    masks_.trace(part, shape == ShaftShape::point ? "point_shaft_trace" : "shaft_trace", [&] { launch(part, shape); });
}

void ShaftPasses::launch(const PointPart& part, ShaftShape shape) {
    const bool is_of_point = shape == ShaftShape::point;
    const std::size_t width = shaft_width(session_), blocks = (part.count + width - 1) / width;
    const TriangleInputs triangles = triangle_inputs(run_.triangles);
    const SortedPoints& points = run_.sorted;
    session_.launch(is_of_point ? triangles.kernel("shafts/point_shaft_trace.cl", "point_shaft_trace")
                                : triangles.kernel("shafts/shaft_trace.cl", "shaft_trace"),
                    shaft_range(session_, blocks * masks_.bundle_count()), masks_.params_of(part), masks_.bundles(),
                    run_.tree.nodes(), run_.tree.leaves(), run_.tree.ids(), points.positions(), points.receivers(),
                    points.surface_normals(), masks_.masks(), masks_.queue(), masks_.counters(),
                    cl::LocalBytes{(is_of_point ? POINT_SHAFT_LOCAL_WORDS : SHAFT_LOCAL_WORDS) * sizeof(cl_uint)});
}

}  // namespace gnomon
