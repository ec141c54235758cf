// SPDX-License-Identifier: MIT
// Technique frustum-traced: exact hard shadows by frustum tracing over an irregular z-buffer, with a conservative map.
// The order of the stages is in frustum_traced.cpp, top to bottom.
#pragma once

#include <array>
#include <optional>

#include "prepared/prepared_light.hpp"
#include "receivers/light_frames.hpp"
#include "samples/classify_footprints.hpp"
#include "trace/provenance.hpp"

namespace gnomon {

class FrustumTraced final : public Technique, public ClassifiesFootprints {
public:
    explicit FrustumTraced(const Device& device) : device_(device) {}
    Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                   const Visibility& visibility) override;
    Statistics classify_footprints(const Triangles& triangles, const Points& centres, const cl::Buffer& footprints,
                                   const Light& light, const Visibility& answers) override;
    Statistics trace_mixed(const Triangles& triangles, const Points& samples, const Light& light,
                           const Visibility& visibility) override;
    Statistics prepare(const Triangles& triangles, const Light& light) override;
    void forget() override;
    void set(std::string_view name, std::string_view value) override;
    /// "decided": what decided each point. Of any points, not only a camera's.
    std::vector<std::uint8_t> diagnose(std::string_view name, const Triangles& triangles, const Points& points,
                                       const Light& light) override;

    static TechniqueDescription describe();

    /// On a GPU: whether a frame with a map, which counted this, took less time than one without.
    static bool was_worth_a_map(const FrameCounters& counted);

private:
    enum class MapMode { on, off, automatic };
    enum class Traversal { points, triangles };
    struct Run;

    Statistics run_on(const Triangles& triangles, const PointInputs& points, const Light& light, cl_mem visibility);
    FrameGrid grid(std::size_t triangle_count, std::size_t point_count) const;
    FrameGrid prepared_grid(std::size_t triangle_count, bool is_point_light) const;
    bool draws_map(const PointInputs& points) const;
    ListSettings list_settings(const PointInputs& points, cl_uint frame) const;
    bool goes_by_last_map(const PointInputs& points) const;
    void judge_last_map(bool was_drawn, const FrameCounters& counted, cl_uint frame);
    bool run_prepared(Run& run);
    void run_unprepared(Run& run);
    void run_one_frame(Run& run);
    void run_frame(Run& run, cl_uint frame);
    static void add(Run& run, const FrameCounters& counted);
    /// Nothing if a list was too short, which is longer now.
    std::optional<FrameCounters> run_frame_once(Run& run, cl_uint frame);
    /// The stages after the lists.
    std::optional<FrameCounters> decide_by_lists(Run& run, cl_uint frame);

    Device device_;
    MapMode map_mode_ = MapMode::automatic;
    CoverTest cover_test_ = CoverTest::tight;
    Traversal traversal_ = Traversal::points;
    std::uint32_t map_size_ = 0;        ///< 0: chosen by the device and the number of points
    std::uint32_t first_capacity_ = 0;  ///< 0: the lists' own

    std::uint64_t kept_bytes_ = 0;  ///< of the lists below, kept from run to run

    /// On a GPU, by frame: runs that are to do without a map since the last one decided too little. Only a matter of
    /// time.
    std::array<std::uint32_t, POINT_LIGHT_FRAMES> runs_without_map_{};

    cl::Buffer counters_;
    LightFrames frames_;
    ReceiverDepthPyramid receiver_depth_pyramid_;
    OccluderLists lists_;
    Izb izb_;
    Trace trace_;
    /// What the lists below were made for, if that were footprints, and they serve for all of their samples.
    struct SettledLists {
        LightFrame light_frame;
        const cl::Buffer* map;
    };
    std::optional<SettledLists> settled_;
    std::optional<Provenance> provenance_;  ///< while a run is watched
    std::unique_ptr<PreparedLight> prepared_;
};

}  // namespace gnomon
