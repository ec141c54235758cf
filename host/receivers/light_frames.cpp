// SPDX-License-Identifier: MIT
#include "receivers/light_frames.hpp"

namespace gnomon {

void LightFrames::start_facing(cl::Session& session, Statistics& statistics, const FramedInputs& in,
                               const cl::Buffer& counters) {
    cl::StageTimer timer(session, statistics, "facing");
    facing_.run(session, in.light_frame, in.triangles, in.points, in.visibility, counters);
}

void LightFrames::fit_one(cl::Session& session, Statistics& statistics, const LightFrame& light_frame) {
    cl::StageTimer timer(session, statistics, "light_frame");
    light_frame_.run(session, light_frame, facing_.frame_bounds());
    has_one_ = true;
}

void LightFrames::reduce_depths(cl::Session& session, Statistics& statistics, const FramedInputs& in, cl_uint frame) {
    cl::StageTimer timer(session, statistics, "receiver_depth_pyramid");
    receiver_depths_.run(session, in.light_frame, frame, 1, in.points, projection(), facing_.blocks(), in.visibility);
}

void LightFrames::for_each(cl::Session& session, Statistics& statistics, const LightFrame& light_frame,
                           const std::function<void(cl_uint frame)>& use) {
    fit_one(session, statistics, light_frame);
    has_one_ = false;
    const cl_uint frame_count = frame_count_of(light_frame);
    const auto projections = session.read_values<Projection>(light_frame_.projections().get(), frame_count);
    projection_.reserve(session, sizeof(Projection));
    for (cl_uint frame = 0; frame < frame_count; ++frame) {
        if (projections[frame].active_points == 0) continue;
        session.copy(light_frame_.projections(), frame * sizeof(Projection), projection_, 0, sizeof(Projection));
        use(frame);
    }
}

}  // namespace gnomon
