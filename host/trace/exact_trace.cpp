// SPDX-License-Identifier: MIT
#include "trace/exact_trace.hpp"

namespace gnomon {

void run_exact_trace(cl::Session& session, const TraceInputs& inputs, const Trace& trace) {
    session.launch("trace/exact_trace.cl", "exact_trace", cl::Range::items(trace.capacity() / session.lanes() + 1),
                   trace.params(inputs), inputs.points.positions, inputs.triangles.vertices, trace.queue(),
                   inputs.visibility, inputs.counters);
}

}  // namespace gnomon
