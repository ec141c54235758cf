// SPDX-License-Identifier: MIT
// Stage facing: every point starts lit; those that face away from the light are decided (kernels/facing.cl).
#pragma once

#include "inputs.hpp"

namespace gnomon {

void run_facing(cl::Session& session, const TriangleInputs& triangles, const PointInputs& points, const Light& light,
                cl_mem visibility, const cl::Buffer& counters);

}  // namespace gnomon
