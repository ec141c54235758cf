// SPDX-License-Identifier: MIT
#include "settle.hpp"

namespace gnomon {

void run_settle(cl::Session& session, const LightFrame& light_frame, cl_uint first_frame, cl_uint frame_count,
                const TriangleInputs& triangles, const PointInputs& points, const cl::Buffer& projections,
                const cl::Buffer* map, const ListBuffers& lists, cl_mem visibility, const cl::Buffer& counters) {
    session.launch("settle.cl", "settle", cl::Range::items(points.layout.count / session.lanes() + 1), light_frame,
                   first_frame, frame_count, points.layout, projections, cl_uint(map != nullptr), triangles.first_float,
                   triangles.vertices, points.positions, points.footprints, points.receivers,
                   map != nullptr ? *map : lists.ranges, lists.ranges, lists.entries, lists.records, lists.bounds,
                   visibility, counters);
}

}  // namespace gnomon
