// SPDX-License-Identifier: MIT
// Rectilinear texture warping: tables that move texels to where they matter
// (kernels/techniques/shadow_map/rectilinear_warp.h).
#pragma once

#include "kernels/techniques/shadow_map/rectilinear_warp.h"
#include "techniques/shadow_map/depth_pass.hpp"

namespace gnomon {

class RectilinearWarp {
public:
    /// True if the setting is one of the warp's; throws InvalidArgument if its value is none.
    bool set(std::string_view name, std::string_view value);
    static std::vector<SettingDescription> settings();

    bool is_on() const { return analysis_ != ANALYSIS_NONE; }
    bool looks_from_light() const { return (analysis_ & ANALYSIS_FORWARD) != 0; }
    /// Floats that the tables of so many views take.
    static std::size_t table_floats(std::uint32_t view_count) {
        return std::size_t(view_count) * 2 * (WARP_PIECES + 1);
    }
    /// Gives the views their tables, from map_views.tables[tables_first] on. small_views: the same views at
    /// WARP_PIECES^2 texels, read if looks_from_light().
    void run(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs, const cl::Buffer& bounds,
             const MapViews& small_views, std::uint32_t tables_first, MapViews& map_views);

private:
    cl_uint analysis_ = ANALYSIS_NONE;
    cl_uint functions_ = IMPORTANCE_VIEW | IMPORTANCE_DISTANCE | IMPORTANCE_EDGE | IMPORTANCE_NORMAL;
    cl::Buffer importance_;
    DepthMap small_map_;
};

}  // namespace gnomon
