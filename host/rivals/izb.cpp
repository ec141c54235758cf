// SPDX-License-Identifier: MIT
#include "rivals/izb.hpp"

#include "occluders/occluder_lists.hpp"
#include "query/statistics.hpp"
#include "rivals/framed_technique.hpp"

namespace gnomon {

IzbParams Izb::params(const TraceInputs& inputs, cl_uint queue_capacity) const {
    return {.framed = {.triangles = inputs.triangles,
                       .light_frame = inputs.light_frame,
                       .layout = inputs.points.layout,
                       .frame = inputs.first_frame,
                       .padding = 0},
            .has_map = inputs.map != nullptr,
            .slot_count = slot_count_,
            .queue_capacity = queue_capacity,
            .padding = 0};
}

void Izb::run(cl::Session& session, const TraceInputs& inputs) {
    const PointInputs& points = inputs.points;
    const LightFrame& frame = inputs.light_frame;
    const cl_uint list_count = (frame.bins_x * frame.bins_y) << (2 * frame.bin_log2);
    const std::size_t list_bytes = list_count * sizeof(cl_uint);
    // A CPU reads as many slots as it has lanes, also past the last one.
    slot_count_ = (points.layout.count + session.lanes() + 15) / 16 * 16;
    lists_.reserve(session, IZB_WORDS * std::size_t(slot_count_) * sizeof(cl_uint));
    ranks_.reserve(session, points.layout.count * sizeof(cl_uint));
    offsets_.reserve(session, list_bytes + sizeof(cl_uint));

    session.reserve_filled(counts_, 0, list_bytes);
    const auto blocks = session.blocks(points.layout.count);
    session.launch("rivals/izb.cl", "izb_count", blocks, params(inputs, 0), inputs.projections, points.positions,
                   inputs.map != nullptr ? *inputs.map : counts_, inputs.visibility, counts_, ranks_, inputs.counters);
    scan_.run(session, list_count, counts_, offsets_);
    session.launch("rivals/izb.cl", "izb_scatter", blocks, params(inputs, 0), inputs.projections, points.positions,
                   offsets_, ranks_, inputs.visibility, lists_, inputs.counters);
}

void Izb::trace(cl::Session& session, const TraceInputs& inputs, const Bins& bins, Trace& queue) {
    queue.reserve_queue(session, inputs.points);
    const std::size_t capacity = bins.pair_capacity(), each = 4;  // pairs of a GPU's item
    const cl::Range range = session.is_cpu() ? cl::Range::shares(capacity)
                                             : cl::Range::groups(capacity / (each * IZB_GROUP) + 1, IZB_GROUP);
    session.launch(inputs.triangles.kernel("rivals/izb.cl", "izb_trace"), range, params(inputs, queue.capacity()),
                   inputs.points.positions, inputs.points.receivers, inputs.triangles.vertices, lists_, offsets_,
                   bins.pairs(), inputs.lists.records, inputs.lists.bounds, inputs.visibility, queue.queue(),
                   inputs.counters);
}

namespace {

class IrregularZBuffer final : public FramedTechnique {
public:
    explicit IrregularZBuffer(const Device& device) : FramedTechnique(device, describe()) {}

    static TechniqueDescription describe() {
        return {
            "izb",
            "exact hard shadows by an irregular z-buffer (Wyman et al. 2016): triangles are traced over the lists of "
            "the points that they may shadow; a baseline to compare with",
            true, settings({"conservative-map", "cover-test", "map-size"})};
    }

private:
    /// Lists triangles and points, and decides the points; the counts of the frame.
    FrameCounters run_once(Run& run, cl_uint frame) {
        session_.fill(counters_, 0, sizeof(FrameCounters));
        const cl::Buffer* map =
            lists_.run(session_, run.statistics, run.light_frame, frames_.projection(), run.triangles,
                       {settings_.draws_map, false, settings_.cover_test}, frames_.receiver_depths(), counters_);
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
        cl::StageTimer timer(session_, run.statistics, "izb");
        izb_.run(session_, inputs);
        timer.next("trace");
        izb_.trace(session_, inputs, lists_.bins(), trace_);
        timer.next("exact_trace");
        trace_.decide_queue(session_, inputs);
        return session_.read_value<FrameCounters>(counters_);
    }

    FrameCounters run_frame(Run& run, cl_uint frame) override {
        frames_.reduce_depths(session_, run.statistics, run, frame);
        FrameCounters counted = run_once(run, frame);
        for (; !lists_.fitted(session_, counted); counted = run_once(run, frame)) ++run.grown;
        trace_.fitted(session_, run.points, counted);  // for later frames: no pair was lost
        return counted;
    }

    decltype(Statistics::counts) counts_of(Run& run) const override {
        const FrameCounters& total = run.counted;
        return {{"points_decided_by_map", total.decided_by_map},
                {"points_listed", total.listed},
                {"points_decided_by_trace", total.decided_by_trace},
                {"points_decided_by_exact", total.decided_by_exact},
                {"map_candidates", total.map_candidates},
                {"map_texels_written", total.map_texels},
                {"references", total.references},
                {"tests", run.tests},
                {"uncertain_pairs", total.uncertain},
                {"decided_by_float", total.exact_float},
                {"decided_by_double", total.exact_double},
                {"decided_by_integers", total.exact_exact}};
    }

    OccluderLists lists_;
    Izb izb_;
    Trace trace_;
};

}  // namespace

Registered izb_technique() { return registered<IrregularZBuffer>(); }

}  // namespace gnomon
