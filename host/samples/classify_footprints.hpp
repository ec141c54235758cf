// SPDX-License-Identifier: MIT
// Stage classify_footprints: tests footprints, regions of points on one receiver, against the map and the triangles of
// their bins' lists (kernels/receivers/footprint.h, kernels/samples/classify_footprints.cl).
#pragma once

#include "receivers/light_frame.hpp"
#include "trace/trace.hpp"

namespace gnomon {

/// As Trace::run(), for points that carry footprints.
void run_classify_footprints(cl::Session& session, const TraceInputs& inputs);

}  // namespace gnomon
