// SPDX-License-Identifier: MIT
#include "lights/point_order.hpp"

#include <algorithm>
#include <utility>

#include "kernels/lights/point_order.h"
#include "lists/morton.hpp"
#include "lists/sort.hpp"

namespace gnomon {
namespace {

// Fits the grid to the present points. Returns the largest magnitude of a coordinate.
float fit_grid(cl::Session& session, PointOrderParams& params, const PointInputs& points) {
    cl::Buffer bounds(session, POINT_BOUNDS_WORDS * sizeof(cl_uint));
    const cl_uint none[POINT_BOUNDS_WORDS] = {GN_NO_ID, GN_NO_ID, GN_NO_ID, 0, 0, 0};
    session.write(bounds.get(), none, sizeof(none));
    session.launch("lights/point_order.cl", "point_bounds", cl::Range::items(points.layout.count), params,
                   points.positions, bounds);
    const auto keys = session.read_values<cl_uint>(bounds.get(), POINT_BOUNDS_WORDS);
    const auto box = bounds_of_keys(keys);
    if (!box) return 0;
    params.grid = morton_grid(box->low, box->high, 2 * POINT_CODE_BITS);
    return box->largest();
}

PointsLayout packed(PointsLayout layout) {
    layout.picture_width = 0;
    layout.point_stride = 3;
    layout.coordinate_stride = 1;
    return layout;
}

PointOrderParams params_of(const Device& device, const TriangleInputs& triangles, const Points& points, cl_mem normals,
                           const PointLayout& normals_at) {
    PointOrderParams params{};
    params.triangles = triangles;
    params.points = params.normals = point_inputs(points).layout;
    params.has_normals = normals != nullptr;
    if (normals != nullptr)
        params.normals = point_inputs(Points::wrap(device, normals, normals_at, points.count())).layout;
    return params;
}

}  // namespace

SortedPoints::SortedPoints(const Device& device, const Triangles& triangles, const Points& points, cl_mem normals,
                           const PointLayout& normals_at, SortedPoints earlier)
    : SortedPoints(std::move(earlier)) {
    cl::Session& session = session_of(device);
    const PointInputs in = point_inputs(points);
    layout_ = packed(in.layout);
    const TriangleInputs scene = triangle_inputs(triangles);
    PointOrderParams params = params_of(device, scene, points, normals, normals_at);
    if (normals == nullptr) normals = in.positions;
    largest_coordinate_ = fit_grid(session, params, in);
    sort(session, params, in, scene.vertices, normals);
    gather(session, params, in, scene.vertices, normals);
}

SortedPoints SortedPoints::sample(std::size_t share, const Device& device, const Triangles& triangles,
                                  const Points& points, cl_mem normals, const PointLayout& normals_at) const {
    cl::Session& session = session_of(device);
    const PointInputs in = point_inputs(points);
    const TriangleInputs scene = triangle_inputs(triangles);
    SortedPoints some;
    some.layout_ = layout_;
    const std::size_t runs = std::max<std::size_t>(layout_.count / POINTS_OF_RUN / share, 1);
    some.layout_.count = static_cast<cl_uint>(std::min<std::size_t>(runs * POINTS_OF_RUN, layout_.count));
    some.largest_coordinate_ = largest_coordinate_;
    some.order_.reserve(session, some.layout_.count * sizeof(cl_uint));
    session.launch("lights/point_order.cl", "point_sample", cl::Range::items(some.layout_.count), some.layout_.count,
                   static_cast<cl_uint>(share), order_, some.order_);
    some.gather(session, params_of(device, scene, points, normals, normals_at), in, scene.vertices,
                normals != nullptr ? normals : in.positions);
    return some;
}

void SortedPoints::gather(cl::Session& session, PointOrderParams params, const PointInputs& in, cl_mem vertices,
                          cl_mem normals) {
    const std::size_t words = layout_.count * sizeof(cl_uint);
    // A block of lanes is read whole, also where it has fewer points.
    constexpr std::size_t room = 32 * sizeof(cl_uint);
    positions_.reserve(session, 3 * words + room);
    receivers_.reserve(session, in.layout.has_receivers != 0 ? words + room : 0);
    normals_.reserve(session, params.has_normals != 0 ? 3 * words + room : 0);
    surface_normals_.reserve(session, 3 * words + room);
    params.points.count = layout_.count;
    session.launch("lights/point_order.cl", "point_gather", cl::Range::items(layout_.count), params, vertices,
                   in.positions, in.receivers, normals, order_, positions_, receivers_, normals_, surface_normals_);
}

void SortedPoints::sort(cl::Session& session, const PointOrderParams& params, const PointInputs& in, cl_mem vertices,
                        cl_mem normals) {
    const cl_uint count = in.layout.count;
    const std::size_t words = count * sizeof(cl_uint);
    order_.reserve(session, words);
    if (in.layout.picture_width != 0) {
        session.launch("lights/point_order.cl", "picture_order", cl::Range::items(count), params, order_);
        return;
    }
    cl::Buffer low(session, words), high(session, words), sorted_high(session, words);
    session.launch("lights/point_order.cl", "point_codes", cl::Range::items(count), params, vertices, in.positions,
                   in.receivers, normals, low, high, order_);
    // The sort keeps the order of equal keys, so the lower half goes first.
    Sort sort;
    sort.run(session, count, low, order_);
    session.launch("lights/point_order.cl", "point_reorder", cl::Range::items(count), count, high, order_, sorted_high);
    sort.run(session, count, sorted_high, order_);
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
