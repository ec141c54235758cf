// SPDX-License-Identifier: MIT
// Stage exact_trace: the exact predicate decides the pairs that the trace queued (kernels/trace/exact_trace.cl).
#pragma once

#include "trace/trace.hpp"

namespace gnomon {

void run_exact_trace(cl::Session& session, const TraceInputs& inputs, const Trace& trace);

}  // namespace gnomon
