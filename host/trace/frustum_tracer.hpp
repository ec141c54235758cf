// SPDX-License-Identifier: MIT
// Exact shadows of one light: points are traced over lists of the triangles that may block them, with a conservative
// map. The order of the stages is in frustum_tracer.cpp.
#pragma once

#include <functional>
#include <optional>

#include "query/statistics.hpp"
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

struct TracedRun;

/// How a run differs from the usual one.
struct TracePlan {
    /// Decides all points, in place of run_frames().
    std::function<void(const FramedInputs& in, TracedRun& run)> decide{};
    /// A stage over the lists of a frame, in place of trace and exact_trace.
    std::function<void(const TraceInputs& inputs, Statistics& statistics)> last_stage{};
    Provenance* provenance = nullptr;  ///< records what decided each point
};

/// The counts of a run.
struct TracedRun {
    Statistics& statistics;  ///< of the stages
    const TracePlan& plan;
    FrameCounters facing{}, total{};  ///< total: over the frames
    std::uint64_t tests = 0, frames = 0, lists_grown = 0, maps_drawn = 0;
    std::uint64_t fallback_points = 0;  ///< points that a prepared light did not cover
    bool used_prepared = false, sorted_points = false;
    const cl::Buffer* map = nullptr;  ///< of the last frame; null where it drew none

    void add(const FrameCounters& counted) {
        add_counters(total, counted);
        tests += counted.tests_low + (std::uint64_t(counted.tests_high) << 32);
    }
    bool has_open_points(const PointInputs& points) const {
        return facing.absent + facing.facing_away < points.layout.count;
    }
};

/// Adds what happened to triangles on the way to lists.
void add_list_counts(decltype(Statistics::counts)& counts, const FrameCounters& counted);

class FrustumTracer {
public:
    explicit FrustumTracer(const Device& device) : device_(device), session_(session_of(device)) {}
    void set(const TracerSettings& settings);
    const TracerSettings& settings() const { return settings_; }
    /// Bytes of the buffers that are kept from run to run: for MeasuredRun, here and in the wings after this one.
    std::uint64_t& kept_bytes() { return kept_bytes_; }

    /// Sorts points that come in no order first, if that saves time.
    Statistics run(const Triangles& triangles, const PointInputs& points, const Light& light, cl_mem visibility,
                   const TracePlan& plan = {});
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
    /// The stages after the lists. No stage runs if a list was too short; the list is longer now. `first_read`: the
    /// counters before a queue overflow, in any case.
    std::optional<FrameCounters> run_last_stages(const TraceInputs& inputs, TracedRun& run, FrameCounters& first_read);
    /// Decides the pairs that found no room in the queue.
    FrameCounters run_queue_overflow(const TraceInputs& inputs, Statistics& statistics);

private:
    void run_one_frame(const FramedInputs& in, TracedRun& run);
    /// `counters_hold_facing`: the counts of facing are still to be read, with the counts of the frame.
    void run_frame(const FramedInputs& in, cl_uint frame, TracedRun& run, bool counters_hold_facing);
    void observe(Moment moment, const TraceInputs& inputs, const TracedRun& run);
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
};

}  // namespace gnomon
