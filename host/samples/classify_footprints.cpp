// SPDX-License-Identifier: MIT
#include "samples/classify_footprints.hpp"

#include "api/variants.hpp"
#include "kernels/samples/classify_footprints.h"

namespace gnomon {

void run_classify_footprints(cl::Session& session, const TraceInputs& inputs) {
    const PointInputs& points = inputs.points;
    const ListBuffers& lists = inputs.lists;
    session.launch(
        variant(session, Task::classify_footprints, inputs.light_frame.perspective == 0, inputs.triangles.has_cut_outs),
        session.blocks(points.layout.count),
        ClassifyParams{.triangles = inputs.triangles,
                       .light_frame = inputs.light_frame,
                       .layout = points.layout,
                       .first_frame = inputs.first_frame,
                       .frame_count = inputs.frame_count,
                       .has_map = inputs.map != nullptr,
                       .domains = lists.tables.domains},
        inputs.projections, inputs.triangles.vertices, points.positions, points.footprints, points.receivers,
        inputs.map != nullptr ? *inputs.map : lists.ranges, lists.ranges, lists.entries, lists.records, lists.bounds,
        inputs.visibility, inputs.counters);
}

}  // namespace gnomon
