// SPDX-License-Identifier: MIT
#include "light_tables/light_masks.hpp"

#include "kernels/lights/light_sides.h"
#include "query/raster_triangles.hpp"

namespace gnomon {
namespace {

constexpr std::size_t first_queue = std::size_t(1) << 16;

}  // namespace

std::size_t max_mask_bytes(const cl::Session& session) {
    return session.is_cpu() ? std::size_t(1) << 25 : std::size_t(1) << 28;
}

LightMasks::LightMasks(const BvhRun& run, const LightBundles& bundles, Statistics& statistics, Before before)
    : run_(run), session_(session_of(run.device)), statistics_(statistics), before_(before) {
    queue_.reserve(session_, first_queue * sizeof(BeamPairs));
    set_bundles(bundles);
}

void LightMasks::set_bundles(const LightBundles& bundles) {
    slots_ = bundles.lights;
    bundle_count_ = static_cast<cl_uint>(bundles.bundles.size());
    are_positions_ = bundles.are_positions;
    queued_ = 0;
    std::ranges::fill(by_level_, 0);
    session_.upload(bundles_, bundles.bundles);
}

void LightMasks::reserve(std::size_t points) {
    constexpr std::size_t width = 64;
    const auto whole = [=](std::size_t count) { return std::max((count + width - 1) / width * width, width); };
    points = std::min(whole(points), whole(run_.points.count()));
    for (;; points = whole(points / 2)) {
        try {
            const std::size_t listed = session_.is_cpu() ? 0 : tasks_of(points);
            counters_.reserve(session_, sizeof(BeamCounters) + listed * sizeof(cl_uint));
            // The masks' buffer is enlarged last, since buffers never shrink.
            if (before_ != Before::nothing) lit_.reserve(session_, points * bytes_per_point());
            if (before_ == Before::horizons) begins_.reserve(session_, points * bytes_per_point());
            masks_.reserve(session_, points * bytes_per_point());
            max_points_ = points;
            return;
        } catch (const OutOfDeviceMemory&) {
            lit_ = {}, begins_ = {};
            if (points <= width) throw;
        }
    }
}

cl_uint LightMasks::side() const {
    if (run_.options.normals != nullptr) return SIDE_NORMALS;
    if (run_.points.receivers() == nullptr) return SIDE_NONE;
    if (run_.options.front) return SIDE_WINDING;
    return Internals::eye(run_.points) ? SIDE_EYE : SIDE_NONE;
}

void LightMasks::face(const PointPart& part) {
    const cl::StageTimer timer(session_, statistics_, "light_sides");
    const TriangleInputs triangles = implicit_inputs(run_.triangles);
    const LightSidesParams params{.triangles = triangles,
                                  .points = run_.sorted.part(part.first, part.count),
                                  .bundle_count = bundle_count_,
                                  .mask_stride = static_cast<cl_uint>(max_points_),
                                  .side = side(),
                                  .padding = 0};
    session_.launch(
        {"lights/light_sides.cl", "light_sides", {.point_lights = are_positions_, .raster = triangles.is_raster}},
        session_.blocks(part.count), params, bundles_, triangles.vertices, run_.sorted.positions(),
        run_.sorted.receivers(), run_.sorted.normals(), masks_);
}

void LightMasks::join(const PointPart& part) {
    if (before_ == Before::nothing) return;
    const cl::StageTimer timer(session_, statistics_, before_ == Before::sweeps ? "sweeps_join" : "horizons_join");
    LightSumsParams params{};
    params.point_count = static_cast<cl_uint>(part.count);
    params.bundle_count = bundle_count_;
    params.mask_stride = static_cast<cl_uint>(max_points_);
    session_.launch("lights/light_sums.cl", "light_join", cl::Range::items(part.count * bundle_count_), params, masks_,
                    lit_);
}

void LightMasks::add_to(LightSums& sums, const PointPart& part, std::uint32_t first_bundle) {
    cl::StageTimer timer(session_, statistics_, "light_sums");
    sums.add(masks_, max_points_, part.first, part.count, first_bundle, bundle_count_);
    session_.finish();
}

BeamParams LightMasks::params_of(const PointPart& part) const {
    const float factor = are_positions_ ? BEAM_ROUNDING_OF_POSITIONS : BEAM_ROUNDING;
    return {.triangles = implicit_inputs(run_.triangles),
            .points = run_.sorted.part(part.first, part.count),
            .bundle_count = bundle_count_,
            .mask_stride = static_cast<cl_uint>(max_points_),
            .queue_capacity = capacity(),
            .listed_tasks = 0,
            .rounding = factor * run_.largest_coordinate() + BEAM_ROUNDING_LEAST,
            .are_sectors = before_ == Before::horizons ? 1u : 0u,
            .are_packets = 0,
            .parts_of_task = 1};
}

void LightMasks::decide_queue(const PointPart& part) {
    const TriangleInputs triangles = implicit_inputs(run_.triangles);
    session_.launch(triangles.kernel_of_lights("light_tables/beam_trace.cl", "beam_exact", are_positions_),
                    cl::Range::items(capacity()), params_of(part), bundles_, triangles.vertices,
                    run_.sorted.positions(), queue_, masks_, counters_);
    const auto counted = session_.read_value<BeamCounters>(counters_);
    queued_ += counted.queued;
    for (int level = 0; level < 3; ++level) by_level_[level] += counted.by_level[level];
}

void LightMasks::describe(decltype(Statistics::counts)& counts) const {
    const bool is_first = counts.empty();
    if (is_first) counts = {{"points", run_.points.count()}, {"lights", run_.lights.count()}};
    const decltype(Statistics::counts) own = {{"bundles", bundle_count_},
                                              {"queued_pairs", queued_},
                                              {"decided_by_float", by_level_[0]},
                                              {"decided_by_double", by_level_[1]},
                                              {"decided_by_integers", by_level_[2]}};
    for (std::size_t i = 0; i < own.size(); ++i)
        is_first ? counts.push_back(own[i]) : void(counts[2 + i].second += own[i].second);
}

}  // namespace gnomon
