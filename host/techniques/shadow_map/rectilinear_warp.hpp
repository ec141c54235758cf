// SPDX-License-Identifier: MIT
// Rectilinear texture warping: tables that move texels to where they matter
// (kernels/techniques/shadow_map/rectilinear_warp.h).
#pragma once

#include "api/settings_table.hpp"
#include "kernels/techniques/shadow_map/rectilinear_warp.h"
#include "techniques/shadow_map/depth_pass.hpp"

namespace gnomon {

class RectilinearWarp {
public:
    /// False where the setting is none of the warp's; throws InvalidArgument where its value is not allowed.
    bool set(std::string_view name, std::string_view value) {
        return settings_table().set_if_known(settings_, name, value);
    }
    static std::vector<SettingDescription> settings() { return settings_table().descriptions(); }

    bool is_on() const { return settings_.analysis != ANALYSIS_NONE; }
    bool looks_from_light() const { return (settings_.analysis & ANALYSIS_FORWARD) != 0; }
    /// Floats that the tables of so many views take.
    static std::size_t table_floats(std::uint32_t view_count) {
        return std::size_t(view_count) * 2 * (WARP_PIECES + 1);
    }
    /// Gives the views their tables, from map_views.tables[tables_first] on. small_views: the same views at
    /// WARP_PIECES^2 texels, read if looks_from_light().
    void run(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs, const cl::Buffer& bounds,
             const MapViews& small_views, std::uint32_t tables_first, MapViews& map_views);

private:
    struct Settings {
        cl_uint analysis, functions;
    };
    static const SettingsTable<Settings>& settings_table();

    Settings settings_ = settings_table().defaults();
    cl::Buffer importance_;
    DepthMap small_map_;
};

}  // namespace gnomon
