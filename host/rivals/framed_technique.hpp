// SPDX-License-Identifier: MIT
// The base of techniques that decide points frame by frame of the light, by a map of triangles. A derived technique
// adds the map and its lookup.
#pragma once

#include "kernels/rivals/framed_technique.h"
#include "occluders/conservative_map.hpp"
#include "occluders/triangle_setup.hpp"
#include "query/settings_table.hpp"
#include "query/statistics.hpp"
#include "receivers/light_frames.hpp"
#include "technique/registered.hpp"

namespace gnomon {

/// The settings of all framed techniques; each has some of them.
struct FramedSettings {
    bool draws_map, neighbours;
    CoverTest cover_test;
    std::uint32_t map_size;
};

class FramedTechnique : public Technique {
public:
    const Device& device() const final { return device_; }
    Statistics run_light(const Triangles& triangles, const Points& points, const Light& light,
                         const Visibility& visibility) final;
    void set(std::string_view name, std::string_view value) final;

protected:
    struct Run : FramedInputs {
        Statistics statistics{};
        std::uint64_t frames = 0, grown = 0, tests = 0;
        FrameCounters counted{};  ///< sums over the frames
    };
    FramedTechnique(const Device& device, TechniqueDescription description);
    /// The descriptions of some settings, by name.
    static std::vector<SettingDescription> settings(std::initializer_list<std::string_view> names);

    virtual FrameGrid grid() const { return map_grid(session_, settings_.map_size); }
    /// Decides the open points of a frame by its projection, frames_.projection(); the counters of the frame.
    virtual FrameCounters run_frame(Run& run, cl_uint frame) = 0;
    /// The technique's own counts.
    virtual decltype(Statistics::counts) counts_of(Run& run) const = 0;

    FramedParams params_of(const Run& run, cl_uint frame) const;
    /// Makes the frame's triangles and their tiles; for the conservative map, only those that may cover a whole texel.
    void list_triangles(Run& run, bool for_map);

    Device device_;
    cl::Session& session_;
    FramedSettings settings_;
    cl::Buffer counters_;  ///< FrameCounters
    LightFrames frames_;
    TriangleSetup setup_;

private:
    TechniqueDescription description_;
    std::uint64_t kept_bytes_ = 0;  ///< of the buffers, kept from run to run
};

}  // namespace gnomon
