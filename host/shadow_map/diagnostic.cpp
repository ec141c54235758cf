// SPDX-License-Identifier: MIT
#include "diagnostic.hpp"

namespace gnomon {
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
    const DiagnosticPlan plan{pixel_steps(*inputs.camera), diagnostic, {}};
    session.launch("shadow_map/diagnostic.cl", "map_diagnostic", cl::Range::items(count), plan, map_views.set,
                   inputs.points.layout, inputs.triangles.first_float, inputs.points.positions, inputs.points.receivers,
                   inputs.triangles.vertices, map_views.views, map_views.tables, errors, colors);
    MapDiagnostic drawn{std::vector<float>(count), std::vector<float>(3 * count)};
    session.read(errors.get(), drawn.texels_per_pixel.data(), count * sizeof(float));
    session.read(colors.get(), drawn.colors.data(), 3 * count * sizeof(float));
    return drawn;
}

}  // namespace gnomon
