// SPDX-License-Identifier: MIT
#include "techniques/shadow_map/map_views.hpp"

#include <cmath>

#include "api/vectors.hpp"

namespace gnomon {

PixelSteps pixel_steps(const PointsCamera& from) {
    PixelSteps steps{};
    const double pixel = 2 * std::tan(from.camera.fov_y_radians / 2) / from.height;
    std::copy(from.camera.eye.begin(), from.camera.eye.end(), steps.eye);
    store(steps.forward, from.camera.forward);
    store(steps.step_x, scaled(from.camera.right, pixel));
    store(steps.step_y, scaled(from.camera.up, -pixel));
    return steps;
}

void fill_centres(cl::Session& session, const MapViews& map_views) {
    session.launch("techniques/shadow_map/map_projection.cl", "map_projection_centres", cl::Range::items(4096),
                   map_views.set, map_views.views, map_views.tables);
}

}  // namespace gnomon
