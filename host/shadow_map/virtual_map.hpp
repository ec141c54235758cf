// SPDX-License-Identifier: MIT
// Technique virtual-shadow-map: a large shadow map of which only the pages that shading points ask for exist
// (kernels/shadow_map/virtual_map.h).
#pragma once

#include "../../kernels/shadow_map/virtual_map.h"
#include "../scan.hpp"
#include "depth_pass.hpp"
#include "projection.hpp"

namespace gnomon {

class VirtualShadowMap final : public Technique {
public:
    explicit VirtualShadowMap(const Device& device) : device_(device) {}
    Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                   const Visibility& visibility) override;
    void set(std::string_view name, std::string_view value) override;
    /// "page": which page serves each point. Of any points, not only a camera's.
    std::vector<std::uint8_t> diagnose(std::string_view name, const Triangles& triangles, const Points& points,
                                       const Light& light) override;

    static TechniqueDescription describe();

private:
    VirtualPlan plan_of(const FitInputs& inputs, std::uint32_t view_count) const;
    void run_stages(const FitInputs& inputs, Statistics& statistics);
    void request(const FitInputs& inputs, const VirtualPlan& plan);
    /// Makes a physical page of every entry that was asked for.
    void allocate(const VirtualPlan& plan);
    void draw(const TriangleInputs& triangles, const VirtualPlan& plan);

    Device device_;
    std::uint32_t size_ = 16384, level_ = 0;
    float detail_ = 1;
    float constant_bias_ = 1e-4f, slope_bias_ = 1.5f, slope_limit_ = 0.05f;  // as shadow-map's
    std::uint64_t kept_bytes_ = 0;  ///< of the buffers below, kept from run to run

    ViewFit fit_;
    Scan scan_;
    MapViews map_views_, level_views_;
    cl::Buffer counters_, requested_, page_of_, point_entries_, pages_, touched_, keys_, pairs_;
    std::uint32_t pair_capacity_ = 1u << 12;
    VirtualCounters counted_{};
};

}  // namespace gnomon
