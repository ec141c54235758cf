// SPDX-License-Identifier: MIT
#include "trace/light_order.hpp"

#include <algorithm>
#include <cmath>

#include "lists/morton.hpp"

namespace gnomon {
namespace {

constexpr std::uint32_t max_runs = 1024;

// Sorting pays from these on: measured on two cores with 5,000 to a million points and 100 to 1.3 million triangles,
// where it takes .31 to 1.0 of the time of the given order (docs/performance.md).
constexpr std::uint32_t min_points = 16384;
constexpr double min_run_in_bins = 2, min_run_beside_sorted = 2;

bool is_finite(const Rectangle& rectangle) {
    const glm::dvec2 size = rectangle.size();
    return std::isfinite(size.x) && std::isfinite(size.y) && size.x >= 0;
}

struct Sampled {
    Rectangle all{};
    double run_in_bins = 0;  ///< the mean of the runs' larger sides, in bins
};

Sampled sampled_from(const std::vector<std::array<float, 4>>& boxes, const LightFrame& frame) {
    Sampled made;
    std::vector<Rectangle> runs;
    for (const auto& [low_x, low_y, high_x, high_y] : boxes) {
        const Rectangle run{{low_x, low_y}, {high_x, high_y}};
        if (!is_finite(run)) continue;
        runs.push_back(run);
        made.all.add(run);
    }
    for (const Rectangle& run : runs) {
        const glm::dvec2 shares = run.size() / made.all.size();
        made.run_in_bins += std::max(shares.x, shares.y) * frame.bins_x;
    }
    made.run_in_bins /= double(std::max<std::size_t>(runs.size(), 1));
    return made;
}

}  // namespace

std::optional<PointInputs> LightOrder::sort(cl::Session& session, Statistics& statistics, SortPoints choice,
                                            const LightFrame& light_frame, const PointInputs& points) {
    const std::uint32_t count = points.layout.count;
    const bool is_auto = choice == SortPoints::automatic;
    if (choice == SortPoints::off || count < (is_auto ? min_points : LIGHT_ORDER_RUN)) return {};
    if (is_auto && !session.is_cpu()) return {};  // not measured on a GPU
    cl::StageTimer timer(session, statistics, "light_order");
    const std::uint32_t runs = std::min(max_runs, count / LIGHT_ORDER_RUN);
    LightOrderParams params{
        .points = points.layout,
        .light_frame = light_frame,
        .origin = {},
        .scale = {},
        .run_count = runs,
        .run_stride = count / LIGHT_ORDER_RUN / runs * LIGHT_ORDER_RUN,  // from the start of a block
        .padding = {}};
    boxes_.reserve(session, runs * 4 * sizeof(float));
    session.launch("trace/light_order.cl", "light_order_extents", cl::Range::items(runs), params, points.positions,
                   boxes_);
    const Sampled found = sampled_from(session.read_values<std::array<float, 4>>(boxes_.get(), runs), light_frame);
    if (!is_finite(found.all) || !(found.all.size().x > 0) || !(found.all.size().y > 0)) return {};
    const double sorted_run_in_bins = std::sqrt(double(LIGHT_ORDER_RUN) / count) * light_frame.bins_x;
    if (is_auto && !(found.run_in_bins > std::max(min_run_in_bins, min_run_beside_sorted * sorted_run_in_bins)))
        return {};
    for (int axis = 0; axis < 2; ++axis) {
        params.origin[axis] = static_cast<float>(found.all.low[axis]);
        params.scale[axis] = static_cast<float>((1u << LIGHT_ORDER_BITS) / found.all.size()[axis]);
    }
    try {
        return sorted(session, params, points);
    } catch (const OutOfDeviceMemory&) {
        if (!is_auto) throw;
        *this = {};
        return {};
    }
}

PointInputs LightOrder::sorted(cl::Session& session, const LightOrderParams& params, const PointInputs& points) {
    const std::uint32_t count = points.layout.count;
    const std::size_t words = count * sizeof(cl_uint);
    codes_.reserve(session, words);
    numbers_.reserve(session, words);
    session.launch("trace/light_order.cl", "light_order_codes", cl::Range::items(count), params, points.positions,
                   codes_, numbers_);
    sort_.run(session, count, codes_, numbers_, 2 * LIGHT_ORDER_BITS);
    positions_.reserve(session, 3 * words);
    receivers_.reserve(session, points.layout.has_receivers != 0 ? words : sizeof(cl_uint));
    visibility_.reserve(session, words);
    session.launch("trace/light_order.cl", "light_order_gather", cl::Range::items(count), params, points.positions,
                   points.receivers, numbers_, positions_, receivers_);
    PointInputs sorted = points;
    sorted.positions = positions_.get();
    sorted.receivers = receivers_.get();
    sorted.layout.first = 0;
    sorted.layout.point_stride = 3;
    sorted.layout.coordinate_stride = 1;
    return sorted;
}

void LightOrder::scatter(cl::Session& session, Statistics& statistics, std::size_t count, cl_mem visibility) const {
    const cl::StageTimer timer(session, statistics, "light_order");
    session.launch("trace/light_order.cl", "light_order_scatter", cl::Range::items(count), static_cast<cl_uint>(count),
                   visibility_, numbers_, visibility);
}

}  // namespace gnomon
