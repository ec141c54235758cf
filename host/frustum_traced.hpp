// SPDX-License-Identifier: MIT
// Technique frustum-traced: exact hard shadows. Points are traced over lists of the triangles that may block them, with
// a conservative map. The order of the stages is in frustum_traced.cpp, top to bottom.
#pragma once

#include <array>
#include <optional>

#include "api/settings_table.hpp"
#include "prepared/prepared_light.hpp"
#include "receivers/light_frames.hpp"
#include "samples/classify_footprints.hpp"
#include "shafts/tree_run.hpp"
#include "trace/light_order.hpp"
#include "trace/provenance.hpp"

namespace gnomon {

class FrustumTraced final : public Technique, public ClassifiesFootprints {
public:
    explicit FrustumTraced(const Device& device) : device_(device), session_(session_of(device)) {}
    const Device& device() const override { return device_; }
    Statistics run_light(const Triangles& triangles, const Points& points, const Light& light,
                         const Visibility& visibility) override;
    Statistics run_table(const Triangles& triangles, const Points& points, const Lights& lights,
                         const LightsOutputs& outputs, const LightsOptions& options) override;
    Statistics classify_footprints(const Triangles& triangles, const Points& centres, const cl::Buffer& footprints,
                                   const Light& light, const Visibility& answers) override;
    Statistics classify_parts(const Triangles& triangles, const Points& centres, const cl::Buffer& footprints,
                              const Light& light, const Visibility& answers) override;
    Statistics trace_mixed(const Triangles& triangles, const Points& samples, const Light& light,
                           const Visibility& visibility) override;
    Statistics prepare(const Triangles& triangles, const Light& light) override;
    void release_prepared_light() override;
    void set(std::string_view name, std::string_view value) override;
    /// "decided": the provenance of each point. For any points, not only a camera's.
    std::vector<std::uint8_t> draw_diagnostic(std::string_view name, const Triangles& triangles, const Points& points,
                                              const Light& light) override;

    /// run_light() with a record of provenance: a PROVENANCE_... for each point.
    std::vector<std::uint32_t> run_watched(const Triangles& triangles, const Points& points, const Light& light,
                                           const Visibility& visibility);

    static TechniqueDescription describe();

    /// On a GPU: true if a frame with a map and these counts took less time than one without.
    static bool map_was_worth_drawing(const FrameCounters& counted);

private:
    enum class MapMode { on, off, automatic };
    struct Settings {
        MapMode map_mode;
        CoverTest cover_test;
        std::uint32_t map_size;        ///< 0: chosen by the device and the scene
        std::uint32_t first_capacity;  ///< 0: the lists' default
        ManyLightsWay many_lights;
        std::uint32_t bundle_lights;
        SortPoints sort_points;
    };
    struct FrameResult;
    struct RunResult;

    static const SettingsTable<Settings>& settings_table();
    bool may_sort(const PointInputs& points) const;
    Statistics run_on(const Triangles& triangles, const PointInputs& points, const Light& light, cl_mem visibility);
    /// Over the lists of the last footprints.
    Statistics run_on_footprint_lists(const Triangles& triangles, const PointInputs& points, cl_mem visibility);
    template <typename Built>
    const Built& kept_of(std::unique_ptr<Built>& kept, const Triangles& triangles);
    const SortedPoints& sort_points(const LightsRun& run);
    /// The setting's way; in place of `automatic` the one that was taken for the same lights and as many points.
    ManyLightsWay way_of(const LightsRun& run);
    void note_way(const LightsRun& run, ManyLightsWay taken);
    TraceInputs prepared_inputs(const FramedInputs& in) const;
    void classify_prepared(const FramedInputs& in, RunResult& result);
    bool run_prepared(const FramedInputs& in, RunResult& result);
    void run_unprepared(const FramedInputs& in, RunResult& result);
    void run_one_frame(const FramedInputs& in, RunResult& result);
    /// `counters_hold_facing`: the counts of facing are still to be read, with the counts of the frame.
    FrameResult run_frame(const FramedInputs& in, cl_uint frame, Statistics& statistics, bool counters_hold_facing);
    /// The stages after the lists. No stage runs if a list was too short; the list is longer now. `first_read`: the
    /// counters before a queue overflow, in any case.
    std::optional<FrameCounters> decide(const TraceInputs& inputs, Statistics& statistics, FrameCounters& first_read);
    FrameCounters run_queue_overflow(const TraceInputs& inputs, Statistics& statistics);
    TraceInputs frame_inputs(const FramedInputs& in, cl_uint frame, const cl::Buffer* map) const;
    /// Records provenance if the run has a Provenance.
    void observe(Moment moment, const TraceInputs& inputs);

    std::size_t expected_count(const PointInputs& points) const;
    bool may_draw_map(const PointInputs& points) const;
    bool goes_by_last_map(const PointInputs& points) const;
    ListSettings list_settings(const PointInputs& points, cl_uint frame) const;
    void note_map_benefit(const FrameResult& result, cl_uint frame);

    void describe_stages(const FramedInputs& in, RunResult& result) const;
    static void describe_counts(const FramedInputs& in, RunResult& result);

    Device device_;
    cl::Session& session_;
    Settings settings_ = settings_table().defaults();
    std::uint64_t kept_bytes_ = 0;  ///< of the buffers below, kept from run to run

    /// On a GPU, by frame: runs that leave the map out, since the last one decided too few points. Affects time alone.
    std::array<std::uint32_t, POINT_LIGHT_FRAMES> runs_without_map_{};

    cl::Buffer counters_;
    LightOrder order_;
    LightFrames frames_;
    OccluderLists lists_;
    Trace trace_;
    /// The frame of the lists, if they were made for footprints and are valid for all of their samples; or the prepared
    /// light's, whose trace takes any points.
    struct FootprintLists {
        LightFrame light_frame;
        const cl::Buffer* map;
        bool is_prepared;
    };
    std::optional<FootprintLists> footprint_lists_;
    std::optional<Provenance> provenance_;  ///< while a run records provenance
    std::unique_ptr<PreparedLight> prepared_;
    std::unique_ptr<BuiltShaftTree> tree_;
    std::unique_ptr<BuiltHeightField> field_;
    SortedPoints sorted_points_;  ///< of the last run over many lights, for their memory

    /// The way that `auto` took for a run over many lights, for the next runs of the same kind, as long as the tree is
    /// kept. Affects time alone.
    struct WayTaken {
        std::vector<Light> lights;
        std::size_t point_count;
        bool is_picture;
        ManyLightsWay way;
        std::uint32_t runs_left;
    };
    std::optional<WayTaken> way_taken_;
};

}  // namespace gnomon
