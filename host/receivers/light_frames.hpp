// SPDX-License-Identifier: MIT
// What techniques in light frames begin with: facing and light_frame, then the frames that have open points, one by
// one.
#pragma once

#include "kernels/simd/frame_counters.h"
#include "receivers/facing.hpp"

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
    /// Of a light with one frame both, without waiting for the device: what facing counts stays in `counters`, and the
    /// frame may turn out to have no open points.
    void fit_one(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                 const TriangleInputs& triangles, const PointInputs& points, cl_mem visibility,
                 const cl::Buffer& counters);
    const cl::Buffer& empty_facing_cache(cl::Session& session, const TriangleInputs& triangles) {
        return facing_.empty_facing_cache(session, triangles);
    }
    const cl::Buffer& projection() const { return has_one_ ? light_frame_.projections() : projection_; }
    const cl::Buffer* blocks() const { return facing_.blocks(); }  ///< of the points that facing was given

private:
    void start_facing(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                      const TriangleInputs& triangles, const PointInputs& points, cl_mem visibility,
                      const cl::Buffer& counters);
    void start_fit(cl::Session& session, Statistics& statistics, const LightFrame& light_frame);

    Facing facing_;
    LightFrameFit light_frame_;
    cl::Buffer projection_;
    bool has_one_ = false;
};

}  // namespace gnomon
