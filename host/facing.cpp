// SPDX-License-Identifier: MIT
#include "facing.hpp"

namespace gnomon {
namespace {

// What `opens` has no use for may be any buffer.
void launch(cl::Session& session, const LightFrame& light_frame, cl_uint opens, const TriangleInputs& triangles,
            const PointInputs& points, cl_mem visibility, const cl::Buffer& frame_bounds, const cl::Buffer& counters) {
    session.launch("facing.cl", "facing", cl::Range::items(points.layout.count / session.lanes() + 1), points.layout,
                   light_frame, opens, cl_uint(points.footprints != nullptr), triangles.first_float, triangles.count,
                   points.positions, points.footprints != nullptr ? points.footprints : points.positions,
                   points.receivers, triangles.vertices, visibility, frame_bounds, counters,
                   cl::LocalBytes{frame_count_of(light_frame) * sizeof(PointBounds)});
}

}  // namespace

void Facing::run(cl::Session& session, const LightFrame& light_frame, const TriangleInputs& triangles,
                 const PointInputs& points, cl_mem visibility, const cl::Buffer& counters) {
    const std::size_t bytes = frame_count_of(light_frame) * sizeof(PointBounds);
    frame_bounds_.reserve(session, bytes);
    session.fill(frame_bounds_, 0, bytes);
    launch(session, light_frame, triangles.count != 0 ? FACING_BOUNDS : FACING_DECIDES, triangles, points, visibility,
           frame_bounds_, counters);
}

FrameCounters run_facing(cl::Session& session, Statistics& statistics, const TriangleInputs& triangles,
                         const PointInputs& points, const Light& light, cl_mem visibility, cl::Buffer& counters) {
    if (points.layout.count == 0) return {};
    {
        cl::StageTimer timer(session, statistics, "facing");
        counters.reserve(session, sizeof(FrameCounters));
        session.fill(counters, 0, sizeof(FrameCounters));
        // No bounds are taken of points that are not opened.
        launch(session, make_light_frame(light, {1, 0}), FACING_DECIDES, triangles, points, visibility, counters,
               counters);
    }
    return session.read_value<FrameCounters>(counters);
}

}  // namespace gnomon
