// SPDX-License-Identifier: MIT
#include "techniques/shadow_map/rectilinear_warp.hpp"

#include "api/setting_values.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "techniques/shadow_map/rectilinear_warp.cl";
// In the order of their values in rectilinear_warp.h; functions by their bits.
constexpr std::string_view analyses[] = {"off", "backward", "forward", "hybrid"};
constexpr std::string_view functions[] = {"view", "distance", "edge", "normal"};

// "view+edge": their bits.
cl_uint functions_of(std::string_view name, std::string_view value) {
    cl_uint bits = 0;
    while (!value.empty()) {
        const std::string_view one = value.substr(0, value.find('+'));
        bits |= 1u << choice_setting(name, one, functions);
        value.remove_prefix(std::min(one.size() + 1, value.size()));
    }
    if (bits == 0) throw InvalidArgument(std::string(name) + " is view, distance, edge and normal, joined by +");
    return bits;
}

}  // namespace

bool RectilinearWarp::set(std::string_view name, std::string_view value) {
    if (name == "warp")
        analysis_ = choice_setting(name, value, analyses);
    else if (name == "importance")
        functions_ = functions_of(name, value);
    else
        return false;
    return true;
}

std::vector<SettingDescription> RectilinearWarp::settings() {
    return {{"warp", "off", "off, backward, forward or hybrid: move texels to where this analysis finds them needed"},
            {"importance", "view+distance+edge+normal", "what makes a cell of the warp important, joined by +"}};
}

void RectilinearWarp::run(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs, const cl::Buffer& bounds,
                          const MapViews& small_views, std::uint32_t tables_first, MapViews& map_views) {
    const WarpPlan warp{analysis_, functions_, tables_first, 0};
    const std::size_t cells = std::size_t(plan.view_count) * WARP_PIECES * WARP_PIECES;
    importance_.reserve(session, cells * sizeof(cl_uint));
    session.launch(file, "rectilinear_clear", cl::Range::items(cells), cl_uint(cells), importance_);
    if (analysis_ != ANALYSIS_FORWARD)
        session.launch(file, "rectilinear_backward", cl::Range::items(inputs.points.layout.count), plan, warp,
                       map_views.set, inputs.points.layout, inputs.triangles.first_float, inputs.points.positions,
                       inputs.points.receivers, inputs.triangles.vertices, inputs.visibility, map_views.views, bounds,
                       importance_);
    if (looks_from_light()) {
        small_map_.run(session, inputs.triangles, small_views, {}, false);
        session.launch(file, "rectilinear_forward", cl::Range::items(cells), plan, warp, small_views.views,
                       small_map_.keys(), bounds, importance_);
    }
    session.launch(file, "rectilinear_tables", cl::Range::groups(2 * plan.view_count), warp, importance_,
                   map_views.views, map_views.tables, cl::LocalBytes{2 * WARP_PIECES * sizeof(float)});
}

}  // namespace gnomon
