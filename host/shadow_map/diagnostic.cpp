// SPDX-License-Identifier: MIT
#include "diagnostic.hpp"

#include <cmath>

#include "../vectors.hpp"

namespace gnomon {
namespace {

void store(float* to, const Double3& v, double factor) {
    for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(v[i] * factor);
}

DiagnosticPlan plan_of(const PointsCamera& from, cl_uint diagnostic) {
    DiagnosticPlan plan{};
    const double pixel = 2 * std::tan(from.camera.fov_y_radians / 2) / from.height;
    std::copy(from.camera.eye.begin(), from.camera.eye.end(), plan.eye);
    store(plan.forward, from.camera.forward, 1);
    store(plan.step_x, from.camera.right, pixel);
    store(plan.step_y, from.camera.up, -pixel);
    plan.diagnostic = diagnostic;
    return plan;
}

}  // namespace

std::span<const std::string_view> map_diagnostics() {
    static constexpr std::string_view names[] = {"aliasing", "grid", "views", "depth"};
    return names;
}

MapDiagnostic run_map_diagnostic(cl::Session& session, cl_uint diagnostic, const FitInputs& inputs,
                                 const MapViews& map_views) {
    if (!inputs.camera || inputs.points.layout.has_receivers == 0)
        throw InvalidArgument("a diagnostic is drawn for the pixels of a camera: give points made by look()");
    const std::size_t count = inputs.points.layout.count;
    cl::Buffer errors(session, count * sizeof(float)), colors(session, 3 * count * sizeof(float));
    session.launch("shadow_map/diagnostic.cl", "map_diagnostic", cl::Range::items(count),
                   plan_of(*inputs.camera, diagnostic), map_views.set, inputs.points.layout,
                   inputs.triangles.first_float, inputs.points.positions, inputs.points.receivers,
                   inputs.triangles.vertices, map_views.views, map_views.tables, errors, colors);
    MapDiagnostic drawn{std::vector<float>(count), std::vector<float>(3 * count)};
    session.read(errors.get(), drawn.texels_per_pixel.data(), count * sizeof(float));
    session.read(colors.get(), drawn.colors.data(), 3 * count * sizeof(float));
    return drawn;
}

}  // namespace gnomon
