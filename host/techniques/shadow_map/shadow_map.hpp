// SPDX-License-Identifier: MIT
// Technique shadow-map: projection x partition x stored quantity x prefilter x lookup, each a setting of its own.
// The order of the stages is in shadow_map.cpp; named compositions are in presets.cpp.
#pragma once

#include "kernels/techniques/shadow_map/lookup.h"
#include "techniques/shadow_map/map_projection.hpp"
#include "techniques/shadow_map/stored_map.hpp"

namespace gnomon {

/// The settings of a shadow map beside its fit. Depths are in units of the map's depth: 0 to 1 over the receivers.
struct ShadowMapSettings : StorePlan {
    enum class Bias : std::uint32_t { scaled, adaptive, dual };

    std::uint32_t size, filter_width, lookup, taps;
    Prefilter prefilter;
    float softness, light_size;
    Bias bias;
    float slope_bias, slope_limit, dual_limit;
    std::optional<float> set_moment_bias;  ///< none: the store's own
    bool all_bits;
};

class ShadowMap final : public Technique {
public:
    /// `name`: of the preset, for the texts of errors.
    explicit ShadowMap(const Device& device, std::string name = "shadow-map");
    Statistics run(const Triangles& triangles, const Points& points, const Light& light,
                   const Visibility& visibility) override;
    void set(std::string_view name, std::string_view value) override;
    std::vector<std::uint8_t> diagnose(std::string_view name, const Triangles& triangles, const Points& points,
                                       const Light& light) override;

    static TechniqueDescription describe();

private:
    /// Throws InvalidArgument where settings contradict each other.
    void require_consistent() const;
    StorePlan store_plan() const;
    LookupPlan lookup_plan(const TriangleInputs& triangles) const;
    void run_stages(const FitInputs& inputs, Statistics& statistics);

    Device device_;
    std::string name_;
    ShadowMapSettings settings_;
    ViewFit fit_;
    std::uint64_t kept_bytes_ = 0;  ///< of the buffers below, kept from run to run
    cl::Buffer counters_, offsets_;
    MapViews map_views_;
    DepthMap depths_;
    StoredMap stored_;
};

}  // namespace gnomon
