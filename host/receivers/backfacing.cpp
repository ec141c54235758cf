// SPDX-License-Identifier: MIT
#include "receivers/backfacing.hpp"

#include <algorithm>

#include "kernels/receivers/backfacing.h"

namespace gnomon {
namespace {

BackfacingParams params_of(const PointInputs& points, const Light& light) {
    BackfacingParams params{};
    params.points = points.layout;
    std::copy(light.xyzw.begin(), light.xyzw.end(), params.light);
    return params;
}

void darken_by_normals(cl::Session& session, const Device& device, const Points& points, const FacingInputs& sides,
                       const Light& light, const Visibility& visibility) {
    const PointInputs at = point_inputs(points);
    BackfacingParams params = params_of(at, light);
    params.normals = point_inputs(Points::wrap(device, sides.normals, sides.normals_layout, points.count())).layout;
    session.launch("receivers/backfacing.cl", "darken_by_normals", cl::Range::items(points.count()), params,
                   at.positions, sides.normals, visibility.buffer());
}

void darken_by_winding(cl::Session& session, const Triangles& triangles, const Points& points, const Light& light,
                       const Visibility& visibility) {
    if (points.receivers() == nullptr) return;
    const TriangleInputs inputs = triangle_inputs(triangles);
    const PointInputs at = point_inputs(points);
    BackfacingParams params = params_of(at, light);
    params.triangles = inputs;
    session.launch("receivers/backfacing.cl", "darken_by_winding", cl::Range::items(points.count()), params,
                   inputs.vertices, at.positions, at.receivers, visibility.buffer());
}

void darken_by_fans(cl::Session& session, const Triangles& triangles, const FacingInputs& sides, const Light& light,
                    const Visibility& visibility) {
    BackfacingFansParams params{};
    const TriangleInputs inputs = triangle_inputs(triangles);
    params.triangles = inputs;
    params.count = static_cast<cl_uint>(sides.fans->count());
    params.has_up = sides.up.has_value();
    if (sides.up) std::copy(sides.up->begin(), sides.up->end(), params.up);
    std::copy(light.xyzw.begin(), light.xyzw.end(), params.light);
    const FansOnDevice fans = Internals::on_device(*sides.fans);
    session.fill(fans.extended, 0, sizeof(std::uint32_t));
    session.launch("receivers/backfacing.cl", "darken_by_fans", cl::Range::items(sides.fans->count()), params,
                   inputs.vertices, fans.fans, fans.corners, visibility.buffer(), fans.extended);
}

}  // namespace

void darken_backfacing(const Device& device, const Triangles& triangles, const Points& points,
                       const FacingInputs& sides, const Light& light, const Visibility& visibility) {
    if (points.count() == 0) return;
    cl::Session& session = session_of(device);
    if (sides.normals != nullptr) darken_by_normals(session, device, points, sides, light, visibility);
    if (sides.front) darken_by_winding(session, triangles, points, light, visibility);
    if (sides.fans != nullptr) darken_by_fans(session, triangles, sides, light, visibility);
}

}  // namespace gnomon
