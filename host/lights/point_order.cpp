// SPDX-License-Identifier: MIT
#include "lights/point_order.hpp"

#include <algorithm>
#include <utility>

#include "kernels/lights/point_order.h"
#include "lights/many_lights.hpp"
#include "lists/morton.hpp"
#include "lists/sort.hpp"
#include "query/raster_triangles.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "lights/point_order.cl";

PointsLayout packed(PointsLayout layout) {
    layout.picture_width = 0;
    layout.point_stride = 3;
    layout.coordinate_stride = 1;
    return layout;
}

}  // namespace

struct SortedPoints::Inputs {
    cl::Session& session;
    PointInputs points;
    cl_mem vertices, normals;  ///< normals: any buffer if there are none
    PointOrderParams params{};
    cl::ProgramFlags flags{};  ///< of kernels that read triangles

    explicit Inputs(const LightsRun& run)
        : session(session_of(run.device)), points(point_inputs(run.points)), normals(run.options.normals) {
        const TriangleInputs triangles = implicit_inputs(run.triangles);
        flags.raster = triangles.is_raster && points.layout.has_receivers != 0;
        vertices = triangles.vertices;
        params.triangles = triangles;
        params.points = params.normals = points.layout;
        params.has_normals = normals != nullptr;
        if (normals == nullptr)
            normals = points.positions;
        else
            params.normals =
                point_inputs(Points::wrap(run.device, normals, run.options.normals_layout, run.points.count())).layout;
    }

    // Fits the grid to the present points. Returns the largest magnitude of a coordinate.
    float fit_grid() {
        cl::Buffer bounds(session, POINT_BOUNDS_WORDS * sizeof(cl_uint));
        const cl_uint none[POINT_BOUNDS_WORDS] = {GN_NO_ID, GN_NO_ID, GN_NO_ID, 0, 0, 0};
        session.write(bounds.get(), none, sizeof(none));
        session.launch(file, "point_bounds", cl::Range::items(points.layout.count), params, points.positions, bounds);
        const auto box = bounds_of_keys(session.read_values<cl_uint>(bounds.get(), POINT_BOUNDS_WORDS));
        if (!box) return 0;
        params.grid = morton_grid(*box, 2 * POINT_CODE_BITS);
        return box->largest();
    }
};

SortedPoints::SortedPoints(const LightsRun& run, SortedPoints earlier) : SortedPoints(std::move(earlier)) {
    Inputs in(run);
    layout_ = packed(in.points.layout);
    largest_coordinate_ = in.fit_grid();
    sort(in);
    gather(in);
}

SortedPoints SortedPoints::sample(std::size_t share, const LightsRun& run) const {
    Inputs in(run);
    SortedPoints some;
    some.layout_ = layout_;
    const std::size_t runs = std::max<std::size_t>(layout_.count / POINTS_OF_RUN / share, 1);
    some.layout_.count = static_cast<cl_uint>(std::min<std::size_t>(runs * POINTS_OF_RUN, layout_.count));
    some.largest_coordinate_ = largest_coordinate_;
    some.order_.reserve(in.session, some.layout_.count * sizeof(cl_uint));
    in.session.launch(file, "point_sample", cl::Range::items(some.layout_.count), some.layout_.count,
                      static_cast<cl_uint>(share), order_, some.order_);
    some.gather(in);
    return some;
}

void SortedPoints::gather(Inputs& in) {
    const std::size_t words = layout_.count * sizeof(cl_uint);
    // A block of lanes is read whole, also where it has fewer points.
    constexpr std::size_t room = 32 * sizeof(cl_uint);
    positions_.reserve(in.session, 3 * words + room);
    receivers_.reserve(in.session, in.points.layout.has_receivers != 0 ? words + room : 0);
    normals_.reserve(in.session, in.params.has_normals != 0 ? 3 * words + room : 0);
    surface_normals_.reserve(in.session, 3 * words + room);
    in.params.points.count = layout_.count;
    in.session.launch({file, "point_gather", in.flags}, cl::Range::items(layout_.count), in.params, in.vertices,
                      in.points.positions, in.points.receivers, in.normals, order_, positions_, receivers_, normals_,
                      surface_normals_);
}

void SortedPoints::sort(const Inputs& in) {
    cl::Session& session = in.session;
    const cl_uint count = in.points.layout.count;
    const std::size_t words = count * sizeof(cl_uint);
    order_.reserve(session, words);
    if (in.points.layout.picture_width != 0) {
        session.launch(file, "picture_order", cl::Range::items(count), in.params, order_);
        return;
    }
    cl::Buffer low(session, words), high(session, words), sorted_high(session, words);
    session.launch({file, "point_codes", in.flags}, cl::Range::items(count), in.params, in.vertices,
                   in.points.positions, in.points.receivers, in.normals, low, high, order_);
    Sort sort;
    // The sort keeps the order of equal keys. For few points the upper half is enough.
    if (count > 16u << 2 * POINT_CODE_BITS) {
        sort.run(session, count, low, order_, 3 * POINT_CODE_BITS);
        session.launch(file, "point_reorder", cl::Range::items(count), count, high, order_, sorted_high);
        std::swap(high, sorted_high);
    }
    sort.run(session, count, high, order_, 3 * POINT_CODE_BITS + POINT_AXIS_BITS);
}

Points SortedPoints::as_points(const Device& device, const Points& given) const {
    const bool has_receivers = given.receivers() != nullptr;
    return Internals::seen_from(
        Points::wrap(device, positions_.get(), {}, layout_.count, has_receivers ? receivers_.get() : nullptr),
        Internals::eye(given));
}

PointsLayout SortedPoints::part(std::size_t first, std::size_t count) const {
    PointsLayout layout = layout_;
    layout.first = static_cast<cl_uint>(3 * first);
    layout.count = static_cast<cl_uint>(count);
    return layout;
}

}  // namespace gnomon
