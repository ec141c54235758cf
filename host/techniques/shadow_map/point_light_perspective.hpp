// SPDX-License-Identifier: MIT
// Stage lamp perspective: warps the faces of a lamp's cube along the view
// (kernels/techniques/shadow_map/point_light_perspective.h).
#pragma once

#include "kernels/techniques/shadow_map/point_light_perspective.h"
#include "techniques/shadow_map/map_views.hpp"

namespace gnomon {

class PointLightPerspective {
public:
    /// Gives `planned` (after its entries that are no views: the plain faces) the warp of least error over the open
    /// points. `bounds` holds what the faces' points range over, and is empty again for the faces afterwards.
    void run(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs, const cl::Buffer& planned,
             const cl::Buffer& bounds);

private:
    cl::Buffer samples_, faces_, costs_;
};

}  // namespace gnomon
