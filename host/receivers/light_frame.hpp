// SPDX-License-Identifier: MIT
// Stage light_frame: the light's grid, fitted to the open points (kernels/receivers/light_frame.h).
#pragma once

#include "kernels/receivers/light_frame.h"
#include "query/inputs.hpp"
#include "receivers/frame_grid.hpp"

namespace gnomon {

/// The frame of a directional light, or the first of a point light's POINT_LIGHT_FRAMES (the faces of a cube around
/// it).
LightFrame make_light_frame(const Light& light, const FrameGrid& grid);
inline cl_uint frame_count_of(const LightFrame& light_frame) {
    return light_frame.perspective ? POINT_LIGHT_FRAMES : 1;
}

class LightFrameFit {
public:
    /// Fits projections(), one per frame, to the open points, by the bounds from the facing stage.
    void run(cl::Session& session, const LightFrame& light_frame, const cl::Buffer& frame_bounds);
    const cl::Buffer& projections() const { return projections_; }

private:
    cl::Buffer projections_;
};

}  // namespace gnomon
