// SPDX-License-Identifier: MIT
// The first stages of techniques in light frames: facing and light_frame, then the frames with open points, one by one.
#pragma once

#include "kernels/simd/frame_counters.h"
#include "receivers/facing.hpp"
#include "receivers/receiver_depth_pyramid.hpp"

namespace gnomon {

/// The inputs of a run. They do not change until the run's end.
struct FramedInputs {
    TriangleInputs triangles;
    PointInputs points;
    LightFrame light_frame;
    cl_mem visibility;
};

class LightFrames {
public:
    /// Decides the backfacing points, and opens the others that have a frame. There must be points. Does not wait for
    /// the device: `counters` receives FrameCounters.
    void start_facing(cl::Session& session, Statistics& statistics, const FramedInputs& in, const cl::Buffer& counters);
    /// Calls use(frame) for each frame that has open points, with its projection in projection().
    void for_each(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                  const std::function<void(cl_uint frame)>& use);
    /// For a light with one frame, without waiting for the device: the frame may turn out to have no open points.
    void fit_one(cl::Session& session, Statistics& statistics, const LightFrame& light_frame);
    /// Makes receiver_depths() of a frame in projection(), over the points of start_facing().
    void reduce_depths(cl::Session& session, Statistics& statistics, const FramedInputs& in, cl_uint frame);
    ReceiverDepthPyramid& receiver_depths() { return receiver_depths_; }
    cl::Fill empty_facing_cache(cl::Session& session, const TriangleInputs& triangles) {
        return facing_.empty_cache(session, triangles);
    }
    const cl::Buffer& projection() const { return has_one_ ? light_frame_.projections() : projection_; }
    const cl::Buffer* blocks() const { return facing_.blocks(); }  ///< Facing::blocks()

private:
    FacingStage facing_;
    LightFrameFit light_frame_;
    ReceiverDepthPyramid receiver_depths_;
    cl::Buffer projection_;
    bool has_one_ = false;
};

}  // namespace gnomon
