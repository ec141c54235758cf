// SPDX-License-Identifier: MIT
#include "samples/classify_footprints.hpp"

#include "kernels/samples/classify_footprints.h"

namespace gnomon {
namespace {

PointInputs inputs_of(const Footprints& footprints) {
    PointInputs inputs = point_inputs(footprints.centres);
    inputs.footprints = footprints.buffer.get();
    inputs.expected_footprints = footprints.expected;
    return inputs;
}

void classify_over_lists(cl::Session& session, const TraceInputs& inputs) {
    const PointInputs& points = inputs.points;
    const ListBuffers& lists = inputs.lists;
    cl::Kernel kernel = inputs.triangles.kernel("samples/classify_footprints.cl", "classify_footprints");
    // Of its own for directional lights, with fewer registers, as specialised rows of query/variants.cpp are.
    kernel.flags.directional_only = !session.is_cpu() && inputs.light_frame.perspective == 0;
    session.launch(kernel, session.blocks(points.layout.count),
                   ClassifyParams{.triangles = inputs.triangles,
                                  .light_frame = inputs.light_frame,
                                  .layout = points.layout,
                                  .first_frame = inputs.first_frame,
                                  .frame_count = inputs.frame_count,
                                  .has_map = inputs.map != nullptr,
                                  .domains = lists.tables.domains},
                   inputs.projections, inputs.triangles.vertices, points.positions, points.footprints, points.receivers,
                   inputs.map != nullptr ? *inputs.map : lists.ranges, lists.ranges, lists.entries, lists.records,
                   lists.bounds, inputs.visibility, inputs.counters);
}

}  // namespace

Statistics TracedFootprints::classify(const Footprints& footprints) {
    require_run(triangles_, footprints.centres, light_, footprints.classes);
    lists_.reset();
    TracePlan plan = plan_of_classes();
    plan.decide = [&](const FramedInputs& in, TracedRun& run) {
        is_prepared_ ? classify_prepared(in, run) : classify_frames(in, run);
    };
    return tracer_.run(triangles_, inputs_of(footprints), light_, footprints.classes.buffer(), plan);
}

void TracedFootprints::classify_frames(const FramedInputs& in, TracedRun& run) {
    tracer_.run_frames(in, run);
    if (frame_count_of(in.light_frame) == 1 && run.frames == 1 && run.total.fallback_points == 0)
        lists_ = Lists{in.light_frame, run.map};
}

// Decides facing, then the classes over the prepared lists. A footprint that the lists do not cover is mixed.
void TracedFootprints::classify_prepared(const FramedInputs& in, TracedRun& run) {
    const TraceInputs inputs = prepared_.inputs(in);
    tracer_.frames().start_facing(tracer_.session(), run.statistics,
                                  {in.triangles, in.points, inputs.light_frame, in.visibility}, tracer_.counters());
    run.plan.last_stage(inputs, run.statistics);
    run.facing = tracer_.session().read_value<FrameCounters>(tracer_.counters());
    run.frames = inputs.frame_count;
    run.used_prepared = true;
    lists_ = Lists{inputs.light_frame, inputs.map};
}

Statistics TracedFootprints::classify_parts(const Footprints& footprints) {
    if (!lists_) return classify(footprints);
    require_run(triangles_, footprints.centres, light_, footprints.classes);
    return run_on_lists(inputs_of(footprints), footprints.classes, plan_of_classes());
}

Statistics TracedFootprints::trace(const Points& samples, const Visibility& visibility) {
    require_run(triangles_, samples, light_, visibility);
    PointInputs inputs = point_inputs(samples, true);
    if (lists_ && !is_prepared_) return run_on_lists(inputs, visibility, {});
    inputs.face_light = !lists_;  // a prepared trace decides facing itself, at no cost
    return prepared_.run(triangles_, inputs, light_, visibility.buffer());
}

Statistics TracedFootprints::run_on_lists(const PointInputs& points, const Visibility& visibility,
                                          const TracePlan& plan) {
    MeasuredRun measured(tracer_.session(), tracer_.kept_bytes());
    const FramedInputs in{triangle_inputs(triangles_), points, lists_->light_frame, visibility.buffer()};
    TracedRun run{measured.stages, plan};
    FrameCounters read;
    tracer_.clear_counters();
    tracer_.run_last_stages(is_prepared_ ? prepared_.inputs(in) : tracer_.frame_inputs(in, 0, lists_->map), run, read);
    return measured.finish();
}

TracePlan TracedFootprints::plan_of_classes() {
    return {.last_stage = [&](const TraceInputs& inputs, Statistics& statistics) {
        const cl::StageTimer timer(tracer_.session(), statistics, "classify_footprints");
        classify_over_lists(tracer_.session(), inputs);
    }};
}

}  // namespace gnomon
