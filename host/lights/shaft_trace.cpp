// SPDX-License-Identifier: MIT
// Stage shaft_trace: a run over many lights by shafts. Parts of the sorted points pass through facing (light_sides),
// the trace (shaft_trace or fan_trace), the exact predicate and the sums, each part with all bundles of lights.
#include <algorithm>
#include <array>
#include <limits>

#include "api/statistics.hpp"
#include "kernels/lights/light_sides.h"
#include "kernels/lights/shaft.h"
#include "lights/many_lights.hpp"

namespace gnomon {
namespace {

constexpr std::size_t first_queue = std::size_t(1) << 16;

struct Part {
    std::size_t first, count;
};

// Which shape the next part gets: the one that took less time per point where each was tried last. The other is tried
// again after some parts, the sooner the less it lost, since neighbouring parts are alike and distant ones are not.
class ShapeChoice {
public:
    explicit ShapeChoice(std::optional<ShaftShape> only) : only_(only) {}

    ShaftShape next() {
        if (only_) return *only_;
        for (std::size_t shape = 0; shape < 2; ++shape)
            if (!ms_per_point_[shape]) return ShaftShape(shape);
        const std::size_t best = *ms_per_point_[0] <= *ms_per_point_[1] ? 0 : 1;
        const double loss = *ms_per_point_[1 - best] / *ms_per_point_[best];
        const unsigned wait = loss < 1.5 ? 8 : loss < 4 ? 32 : 128;
        if (++parts_since_other_ < wait) return ShaftShape(best);
        parts_since_other_ = 0;
        return ShaftShape(1 - best);
    }
    void took(ShaftShape shape, double ms_per_point) { ms_per_point_[std::size_t(shape)] = ms_per_point; }

private:
    std::optional<ShaftShape> only_;
    std::array<std::optional<double>, 2> ms_per_point_{};
    unsigned parts_since_other_ = 0;
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
    }

    // The time that all points may take, from a part in their middle, by the better shape.
    double estimated_ms() {
        constexpr std::size_t pairs = std::size_t(1) << 22;
        const std::size_t count = run_.points.count();
        const std::size_t sample =
            std::min({count, part_points_, std::max<std::size_t>(pairs / run_.lights.count(), 512)});
        const Part middle{(count - sample) / 2, sample};
        double least = std::numeric_limits<double>::infinity();
        for (const ShaftShape shape : {ShaftShape::block, ShaftShape::fan})
            if (!run_.shape || run_.shape == shape) least = std::min(least, timed(middle, shape));
        return least * (double(count) / double(sample));
    }

    void run() {
        const std::size_t count = run_.points.count();
        LightSums sums(run_, slots_, &points_);
        ShapeChoice choice(run_.shape);
        if (!run_.shape) build_kernels();
        for (std::size_t first = 0; first < count; first += part_points_) {
            const Part part{first, std::min(part_points_, count - first)};
            const ShaftShape shape = choice.next();
            choice.took(shape, timed(part, shape) / double(part.count));
            if (shape == ShaftShape::fan) points_in_fans_ += part.count;
            cl::StageTimer timer(session_, statistics_, "light_sums");
            sums.add(masks_, part_points_, part.first, part.count, 0, bundle_count_);
            session_.finish();
            report_progress(run_.options, double(part.first + part.count) / double(count));
        }
        sums.finish();
        statistics_.counts = {{"points", count},
                              {"lights", run_.lights.count()},
                              {"bundles", bundle_count_},
                              {"points_in_fans", points_in_fans_},
                              {"queued_pairs", queued_},
                              {"decided_by_float", by_level_[0]},
                              {"decided_by_double", by_level_[1]},
                              {"decided_by_integers", by_level_[2]}};
    }

private:
    // Masks for the points of a part: as many pairs as take some tenths of a second on a CPU, some ms on a GPU.
    std::size_t reserve_masks() {
        const std::size_t pairs = session_.is_cpu() ? std::size_t(1) << 22 : std::size_t(1) << 26;
        const std::size_t width = 64, per_point = bundle_count_ * sizeof(cl_uint);
        std::size_t points = std::max(pairs / run_.lights.count(), width);
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
        for (const ShaftShape shape : {ShaftShape::block, ShaftShape::fan})
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
        timer.next(shape == ShaftShape::fan ? "fan_trace" : "shaft_trace");
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
        const bool is_fan = shape == ShaftShape::fan;
        const std::size_t width = shaft_width(session_), blocks = (part.count + width - 1) / width;
        const std::size_t tasks = blocks * bundle_count_;
        const cl::Range range = session_.is_cpu() ? session_.uneven_items(tasks, 1)
                                                  : cl::Range::groups_of(width, std::min<std::size_t>(tasks, 65536));
        const TriangleInputs triangles = triangle_inputs(run_.triangles);
        session_.launch(is_fan ? triangles.kernel("lights/fan_trace.cl", "fan_trace")
                               : triangles.kernel("lights/shaft_trace.cl", "shaft_trace"),
                        range, params_of(part), bundles_, run_.tree.nodes(), run_.tree.leaves(), run_.tree.ids(),
                        points_.positions(), points_.receivers(), points_.surface_normals(), masks_, queue_, counters_,
                        cl::LocalBytes{(is_fan ? FAN_LOCAL_WORDS : SHAFT_LOCAL_WORDS) * sizeof(cl_uint)});
        return session_.read_value<ShaftCounters>(counters_);
    }

    void decide_queue(const Part& part) {
        const TriangleInputs triangles = triangle_inputs(run_.triangles);
        session_.launch(triangles.kernel("lights/shaft_trace.cl", "shaft_exact"), cl::Range::items(capacity()),
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
    std::uint64_t points_in_fans_ = 0, queued_ = 0, by_level_[3] = {};
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
