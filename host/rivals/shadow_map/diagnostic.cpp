// SPDX-License-Identifier: MIT
#include "rivals/shadow_map/diagnostic.hpp"

#include <cmath>

namespace gnomon {

const std::vector<DiagnosticDescription>& map_diagnostics() {
    static const std::vector<DiagnosticDescription> all{
        {"aliasing", "texels per pixel: green one, yellow, red and black too few, blue more than needed"},
        {"grid", "the map's texels as lines; evenly grey where a pixel is wider than a texel"},
        {"views", "a colour for each cascade, side or cube face that serves; black where none does"},
        {"depth", "the map's depth of what is seen, black nearest to the light"},
        {"warp",
         "32 x 32 equal shares of the map; green as dense as without the warp, blue denser, yellow and red less"}};
    return all;
}

std::vector<std::uint8_t> opaque_bytes(std::span<const float> colors) {
    std::vector<std::uint8_t> rgba(colors.size() / 3 * 4, 255);
    for (std::size_t i = 0; i < colors.size(); ++i)
        rgba[i / 3 * 4 + i % 3] = static_cast<std::uint8_t>(std::lround(255 * colors[i]));
    return rgba;
}

MapDiagnostic run_map_diagnostic(cl::Session& session, cl_uint diagnostic, const FitInputs& inputs,
                                 const MapViews& map_views) {
    if (!inputs.camera || inputs.points.layout.has_receivers == 0)
        throw InvalidArgument("a diagnostic is drawn for the pixels of a camera: give points made by look()");
    const std::size_t count = inputs.points.layout.count;
    cl::Buffer errors(session, count * sizeof(float)), colors(session, 3 * count * sizeof(float));
    const DiagnosticPlan plan{pixel_steps(*inputs.camera), diagnostic, {}};
    session.launch("rivals/shadow_map/diagnostic.cl", "map_diagnostic", cl::Range::items(count), plan, map_views.set,
                   inputs.points.layout, inputs.triangles.first_float, inputs.points.positions, inputs.points.receivers,
                   inputs.triangles.vertices, map_views.views, map_views.tables, errors, colors);
    return {session.read_values<float>(errors.get(), count), session.read_values<float>(colors.get(), 3 * count)};
}

}  // namespace gnomon
