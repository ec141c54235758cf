// SPDX-License-Identifier: MIT
// The inputs of a fit, and its result for the other stages of the shadow-map family
// (kernels/techniques/shadow_map/map_view.h).
#pragma once

#include "api/inputs.hpp"
#include "kernels/techniques/shadow_map/map_view.h"
#include "kernels/techniques/shadow_map/texel_footprint.h"

namespace gnomon {

/// The views of one shadow map. The host knows `set`; the rest stays on the device.
struct MapViews {
    cl::Buffer views;   ///< MapView, set.view_count of them
    cl::Buffer tables;  ///< floats: texel centres of every view, and the tables of rectilinear warps
    MapSet set{};
};

/// The inputs of a fit. Points with visibility 1 are still open.
struct FitInputs {
    TriangleInputs triangles;
    PointInputs points;
    cl_mem visibility;
    Light light;
    std::optional<PointsCamera> camera;
    bool keeps_casters = false;  ///< the map's depths reach to the casters nearest to the light, not only to receivers
};

/// The camera's steps from pixel to pixel.
PixelSteps pixel_steps(const PointsCamera& from);

/// Fills map_views.tables with the texel centres of the views (kernels/techniques/shadow_map/map_view.cl).
void fill_centres(cl::Session& session, const MapViews& map_views);

}  // namespace gnomon
