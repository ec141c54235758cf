// SPDX-License-Identifier: MIT
// Stage facing: decides backfacing points, opens the others and computes their bounds (kernels/receivers/facing.h).
#pragma once

#include "kernels/receivers/facing.h"
#include "kernels/simd/frame_counters.h"
#include "receivers/light_frame.hpp"

namespace gnomon {

class FacingStage {
public:
    /// Writes every point's visibility, frame_bounds(), and the points' counts in `counters` (FrameCounters, zeroed
    /// here). Without `opens_points` all points that do not face away are lit, and no bounds are taken.
    void run(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
             const PointInputs& points, cl_mem visibility, const cl::Buffer& counters, bool opens_points = true);
    /// For techniques without frames: decides the backfacing points, and makes all other points lit. Returns the
    /// counts, in `counters`, which then has room for FrameCounters.
    FrameCounters run_alone(cl::Session& session, Statistics& statistics, const TriangleInputs& triangles,
                            const PointInputs& points, const Light& light, cl_mem visibility, cl::Buffer& counters);
    /// On a CPU: room for a cache, and what makes it one in which no triangle is classified yet (facing_cache.clh).
    cl::Fill empty_cache(cl::Session& session, const TriangleInputs& triangles);
    const cl::Buffer& frame_bounds() const { return frame_bounds_; }  ///< PointBounds of each frame
    /// BlockBounds of each block of points (kernels/receivers/block_bounds.h); null where blocks are single points or
    /// footprints.
    const cl::Buffer* blocks() const { return has_blocks_ ? &blocks_ : nullptr; }
    /// On a GPU: the points that the float filter left undecided (UNDECIDED_CAPACITY).
    const cl::Buffer& undecided() const { return undecided_; }

private:
    /// Null: every point classifies its receiver.
    const cl::Buffer* make_cache(cl::Session& session, const FacingParams& params, const TriangleInputs& triangles,
                                 const PointInputs& points, const cl::Buffer& counters);

    cl::Buffer frame_bounds_, cache_, blocks_, undecided_;
    bool has_blocks_ = false;
};

}  // namespace gnomon
