// SPDX-License-Identifier: MIT
#include "techniques/framed_technique.hpp"

namespace gnomon {

Statistics FramedTechnique::run(const Triangles& triangles, const Points& points, const Light& light,
                                const Visibility& visibility) {
    require_run(triangles, points, light, visibility);
    const auto start = std::chrono::steady_clock::now();
    cl::Session& session = device_.session();
    const cl::RunMemory memory(session, kept_bytes_);
    Run run{triangle_inputs(triangles), point_inputs(points), make_light_frame(light, grid()), visibility.buffer()};
    Statistics& s = run.statistics;
    counters_.reserve(session, sizeof(FrameCounters));
    begin_counts();
    FrameCounters facing{};
    if (points.count() != 0) {
        frames_.start_facing(session, s, run.light_frame, run.triangles, run.points, run.visibility, counters_);
        facing = session.read_value<FrameCounters>(counters_);
        if (triangles.count() != 0)
            frames_.for_each(session, s, run.light_frame, [&](cl_uint frame) {
                run_frame(run, frame);
                ++run.frames;
            });
    }
    s.counts = {{"points", points.count()},
                {"points_absent", facing.absent},
                {"points_facing_away", facing.facing_away},
                {"points_in_shadow", facing.facing_away + run.in_shadow},
                {"triangles", triangles.count()},
                {"frames", run.frames},
                {"lists_grown", run.grown}};
    add_counts(run);
    s.device_memory_bytes = memory.peak_bytes();
    s.total_wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return s;
}

}  // namespace gnomon
