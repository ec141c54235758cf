// SPDX-License-Identifier: MIT
#include "light_frames.hpp"

namespace gnomon {

FrameCounters LightFrames::run(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                               const TriangleInputs& triangles, const PointInputs& points, cl_mem visibility,
                               const cl::Buffer& counters, const std::function<void(cl_uint frame)>& use) {
    if (points.layout.count == 0) return {};
    session.fill(counters, 0, sizeof(FrameCounters));
    {
        cl::StageTimer timer(session, statistics, "facing");
        facing_.run(session, light_frame, triangles, points, visibility, counters);
    }
    const auto facing = session.read_value<FrameCounters>(counters);
    if (triangles.count == 0) return facing;
    {
        cl::StageTimer timer(session, statistics, "light_frame");
        light_frame_.run(session, light_frame, facing_.frame_bounds());
    }
    const auto projections = session.read_value<std::array<Projection, LAMP_FRAMES>>(light_frame_.projections());
    projection_.reserve(session, sizeof(Projection));
    for (cl_uint frame = 0; frame < frame_count_of(light_frame); ++frame) {
        if (projections[frame].active_points == 0) continue;
        session.write(projection_.get(), &projections[frame], sizeof(Projection));
        use(frame);
    }
    return facing;
}

}  // namespace gnomon
