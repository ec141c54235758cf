// SPDX-License-Identifier: MIT
#include "techniques/shadow_map/rectilinear_warp.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "techniques/shadow_map/rectilinear_warp.cl";

}  // namespace

void RectilinearWarp::run(cl::Session& session, const ViewPlan& plan, const WarpPlan& warp, const FitInputs& inputs,
                          const cl::Buffer& bounds, const MapViews& small_views, MapViews& map_views) {
    const std::size_t cells = std::size_t(plan.view_count) * WARP_SEGMENTS * WARP_SEGMENTS;
    importance_.reserve(session, cells * sizeof(cl_uint));
    session.fill(importance_, 0, cells * sizeof(cl_uint));
    if (warp.analysis != ANALYSIS_FORWARD)
        session.launch(file, "rectilinear_backward", cl::Range::items(inputs.points.layout.count), plan, warp,
                       map_views.set, inputs.points.layout, inputs.triangles.first_float, inputs.points.positions,
                       inputs.points.receivers, inputs.triangles.vertices, inputs.visibility, map_views.views, bounds,
                       importance_);
    if ((warp.analysis & ANALYSIS_FORWARD) != 0) {
        small_map_.run(session, inputs.triangles, small_views, {}, false);
        session.launch(file, "rectilinear_forward", cl::Range::items(cells), plan, warp, small_views.views,
                       small_map_.keys(), bounds, importance_);
    }
    session.launch(file, "rectilinear_tables", cl::Range::groups(2 * plan.view_count), warp, importance_,
                   map_views.views, map_views.tables, cl::LocalBytes{2 * WARP_SEGMENTS * sizeof(float)});
}

}  // namespace gnomon
