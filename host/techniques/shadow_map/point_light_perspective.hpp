// SPDX-License-Identifier: MIT
// Stage point_light_perspective: warps the faces of a point light's cube along the view
// (kernels/techniques/shadow_map/point_light_perspective.h).
#pragma once

#include "kernels/techniques/shadow_map/point_light_perspective.h"
#include "techniques/shadow_map/map_views.hpp"

namespace gnomon {

class PointLightPerspective {
public:
    /// Gives `planned` (after its entries that are no views: the plain faces) the warp of least error over the open
    /// points. `bounds` contains the faces' bounds of the points; afterwards those of the faces are empty again.
    void run(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs, const cl::Buffer& planned,
             const cl::Buffer& bounds);

private:
    cl::Buffer samples_, faces_, costs_;
};

}  // namespace gnomon
