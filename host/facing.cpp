// SPDX-License-Identifier: MIT
#include "facing.hpp"

namespace gnomon {

void run_facing(cl::Session& session, const TriangleInputs& triangles, const PointInputs& points, const Light& light,
                cl_mem visibility, const cl::Buffer& counters) {
    session.launch("facing.cl", "facing", cl::Range::items(points.layout.count), points.layout, float4_of(light.xyzw),
                   triangles.first_float, triangles.count, points.positions, points.receivers, triangles.vertices,
                   visibility, counters);
}

}  // namespace gnomon
