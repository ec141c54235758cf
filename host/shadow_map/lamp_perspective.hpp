// SPDX-License-Identifier: MIT
// Stage lamp perspective: warps the faces of a lamp's cube along the view (kernels/shadow_map/lamp_perspective.h).
#pragma once

#include "../../kernels/shadow_map/lamp_perspective.h"
#include "map_views.hpp"

namespace gnomon {

class LampPerspective {
public:
    /// Gives `planned` (after its entries that are no views: the plain faces) the warp of least error over the open
    /// points. `bounds` holds what the faces' points range over, and is empty again for the faces afterwards.
    void run(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs, const cl::Buffer& planned,
             const cl::Buffer& bounds);

private:
    cl::Buffer samples_, faces_, costs_;
};

}  // namespace gnomon
