// SPDX-License-Identifier: MIT
// Stage exact_trace: the pairs that the trace left open, decided by the exact predicate (kernels/trace/exact_trace.cl).
#pragma once

#include "trace/trace.hpp"

namespace gnomon {

void run_exact_trace(cl::Session& session, const TriangleInputs& triangles, const PointInputs& points,
                     const Light& light, const Trace& trace, cl_mem visibility, const cl::Buffer& counters);

}  // namespace gnomon
