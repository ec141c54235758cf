// SPDX-License-Identifier: MIT
#include "prepared/prepared_runs.hpp"

namespace gnomon {

Statistics PreparedRuns::prepare(const Triangles& triangles, const Light& light) {
    cl::Session& session = tracer_.session();
    const TracerSettings& settings = tracer_.settings();
    MeasuredRun measured(session, tracer_.kept_bytes());
    const FrameGrid grid = prepared_grid(session, settings.map_size, triangles.count(), !light.is_directional());
    light_ = std::make_unique<PreparedLight>(
        session, measured.stages, triangles, light, grid,
        ListSettings{settings.map_mode != MapMode::off, false, settings.cover_test}, settings.first_capacity);
    merge_stages(measured.stages);
    auto& counts = measured.stages.counts;
    counts = {{"triangles", triangles.count()}};
    add_list_counts(counts, light_->counted());
    counts.insert(counts.end(), {{"prepared", light_->is_usable()}, {"prepared_bytes", light_->bytes()}});
    return measured.finish();
}

TraceInputs PreparedRuns::inputs(const FramedInputs& in) const {
    const LightFrame& frame = light_->light_frame();
    return {frame,
            0,
            frame_count_of(frame),
            in.triangles,
            in.points,
            light_->projections(),
            light_->map(),
            light_->lists(),
            in.visibility,
            tracer_.counters()};
}

Statistics PreparedRuns::run(const Triangles& triangles, const PointInputs& points, const Light& light,
                             cl_mem visibility) {
    if (!serves(triangles, light)) return tracer_.run(triangles, points, light, visibility);
    const TracePlan plan{.decide = [&](const FramedInputs& in, TracedRun& run) {
        run.used_prepared = decide(in, run);
        if (!run.used_prepared) tracer_.run_frames(in, run);
    }};
    return tracer_.run(triangles, points, light, visibility, plan);
}

// Runs only the stages that depend on the points; false if there are fallback points.
bool PreparedRuns::decide(const FramedInputs& in, TracedRun& run) {
    cl::Session& session = tracer_.session();
    const TraceInputs inputs = this->inputs(in);
    const auto trace = [&](Task task) {
        const bool caches = task == Task::trace_prepared_cached_facing;
        const cl::Fill counters{tracer_.counters(), 0, sizeof(FrameCounters)};
        const cl::Fill cache =
            caches ? tracer_.frames().empty_facing_cache(session, in.triangles) : cl::Fill{tracer_.counters(), 0, 0};
        session.fill({counters, cache});
        cl::StageTimer timer(session, run.statistics, "trace");
        tracer_.trace().run(session, task, inputs, caches ? &cache.buffer : nullptr);
        timer.next("exact_trace");
        tracer_.trace().decide_queue(session, inputs);
        timer.next(nullptr);
        return session.read_value<FrameCounters>(tracer_.counters());
    };
    const Task task = prepared_trace_task(session, in.points, inputs.light_frame.perspective == 0);
    FrameCounters counted = trace(task);
    if (task == Task::trace_prepared_plane_side && counted.fallback_points != 0) counted = trace(Task::trace_prepared);
    run.fallback_points = counted.fallback_points;
    if (counted.fallback_points != 0) return false;
    if (!tracer_.trace().fitted(session, in.points, counted))
        counted = tracer_.run_queue_overflow(inputs, run.statistics);
    run.frames = inputs.frame_count;
    run.facing = counted;
    run.add(counted);
    run.statistics.stages.push_back({"facing", 0, 0, "decided by the trace"});
    return true;
}

}  // namespace gnomon
