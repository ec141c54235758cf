// SPDX-License-Identifier: MIT
// What techniques in light frames begin with: facing and light_frame, then the frames that have open points, one by
// one.
#pragma once

#include "../kernels/triangle_setup.h"
#include "facing.hpp"

namespace gnomon {

class LightFrames {
public:
    /// Decides the points that face away; those of the frames are open. There must be points. Returns what facing
    /// counted; `counters` holds FrameCounters.
    FrameCounters decide_facing(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                                const TriangleInputs& triangles, const PointInputs& points, cl_mem visibility,
                                const cl::Buffer& counters);
    /// Calls use(frame) for each frame that has open points, with its projection in projection().
    void for_each(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                  const std::function<void(cl_uint frame)>& use);
    const cl::Buffer& projection() const { return projection_; }
    const cl::Buffer* blocks() const { return facing_.blocks(); }  ///< of the points that decide_facing() was given

private:
    Facing facing_;
    LightFrameFit light_frame_;
    cl::Buffer projection_;
};

}  // namespace gnomon
