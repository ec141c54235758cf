// SPDX-License-Identifier: MIT
// Stage projection: projection x partition, the views of a shadow map fitted to the shading points
// (kernels/techniques/shadow_map/map_projection.h, kernels/techniques/shadow_map/partition.clh).
#pragma once

#include "api/settings_table.hpp"
#include "kernels/techniques/shadow_map/map_projection.h"
#include "techniques/shadow_map/point_light_perspective.hpp"
#include "techniques/shadow_map/rectilinear_warp.hpp"

namespace gnomon {

class ViewFit {
public:
    /// False if the fit has no such setting; throws InvalidArgument if the value is not allowed.
    bool set(std::string_view name, std::string_view value) {
        return settings_table().set_if_known(settings_, name, value);
    }
    static std::vector<SettingDescription> settings() { return settings_table().descriptions(); }
    /// Fills map_views, texel centres included, with views of size x size texels each (or that many in all, shared out
    /// by error). Nothing is read back.
    void run(cl::Session& session, const FitInputs& inputs, std::uint32_t size, MapViews& map_views);
    /// The limits of run() for these inputs: empty, or the reason why it cannot do as the settings require, and the
    /// replacement.
    std::string limits(const FitInputs& inputs) const;

private:
    struct Settings : ViewPlan {
        std::optional<cl_uint> set_partition, set_range;  ///< none: chosen by the light and the other settings
        cl_uint cascades, analysis, importance;           ///< the last two: of the warp (rectilinear_warp.h)
        bool is_atlas;
    };
    static const SettingsTable<Settings>& settings_table();
    ViewPlan plan_of(const FitInputs& inputs, std::uint32_t size) const;
    void run_bounds(cl::Session& session, const ViewPlan& plan, const ViewRange& range, const PointInputs& points,
                    cl_mem visibility);

    void run_fit(cl::Session& session, const ViewPlan& plan, MapViews& map_views);
    void run_warp(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs, MapViews& map_views);

    Settings settings_ = settings_table().defaults();

    PointLightPerspective point_light_perspective_;
    RectilinearWarp warp_;
    MapViews small_views_;  ///< for the warp's analysis from the light
    cl::Buffer planned_, bounds_;
};

}  // namespace gnomon
