// SPDX-License-Identifier: MIT
// The masks of the lights that reach a part of the sorted points: which of them each point faces, and the exact
// predicate for what a trace leaves undecided.
#pragma once

#include <algorithm>

#include "bvh/wide_bvh.hpp"
#include "horizons/horizons.hpp"
#include "kernels/beams/beam.h"
#include "lights/many_lights.hpp"
#include "query/statistics.hpp"

namespace gnomon {

/// A run that reads the BVH over the triangles.
struct BvhRun : LightsRun {
    const SortedPoints& sorted;
    const WideBvh& tree;

    /// The largest magnitude of a coordinate of triangles, points and point lights.
    float largest_coordinate() const {
        return std::max({tree.largest_coordinate(), sorted.largest_coordinate(), largest_position(lights.lights())});
    }
};

/// A part of the sorted points.
struct PointPart {
    std::size_t first, count;
};

/// The largest number of bytes that a part's masks may take.
std::size_t max_mask_bytes(const cl::Session& session);

class LightMasks {
public:
    /// What decides some pairs before a trace, and writes HorizonMasks.
    enum class Before { nothing, sweeps, horizons };
    LightMasks(const BvhRun& run, const LightBundles& bundles, Statistics& statistics, Before before);

    /// Takes other bundles. Their masks need room again; buffers only grow.
    void set_bundles(const LightBundles& bundles);

    /// Makes room for a part of `points` points, or of fewer if there is no memory for them.
    void reserve(std::size_t points);
    std::size_t max_points() const { return max_points_; }
    std::size_t bytes_per_point() const { return bundle_count_ * sizeof(cl_uint); }
    /// The number of tasks, blocks x bundles, of a part of `points` points.
    std::size_t tasks_of(std::size_t points) const {
        const std::size_t width = bvh_width(session_);
        return (points + width - 1) / width * bundle_count_;
    }

    /// Writes the masks of the lights that the points face.
    void face(const PointPart& part);
    /// Launches a trace, which takes params_of(part), then decides the queued pairs. A trace whose queue was too short
    /// is launched again: its masks only lose lights.
    template <typename Trace>
    void trace(const PointPart& part, const char* stage, Trace&& launch) {
        cl::StageTimer timer(session_, statistics_, stage);
        BeamCounters counted;
        for (;;) {
            session_.fill(counters_, 0, sizeof(BeamCounters));
            launch();
            counted = session_.read_value<BeamCounters>(counters_);
            if (counted.queued <= capacity()) break;
            queue_.reserve(session_, std::size_t(counted.queued) * 5 / 4 * sizeof(BeamPairs));
        }
        timer.next("beam_exact");
        if (counted.queued != 0) decide_queue(part);
    }
    /// Adds to the masks, after the trace, the lights that horizons or sweeps found to reach the points.
    void join(const PointPart& part);
    /// Adds the masks of all bundles to the sums, where `first_bundle` is the number of the first one.
    void add_to(LightSums& sums, const PointPart& part, std::uint32_t first_bundle);

    BeamParams params_of(const PointPart& part) const;
    const cl::Buffer& bundles() const { return bundles_; }
    const cl::Buffer& masks() const { return masks_; }
    /// The buffers that horizons and sweeps read and write; `begins` only where bundles are sectors.
    HorizonMasks for_horizons() const {
        return {masks_, lit_, begins_, bundle_count_, static_cast<cl_uint>(max_points_)};
    }
    const cl::Buffer& queue() const { return queue_; }
    const cl::Buffer& counters() const { return counters_; }
    std::span<const std::uint32_t> slots() const { return slots_; }
    cl_uint bundle_count() const { return bundle_count_; }
    bool are_positions() const { return are_positions_; }
    /// Adds the counts of the run so far, to those of other bundles if there are some.
    void describe(decltype(Statistics::counts)& counts) const;

private:
    cl_uint side() const;
    cl_uint capacity() const { return static_cast<cl_uint>(queue_.bytes() / sizeof(BeamPairs)); }
    void decide_queue(const PointPart& part);

    const BvhRun& run_;
    cl::Session& session_;
    Statistics& statistics_;
    std::vector<std::uint32_t> slots_;
    cl_uint bundle_count_ = 0;
    Before before_;
    bool are_positions_ = false;
    cl::Buffer bundles_, counters_, queue_, masks_, lit_, begins_;
    std::size_t max_points_ = 0;
    std::uint64_t queued_ = 0, by_level_[3] = {};
};

}  // namespace gnomon
