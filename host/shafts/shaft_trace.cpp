// SPDX-License-Identifier: MIT
// Stage shaft_trace: a run over many lights by shafts. Parts of the sorted points pass through facing (light_sides),
// the trace (shaft_trace or point_shaft_trace), the exact predicate and the sums, each part with all bundles of lights.
#include "shafts/shaft_trace.hpp"

#include <algorithm>

#include "api/statistics.hpp"
#include "kernels/lights/light_sides.h"
#include "kernels/shafts/shaft.h"

namespace gnomon {
namespace {

constexpr std::size_t first_queue = std::size_t(1) << 16;

struct Part {
    std::size_t first, count;
};

class ShaftPasses {
public:
    ShaftPasses(const ShaftRun& run, const LightBundles& bundles, Statistics& statistics)
        : run_(run),
          session_(session_of(run.device)),
          points_(run.sorted),
          statistics_(statistics),
          slots_(bundles.lights),
          bundle_count_(static_cast<cl_uint>(bundles.bundles.size())),
          bundles_(session_, bundle_count_ * sizeof(LightBundle)),
          counters_(session_, sizeof(ShaftCounters)) {
        session_.write(bundles_.get(), bundles.bundles.data(), bundle_count_ * sizeof(LightBundle));
        queue_.reserve(session_, first_queue * sizeof(ShaftPairs));
        part_points_ = reserve_masks();
        if (!run_.shape) build_kernels();
    }

    // The time that all points may take, by the better shape.
    double estimated_ms() {
        const Part all{0, run_.points.count()};
        return std::min(sampled_ms(all, ShaftShape::block), sampled_ms(all, ShaftShape::point));
    }

    void run() {
        const std::size_t count = run_.points.count();
        LightSums sums(run_, slots_, &points_);
        ShaftShape shape = run_.shape.value_or(ShaftShape::point);
        std::size_t index = 0;
        for (Part part{0, 0}; part.first < count; part.first += part.count) {
            part.count = std::min(part_points_, count - part.first);
            if (!run_.shape && index++ % parts_of_a_choice == 0) shape = faster_shape(part);
            decide(part, shape);
            if (shape == ShaftShape::point) points_in_point_shafts_ += part.count;
            cl::StageTimer timer(session_, statistics_, "light_sums");
            sums.add(masks_, part_points_, part.first, part.count, 0, bundle_count_);
            session_.finish();
            report_progress(run_.options, double(part.first + part.count) / double(count));
        }
        sums.finish();
        statistics_.counts = {{"points", count},
                              {"lights", run_.lights.count()},
                              {"bundles", bundle_count_},
                              {"points_in_point_shafts", points_in_point_shafts_},
                              {"queued_pairs", queued_},
                              {"decided_by_float", by_level_[0]},
                              {"decided_by_double", by_level_[1]},
                              {"decided_by_integers", by_level_[2]}};
    }

private:
    // Neighbouring parts are alike and distant ones are not: the shapes are compared for every few parts, on small
    // pieces of the part that is next.
    static constexpr std::size_t parts_of_a_choice = 8, pieces = 4, sample_of_part = 32;

    ShaftShape faster_shape(const Part& part) {
        if (part.count * run_.lights.count() < std::size_t(1) << 20) return ShaftShape::point;
        return sampled_ms(part, ShaftShape::block) < sampled_ms(part, ShaftShape::point) ? ShaftShape::block
                                                                                         : ShaftShape::point;
    }

    // The time that a part may take, from pieces that are strewn over it.
    double sampled_ms(const Part& part, ShaftShape shape) {
        const std::size_t piece =
            std::clamp<std::size_t>(part.count / (pieces * sample_of_part) / 64 * 64, 64, part_points_);
        double ms = 0, sampled = 0;
        for (std::size_t i = 0; i < pieces; ++i) {
            const std::size_t first = part.first + part.count * (2 * i + 1) / (2 * pieces);
            const Part strewn{first, std::min(piece, part.first + part.count - first)};
            ms += timed(strewn, shape);
            sampled += double(strewn.count);
        }
        return ms * double(part.count) / sampled;
    }

    // Masks for the points of a part: as many pairs as take some tenths of a second. At the end of each part a GPU
    // waits for the work-groups that have most to do (Sponza, 2^26 pairs a part: 1.7 G pairs/s in place of 4.2).
    std::size_t reserve_masks() {
        const std::size_t pairs = session_.is_cpu() ? std::size_t(1) << 24 : std::size_t(1) << 30;
        const std::size_t most_bytes = session_.is_cpu() ? std::size_t(1) << 25 : std::size_t(1) << 28;
        const std::size_t width = 64, per_point = bundle_count_ * sizeof(cl_uint);
        std::size_t points = std::max(std::min(pairs / run_.lights.count(), most_bytes / per_point), width);
        points = std::min((points + width - 1) / width, (run_.points.count() + width - 1) / width) * width;
        for (;; points = (points / 2 + width - 1) / width * width) {
            try {
                masks_.reserve(session_, points * per_point);
                return points;
            } catch (const OutOfDeviceMemory&) {
                if (points <= width) throw;
            }
        }
    }

    // So that no part's time holds that of a build.
    void build_kernels() {
        for (const ShaftShape shape : {ShaftShape::block, ShaftShape::point})
            decide({0, std::min<std::size_t>(run_.points.count(), 64)}, shape);
    }

    double timed(const Part& part, ShaftShape shape) {
        session_.finish();
        const auto start = cl::Clock::now();
        decide(part, shape);
        session_.finish();
        return cl::ms_since(start);
    }

    // The masks of a part of the points.
    void decide(const Part& part, ShaftShape shape) {
        cl::StageTimer timer(session_, statistics_, "light_sides");
        decide_sides(part);
        timer.next(shape == ShaftShape::point ? "point_shaft_trace" : "shaft_trace");
        ShaftCounters counted;
        while (counted = trace(part, shape), counted.queued > capacity())
            queue_.reserve(session_, std::size_t(counted.queued) * 5 / 4 * sizeof(ShaftPairs));
        timer.next("shaft_exact");
        if (counted.queued != 0) decide_queue(part);
    }

    cl_uint side() const {
        if (run_.options.normals != nullptr) return SIDE_NORMALS;
        if (run_.points.receivers() == nullptr) return SIDE_NONE;
        if (run_.options.front) return SIDE_WINDING;
        return run_.points.eye() ? SIDE_EYE : SIDE_NONE;
    }

    void decide_sides(const Part& part) {
        const TriangleInputs triangles = triangle_inputs(run_.triangles);
        const LightSidesParams params{.triangles = triangles,
                                      .points = points_.part(part.first, part.count),
                                      .bundle_count = bundle_count_,
                                      .mask_stride = static_cast<cl_uint>(part_points_),
                                      .side = side(),
                                      .padding = 0};
        session_.launch("lights/light_sides.cl", "light_sides", session_.blocks(part.count), params, bundles_,
                        triangles.vertices, points_.positions(), points_.receivers(), points_.normals(), masks_);
    }

    cl_uint capacity() const { return static_cast<cl_uint>(queue_.bytes() / sizeof(ShaftPairs)); }

    ShaftParams params_of(const Part& part) const {
        return {.triangles = triangle_inputs(run_.triangles),
                .points = points_.part(part.first, part.count),
                .bundle_count = bundle_count_,
                .mask_stride = static_cast<cl_uint>(part_points_),
                .queue_capacity = capacity(),
                .rounding = rounding()};
    }

    ShaftCounters trace(const Part& part, ShaftShape shape) {
        session_.fill(counters_, 0, sizeof(ShaftCounters));
        const bool is_of_point = shape == ShaftShape::point;
        const std::size_t width = shaft_width(session_), blocks = (part.count + width - 1) / width;
        const std::size_t tasks = blocks * bundle_count_;
        const cl::Range range = session_.is_cpu() ? session_.uneven_items(tasks, 1)
                                                  : cl::Range::groups_of(width, std::min<std::size_t>(tasks, 65536));
        const TriangleInputs triangles = triangle_inputs(run_.triangles);
        session_.launch(is_of_point ? triangles.kernel("shafts/point_shaft_trace.cl", "point_shaft_trace")
                                    : triangles.kernel("shafts/shaft_trace.cl", "shaft_trace"),
                        range, params_of(part), bundles_, run_.tree.nodes(), run_.tree.leaves(), run_.tree.ids(),
                        points_.positions(), points_.receivers(), points_.surface_normals(), masks_, queue_, counters_,
                        cl::LocalBytes{(is_of_point ? POINT_SHAFT_LOCAL_WORDS : SHAFT_LOCAL_WORDS) * sizeof(cl_uint)});
        return session_.read_value<ShaftCounters>(counters_);
    }

    void decide_queue(const Part& part) {
        const TriangleInputs triangles = triangle_inputs(run_.triangles);
        session_.launch(triangles.kernel("shafts/shaft_trace.cl", "shaft_exact"), cl::Range::items(capacity()),
                        params_of(part), bundles_, triangles.vertices, points_.positions(), queue_, masks_, counters_);
        const auto counted = session_.read_value<ShaftCounters>(counters_);
        queued_ += counted.queued;
        for (int level = 0; level < 3; ++level) by_level_[level] += counted.by_level[level];
    }

    // n . X rounds five times, for a triangle and for a point; the sum of sizes is at most 3 times the largest.
    float rounding() const {
        return 4e-6f * std::max(run_.tree.largest_coordinate(), points_.largest_coordinate()) + 1e-30f;
    }

    const ShaftRun& run_;
    cl::Session& session_;
    const SortedPoints& points_;
    Statistics& statistics_;
    std::span<const std::uint32_t> slots_;
    cl_uint bundle_count_;
    cl::Buffer bundles_, counters_, queue_, masks_;
    std::size_t part_points_ = 0;
    std::uint64_t points_in_point_shafts_ = 0, queued_ = 0, by_level_[3] = {};
};

}  // namespace

bool run_shafts(const ShaftRun& run, Statistics& statistics) {
    if (!(std::max(run.tree.largest_coordinate(), run.sorted.largest_coordinate()) <= SHAFT_LARGEST_COORDINATE))
        return false;
    const auto bundles = make_light_bundles(run.lights.lights(), run.bundle_lights);
    if (!bundles) return false;
    ShaftPasses passes(run, *bundles, statistics);
    if (run.one_light_ms && passes.estimated_ms() > *run.one_light_ms * double(run.lights.count())) return false;
    passes.run();
    merge_stages(statistics);
    return true;
}

}  // namespace gnomon
