// SPDX-License-Identifier: MIT
#include "trace/exact_trace.hpp"

namespace gnomon {

void run_exact_trace(cl::Session& session, const TriangleInputs& triangles, const PointInputs& points,
                     const Light& light, const Trace& trace, cl_mem visibility, const cl::Buffer& counters) {
    session.launch("trace/exact_trace.cl", "exact_trace", cl::Range::items(trace.capacity() / session.lanes() + 1),
                   float4_of(light.xyzw), points.layout, triangles.first_float, trace.capacity(), points.positions,
                   triangles.vertices, trace.queue(), visibility, counters);
}

}  // namespace gnomon
