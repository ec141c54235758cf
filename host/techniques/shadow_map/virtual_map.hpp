// SPDX-License-Identifier: MIT
// Technique virtual-shadow-map: a large shadow map that has only the pages that shading points request
// (kernels/techniques/shadow_map/virtual_map.h).
#pragma once

#include "api/settings_table.hpp"
#include "kernels/techniques/shadow_map/virtual_map.h"
#include "lists/scan.hpp"
#include "techniques/shadow_map/depth_pass.hpp"
#include "techniques/shadow_map/map_projection.hpp"

namespace gnomon {

class VirtualShadowMap final : public Technique {
public:
    explicit VirtualShadowMap(const Device& device) : device_(device) {}
    Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                   const Visibility& visibility) override;
    /// All lights' pages lie in one pool, drawn in one pass.
    std::vector<Statistics> run_lights(const Triangles& triangles, const Points& points, std::span<const Light> lights,
                                       std::span<const Visibility> visibilities) override;
    void set(std::string_view name, std::string_view value) override {
        settings_table().set(settings_, "virtual-shadow-map", name, value);
    }
    /// "page": the page that serves each point. The points need not be a camera's.
    std::vector<std::uint8_t> diagnose(std::string_view name, const Triangles& triangles, const Points& points,
                                       const Light& light) override;

    static TechniqueDescription describe();

private:
    struct Settings {
        std::uint32_t size, level;
        float detail;
        float constant_bias, slope_bias, slope_limit;  ///< as shadow-map's
    };
    static const SettingsTable<Settings>& settings_table();
    /// A light, the inputs of its stages, and the position of its views and points among those of all lights.
    struct LightRun {
        FitInputs inputs;
        Statistics statistics{};
        std::uint64_t facing_away = 0, absent = 0, outside = 0, pages = 0;
        std::size_t index = 0;
        VirtualLight light{};
    };

    VirtualPlan plan_of(const FitInputs& inputs, std::uint32_t view_count) const;
    /// Views, requests, pages, drawing and lookup for the lights that some point faces.
    void run_stages(std::vector<LightRun*>& runs);
    void request(LightRun& run, const VirtualPlan& plan);
    /// Makes a physical page of every requested entry.
    void allocate(const VirtualPlan& plan);
    void draw(const TriangleInputs& triangles, const VirtualPlan& plan);
    /// How many of the pages [first, first + count) overlap the rectangle of some caster.
    std::uint64_t pages_drawn(std::uint64_t first, std::uint64_t count) const;

    Device device_;
    Settings settings_ = settings_table().defaults();
    std::uint64_t kept_bytes_ = 0;  ///< of the buffers below, kept from run to run

    ViewFit fit_;
    Scan scan_;
    std::vector<MapViews> light_views_;  ///< of each light
    MapViews level_views_;
    cl::Buffer counters_, requested_, page_of_, point_entries_, pages_, touched_, keys_, pairs_;
    std::uint32_t pair_capacity_ = 1u << 12;
    VirtualCounters counted_{};
};

}  // namespace gnomon
