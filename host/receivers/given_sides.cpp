// SPDX-License-Identifier: MIT
// Facing by a side that the caller gives: normals, or the winding of the receivers.
#include "kernels/receivers/given_sides.h"

#include <algorithm>

#include "api/inputs.hpp"

namespace gnomon {
namespace {

GivenSidesParams params_of(const PointInputs& points, const Light& light) {
    GivenSidesParams params{};
    params.points = points.layout;
    std::copy(light.xyzw.begin(), light.xyzw.end(), params.light);
    return params;
}

}  // namespace

void face_by_normals(const Device& device, const Points& points, cl_mem normals, const PointLayout& layout,
                     const Light& light, const Visibility& visibility) {
    // Points::wrap checks the buffer's context and its size, require_run that the visibility overlaps neither input.
    const Points vectors = Points::wrap(device, normals, layout, points.count());
    require_run(Triangles{}, points, light, visibility);
    require_run(Triangles{}, vectors, light, visibility);
    if (points.count() == 0) return;
    const PointInputs at = point_inputs(points);
    GivenSidesParams params = params_of(at, light);
    params.normals = point_inputs(vectors).layout;
    session_of(device).launch("receivers/given_sides.cl", "given_normals", cl::Range::items(points.count()), params,
                              at.positions, normals, visibility.buffer());
}

void face_by_normals(const Device& device, const Points& points, std::span<const float> normals, const Light& light,
                     const Visibility& visibility) {
    if (normals.size() / 3 < points.count())
        throw InvalidArgument("there are normals for " + std::to_string(normals.size() / 3) + " of " +
                              std::to_string(points.count()) + " points: give three floats each");
    const Points vectors = Points::upload(device, normals.first(3 * points.count()));
    face_by_normals(device, points, vectors.positions(), {}, light, visibility);
}

void face_by_winding(const Device& device, const Triangles& triangles, const Points& points, const Light& light,
                     const Visibility& visibility) {
    require_run(triangles, points, light, visibility);
    if (points.count() == 0 || points.receivers() == nullptr) return;
    const TriangleInputs inputs = triangle_inputs(triangles);
    const PointInputs at = point_inputs(points);
    GivenSidesParams params = params_of(at, light);
    params.triangles = inputs;
    session_of(device).launch("receivers/given_sides.cl", "given_winding", cl::Range::items(points.count()), params,
                              inputs.vertices, at.positions, at.receivers, visibility.buffer());
}

}  // namespace gnomon
