// SPDX-License-Identifier: MIT
// What a fit hands to the rest of the shadow-map family, and what it is given
// (kernels/techniques/shadow_map/map_view.h).
#pragma once

#include "api/inputs.hpp"
#include "kernels/techniques/shadow_map/map_view.h"
#include "kernels/techniques/shadow_map/texel_footprint.h"

namespace gnomon {

/// The views of one shadow map. `set` is known to the host; the rest stays on the device.
struct MapViews {
    cl::Buffer views;   ///< MapView, set.view_count of them
    cl::Buffer tables;  ///< floats: texel centres of every view, and the tables of rectilinear warps
    MapSet set{};
};

/// What a fit may look at. Points with visibility 1 are those that still need an answer.
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
