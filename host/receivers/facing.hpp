// SPDX-License-Identifier: MIT
// Stage facing: points that face away are decided, the others are open, and their bounds are taken
// (kernels/receivers/facing.cl).
#pragma once

#include "kernels/simd/frame_counters.h"
#include "receivers/light_frame.hpp"

namespace gnomon {

class Facing {
public:
    /// Writes every point's visibility, frame_bounds(), and the points' counts in `counters` (FrameCounters, zeroed
    /// here).
    void run(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
             const PointInputs& points, cl_mem visibility, const cl::Buffer& counters);
    /// No point is doubtful, so that all points on a receiver get the same answer.
    static bool can_cache(const PointInputs& points);
    /// On a CPU: where points can look their receivers up, nobody having asked yet.
    const cl::Buffer& empty_facing_cache(cl::Session& session, const TriangleInputs& triangles);
    const cl::Buffer& frame_bounds() const { return frame_bounds_; }  ///< PointBounds of each frame
    /// BlockBounds of each block of points (kernels/receivers/block_bounds.h); null where work-items take single
    /// points, or footprints.
    const cl::Buffer* blocks() const { return has_blocks_ ? &blocks_ : nullptr; }
    /// On a GPU: how many points floats left unsure, if it was they that were asked, then up to UNDECIDED_CAPACITY of
    /// these.
    const cl::Buffer& undecided() const { return undecided_; }

private:
    /// Where points look up which way their receivers face: filled already, or by those who ask first. Null: each asks
    /// for itself.
    const cl::Buffer* make_answers(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
                                   const PointInputs& points, const cl::Buffer& counters);

    cl::Buffer frame_bounds_, answers_, blocks_, undecided_;
    bool has_blocks_ = false;
};

/// For techniques without frames: decides the points that face away, and leaves all others lit. Returns what it
/// counted, in `counters`, which has room for FrameCounters afterwards.
FrameCounters run_facing(cl::Session& session, Statistics& statistics, const TriangleInputs& triangles,
                         const PointInputs& points, const Light& light, cl_mem visibility, cl::Buffer& counters);

}  // namespace gnomon
