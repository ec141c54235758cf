// SPDX-License-Identifier: MIT
#include "light_tables/beam_trace.hpp"

#include "query/raster_triangles.hpp"

namespace gnomon {
namespace {

const char* kernel_of(BeamShape shape) { return shape == BeamShape::point ? "point_beam_trace" : "beam_trace"; }

LightMasks::Before before_of(const DecidedBefore& before) {
    if (before.sweeps != nullptr) return LightMasks::Before::sweeps;
    return before.field != nullptr ? LightMasks::Before::horizons : LightMasks::Before::nothing;
}

const char* stage_of(BeamShape shape) { return shape == BeamShape::packet ? "ray_packets" : kernel_of(shape); }

}  // namespace

BeamPasses::BeamPasses(const BvhRun& run, const LightBundles& bundles, BeamShape shape, Statistics& statistics,
                       const DecidedBefore& before)
    : run_(run),
      session_(session_of(run.device)),
      shape_(shape),
      statistics_(statistics),
      masks_(run, bundles, statistics, before_of(before)),
      sweeps_(before.sweeps) {
    if (before.field != nullptr) horizons_.emplace(run, run.sorted, *before.field, bundles, statistics);
    reserve_masks(bundles);
}

void BeamPasses::set_bundles(const LightBundles& bundles) {
    masks_.set_bundles(bundles);
    reserve_masks(bundles);
}

void BeamPasses::reserve_masks(const LightBundles& bundles) {
    // A part's pairs take some tenths of a second. At the end of each part a GPU waits for its slowest work-groups: in
    // Sponza, parts of 2^26 pairs made 1.7 G pairs/s in place of 4.2.
    const std::size_t pairs = session_.is_cpu() ? std::size_t(1) << 24 : std::size_t(1) << 30;
    masks_.reserve(std::min(pairs / bundles.light_count(), max_mask_bytes(session_) / masks_.bytes_per_point()));
}

void BeamPasses::run() {
    LightSums sums(run_, masks_.slots(), &run_.sorted);
    run_into(sums, 0, 0, 1);
    sums.finish();
}

void BeamPasses::run_into(LightSums& sums, std::uint32_t first_bundle, double done, double share) {
    const std::size_t count = run_.points.count();
    for (PointPart part{0, 0}; part.first < count; part.first += part.count) {
        part.count = std::min(masks_.max_points(), count - part.first);
        decide(part);
        masks_.add_to(sums, part, first_bundle);
        report_progress(run_.options, done + share * double(part.first + part.count) / double(count));
    }
    masks_.describe(statistics_.counts);
}

double BeamPasses::timed_ms() {
    const std::size_t count = run_.points.count();
    const double builds_ms = session_.build_ms();
    session_.finish();
    const auto start = cl::Clock::now();
    for (PointPart part{0, 0}; part.first < count; part.first += part.count) {
        part.count = std::min(masks_.max_points(), count - part.first);
        decide(part);
    }
    session_.finish();
    return cl::ms_since(start) - (session_.build_ms() - builds_ms);
}

// Makes the masks of a part of the points.
void BeamPasses::decide(const PointPart& part) {
    masks_.face(part);
    const PointsLayout points = run_.sorted.part(part.first, part.count);
    if (horizons_) horizons_->decide(points, masks_.for_horizons());
    if (sweeps_ != nullptr) sweeps_->decide(points, masks_.for_horizons());
    masks_.trace(part, stage_of(shape_), [&] { launch(part); });
    masks_.join(part);
}

void BeamPasses::launch(const BeamParams& params, std::size_t tasks, const char* kernel) {
    const TriangleInputs triangles = implicit_inputs(run_.triangles);
    const SortedPoints& points = run_.sorted;
    const std::string file = "light_tables/" + std::string(kernel) + ".cl";
    session_.launch(triangles.kernel_of_lights(file.c_str(), kernel, masks_.are_positions()),
                    bvh_range(session_, tasks, run_.tree.max_groups()), params, masks_.bundles(), run_.tree.nodes(),
                    run_.tree.leaves(), triangles.is_raster ? triangles.vertices : run_.tree.ids().get(),
                    points.positions(), points.receivers(),
                    horizons_ ? masks_.for_horizons().begins : points.surface_normals(), masks_.masks(), masks_.queue(),
                    masks_.counters(), cl::LocalBytes{BEAM_LOCAL_WORDS * sizeof(cl_uint)});
}

// On a GPU a second launch traces the tasks that blocks gave up.
void BeamPasses::launch(const PointPart& part) {
    const bool is_cpu = session_.is_cpu();
    const std::size_t tasks = masks_.tasks_of(part.count);
    BeamParams params = masks_.params_of(part);
    params.are_packets = shape_ == BeamShape::packet ? 1u : 0u;
    // Some points take much longer than others. After sweeps most tasks have no open pair.
    params.parts_of_task = is_cpu || sweeps_ != nullptr ? 1u : 4u;
    launch(params, shape_ == BeamShape::point ? tasks * params.parts_of_task : tasks, kernel_of(shape_));
    if (is_cpu || shape_ != BeamShape::block) return;
    params.listed_tasks = session_.read_value<BeamCounters>(masks_.counters()).left_to_points;
    if (params.listed_tasks != 0)
        launch(params, std::size_t(params.listed_tasks) * params.parts_of_task, kernel_of(BeamShape::point));
}

}  // namespace gnomon
