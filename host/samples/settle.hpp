// SPDX-License-Identifier: MIT
// Stage settle: footprints, regions of points on one receiver, against the map and their bins' triangles
// (kernels/receivers/footprint.h, kernels/samples/settle.cl).
#pragma once

#include "receivers/light_frame.hpp"
#include "trace/trace.hpp"

namespace gnomon {

class SampleBuffers;

/// A technique whose answer for all points of a region can be proven at once. run_samples() asks techniques for it.
class SettlesFootprints {
public:
    SettlesFootprints();
    virtual ~SettlesFootprints();
    /// Writes one answer per footprint: 0 if all its points are in shadow, 1 if all are lit, else VISIBILITY_MIXED.
    /// `centres` have receivers and the eye of a camera; centre and receiver are those of points that it made.
    virtual Statistics settle(const Triangles& triangles, const Points& centres, const cl::Buffer& footprints,
                              const Light& light, const Visibility& answers) = 0;
    /// As Technique::run(), for samples whose footprints the last settle() of these triangles and this light found to
    /// be mixed. Their visibility is VISIBILITY_OPEN.
    virtual Statistics trace_mixed(const Triangles& triangles, const Points& samples, const Light& light,
                                   const Visibility& visibility) = 0;

    /// What run_settled_samples() keeps from run to run, until the technique's end; null before the first.
    std::unique_ptr<SampleBuffers> sample_buffers;
};

/// As Trace::run(), for points that carry footprints.
void run_settle(cl::Session& session, const TraceInputs& inputs);

}  // namespace gnomon
