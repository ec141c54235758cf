// SPDX-License-Identifier: MIT
// Technique frustum-traced: exact hard shadows by frustum tracing over an irregular z-buffer, with a conservative map.
// The order of the stages is in frustum_traced.cpp, top to bottom.
#pragma once

#include <optional>

#include "clusters.hpp"
#include "conservative_map.hpp"
#include "decisions.hpp"
#include "facing.hpp"
#include "farthest_height.hpp"
#include "trace.hpp"

namespace gnomon {

class FrustumTraced final : public Technique {
public:
    explicit FrustumTraced(const Device& device) : device_(device) {}
    Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                   const Visibility& visibility) override;
    void set(std::string_view name, std::string_view value) override;
    /// "decided": what decided each point. Of any points, not only a camera's.
    std::vector<std::uint8_t> diagnose(std::string_view name, const Triangles& triangles, const Points& points,
                                       const Light& light) override;

    static TechniqueDescription describe();

private:
    enum class MapMode { automatic, on, off };
    enum class Traversal { points, triangles };
    struct Run;

    FrameGrid grid(std::size_t point_count) const;
    bool draws_map(const PointInputs& points) const;
    void run_frames(Run& run);
    void run_frame(Run& run, cl_uint frame);
    /// Nothing if a list was too short, which is longer now.
    std::optional<FrameCounters> run_frame_once(Run& run, cl_uint frame);

    Device device_;
    MapMode map_mode_ = MapMode::automatic;
    CoverTest cover_test_ = CoverTest::tight;
    Traversal traversal_ = Traversal::points;
    std::uint32_t map_size_ = 0;  ///< 0: chosen by the device and the number of points

    std::uint64_t kept_bytes_ = 0;  ///< of the lists below, kept from run to run

    cl::Buffer counters_, projection_;
    Facing facing_;
    LightFrameFit light_frame_;
    FarthestHeight farthest_height_;
    ClusterCull clusters_;
    TriangleSetup setup_;
    ConservativeMap map_;
    Izb izb_;
    Bins bins_;
    Trace trace_;
    std::optional<Decisions> decisions_;  ///< while a run is watched
};

}  // namespace gnomon
