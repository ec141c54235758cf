// SPDX-License-Identifier: MIT
// Exact shadows of one light: points are traced over lists of the triangles that may block them, with a conservative
// map. The order of the stages is in frustum_tracer.cpp.
#pragma once

#include <functional>
#include <optional>

#include "api/statistics.hpp"
#include "receivers/light_frames.hpp"
#include "trace/light_order.hpp"
#include "trace/map_choice.hpp"
#include "trace/provenance.hpp"

namespace gnomon {

struct TracerSettings {
    MapMode map_mode = MapMode::automatic;
    CoverTest cover_test = CoverTest::tight;
    std::uint32_t map_size = 0;        ///< 0: chosen by the device and the scene
    std::uint32_t first_capacity = 0;  ///< 0: the lists' default
    SortPoints sort_points = SortPoints::automatic;
};

/// A stage in place of trace and exact_trace, over the lists of a frame.
using LastStage = std::function<void(const TraceInputs& inputs, Statistics& statistics)>;

/// The counts of one frame.
struct TracedFrame {
    FrameCounters counted{};
    FrameCounters first_attempt{};  ///< before lists grew: with the counts of facing, if these were not read before
    std::uint64_t lists_grown = 0;
    bool drew_map = false;
    const cl::Buffer* map = nullptr;  ///< null where no map is drawn
};

/// A run: its last stage, and its counts.
struct TracedRun {
    Statistics& statistics;           ///< of the stages
    LastStage last_stage{};           ///< none: trace and exact_trace
    FrameCounters facing{}, total{};  ///< total: over the frames
    std::uint64_t tests = 0, frames = 0, lists_grown = 0, maps_drawn = 0;
    std::uint64_t fallback_points = 0;  ///< points that a prepared light did not cover
    bool used_prepared = false, sorted_points = false;
    const cl::Buffer* map = nullptr;  ///< of the last frame

    void add(const FrameCounters& counted);
    void add(const TracedFrame& frame);
    bool has_open_points(const PointInputs& points) const {
        return facing.absent + facing.facing_away < points.layout.count;
    }
};

class FrustumTracer {
public:
    explicit FrustumTracer(const Device& device) : device_(device), session_(session_of(device)) {}
    void set(const TracerSettings& settings);
    const TracerSettings& settings() const { return settings_; }
    /// Bytes of the buffers that are kept from run to run: for MeasuredRun, here and in the wings after this one.
    std::uint64_t& kept_bytes() { return kept_bytes_; }

    /// Decides all points that `decide` is given: these, sorted where that pays. Without it run_frames() decides them.
    using Decide = std::function<void(const FramedInputs& in, TracedRun& run)>;
    Statistics run(const Triangles& triangles, const PointInputs& points, const Light& light, cl_mem visibility,
                   const Decide& decide = {});
    /// Decides all points, frame by frame.
    void run_frames(const FramedInputs& in, TracedRun& run);

    /// run() with a record of provenance: a PROVENANCE_... for each point.
    std::vector<std::uint32_t> run_watched(const Triangles& triangles, const Points& points, const Light& light,
                                           const Visibility& visibility);

    // For other ways to decide points with the same stages.
    cl::Session& session() { return session_; }
    LightFrames& frames() { return frames_; }
    Trace& trace() { return trace_; }
    const cl::Buffer& counters() const { return counters_; }
    void clear_counters() { session_.fill(counters_, 0, sizeof(FrameCounters)); }
    /// The lists and the map of a frame, while no other frame has made lists.
    TraceInputs frame_inputs(const FramedInputs& in, cl_uint frame, const cl::Buffer* map) const;
    /// The last stages, over lists. No stage runs if a list of a frame was too short; the list is longer now.
    /// `first_read`: the counters before a queue overflow, in any case.
    std::optional<FrameCounters> decide(const TraceInputs& inputs, TracedRun& run, FrameCounters& first_read);
    /// Decides the pairs that found no room in the queue.
    FrameCounters run_queue_overflow(const TraceInputs& inputs, Statistics& statistics);

private:
    void run_one_frame(const FramedInputs& in, TracedRun& run);
    /// `counters_hold_facing`: the counts of facing are still to be read, with the counts of the frame.
    TracedFrame run_frame(const FramedInputs& in, cl_uint frame, TracedRun& run, bool counters_hold_facing);
    bool may_sort(const PointInputs& points) const;
    /// Records provenance if the run has a Provenance.
    void observe(Moment moment, const TraceInputs& inputs);
    void describe_stages(const FramedInputs& in, TracedRun& run) const;

    Device device_;
    cl::Session& session_;
    TracerSettings settings_;
    std::uint64_t kept_bytes_ = 0;
    MapChoice map_choice_{session_};
    cl::Buffer counters_;
    LightOrder order_;
    LightFrames frames_;
    OccluderLists lists_;
    Trace trace_;
    std::optional<Provenance> provenance_;  ///< while a run records provenance
};

}  // namespace gnomon
