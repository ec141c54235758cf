// SPDX-License-Identifier: MIT
// Rectilinear texture warping: tables that move texels to the parts of the map that the picture needs
// (kernels/techniques/shadow_map/rectilinear_warp.h).
#pragma once

#include "kernels/techniques/shadow_map/rectilinear_warp.h"
#include "techniques/shadow_map/depth_pass.hpp"

namespace gnomon {

class RectilinearWarp {
public:
    /// Floats that the tables of so many views take.
    static std::size_t table_floats(std::uint32_t view_count) {
        return std::size_t(view_count) * 2 * (WARP_SEGMENTS + 1);
    }
    /// Gives the views their tables, from map_views.tables[warp.tables_first] on. small_views: the same views at
    /// WARP_SEGMENTS^2 texels, read if ANALYSIS_FORWARD is among warp.analysis.
    void run(cl::Session& session, const ViewPlan& plan, const WarpPlan& warp, const FitInputs& inputs,
             const cl::Buffer& bounds, const MapViews& small_views, MapViews& map_views);

private:
    cl::Buffer importance_;
    DepthMap small_map_;
};

}  // namespace gnomon
