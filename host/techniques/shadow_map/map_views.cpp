// SPDX-License-Identifier: MIT
#include "techniques/shadow_map/map_views.hpp"

#include <cmath>

#include "api/vectors.hpp"

namespace gnomon {
namespace {

void store(float* to, const Double3& v, double factor) {
    for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(v[i] * factor);
}

}  // namespace

PixelSteps pixel_steps(const PointsCamera& from) {
    PixelSteps steps{};
    const double pixel = 2 * std::tan(from.camera.fov_y_radians / 2) / from.height;
    std::copy(from.camera.eye.begin(), from.camera.eye.end(), steps.eye);
    store(steps.forward, from.camera.forward, 1);
    store(steps.step_x, from.camera.right, pixel);
    store(steps.step_y, from.camera.up, -pixel);
    return steps;
}

void fill_centres(cl::Session& session, const MapViews& map_views) {
    session.launch("techniques/shadow_map/map_view.cl", "map_view_centres", cl::Range::items(4096), map_views.set,
                   map_views.views, map_views.tables);
}

}  // namespace gnomon
