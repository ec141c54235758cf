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
// Under a prepared light (prepare()) facing and trace are one pass, prepared_trace, and only exact_trace follows.
//
// Footprints (samples/fragments.cpp) go through the same stages, with one stage, classify_footprints, instead of the
// last two; the last two then decide the samples of mixed footprints, over the same lists.
//
// Lists are filled optimistically: a list that turns out too short is grown and the frame is run again; the trace does
// no work before all lists fit. trace_queue_overflow decides the undecided pairs that found no room.
#include "frustum_traced.hpp"

#include <algorithm>
#include <limits>

#include "api/statistics.hpp"
#include "techniques/registered.hpp"
#include "trace/explain.hpp"

namespace gnomon {

/// The counts of one frame.
struct FrustumTraced::FrameResult {
    FrameCounters counted{};
    FrameCounters first_attempt{};  ///< before lists grew: with the counts of facing, if these were not read before
    std::uint64_t lists_grown = 0;
    bool drew_map = false;
    const cl::Buffer* map = nullptr;  ///< null where no map is drawn
};

/// The counts of a run.
struct FrustumTraced::RunResult {
    Statistics& statistics;           ///< of the stages
    FrameCounters facing{}, total{};  ///< total: over the frames
    std::uint64_t tests = 0, frames = 0, lists_grown = 0, maps_drawn = 0;
    std::uint64_t fallback_points = 0;  ///< points that a prepared light did not cover
    bool used_prepared = false, sorted_points = false;
    const cl::Buffer* map = nullptr;  ///< of the last frame

    void add(const FrameCounters& counted) {
        add_counters(total, counted);
        tests += counted.tests_low + (std::uint64_t(counted.tests_high) << 32);
    }
    void add(const FrameResult& frame) {
        ++frames;
        lists_grown += frame.lists_grown;
        maps_drawn += frame.drew_map;
        map = frame.map;
        add(frame.counted);
    }
    bool has_open_points(const PointInputs& points) const {
        return facing.absent + facing.facing_away < points.layout.count;
    }
};

namespace {

// In the order of MapMode.
constexpr std::string_view map_mode_names[] = {"on", "off", "auto"};

// In the order of SortPoints.
constexpr std::string_view sort_points_names[] = {"on", "off", "auto"};

// In the order of ManyLightsWay.
constexpr std::string_view many_lights_names[] = {"auto", "one-by-one", "shafts", "point-shafts", "rays", "horizons"};

void clear(cl::Session& session, const cl::Buffer& counters) { session.fill(counters, 0, sizeof(FrameCounters)); }

// Gives stages that had no work the reason.
void mark_skipped(Statistics& statistics, std::string_view stage, const std::string& why) {
    for (StageStatistics& s : statistics.stages)
        if (s.name == stage && s.skipped.empty()) s.skipped = why;
}

}  // namespace

const SettingsTable<FrustumTraced::Settings>& FrustumTraced::settings_table() {
    using S = Settings;
    static const SettingsTable<S> table{
        {{"conservative-map", "auto",
          "on, off or auto: decide points behind triangles that cover a whole texel at once"},
         setting::choice(&S::map_mode, map_mode_names)},
        {{"cover-test", "tight",
          "tight (Mizoguchi and Tokuyoshi) or circle (Hertel et al. 2009): when a texel counts as covered"},
         setting::choice(&S::cover_test, cover_test_names)},
        {{"map-size", "auto", "texels per side of the light's grid, 16 to 8192, or auto"},
         setting::whole_or_auto(&S::map_size, smallest_map_size, largest_map_size)},
        {{"first-capacity", "auto", "entries that growing lists start with, from 1, or auto: for tests"},
         setting::whole_or_auto(&S::first_capacity, 1, std::numeric_limits<std::uint32_t>::max())},
        {{"sort-points", "auto",
          "on, off or auto: sort points that come in no order before they are traced (auto: on a CPU)"},
         setting::choice(&S::sort_points, sort_points_names)},
        {{"many-lights", "auto",
          "auto, one-by-one, shafts, point-shafts, rays (on a GPU point-shafts) or horizons (of height fields): the "
          "way to decide many lights"},
         setting::choice(&S::many_lights, many_lights_names)},
        {{"bundle-lights", "32", "lights that a shaft decides together, 1 to 32"},
         setting::whole(&S::bundle_lights, 1, MOST_BUNDLE_LIGHTS)},
    };
    return table;
}

// ---- Whether a frame draws a map ------------------------------------------------------------------------------------

// What a run's memory goes by. How many slots of footprints are used depends on threads.
std::size_t FrustumTraced::expected_count(const PointInputs& points) const {
    return points.footprints != nullptr ? expected_footprints : points.layout.count;
}

bool FrustumTraced::may_draw_map(const PointInputs& points) const {
    if (settings_.map_mode != MapMode::automatic) return settings_.map_mode == MapMode::on;
    return expected_count(points) >= 4096;  // fewer points than that cost less to trace than a map to clear
}

// A CPU estimates in each frame whether a map is worth its cost, between two kernels. On a GPU a map's launches take a
// tenth of a frame, whatever they draw, so the rule uses the counts of the last map.
bool FrustumTraced::goes_by_last_map(const PointInputs& points) const {
    return settings_.map_mode == MapMode::automatic && !session_.is_cpu() && points.footprints == nullptr;
}

ListSettings FrustumTraced::list_settings(const PointInputs& points, cl_uint frame) const {
    const bool judges_map = settings_.map_mode == MapMode::automatic && session_.is_cpu();
    const bool skips_map = goes_by_last_map(points) && runs_without_map_[frame] != 0;
    return {may_draw_map(points) && !skips_map, judges_map, settings_.cover_test};
}

// A map saves the walks of the points that it decides, and the references of the triangles that it hides, assumed to be
// as many per triangle as for the others. On an H200 lists cost 82 us per million references (pairs, scatter and order
// of foliage v0: 609 us for 7.46 million); the other two constants are fitted to runs with and without a map. At
// 1920x1080 the rule takes the faster of the two in all of 15 views of real and made scenes.
bool FrustumTraced::map_was_worth_drawing(const FrameCounters& counted) {
    constexpr double us_per_point = 25e-6, us_per_reference = 82e-6, us_of_map = 40;
    const double listed = std::max(double(counted.survivors) - counted.edge_on - counted.hidden, 1.0);
    const double spared = counted.hidden * (counted.references / listed);
    return us_per_point * counted.decided_by_map + us_per_reference * spared >= us_of_map;
}

// A GPU leaves out a map that saves less than it costs for some runs; then it draws and judges a map again.
void FrustumTraced::note_map_benefit(const FrameResult& result, cl_uint frame) {
    constexpr std::uint32_t runs_until_next = 31;
    if (!result.drew_map)
        --runs_without_map_[frame];
    else if (!map_was_worth_drawing(result.counted))
        runs_without_map_[frame] = runs_until_next;
}

// ---- A frame --------------------------------------------------------------------------------------------------------

TraceInputs FrustumTraced::frame_inputs(const FramedInputs& in, cl_uint frame, const cl::Buffer* map) const {
    return {.light_frame = in.light_frame,
            .first_frame = frame,
            .frame_count = 1,
            .triangles = in.triangles,
            .points = in.points,
            .projections = frames_.projection(),
            .map = map,
            .lists = list_buffers(lists_.bins(), lists_.setup()),
            .visibility = in.visibility,
            .counters = counters_};
}

void FrustumTraced::observe(Moment moment, const TraceInputs& inputs) {
    if (provenance_) provenance_->record(session_, moment, inputs, trace_);
}

std::optional<FrameCounters> FrustumTraced::decide(const TraceInputs& inputs, Statistics& statistics,
                                                   FrameCounters& first_read) {
    const bool are_footprints = inputs.points.footprints != nullptr;
    if (are_footprints) {
        cl::StageTimer timer(session_, statistics, "classify_footprints");
        run_classify_footprints(session_, inputs);
    } else {
        cl::StageTimer timer(session_, statistics, "trace");
        trace_.run(session_, Task::trace, inputs, frames_.blocks());
        observe(Moment::after_trace, inputs);
        timer.next("exact_trace");
        trace_.decide_queue(session_, inputs);
        observe(Moment::after_exact_trace, inputs);
    }
    first_read = session_.read_value<FrameCounters>(counters_);
    if (!lists_.fitted(session_, first_read)) return {};
    if (are_footprints || trace_.fitted(session_, inputs.points, first_read)) return first_read;
    observe(Moment::before_queue_overflow, inputs);
    return run_queue_overflow(inputs, statistics);
}

FrameCounters FrustumTraced::run_queue_overflow(const TraceInputs& inputs, Statistics& statistics) {
    cl::StageTimer timer(session_, statistics, "trace");
    trace_.run(session_, Task::trace_queue_overflow, inputs, nullptr);
    return session_.read_value<FrameCounters>(counters_);
}

FrustumTraced::FrameResult FrustumTraced::run_frame(const FramedInputs& in, cl_uint frame, Statistics& statistics,
                                                    bool counters_hold_facing) {
    if (!counters_hold_facing) clear(session_, counters_);
    frames_.reduce_depths(session_, statistics, in, frame);
    FrameResult result;
    const ListSettings settings = list_settings(in.points, frame);
    for (;; ++result.lists_grown) {
        if (result.lists_grown != 0) clear(session_, counters_);
        result.map = lists_.run(session_, statistics, in.light_frame, frames_.projection(), in.triangles, settings,
                                frames_.receiver_depths(), counters_);
        FrameCounters read{};
        const auto counted = decide(frame_inputs(in, frame, result.map), statistics, read);
        if (result.lists_grown == 0) result.first_attempt = read;
        if (!counted) continue;
        result.counted = *counted;
        result.drew_map = settings.draws_map;
        if (may_draw_map(in.points) && goes_by_last_map(in.points)) note_map_benefit(result, frame);
        return result;
    }
}

// ---- A run ----------------------------------------------------------------------------------------------------------

TraceInputs FrustumTraced::prepared_inputs(const FramedInputs& in) const {
    const LightFrame& light_frame = prepared_->light_frame();
    return {.light_frame = light_frame,
            .first_frame = 0,
            .frame_count = frame_count_of(light_frame),
            .triangles = in.triangles,
            .points = in.points,
            .projections = prepared_->projections(),
            .map = prepared_->map(),
            .lists = prepared_->lists(),
            .visibility = in.visibility,
            .counters = counters_};
}

// Facing, then the classes over the prepared lists. What they do not cover is mixed.
void FrustumTraced::classify_prepared(const FramedInputs& in, RunResult& result) {
    const TraceInputs inputs = prepared_inputs(in);
    frames_.start_facing(session_, result.statistics, {in.triangles, in.points, inputs.light_frame, in.visibility},
                         counters_);
    cl::StageTimer timer(session_, result.statistics, "classify_footprints");
    run_classify_footprints(session_, inputs);
    result.facing = session_.read_value<FrameCounters>(counters_);
    result.frames = inputs.frame_count;
    footprint_lists_ = FootprintLists{inputs.light_frame, inputs.map, true};
}

// Runs only the stages that depend on the points; false if there are fallback points.
bool FrustumTraced::run_prepared(const FramedInputs& in, RunResult& result) {
    const TraceInputs inputs = prepared_inputs(in);
    const LightFrame& light_frame = inputs.light_frame;
    const auto trace = [&](Task task) {
        clear(session_, counters_);
        cl::StageTimer timer(session_, result.statistics, "trace");
        const bool caches = task == Task::trace_prepared_cached_facing;
        trace_.run(session_, task, inputs, caches ? &frames_.empty_facing_cache(session_, in.triangles) : nullptr);
        timer.next("exact_trace");
        trace_.decide_queue(session_, inputs);
        timer.next(nullptr);
        return session_.read_value<FrameCounters>(counters_);
    };
    const Task task = prepared_trace_task(session_, in.points, light_frame.perspective == 0);
    FrameCounters counted = trace(task);
    if (task == Task::trace_prepared_plane_side && counted.fallback_points != 0) counted = trace(Task::trace_prepared);
    result.fallback_points = counted.fallback_points;
    if (counted.fallback_points != 0) return false;
    if (!trace_.fitted(session_, in.points, counted)) counted = run_queue_overflow(inputs, result.statistics);
    result.frames = inputs.frame_count;
    result.facing = counted;
    result.add(counted);
    result.statistics.stages.push_back({"facing", 0, 0, "decided by the trace"});
    return true;
}

// For a directional light on a GPU: the host reads no counters before the frame's end, since a wait there takes as long
// as a stage. (On a CPU a wait is free, and where no point is open the other stages need not run.)
void FrustumTraced::run_one_frame(const FramedInputs& in, RunResult& result) {
    Statistics& statistics = result.statistics;
    frames_.start_facing(session_, statistics, in, counters_);
    frames_.fit_one(session_, statistics, in.light_frame);
    observe(Moment::after_facing, frame_inputs(in, 0, nullptr));
    const std::size_t stages = statistics.stages.size();
    const FrameResult frame = run_frame(in, 0, statistics, true);
    result.facing = frame.first_attempt;
    result.add(frame);
    if (result.has_open_points(in.points)) return;
    result.frames = 0;
    statistics.stages.resize(stages);
}

void FrustumTraced::run_unprepared(const FramedInputs& in, RunResult& result) {
    if (frame_count_of(in.light_frame) == 1 && in.triangles.count != 0 && !session_.is_cpu())
        return run_one_frame(in, result);
    frames_.start_facing(session_, result.statistics, in, counters_);
    result.facing = session_.read_value<FrameCounters>(counters_);
    observe(Moment::after_facing, frame_inputs(in, 0, nullptr));
    if (in.triangles.count == 0 || !result.has_open_points(in.points)) return;
    frames_.for_each(session_, result.statistics, in.light_frame,
                     [&](cl_uint frame) { result.add(run_frame(in, frame, result.statistics, false)); });
}

Statistics FrustumTraced::run_light(const Triangles& triangles, const Points& points, const Light& light,
                                    const Visibility& visibility) {
    require_run(triangles, points, light, visibility);
    const PointInputs inputs = point_inputs(points, are_lifted_off(triangles, points));
    return run_on(triangles, inputs, light, visibility.buffer());
}

Statistics FrustumTraced::classify_footprints(const Triangles& triangles, const Points& centres,
                                              const cl::Buffer& footprints, const Light& light,
                                              const Visibility& answers) {
    require_run(triangles, centres, light, answers);
    PointInputs inputs = point_inputs(centres);
    inputs.footprints = footprints.get();
    return run_on(triangles, inputs, light, answers.buffer());
}

Statistics FrustumTraced::classify_parts(const Triangles& triangles, const Points& centres,
                                         const cl::Buffer& footprints, const Light& light, const Visibility& answers) {
    if (!footprint_lists_) return classify_footprints(triangles, centres, footprints, light, answers);
    require_run(triangles, centres, light, answers);
    PointInputs inputs = point_inputs(centres);
    inputs.footprints = footprints.get();
    return run_on_footprint_lists(triangles, inputs, answers.buffer());
}

Statistics FrustumTraced::trace_mixed(const Triangles& triangles, const Points& samples, const Light& light,
                                      const Visibility& visibility) {
    require_run(triangles, samples, light, visibility);
    PointInputs inputs = point_inputs(samples, true);
    if (footprint_lists_ && !footprint_lists_->is_prepared)
        return run_on_footprint_lists(triangles, inputs, visibility.buffer());
    inputs.face_light = !footprint_lists_;  // a prepared trace decides facing on the way, which costs nothing
    return run_on(triangles, inputs, light, visibility.buffer());
}

Statistics FrustumTraced::run_on_footprint_lists(const Triangles& triangles, const PointInputs& points,
                                                 cl_mem visibility) {
    MeasuredRun measured(session_, kept_bytes_);
    const FramedInputs in{triangle_inputs(triangles), points, footprint_lists_->light_frame, visibility};
    FrameCounters read;
    clear(session_, counters_);
    decide(footprint_lists_->is_prepared ? prepared_inputs(in) : frame_inputs(in, 0, footprint_lists_->map),
           measured.stages, read);
    return measured.finish();
}

// Shafts share the work of neighbouring points and lights, one light at a time that of all points, and single rays meet
// the fewest triangles. Which takes least time depends on how large triangles are beside the distances of points and
// lights, so `auto` measures them where that pays.
Statistics FrustumTraced::run_table(const Triangles& triangles, const Points& points, const Lights& lights,
                                    const LightsOutputs& outputs, const LightsOptions& options) {
    constexpr std::size_t few_lights = 4, pairs_worth_one_light = std::size_t(1) << 25;
    const bool is_auto = settings_.many_lights == ManyLightsWay::automatic;
    const bool is_empty = triangles.count() == 0 || points.count() == 0 || lights.count() == 0;
    if (settings_.many_lights == ManyLightsWay::one_by_one || is_empty || (is_auto && lights.count() < few_lights))
        return Technique::run_table(triangles, points, lights, outputs, options);
    std::uint64_t kept = kept_bytes_;  // runs of one light within this one note what they keep
    MeasuredRun measured(session_, kept);
    const Triangles clustered = is_auto ? with_clusters(device_, triangles) : triangles;
    const LightsRun run{device_, clustered, points, lights, outputs, options};
    require_lights_run(run);
    cl::StageTimer timer(session_, measured.stages, "point_order");
    const SortedPoints& sorted = sort_points(run);
    timer.next("shaft_tree");
    const TreeRun through_tree{run, sorted, kept_of(tree_, triangles)};
    timer.next(nullptr);
    const SortedPoints* in_order = points.camera() ? nullptr : &sorted;
    // Light by light was faster for the points of some pictures, seldom for others (docs/many_lights.md), which a GPU
    // measures where the next runs can use it.
    OneLightMs one_light_ms;
    const bool may_come_again = !session_.is_cpu() && Internals::clusters(triangles) != nullptr;
    if (is_auto && (points.camera() || may_come_again) && points.count() * lights.count() >= pairs_worth_one_light)
        one_light_ms = [&] { return time_of_one_light(*this, run, in_order); };
    const auto field = [&]() -> const BuiltHeightField* {
        const cl::StageTimer field_timer(session_, measured.stages, "height_field");
        const BuiltHeightField& built = kept_of(field_, triangles);
        return built.is_field() ? &built : nullptr;
    };
    std::optional<ManyLightsWay> way = way_of(run);
    if (way != ManyLightsWay::one_by_one)
        way = run_through_tree(through_tree, *way, is_auto, settings_.bundle_lights, field, one_light_ms,
                               measured.stages);
    if (way) note_way(run, *way);
    if (way && way != ManyLightsWay::one_by_one) return measured.finish(measured.stages.counts);
    if (!is_auto)
        throw InvalidArgument(
            "shafts and rays decide lights that are all directional or all point lights, and coordinates up to 2^19, "
            "and horizons directional lights over triangles that lie side by side over a plane: use many-lights=auto");
    run_one_by_one(*this, run, in_order, measured.stages);
    return measured.finish({{"points", points.count()}, {"lights", lights.count()}});
}

ManyLightsWay FrustumTraced::way_of(const LightsRun& run) {
    if (settings_.many_lights != ManyLightsWay::automatic) return settings_.many_lights;
    if (way_taken_ && (way_taken_->runs_left == 0 || way_taken_->point_count != run.points.count() ||
                       way_taken_->is_picture != run.points.camera().has_value() ||
                       !std::ranges::equal(way_taken_->lights, run.lights.lights(), {}, &Light::xyzw, &Light::xyzw)))
        way_taken_.reset();
    if (!way_taken_) return ManyLightsWay::automatic;
    --way_taken_->runs_left;
    return way_taken_->way;
}

// Measuring takes a tenth of many runs, of those with few lights more. It may be misled by what else the machine does,
// so a way does not serve for ever.
void FrustumTraced::note_way(const LightsRun& run, ManyLightsWay taken) {
    constexpr std::uint32_t runs_of_a_way = 7;
    if (settings_.many_lights != ManyLightsWay::automatic || way_taken_) return;
    const std::span<const Light> lights = run.lights.lights();
    way_taken_ = WayTaken{.lights = {lights.begin(), lights.end()},
                          .point_count = run.points.count(),
                          .is_picture = run.points.camera().has_value(),
                          .way = taken,
                          .runs_left = runs_of_a_way};
}

// Kept as long as the caller keeps the clusters of the same triangles: the promise not to write the vertices lasts so
// long.
template <typename Built>
const Built& FrustumTraced::kept_of(std::unique_ptr<Built>& kept, const Triangles& triangles) {
    const Clusters* clusters = Internals::clusters(triangles);
    if (kept && clusters != nullptr && clusters == Internals::clusters(kept->triangles())) return *kept;
    const MeasuredRun built(session_, kept_bytes_);
    way_taken_.reset();
    kept.reset();
    kept = std::make_unique<Built>(device_, triangles);
    return *kept;
}

const SortedPoints& FrustumTraced::sort_points(const LightsRun& run) {
    const MeasuredRun made(session_, kept_bytes_);
    sorted_points_ = sorted_points(run, std::move(sorted_points_));
    return sorted_points_;
}

// The points of a picture are in order. Footprints and a record of provenance keep the order of their points.
bool FrustumTraced::may_sort(const PointInputs& points) const {
    return points.layout.picture_width == 0 && points.footprints == nullptr && !provenance_;
}

Statistics FrustumTraced::run_on(const Triangles& triangles, const PointInputs& points, const Light& light,
                                 cl_mem visibility) {
    MeasuredRun measured(session_, kept_bytes_);
    const FrameGrid grid = run_grid(session_, settings_.map_size, triangles.count(), expected_count(points));
    FramedInputs in{triangle_inputs(triangles), points, make_light_frame(light, grid), visibility};
    footprint_lists_.reset();
    counters_.reserve(session_, sizeof(FrameCounters));
    RunResult result{measured.stages};
    const auto sorted = may_sort(points)
                            ? order_.sort(session_, measured.stages, settings_.sort_points, in.light_frame, points)
                            : std::nullopt;
    result.sorted_points = sorted.has_value();
    if (sorted) in = {in.triangles, *sorted, in.light_frame, order_.visibility()};
    if (points.layout.count != 0) {
        const bool is_prepared =
            !provenance_ && prepared_ && prepared_->is_usable() && prepared_->is_of(triangles, light);
        if (is_prepared && points.footprints != nullptr) classify_prepared(in, result);
        result.used_prepared = is_prepared && (points.footprints != nullptr || run_prepared(in, result));
        if (!result.used_prepared) run_unprepared(in, result);
    }
    if (sorted) order_.scatter(session_, measured.stages, points.layout.count, visibility);
    const bool has_one_frame = frame_count_of(in.light_frame) == 1 && result.frames == 1;
    if (points.footprints != nullptr && has_one_frame && !result.used_prepared && result.total.fallback_points == 0)
        footprint_lists_ = FootprintLists{in.light_frame, result.map, false};
    describe_stages(in, result);
    describe_counts(in, result);
    return measured.finish();
}

// ---- Statistics -----------------------------------------------------------------------------------------------------

void FrustumTraced::describe_stages(const FramedInputs& in, RunResult& result) const {
    Statistics& s = result.statistics;
    merge_stages(s);
    if (result.used_prepared)
        for (const char* stage :
             {"light_frame", "receiver_depth_pyramid", "triangle_setup", "conservative_map", "bins"})
            s.stages.push_back({stage, 0, 0, "prepared"});
    if (!result.used_prepared && !may_draw_map(in.points)) {
        const char* why = settings_.map_mode == MapMode::off ? "switched off" : "few points";
        s.stages.push_back({"conservative_map", 0, 0, why});
    } else if (result.frames != 0 && !result.used_prepared && result.maps_drawn == 0) {
        s.stages.push_back({"conservative_map", 0, 0, "the last one decided too little"});
    } else if (!result.used_prepared && result.total.map_candidates == 0) {
        mark_skipped(s, "conservative_map", "no triangle can cover a texel");
    }
    if (result.total.uncertain == 0) mark_skipped(s, "exact_trace", "the filter decided every pair");
    if (in.triangles.clusters == nullptr) s.stages.push_back({"clusters", 0, 0, "no clusters are kept"});
    if (result.frames == 0) s.stages.push_back({"trace", 0, 0, "no point faces the light, or there are no triangles"});
}

void FrustumTraced::describe_counts(const FramedInputs& in, RunResult& result) {
    const FrameCounters &t = result.total, &facing = result.facing;
    const std::uint64_t in_shadow = std::uint64_t(facing.facing_away) + t.decided_by_map + t.decided_by_trace;
    result.statistics.counts = {{"points", in.points.layout.count},
                                {"points_absent", facing.absent},
                                {"points_facing_away", facing.facing_away},
                                {"points_decided_by_map", t.decided_by_map},
                                {"points_listed", t.listed},
                                {"points_decided_by_trace", t.decided_by_trace},
                                {"points_decided_by_exact", t.decided_by_exact},
                                {"points_in_shadow", in_shadow + t.decided_by_exact},
                                {"triangles", in.triangles.count},
                                {"frames", result.frames},
                                {"clusters", in.triangles.clusters != nullptr ? in.triangles.clusters->count() : 0},
                                {"clusters_outside", t.clusters_outside},
                                {"clusters_too_far", t.clusters_too_far},
                                {"triangles_not_finite", t.not_finite},
                                {"triangles_edge_on", t.edge_on},
                                {"triangles_outside", t.outside},
                                {"triangles_kept", t.survivors - t.edge_on},
                                {"triangles_hidden", t.hidden},
                                {"map_candidates", t.map_candidates},
                                {"map_texels_written", t.map_texels},
                                {"references", t.references},
                                {"tests", result.tests},
                                {"uncertain_pairs", t.uncertain},
                                {"decided_by_float", t.exact_float},
                                {"decided_by_double", t.exact_double},
                                {"decided_by_integers", t.exact_exact},
                                {"orientations_by_integers", std::uint64_t(t.setup_exact) + facing.facing_exact},
                                {"lists_grown", result.lists_grown},
                                {"points_sorted", result.sorted_points},
                                {"prepared", result.used_prepared},
                                {"prepared_fallback_points", result.fallback_points}};
}

std::vector<std::uint32_t> FrustumTraced::run_watched(const Triangles& triangles, const Points& points,
                                                      const Light& light, const Visibility& visibility) {
    struct Watch {
        explicit Watch(std::optional<Provenance>& provenance) : provenance_(provenance) { provenance_.emplace(); }
        ~Watch() { provenance_.reset(); }
        std::optional<Provenance>& provenance_;
    } const watch(provenance_);
    run_light(triangles, points, light, visibility);
    if (points.count() == 0) return {};
    return provenance_->read(session_, points.count());
}

std::vector<std::uint8_t> FrustumTraced::draw_diagnostic(std::string_view name, const Triangles& triangles,
                                                         const Points& points, const Light& light) {
    if (name != "decided") return Technique::draw_diagnostic(name, triangles, points, light);
    const Visibility visibility(device_, points.count());
    const std::vector<std::uint32_t> provenance = run_watched(triangles, points, light, visibility);
    return provenance_colors(provenance, visibility.read());
}

Explanation explain(const Device& device, const Triangles& triangles, const Points& points, std::size_t index,
                    const Light& light, const Facing& facing) {
    if (index >= points.count())
        throw InvalidArgument("there is no point " + std::to_string(index) + " to explain: there are " +
                              std::to_string(points.count()));
    const Points seen = seen_from_eye(device, points, facing);
    const Visibility visibility(device, points.count());
    const std::uint32_t provenance = FrustumTraced(device).run_watched(triangles, seen, light, visibility)[index];
    Explanation explanation = explain_signs(device, triangles, seen, index, light);
    add_provenance(explanation, provenance, visibility.read()[index]);
    return explanation;
}

// ---- Preparing ------------------------------------------------------------------------------------------------------

Statistics FrustumTraced::prepare(const Triangles& triangles, const Light& light) {
    require_light(light);
    release_prepared_light();
    if (triangles.count() == 0) return {};
    MeasuredRun measured(session_, kept_bytes_);
    const FrameGrid grid = prepared_grid(session_, settings_.map_size, triangles.count(), !light.is_directional());
    prepared_ = std::make_unique<PreparedLight>(
        session_, measured.stages, triangles, light, grid,
        ListSettings{settings_.map_mode != MapMode::off, false, settings_.cover_test}, settings_.first_capacity);
    merge_stages(measured.stages);
    const FrameCounters& c = prepared_->counted();
    return measured.finish({{"triangles", triangles.count()},
                            {"triangles_not_finite", c.not_finite},
                            {"triangles_edge_on", c.edge_on},
                            {"triangles_outside", c.outside},
                            {"triangles_kept", c.survivors - c.edge_on},
                            {"triangles_hidden", c.hidden},
                            {"map_candidates", c.map_candidates},
                            {"map_texels_written", c.map_texels},
                            {"references", c.references},
                            {"prepared", prepared_->is_usable()},
                            {"prepared_bytes", prepared_->bytes()}});
}

void FrustumTraced::release_prepared_light() {
    const MeasuredRun freed(session_, kept_bytes_);
    prepared_.reset();
    tree_.reset();
    field_.reset();
    way_taken_.reset();
    sorted_points_ = {};
}

void FrustumTraced::set(std::string_view name, std::string_view value) {
    release_prepared_light();
    settings_table().set(settings_, "frustum-traced", name, value);
    lists_.limit_initial_capacity(settings_.first_capacity);
    trace_.limit_initial_capacity(settings_.first_capacity);
}

TechniqueDescription FrustumTraced::describe() {
    return {"frustum-traced",
            "exact hard shadows: points are traced over lists of the triangles that may block them, with a "
            "conservative map",
            true,
            settings_table().descriptions(),
            {{"decided",
              "what decided each point: pale and blue the filter, dark blue the map, green to red the exact "
              "predicate; docs/techniques.md has the legend"}}};
}

Registered frustum_traced_technique() { return registered<FrustumTraced>(); }

}  // namespace gnomon
