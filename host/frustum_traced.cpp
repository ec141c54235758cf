// SPDX-License-Identifier: MIT
// The pipeline of exact shadows. Each stage is a room of its own (kernels/<stage>.cl, host/<stage>.cpp); only this file
// knows their order:
//
//   facing            one pass over the points: those that face away are decided, the others are open
//   light_frame       grid fitted to the open points; one for a direction, six for a position
//   receiver_depth_pyramid   how far from the light they reach, per bin
//   clusters          where they are kept: those that can matter
//   triangle_setup    triangles that can matter, each with a float filter
//   conservative_map  where one triangle covers a whole texel
//   bins              triangles are listed by bin
//   trace             open points against the map, then against their bin's triangles by the filter
//   exact_trace       what the filter left open
//
// Under a prepared light (prepare()) facing and trace are one pass, prepared_trace, and only exact_trace follows.
//
// Footprints (samples/fragments.cpp) take the same way, with one stage, classify_footprints, in place of the last two;
// these follow for the samples of mixed footprints, over the same lists.
//
// With traversal=triangles, the baseline to compare with, izb lists the open points by bin and the trace takes each
// listed triangle over them.
//
// Lists are filled optimistically: a list that turns out too small is grown and the frame is run again; the trace does
// nothing before they fit. Undecided pairs that found no room are decided by a second look at their points.
#include "frustum_traced.hpp"

#include <algorithm>
#include <limits>

#include "api/settings_table.hpp"
#include "api/statistics.hpp"
#include "trace/exact_trace.hpp"

namespace gnomon {

struct FrustumTraced::Run {
    cl::Session& session;
    TriangleInputs triangles;
    PointInputs points;
    Light light;
    LightFrame light_frame;
    cl_mem visibility;
    const cl::Buffer* map = nullptr;  ///< of the last frame; null where there is none
    Statistics statistics{};
    FrameCounters total{};  ///< over the frames
    std::uint64_t tests = 0;
    std::uint64_t frames = 0, grown = 0, maps = 0;
    FrameCounters facing{};
    bool counts_facing = false;         ///< what facing counted is still to be read, with what the frame counts
    std::uint64_t fallback_points = 0;  ///< points that a prepared light was of no use for

    bool has_open_points() const { return facing.absent + facing.facing_away < points.layout.count; }
};

namespace {

constexpr std::uint32_t smallest_map = 16, largest_map = 8192;

// In the order of MapMode and Traversal.
constexpr std::string_view map_mode_names[] = {"on", "off", "auto"};
constexpr std::string_view traversal_names[] = {"points", "triangles"};

void clear(cl::Session& session, const cl::Buffer& counters) { session.fill(counters, 0, sizeof(FrameCounters)); }

// Stages that had nothing to do say why.
void mark_skipped(Statistics& statistics, std::string_view stage, const std::string& why) {
    for (StageStatistics& s : statistics.stages)
        if (s.name == stage && s.skipped.empty()) s.skipped = why;
}

// Texels per side of a frame that a GPU keeps, which are bins as well: the finer, the shorter the lists of all the
// scene's triangles. Measured on an H200 with 1024, 2048, 4096 and 8192: Sponza at 2K .22, .146 and .130 ms for 60, 163
// and 544 MB; at 4K the city of 6.5 million triangles .83 -> .52 (4096) for 697 -> 1340 MB, pipes of 12.8 million 2.65
// -> 1.05 (4096) -> .87 (8192) for 1.8, 3.3 and 5.4 GB. A lamp has six frames.
std::uint32_t prepared_size(std::size_t triangle_count, std::uint64_t device_bytes, bool is_point_light) {
    std::uint32_t size = 8192;
    if (triangle_count < 1u << 23 || device_bytes < 64ull << 30) size = 4096;
    if (triangle_count < 1u << 20 || device_bytes < 16ull << 30) size = 2048;
    if (triangle_count < 1u << 17) size = 1024;
    return is_point_light ? std::max(size / 2, 1024u) : size;
}

}  // namespace

FrameGrid FrustumTraced::grid(std::size_t triangle_count, std::size_t point_count) const {
    const cl::Session& session = device_.session();
    if (map_size_ != 0) return binned(session, map_size_);
    // Measured on Sponza and lost_empire at 2K and 4K: a CPU pays for every texel drawn, a GPU hardly. On an H200 the
    // trace of millions of triangles gains more by 1024 than the lists lose (at 4K pipes v0 6.7 -> 4.6 ms, foliage
    // v0 3.4 -> 2.9, the city between 3.0 -> 2.2 and 1.28 -> 1.36); with a million it is even, with Sponza a loss.
    const std::uint32_t largest = session.is_cpu() ? 256 : triangle_count < 1u << 22 ? 512 : 1024;
    // Few points want few bins: a large triangle is asked about every bin it meets, also those that hold no point.
    std::uint32_t size = 4;
    while (size < largest && std::size_t(size) * size * 4 < point_count) size *= 2;
    return binned(session, size);
}

FrameGrid FrustumTraced::prepared_grid(std::size_t triangle_count, bool is_point_light) const {
    // Finer than a run's own, since making them no longer counts, and since the frame holds all triangles and not those
    // of a view.
    const cl::Session& session = device_.session();
    FrameGrid grid{map_size_ != 0 ? map_size_ : 1024u, 0};
    std::uint32_t most_bins = largest_map;
    if (!session.is_cpu()) {
        if (map_size_ == 0)
            grid.size = prepared_size(triangle_count, session.description().global_memory_bytes, is_point_light);
    } else {
        // Counted on Sponza: of 256, 512, 1024 and 2048 texels and 128, 256 and 512 bins this leaves a trace the fewest
        // tests (a tenth to a quarter fewer than 512), but for 2048, where making the map takes five times as long. A
        // list's entries come 16 at a time, so that a bin of few is mostly empty; but to read long lists is what
        // scenes of millions cost (docs/performance.md).
        most_bins = 256;
        while (most_bins < 1024 && triangle_count > std::size_t(most_bins) * most_bins * 8) most_bins *= 2;
    }
    while (grid.bins() > most_bins) ++grid.bin_log2;
    return grid;
}

bool FrustumTraced::draws_map(const PointInputs& points) const {
    if (map_mode_ != MapMode::automatic) return map_mode_ == MapMode::on;
    return points.layout.count >= 4096;  // fewer points than that cost less to trace than a map to clear
}

bool FrustumTraced::goes_by_last_map(const PointInputs& points) const {
    return map_mode_ == MapMode::automatic && !device_.session().is_cpu() && points.footprints == nullptr;
}

// A CPU asks in each frame whether a map is worth its while, between two kernels. A GPU would pay for that even where
// the answer is no: the launches of a map take a tenth of a frame, whatever they draw. So it goes by the last map.
ListSettings FrustumTraced::list_settings(const PointInputs& points, cl_uint frame) const {
    const bool judges_map = map_mode_ == MapMode::automatic && device_.session().is_cpu();
    return {draws_map(points) && !(goes_by_last_map(points) && runs_without_map_[frame] != 0), judges_map, cover_test_};
}

// What a map saves: the walks of the points that it decides, and the references of the triangles that it hides, which
// would have had about as many as the others have. On an H200 lists cost 82 us per million references (pairs, scatter
// and order of foliage v0: 609 us for 7.46 million); the other two are fitted to runs with and without a map. At
// 1920x1080 the rule takes the faster of the two in all of 15 views of real and made scenes.
bool FrustumTraced::was_worth_a_map(const FrameCounters& counted) {
    constexpr double us_per_point = 25e-6, us_per_reference = 82e-6, us_of_map = 40;
    const double listed = std::max(double(counted.survivors) - counted.edge_on - counted.hidden, 1.0);
    const double spared = counted.hidden * (counted.references / listed);
    return us_per_point * counted.decided_by_map + us_per_reference * spared >= us_of_map;
}

// A map that saves less than it costs is left out by a GPU for some runs; then it looks again.
void FrustumTraced::judge_last_map(bool was_drawn, const FrameCounters& counted, cl_uint frame) {
    constexpr std::uint32_t runs_until_next = 31;
    if (!was_drawn)
        --runs_without_map_[frame];
    else if (!was_worth_a_map(counted))
        runs_without_map_[frame] = runs_until_next;
}

void FrustumTraced::add(Run& run, const FrameCounters& counted) {
    add_counters(run.total, counted);
    run.tests += counted.tests_low + (std::uint64_t(counted.tests_high) << 32);
}

std::optional<FrameCounters> FrustumTraced::run_frame_once(Run& run, cl_uint frame) {
    cl::Session& session = run.session;
    Statistics& statistics = run.statistics;
    const LightFrame& light_frame = run.light_frame;
    const cl::Buffer* map = lists_.run(session, statistics, light_frame, frames_.projection(), run.triangles,
                                       list_settings(run.points, frame), receiver_depth_pyramid_, counters_);
    run.map = map;
    return decide_by_lists(run, frame);
}

std::optional<FrameCounters> FrustumTraced::decide_by_lists(Run& run, cl_uint frame) {
    cl::Session& session = run.session;
    Statistics& statistics = run.statistics;
    const LightFrame& light_frame = run.light_frame;
    const cl::Buffer* map = run.map;
    const TraceInputs inputs{light_frame,
                             frame,
                             1,
                             run.triangles,
                             run.points,
                             frames_.projection(),
                             map,
                             list_buffers(lists_.bins(), lists_.setup()),
                             run.visibility,
                             counters_};
    if (run.points.footprints != nullptr) {
        cl::StageTimer timer(session, statistics, "classify_footprints");
        run_classify_footprints(session, inputs);
    } else if (traversal_ == Traversal::triangles) {
        {
            cl::StageTimer timer(session, statistics, "izb");
            izb_.run(session, light_frame, frame, run.points, frames_.projection(), map, run.visibility, counters_);
        }
        cl::StageTimer timer(session, statistics, "trace");
        trace_.run_triangles(session, light_frame, run.triangles, run.points, izb_, lists_.bins(), lists_.setup(),
                             run.visibility, counters_);
    } else {
        cl::StageTimer timer(session, statistics, "trace");
        trace_.run(session, inputs, frames_.blocks());
    }
    if (provenance_)
        provenance_->trace(session, light_frame, frame, run.points, frames_.projection(), map, run.visibility);
    if (run.points.footprints == nullptr) {
        cl::StageTimer timer(session, statistics, "exact_trace");
        run_exact_trace(session, run.triangles, run.points, run.light, trace_, run.visibility, counters_);
    }
    if (provenance_)
        provenance_->exact_trace(session, run.triangles, run.points, run.light, trace_, run.visibility, counters_);
    FrameCounters counted = session.read_value<FrameCounters>(counters_);
    if (run.counts_facing) run.facing = counted;
    run.counts_facing = false;
    if (!lists_.fitted(session, counted)) return {};
    if (run.points.footprints != nullptr) return counted;
    if (!trace_.fitted(session, run.points, counted) && traversal_ == Traversal::points) {
        if (provenance_) provenance_->queue_overflow(session, light_frame, frame, run.points, run.visibility);
        cl::StageTimer timer(session, statistics, "trace");
        trace_.run_queue_overflow(session, inputs);
        counted = session.read_value<FrameCounters>(counters_);
    }
    return counted;
}

void FrustumTraced::run_frame(Run& run, cl_uint frame) {
    ++run.frames;
    if (!run.counts_facing) clear(run.session, counters_);
    {
        cl::StageTimer timer(run.session, run.statistics, "receiver_depth_pyramid");
        receiver_depth_pyramid_.run(run.session, run.light_frame, frame, 1, run.points, frames_.projection(),
                                    frames_.blocks(), run.visibility);
    }
    std::optional<FrameCounters> counted;
    while (!(counted = run_frame_once(run, frame))) {
        ++run.grown;
        clear(run.session, counters_);
    }
    const bool was_drawn = list_settings(run.points, frame).draws_map;
    run.maps += was_drawn;
    if (draws_map(run.points) && goes_by_last_map(run.points)) judge_last_map(was_drawn, *counted, frame);
    add(run, *counted);
}

// Only what depends on the points; false if some of them need more than was prepared.
bool FrustumTraced::run_prepared(Run& run) {
    cl::Session& session = run.session;
    const LightFrame& light_frame = prepared_->light_frame();
    const cl_uint frame_count = frame_count_of(light_frame);
    const TraceInputs inputs{light_frame,      0,
                             frame_count,      run.triangles,
                             run.points,       prepared_->projections(),
                             prepared_->map(), prepared_->lists(),
                             run.visibility,   counters_};
    const bool cached_facing =
        session.is_cpu() && frame_count == 1 && Facing::can_cache(run.points) && run.points.layout.point_stride == 1;
    const auto trace = [&](bool plane_side) {
        clear(session, counters_);
        {
            cl::StageTimer timer(session, run.statistics, "trace");
            if (cached_facing)
                trace_.run_prepared_cached_facing(session, inputs, prepared_->domains(),
                                                  frames_.empty_facing_cache(session, run.triangles));
            else
                trace_.run_prepared(session, inputs, prepared_->receivers(), plane_side);
        }
        {
            cl::StageTimer timer(session, run.statistics, "exact_trace");
            run_exact_trace(session, run.triangles, run.points, run.light, trace_, run.visibility, counters_);
        }
        return session.read_value<FrameCounters>(counters_);
    };
    const bool plane_side = !session.is_cpu() && run.points.layout.is_lifted != 0;
    FrameCounters counted = trace(plane_side);
    if (plane_side && counted.fallback_points != 0) counted = trace(false);
    run.fallback_points = counted.fallback_points;
    if (counted.fallback_points != 0) return false;
    if (!trace_.fitted(session, run.points, counted)) {
        cl::StageTimer timer(session, run.statistics, "trace");
        trace_.run_queue_overflow(session, inputs);
        counted = session.read_value<FrameCounters>(counters_);
    }
    run.frames = frame_count;
    run.facing = counted;
    add(run, counted);
    for (const char* stage : {"light_frame", "receiver_depth_pyramid", "triangle_setup", "conservative_map", "bins"})
        run.statistics.stages.push_back({stage, 0, 0, "prepared"});
    run.statistics.stages.push_back({"facing", 0, 0, "decided by the trace"});
    return true;
}

// Of a direction's frame on a GPU: nothing is read back before its end, since a wait there takes as long as a stage.
// (On a CPU it costs nothing, and where no point is open the rest need not run.)
void FrustumTraced::run_one_frame(Run& run) {
    frames_.fit_one(run.session, run.statistics, run.light_frame, run.triangles, run.points, run.visibility, counters_);
    if (provenance_) provenance_->facing(run.session, run.points, run.visibility);
    const std::size_t stages = run.statistics.stages.size();
    run.counts_facing = true;
    run_frame(run, 0);
    if (run.has_open_points()) return;
    run.frames = 0;
    run.statistics.stages.resize(stages);
}

void FrustumTraced::run_unprepared(Run& run) {
    cl::Session& session = run.session;
    if (frame_count_of(run.light_frame) == 1 && run.triangles.count != 0 && !session.is_cpu())
        return run_one_frame(run);
    run.facing = frames_.decide_facing(session, run.statistics, run.light_frame, run.triangles, run.points,
                                       run.visibility, counters_);
    if (provenance_) provenance_->facing(session, run.points, run.visibility);
    if (run.triangles.count == 0 || !run.has_open_points()) return;
    frames_.for_each(session, run.statistics, run.light_frame, [&](cl_uint frame) { run_frame(run, frame); });
}

Statistics FrustumTraced::run(const Triangles& triangles, const Points& points, const Light& light,
                              const Visibility& visibility) {
    require_run(triangles, points, light, visibility);
    PointInputs inputs = point_inputs(points);
    inputs.layout.is_lifted = points.is_lifted_off(triangles);
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

Statistics FrustumTraced::trace_mixed(const Triangles& triangles, const Points& samples, const Light& light,
                                      const Visibility& visibility) {
    require_run(triangles, samples, light, visibility);
    PointInputs inputs = point_inputs(samples);
    inputs.layout.is_lifted = 1;
    if (settled_) {
        cl::Session& session = device_.session();
        const cl::RunMemory memory(session, kept_bytes_);
        Run run{session,      triangle_inputs(triangles), inputs, light, settled_->light_frame, visibility.buffer(),
                settled_->map};
        clear(session, counters_);
        decide_by_lists(run, 0);
        run.statistics.device_memory_bytes = memory.peak_bytes();
        return run.statistics;
    }
    inputs.face_light = true;
    return run_on(triangles, inputs, light, visibility.buffer());
}

Statistics FrustumTraced::run_on(const Triangles& triangles, const PointInputs& points, const Light& light,
                                 cl_mem visibility) {
    const auto start = std::chrono::steady_clock::now();
    cl::Session& session = device_.session();
    const cl::RunMemory memory(session, kept_bytes_);
    Run run{session,
            triangle_inputs(triangles),
            points,
            light,
            make_light_frame(light, grid(triangles.count(), points.layout.count)),
            visibility};
    settled_.reset();
    counters_.reserve(session, sizeof(FrameCounters));
    const bool is_prepared = !provenance_ && points.footprints == nullptr && prepared_ && prepared_->is_usable() &&
                             prepared_->is_of(triangles, light);
    const bool used_prepared = points.layout.count != 0 && is_prepared && run_prepared(run);
    if (points.layout.count != 0 && !used_prepared) run_unprepared(run);
    const bool has_one_frame = frame_count_of(run.light_frame) == 1 && run.frames == 1;
    if (points.footprints != nullptr && has_one_frame && run.total.fallback_points == 0 &&
        traversal_ == Traversal::points)
        settled_ = SettledLists{run.light_frame, run.map};

    Statistics& s = run.statistics;
    merge_stages(s);
    if (!used_prepared && !draws_map(run.points))
        s.stages.push_back({"conservative_map", 0, 0, map_mode_ == MapMode::off ? "switched off" : "few points"});
    else if (run.frames != 0 && !used_prepared && run.maps == 0)
        s.stages.push_back({"conservative_map", 0, 0, "the last one decided too little"});
    else if (!used_prepared && run.total.map_candidates == 0)
        mark_skipped(s, "conservative_map", "no triangle can cover a texel");
    if (run.total.uncertain == 0) mark_skipped(s, "exact_trace", "the filter decided every pair");
    if (run.triangles.clusters == nullptr) s.stages.push_back({"clusters", 0, 0, "no clusters are kept"});
    if (run.frames == 0) s.stages.push_back({"trace", 0, 0, "no point faces the light, or there are no triangles"});
    const FrameCounters& t = run.total;
    s.counts = {{"points", points.layout.count},
                {"points_absent", run.facing.absent},
                {"points_facing_away", run.facing.facing_away},
                {"points_decided_by_map", t.decided_by_map},
                {"points_listed", t.listed},
                {"points_decided_by_trace", t.decided_by_trace},
                {"points_decided_by_exact", t.decided_by_exact},
                {"points_in_shadow",
                 std::uint64_t(run.facing.facing_away) + t.decided_by_map + t.decided_by_trace + t.decided_by_exact},
                {"triangles", triangles.count()},
                {"frames", run.frames},
                {"clusters", run.triangles.clusters != nullptr ? run.triangles.clusters->count() : 0},
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
                {"tests", run.tests},
                {"uncertain_pairs", t.uncertain},
                {"decided_by_float", t.exact_float},
                {"decided_by_double", t.exact_double},
                {"decided_by_integers", t.exact_exact},
                {"orientations_by_integers", std::uint64_t(t.setup_exact) + run.facing.facing_exact},
                {"lists_grown", run.grown},
                {"prepared", used_prepared},
                {"prepared_fallback_points", run.fallback_points}};
    s.device_memory_bytes = memory.peak_bytes();
    s.total_wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return s;
}

std::vector<std::uint8_t> FrustumTraced::diagnose(std::string_view name, const Triangles& triangles,
                                                  const Points& points, const Light& light) {
    if (name != "decided") return Technique::diagnose(name, triangles, points, light);
    // The other traversal decides in place what finds no room: nothing is left to see whom by.
    if (traversal_ == Traversal::triangles)
        throw InvalidArgument("the diagnostic \"decided\" watches traversal=points: leave traversal=triangles out");
    struct Watch {
        explicit Watch(std::optional<Provenance>& provenance) : provenance_(provenance) { provenance_.emplace(); }
        ~Watch() { provenance_.reset(); }
        std::optional<Provenance>& provenance_;
    } const watch(provenance_);
    const Visibility visibility(device_, points.count());
    run(triangles, points, light, visibility);
    if (points.count() == 0) return {};
    return provenance_colors(provenance_->read(device_.session(), points.count()), visibility.read());
}

Statistics FrustumTraced::prepare(const Triangles& triangles, const Light& light) {
    require_light(light);
    forget();
    Statistics s;
    if (traversal_ != Traversal::points || triangles.count() == 0) return s;
    const auto start = std::chrono::steady_clock::now();
    cl::Session& session = device_.session();
    const cl::RunMemory memory(session, kept_bytes_);
    prepared_ = std::make_unique<PreparedLight>(
        session, s, triangles, light, prepared_grid(triangles.count(), !light.is_directional()),
        ListSettings{map_mode_ != MapMode::off, false, cover_test_}, first_capacity_);
    merge_stages(s);
    const FrameCounters& c = prepared_->counted();
    s.counts = {{"triangles", triangles.count()},
                {"triangles_not_finite", c.not_finite},
                {"triangles_edge_on", c.edge_on},
                {"triangles_outside", c.outside},
                {"triangles_kept", c.survivors - c.edge_on},
                {"triangles_hidden", c.hidden},
                {"map_candidates", c.map_candidates},
                {"map_texels_written", c.map_texels},
                {"references", c.references},
                {"prepared", prepared_->is_usable()},
                {"prepared_bytes", prepared_->bytes()}};
    s.device_memory_bytes = memory.peak_bytes();
    s.total_wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return s;
}

void FrustumTraced::forget() {
    const cl::RunMemory memory(device_.session(), kept_bytes_);
    prepared_.reset();
}

void FrustumTraced::set(std::string_view name, std::string_view value) {
    forget();
    const SettingText text{name, value};
    if (name == "conservative-map") {
        map_mode_ = static_cast<MapMode>(text.choice(map_mode_names));
    } else if (name == "cover-test") {
        cover_test_ = static_cast<CoverTest>(text.choice(cover_test_names));
    } else if (name == "traversal") {
        traversal_ = static_cast<Traversal>(text.choice(traversal_names));
    } else if (name == "map-size") {
        map_size_ = text.whole_or_auto(smallest_map, largest_map);
    } else if (name == "first-capacity") {
        first_capacity_ = text.whole_or_auto(1, std::numeric_limits<std::uint32_t>::max());
        lists_.limit_initial_capacity(first_capacity_);
        trace_.limit_initial_capacity(first_capacity_);
    } else {
        throw InvalidArgument("frustum-traced has no setting \"" + std::string(name) +
                              "\": it has conservative-map, cover-test, map-size, traversal and first-capacity");
    }
}

TechniqueDescription FrustumTraced::describe() {
    return {
        "frustum-traced",
        "exact hard shadows: frustum tracing over an irregular z-buffer, with a conservative map",
        true,
        {{"conservative-map", "auto",
          "on, off or auto: decide points behind triangles that cover a whole texel at once"},
         {"cover-test", "tight",
          "tight (Mizoguchi and Tokuyoshi) or circle (Hertel et al. 2009): when a texel counts as covered"},
         {"map-size", "auto", "texels per side of the light's grid, 16 to 8192, or auto"},
         {"traversal", "points",
          "points (each over its bin's triangles) or triangles (each over its bins' points; a baseline to compare)"},
         {"first-capacity", "auto", "entries that growing lists start with, from 1, or auto: for tests"}},
        {{"decided",
          "what decided each point: pale and blue the filter, dark blue the map, green to red the exact "
          "predicate; docs/techniques.md has the legend"}}};
}

}  // namespace gnomon
