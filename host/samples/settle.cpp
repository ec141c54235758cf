// SPDX-License-Identifier: MIT
#include "samples/settle.hpp"

namespace gnomon {

void run_settle(cl::Session& session, const TraceInputs& inputs) {
    const PointInputs& points = inputs.points;
    const ListBuffers& lists = inputs.lists;
    session.launch("samples/settle.cl", "settle", cl::Range::items(points.layout.count / session.lanes() + 1),
                   inputs.light_frame, inputs.first_frame, inputs.frame_count, points.layout, inputs.projections,
                   cl_uint(inputs.map != nullptr), inputs.triangles.first_float, inputs.triangles.vertices,
                   points.positions, points.footprints, points.receivers,
                   inputs.map != nullptr ? *inputs.map : lists.ranges, lists.ranges, lists.entries, lists.records,
                   lists.bounds, inputs.visibility, inputs.counters);
}

}  // namespace gnomon
