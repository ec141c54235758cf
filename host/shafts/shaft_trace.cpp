// SPDX-License-Identifier: MIT
#include "shafts/shaft_trace.hpp"

namespace gnomon {
namespace {

// Neighbouring parts are alike and distant ones are not: the shapes are compared for every few parts, on small pieces
// of the part that is next.
constexpr std::size_t parts_of_a_choice = 8;
// A sample is one of so many points, but on a GPU large enough to fill it: with 31,000 pairs in a piece, 64 lights on
// the sun's disk seemed to take five times as long as they do (H100, Sponza).
constexpr std::size_t sample_share = 64, rough_share = 512, pairs_of_gpu_piece = std::size_t(1) << 21;

}  // namespace

ShaftPasses::ShaftPasses(const TreeRun& run, const LightBundles& bundles, std::optional<ShaftShape> shape,
                         Statistics& statistics)
    : run_(run),
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
    const auto by_the_better = [&](std::size_t share) {
        const double blocks = sampled_ms(all, ShaftShape::block, share);
        const double points = sampled_ms(all, ShaftShape::point, share);
        return blocks < points ? Estimate{blocks, ShaftShape::block} : Estimate{points, ShaftShape::point};
    };
    if (session_.is_cpu())
        if (const Estimate rough = by_the_better(rough_share); rough.ms > 2 * limit_ms) return rough;
    Estimate estimate = by_the_better(sample_share);
    if (all.count > parts_of_a_choice * masks_.most_points()) estimate.shape.reset();
    return estimate;
}

void ShaftPasses::run() {
    const std::size_t count = run_.points.count();
    LightSums sums(run_, masks_.slots(), &run_.sorted);
    ShaftShape shape = shape_.value_or(ShaftShape::point);
    std::size_t index = 0;
    for (PointPart part{0, 0}; part.first < count; part.first += part.count) {
        part.count = std::min(masks_.most_points(), count - part.first);
        if (!shape_ && index++ % parts_of_a_choice == 0) shape = faster_shape(part);
        decide(part, shape);
        if (shape == ShaftShape::point) points_in_point_shafts_ += part.count;
        masks_.add_to(sums, part);
        report_progress(run_.options, double(part.first + part.count) / double(count));
    }
    sums.finish();
    masks_.describe(statistics_.counts);
    statistics_.counts.emplace_back("points_in_point_shafts", points_in_point_shafts_);
}

ShaftShape ShaftPasses::faster_shape(const PointPart& part) {
    if (part.count * run_.lights.count() < std::size_t(1) << 20) return ShaftShape::point;
    return sampled_ms(part, ShaftShape::block, sample_share) < sampled_ms(part, ShaftShape::point, sample_share)
               ? ShaftShape::block
               : ShaftShape::point;
}

// The time that a part may take, from pieces that are strewn over it.
double ShaftPasses::sampled_ms(const PointPart& part, ShaftShape shape, std::size_t share) {
    const std::size_t least = session_.is_cpu() ? 64 : pairs_of_gpu_piece / run_.lights.count() / 64 * 64 + 64;
    // The order of the points has stretches that face alike, so as many pieces as there are points for, on a CPU.
    const std::size_t wanted = part.count / share;
    const std::size_t pieces = session_.is_cpu() ? std::clamp<std::size_t>(wanted / least, 4, 32) : 4;
    const std::size_t piece = std::min(std::max(wanted / pieces / 64 * 64, least), masks_.most_points());
    double ms = 0, sampled = 0;
    for (std::size_t i = 0; i < pieces; ++i) {
        const std::size_t first = part.first + part.count * (2 * i + 1) / (2 * pieces);
        const PointPart strewn{first, std::min(piece, part.first + part.count - first)};
        ms += timed(strewn, shape);
        sampled += double(strewn.count);
    }
    return ms * double(part.count) / sampled;
}

double ShaftPasses::timed(const PointPart& part, ShaftShape shape) {
    session_.finish();
    const auto start = cl::Clock::now();
    decide(part, shape);
    session_.finish();
    return cl::ms_since(start);
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
