// SPDX-License-Identifier: MIT
// The pipeline of exact shadows. Each stage is a file of its own (kernels/<wing>/<stage>.cl, host/<wing>/<stage>.cpp).
// This file has the order of the stages; occluders/occluder_lists.hpp has that of the stages from clusters to bins:
//
//   light_order       points that come in no order are sorted in the light's plane (trace/light_order.hpp)
//   facing            one pass over the points: backfacing points are decided, the others are open
//   light_frame       grid fitted to the open points; one for a directional light, six for a point light
//   receiver_depth_pyramid   how far from the light the open points reach, per bin
//   clusters to bins  the map, which decides open points, and for each bin the list of its occluders
//   trace             open points against the map, then against their bin's triangles by the filter
//   exact_trace       decides the pairs that the filter left undecided
//
// Under a prepared light (prepared/prepared_runs.cpp) facing and trace are one pass, prepared_trace, and only
// exact_trace follows.
//
// Footprints (samples/classify_footprints.cpp) go through the same stages, with one stage, classify_footprints, instead
// of the last two; the last two then decide the samples of mixed footprints, over the same lists.
//
// Lists are filled optimistically: a list that turns out too short is grown and the frame is run again; the trace does
// no work before all lists fit. trace_queue_overflow decides the undecided pairs that found no room.
#include "trace/frustum_tracer.hpp"

namespace gnomon {
namespace {

// Gives stages that had no work the reason.
void mark_skipped(Statistics& statistics, std::string_view stage, const std::string& why) {
    for (StageStatistics& s : statistics.stages)
        if (s.name == stage && s.skipped.empty()) s.skipped = why;
}

void describe_counts(const FramedInputs& in, TracedRun& run) {
    const FrameCounters &t = run.total, &facing = run.facing;
    const std::uint64_t in_shadow = std::uint64_t(facing.facing_away) + t.decided_by_map + t.decided_by_trace;
    auto& counts = run.statistics.counts;
    counts = {{"points", in.points.layout.count},
              {"points_absent", facing.absent},
              {"points_facing_away", facing.facing_away},
              {"points_decided_by_map", t.decided_by_map},
              {"points_listed", t.listed},
              {"points_decided_by_trace", t.decided_by_trace},
              {"points_decided_by_exact", t.decided_by_exact},
              {"points_in_shadow", in_shadow + t.decided_by_exact},
              {"triangles", in.triangles.count},
              {"frames", run.frames},
              {"clusters", in.triangles.clusters != nullptr ? in.triangles.clusters->count() : 0},
              {"clusters_outside", t.clusters_outside},
              {"clusters_too_far", t.clusters_too_far}};
    add_list_counts(counts, t);
    counts.insert(counts.end(), {{"tests", run.tests},
                                 {"uncertain_pairs", t.uncertain},
                                 {"decided_by_float", t.exact_float},
                                 {"decided_by_double", t.exact_double},
                                 {"decided_by_integers", t.exact_exact},
                                 {"orientations_by_integers", std::uint64_t(t.setup_exact) + facing.facing_exact},
                                 {"lists_grown", run.lists_grown},
                                 {"points_sorted", run.sorted_points},
                                 {"prepared", run.used_prepared},
                                 {"prepared_fallback_points", run.fallback_points}});
}

}  // namespace

void add_list_counts(decltype(Statistics::counts)& counts, const FrameCounters& counted) {
    counts.insert(counts.end(), {{"triangles_not_finite", counted.not_finite},
                                 {"triangles_edge_on", counted.edge_on},
                                 {"triangles_outside", counted.outside},
                                 {"triangles_kept", counted.survivors - counted.edge_on},
                                 {"triangles_hidden", counted.hidden},
                                 {"map_candidates", counted.map_candidates},
                                 {"map_texels_written", counted.map_texels},
                                 {"references", counted.references}});
}

void FrustumTracer::set(const TracerSettings& settings) {
    settings_ = settings;
    map_choice_.set(settings.map_mode);
    lists_.limit_initial_capacity(settings.first_capacity);
    trace_.limit_initial_capacity(settings.first_capacity);
}

// ---- A frame --------------------------------------------------------------------------------------------------------

TraceInputs FrustumTracer::frame_inputs(const FramedInputs& in, cl_uint frame, const cl::Buffer* map) const {
    return trace_inputs(in, frame, frames_.projection(), map, list_buffers(lists_.bins(), lists_.setup()), counters_);
}

void FrustumTracer::observe(Moment moment, const TraceInputs& inputs, const TracedRun& run) {
    if (run.plan.provenance != nullptr) run.plan.provenance->record(session_, moment, inputs, trace_);
}

std::optional<FrameCounters> FrustumTracer::run_last_stages(const TraceInputs& inputs, TracedRun& run,
                                                            FrameCounters& first_read) {
    if (run.plan.last_stage) {
        run.plan.last_stage(inputs, run.statistics);
    } else {
        cl::StageTimer timer(session_, run.statistics, "trace");
        trace_.run(session_, Task::trace, inputs, frames_.blocks());
        observe(Moment::after_trace, inputs, run);
        timer.next("exact_trace");
        trace_.decide_queue(session_, inputs);
        observe(Moment::after_exact_trace, inputs, run);
    }
    first_read = session_.read_value<FrameCounters>(counters_);
    if (!lists_.fitted(session_, first_read)) return {};
    if (run.plan.last_stage || trace_.fitted(session_, inputs.points, first_read)) return first_read;
    observe(Moment::before_queue_overflow, inputs, run);
    return run_queue_overflow(inputs, run.statistics);
}

FrameCounters FrustumTracer::run_queue_overflow(const TraceInputs& inputs, Statistics& statistics) {
    cl::StageTimer timer(session_, statistics, "trace");
    trace_.run(session_, Task::trace_queue_overflow, inputs, nullptr);
    return session_.read_value<FrameCounters>(counters_);
}

void FrustumTracer::run_frame(const FramedInputs& in, cl_uint frame, TracedRun& run, bool counters_hold_facing) {
    if (!counters_hold_facing) clear_counters();
    frames_.reduce_depths(session_, run.statistics, in, frame);
    const ListSettings settings = map_choice_.list_settings(in.points, frame, settings_.cover_test);
    for (bool is_first = true;; is_first = false) {
        if (!is_first) clear_counters();
        run.map = lists_.run(session_, run.statistics, in.light_frame, frames_.projection(), in.triangles, settings,
                             frames_.receiver_depths(), counters_);
        FrameCounters first_read{};
        const auto counted = run_last_stages(frame_inputs(in, frame, run.map), run, first_read);
        if (is_first && counters_hold_facing) run.facing = first_read;
        if (counted) {
            run.add(*counted);
            map_choice_.note(in.points, frame, settings.draws_map, *counted);
            break;
        }
        ++run.lists_grown;
    }
    ++run.frames;
    run.maps_drawn += settings.draws_map;
}

// ---- A run ----------------------------------------------------------------------------------------------------------

// For a directional light: the host reads no counters before the frame's end, since a wait there takes as long as a
// stage. Where no point is open, the other stages find nothing to do.
void FrustumTracer::run_one_frame(const FramedInputs& in, TracedRun& run) {
    frames_.start_facing(session_, run.statistics, in, counters_);
    frames_.fit_one(session_, run.statistics, in.light_frame);
    observe(Moment::after_facing, frame_inputs(in, 0, nullptr), run);
    const std::size_t stages = run.statistics.stages.size();
    run_frame(in, 0, run, true);
    if (run.has_open_points(in.points)) return;
    run.frames = 0;
    run.statistics.stages.resize(stages);
}

void FrustumTracer::run_frames(const FramedInputs& in, TracedRun& run) {
    if (frame_count_of(in.light_frame) == 1 && in.triangles.count != 0) return run_one_frame(in, run);
    frames_.start_facing(session_, run.statistics, in, counters_);
    run.facing = session_.read_value<FrameCounters>(counters_);
    observe(Moment::after_facing, frame_inputs(in, 0, nullptr), run);
    if (in.triangles.count == 0 || !run.has_open_points(in.points)) return;
    frames_.for_each(session_, run.statistics, in.light_frame,
                     [&](cl_uint frame) { run_frame(in, frame, run, false); });
}

Statistics FrustumTracer::run(const Triangles& triangles, const PointInputs& points, const Light& light,
                              cl_mem visibility, const TracePlan& plan) {
    MeasuredRun measured(session_, kept_bytes_);
    const FrameGrid grid = run_grid(session_, settings_.map_size, triangles.count(), expected_count(points));
    FramedInputs in{triangle_inputs(triangles), points, make_light_frame(light, grid), visibility};
    counters_.reserve(session_, sizeof(FrameCounters));
    TracedRun run{measured.stages, plan};
    // The points of a picture are in order. Footprints and a record of provenance keep the order of their points.
    const bool may_sort =
        points.layout.picture_width == 0 && points.footprints == nullptr && plan.provenance == nullptr;
    const auto sorted =
        may_sort ? order_.sort(session_, measured.stages, settings_.sort_points, in.light_frame, points) : std::nullopt;
    run.sorted_points = sorted.has_value();
    if (sorted) in = {in.triangles, *sorted, in.light_frame, order_.visibility()};
    if (points.layout.count != 0) plan.decide ? plan.decide(in, run) : run_frames(in, run);
    if (sorted) order_.scatter(session_, measured.stages, points.layout.count, visibility);
    describe_stages(in, run);
    describe_counts(in, run);
    return measured.finish();
}

std::vector<std::uint32_t> FrustumTracer::run_watched(const Triangles& triangles, const Points& points,
                                                      const Light& light, const Visibility& visibility) {
    require_run(triangles, points, light, visibility);
    Provenance provenance;
    run(triangles, point_inputs(points, triangles), light, visibility.buffer(), {.provenance = &provenance});
    return points.count() != 0 ? provenance.read(session_, points.count()) : std::vector<std::uint32_t>{};
}

void FrustumTracer::describe_stages(const FramedInputs& in, TracedRun& run) const {
    Statistics& s = run.statistics;
    merge_stages(s);
    if (run.used_prepared)
        for (const char* stage :
             {"light_frame", "receiver_depth_pyramid", "triangle_setup", "conservative_map", "bins"})
            s.stages.push_back({stage, 0, 0, "prepared"});
    if (!run.used_prepared && !map_choice_.may_draw(in.points)) {
        const char* why = settings_.map_mode == MapMode::off ? "switched off" : "few points";
        s.stages.push_back({"conservative_map", 0, 0, why});
    } else if (run.frames != 0 && !run.used_prepared && run.maps_drawn == 0) {
        s.stages.push_back({"conservative_map", 0, 0, "the last one decided too little"});
    } else if (!run.used_prepared && run.total.map_candidates == 0) {
        mark_skipped(s, "conservative_map", "no triangle can cover a texel");
    }
    if (run.total.uncertain == 0) mark_skipped(s, "exact_trace", "the filter decided every pair");
    if (in.triangles.clusters == nullptr) s.stages.push_back({"clusters", 0, 0, "no clusters are kept"});
    if (run.frames == 0) s.stages.push_back({"trace", 0, 0, "no point faces the light, or there are no triangles"});
}

}  // namespace gnomon
