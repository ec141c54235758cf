// SPDX-License-Identifier: MIT
#include "techniques/izb.hpp"

#include <algorithm>

#include "api/statistics.hpp"

namespace gnomon {

IzbParams Izb::params(const TraceInputs& inputs, cl_uint queue_capacity) const {
    return {.triangles = inputs.triangles,
            .light_frame = inputs.light_frame,
            .layout = inputs.points.layout,
            .frame = inputs.first_frame,
            .has_map = inputs.map != nullptr,
            .slot_count = slot_count_,
            .queue_capacity = queue_capacity};
}

void Izb::run(cl::Session& session, const TraceInputs& inputs) {
    const PointInputs& points = inputs.points;
    const cl_uint bin_count = inputs.light_frame.bins_x * inputs.light_frame.bins_y;
    const std::size_t bin_bytes = bin_count * sizeof(cl_uint);
    // Each bin's list is padded to a multiple of the lanes, and no more bins than points can need padding.
    const std::size_t padding = (session.lanes() - 1) * std::min<std::size_t>(bin_count, points.layout.count);
    const std::size_t slots = (points.layout.count + padding + 15) / 16 * 16;
    slot_count_ = static_cast<cl_uint>(slots);
    lists_.reserve(session, IZB_WORDS * slots * sizeof(cl_uint));
    cursors_.reserve(session, bin_bytes);
    offsets_.reserve(session, bin_bytes + sizeof(cl_uint));

    session.fill(cursors_, 0, bin_bytes);
    const auto blocks = cl::Range::items(points.layout.count / session.lanes() + 1);
    session.launch("techniques/izb.cl", "izb_count", blocks, params(inputs, 0), inputs.projections, points.positions,
                   inputs.map != nullptr ? *inputs.map : cursors_, inputs.visibility, cursors_, inputs.counters);
    scan_.run(session, bin_count, session.lanes(), cursors_, offsets_);
    session.fill(cursors_, 0, bin_bytes);
    if (session.lanes() > 1) session.fill(lists_, GN_NO_ID, slots * sizeof(cl_uint));
    session.launch("techniques/izb.cl", "izb_scatter", blocks, params(inputs, 0), inputs.projections, points.positions,
                   offsets_, inputs.visibility, cursors_, lists_, inputs.counters);
}

void Izb::trace(cl::Session& session, const TraceInputs& inputs, const Bins& bins, Trace& queue) {
    queue.reserve_queue(session, inputs.points);
    session.launch("techniques/izb.cl", "izb_trace", cl::Range::items(bins.pair_capacity()),
                   params(inputs, queue.capacity()), inputs.points.positions, inputs.points.receivers,
                   inputs.triangles.vertices, lists_, offsets_, bins.pairs(), inputs.lists.records, inputs.lists.bounds,
                   inputs.visibility, queue.queue(), inputs.counters);
}

const SettingsTable<IrregularZBuffer::Settings>& IrregularZBuffer::settings_table() {
    using S = Settings;
    static const SettingsTable<S> table{
        {{"conservative-map", "on", "on or off: decide points behind triangles that cover a whole texel at once"},
         setting::on_off(&S::draws_map)},
        {{"cover-test", "tight",
          "tight (Mizoguchi and Tokuyoshi) or circle (Hertel et al. 2009): when a texel counts as covered"},
         setting::choice(&S::cover_test, cover_test_names)},
        {{"map-size", "1024", "texels per side of the light's grid, 16 to 8192"},
         setting::whole(&S::map_size, smallest_map_size, largest_map_size)},
    };
    return table;
}

FrameCounters IrregularZBuffer::run_once(Run& run, cl_uint frame) {
    cl::Session& session = device_.session();
    session.fill(counters_, 0, sizeof(FrameCounters));
    const ListSettings settings{settings_.draws_map, false, settings_.cover_test};
    const cl::Buffer* map = lists_.run(session, run.statistics, run.light_frame, frames_.projection(), run.triangles,
                                       settings, receiver_depth_pyramid_, counters_);
    const TraceInputs inputs{.light_frame = run.light_frame,
                             .first_frame = frame,
                             .frame_count = 1,
                             .triangles = run.triangles,
                             .points = run.points,
                             .projections = frames_.projection(),
                             .map = map,
                             .lists = list_buffers(lists_.bins(), lists_.setup()),
                             .visibility = run.visibility,
                             .counters = counters_};
    {
        cl::StageTimer timer(session, run.statistics, "izb");
        izb_.run(session, inputs);
    }
    {
        cl::StageTimer timer(session, run.statistics, "trace");
        izb_.trace(session, inputs, lists_.bins(), trace_);
    }
    cl::StageTimer timer(session, run.statistics, "exact_trace");
    trace_.decide_queue(session, inputs);
    return session.read_value<FrameCounters>(counters_);
}

void IrregularZBuffer::run_frame(Run& run, cl_uint frame) {
    cl::Session& session = device_.session();
    {
        cl::StageTimer timer(session, run.statistics, "receiver_depth_pyramid");
        receiver_depth_pyramid_.run(session, run.light_frame, frame, 1, run.points, frames_.projection(),
                                    frames_.blocks(), run.visibility);
    }
    FrameCounters counted = run_once(run, frame);
    for (; !lists_.fitted(session, counted); counted = run_once(run, frame)) ++run.grown;
    trace_.fitted(session, run.points, counted);  // for later frames: no pair was lost
    gnomon::add_counters(total_, counted);
    tests_ += counted.tests_low + (std::uint64_t(counted.tests_high) << 32);
    run.in_shadow += std::uint64_t(counted.decided_by_map) + counted.decided_by_trace + counted.decided_by_exact;
}

void IrregularZBuffer::add_counts(Run& run) const {
    auto& counts = run.statistics.counts;
    merge_stages(run.statistics);
    counts.emplace_back("points_decided_by_map", total_.decided_by_map);
    counts.emplace_back("points_listed", total_.listed);
    counts.emplace_back("points_decided_by_trace", total_.decided_by_trace);
    counts.emplace_back("points_decided_by_exact", total_.decided_by_exact);
    counts.emplace_back("map_candidates", total_.map_candidates);
    counts.emplace_back("map_texels_written", total_.map_texels);
    counts.emplace_back("references", total_.references);
    counts.emplace_back("tests", tests_);
    counts.emplace_back("uncertain_pairs", total_.uncertain);
    counts.emplace_back("decided_by_float", total_.exact_float);
    counts.emplace_back("decided_by_double", total_.exact_double);
    counts.emplace_back("decided_by_integers", total_.exact_exact);
}

void IrregularZBuffer::set(std::string_view name, std::string_view value) {
    settings_table().set(settings_, "izb", name, value);
}

TechniqueDescription IrregularZBuffer::describe() {
    return {
        "izb",
        "exact hard shadows by an irregular z-buffer (Wyman et al. 2016): triangles are traced over the lists of the "
        "points that they may shadow; a baseline to compare with",
        true, settings_table().descriptions()};
}

}  // namespace gnomon
