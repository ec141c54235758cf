// SPDX-License-Identifier: MIT
// Diagnostics of shadow maps: how texels lie over what the camera sees (kernels/shadow_map/diagnostic.h).
#pragma once

#include "../../kernels/shadow_map/diagnostic.h"
#include "map_views.hpp"

namespace gnomon {

struct MapDiagnostic {
    std::vector<float> texels_per_pixel;  ///< one per point; 0: no map there
    std::vector<float> colors;            ///< red, green, blue per point, 0 to 1
};

/// The names of diagnostics, in the order of their values.
std::span<const std::string_view> map_diagnostics();

/// Draws a diagnostic of the views. Throws InvalidArgument unless the points have a camera and receivers.
MapDiagnostic run_map_diagnostic(cl::Session& session, cl_uint diagnostic, const FitInputs& inputs,
                                 const MapViews& map_views);

}  // namespace gnomon
