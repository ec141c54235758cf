// SPDX-License-Identifier: MIT
// Technique izb: exact hard shadows by an irregular z-buffer. Each triangle traverses the lists of the points that it
// may shadow (kernels/rivals/izb.cl); frustum-traced does the reverse. A baseline to compare with.
#pragma once

#include "kernels/rivals/izb.h"
#include "lists/scan.hpp"
#include "trace/trace.hpp"

namespace gnomon {

/// The points of a frame that the conservative map leaves open, listed by texel: those of a bin one after the other.
class Izb {
public:
    /// Lists the points of inputs.first_frame, once its triangles are listed.
    void run(cl::Session& session, const TraceInputs& inputs);
    /// Tests each pair of a triangle and a bin over the bin's points, and queues undecided pairs of a triangle and a
    /// point. If the queue is full, the item decides the pair in place.
    void trace(cl::Session& session, const TraceInputs& inputs, const Bins& bins, Trace& queue);

    const cl::Buffer& offsets() const { return offsets_; }  ///< of each texel's slots
    const cl::Buffer& lists() const { return lists_; }      ///< IZB_WORDS arrays of slot_count() words
    cl_uint slot_count() const { return slot_count_; }

private:
    IzbParams params(const TraceInputs& inputs, cl_uint queue_capacity) const;

    Scan scan_;
    cl::Buffer counts_, ranks_, offsets_, lists_;
    cl_uint slot_count_ = 0;
};

}  // namespace gnomon
