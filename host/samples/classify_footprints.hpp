// SPDX-License-Identifier: MIT
// Stage classify_footprints: tests footprints, regions of points on one receiver, against the map and the triangles of
// their bins' lists (kernels/receivers/footprint.h, kernels/samples/classify_footprints.cl).
#pragma once

#include "receivers/light_frame.hpp"
#include "trace/trace.hpp"

namespace gnomon {

class SampleBuffers;

/// A technique that can prove one result for all points of a footprint. run_samples() uses this interface if a
/// technique implements it.
class ClassifiesFootprints {
public:
    ClassifiesFootprints();
    virtual ~ClassifiesFootprints();
    /// Writes one value per footprint: 0 if all its points are in shadow, 1 if all are lit, else VISIBILITY_MIXED.
    /// `centres` have receivers and the camera's eye; that camera made the footprints' points.
    virtual Statistics classify_footprints(const Triangles& triangles, const Points& centres,
                                           const cl::Buffer& footprints, const Light& light,
                                           const Visibility& classes) = 0;
    /// The same for footprints within mixed ones, whose class is VISIBILITY_OPEN: others need not be classified again.
    virtual Statistics classify_parts(const Triangles& triangles, const Points& centres, const cl::Buffer& footprints,
                                      const Light& light, const Visibility& classes) = 0;
    /// As Technique::run(), for samples of mixed footprints, as the last classify_footprints() of these triangles and
    /// this light classified them. Their visibility is VISIBILITY_OPEN.
    virtual Statistics trace_mixed(const Triangles& triangles, const Points& samples, const Light& light,
                                   const Visibility& visibility) = 0;

    /// Buffers that run_samples_by_fragments() keeps from run to run, until the technique's end; null before the first.
    std::unique_ptr<SampleBuffers> sample_buffers;
    std::size_t expected_footprints = 0;  ///< about as many as a batch has, and the same number in each run
};

/// As Trace::run(), for points that carry footprints.
void run_classify_footprints(cl::Session& session, const TraceInputs& inputs);

}  // namespace gnomon
