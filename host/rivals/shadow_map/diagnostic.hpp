// SPDX-License-Identifier: MIT
// Diagnostics of shadow maps: texels over the camera's picture (kernels/rivals/shadow_map/diagnostic.h).
#pragma once

#include "kernels/rivals/shadow_map/diagnostic.h"
#include "rivals/shadow_map/map_projection.hpp"

namespace gnomon {

struct MapDiagnostic {
    std::vector<float> texels_per_pixel;  ///< one per point; 0: no map there
    std::vector<float> colors;            ///< red, green, blue per point, 0 to 1
};

/// The names of the diagnostics, in the order of their values.
const std::vector<DiagnosticDescription>& map_diagnostics();

/// RGBA, 4 bytes per point, of red, green and blue from 0 to 1.
std::vector<std::uint8_t> opaque_bytes(std::span<const float> colors);

/// Draws a diagnostic of the views. Throws InvalidArgument unless the points have a camera and receivers.
MapDiagnostic run_map_diagnostic(cl::Session& session, cl_uint diagnostic, const FitInputs& inputs,
                                 const MapViews& map_views);

}  // namespace gnomon
