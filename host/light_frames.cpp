// SPDX-License-Identifier: MIT
#include "light_frames.hpp"

namespace gnomon {

FrameCounters LightFrames::decide_facing(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                                         const TriangleInputs& triangles, const PointInputs& points, cl_mem visibility,
                                         const cl::Buffer& counters) {
    session.fill(counters, 0, sizeof(FrameCounters));
    {
        cl::StageTimer timer(session, statistics, "facing");
        facing_.run(session, light_frame, triangles, points, visibility, counters);
    }
    return session.read_value<FrameCounters>(counters);
}

void LightFrames::for_each(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                           const std::function<void(cl_uint frame)>& use) {
    {
        cl::StageTimer timer(session, statistics, "light_frame");
        light_frame_.run(session, light_frame, facing_.frame_bounds());
    }
    std::array<Projection, LAMP_FRAMES> projections;
    const cl_uint frame_count = frame_count_of(light_frame);
    session.read(light_frame_.projections().get(), projections.data(), frame_count * sizeof(Projection));
    projection_.reserve(session, sizeof(Projection));
    for (cl_uint frame = 0; frame < frame_count; ++frame) {
        if (projections[frame].active_points == 0) continue;
        session.write(projection_.get(), &projections[frame], sizeof(Projection));
        use(frame);
    }
}

}  // namespace gnomon
