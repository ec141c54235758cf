// SPDX-License-Identifier: MIT
#include "techniques/shadow_map/rectilinear_warp.hpp"

namespace gnomon {
namespace {

constexpr const char* file = "techniques/shadow_map/rectilinear_warp.cl";
// In the order of their values in rectilinear_warp.h; functions by their bits.
constexpr std::string_view analyses[] = {"off", "backward", "forward", "hybrid"};
constexpr std::string_view functions[] = {"view", "distance", "edge", "normal"};

// "view+edge": their bits.
cl_uint functions_of(const SettingText& value) {
    cl_uint bits = 0;
    for (std::string_view rest = value.text; !rest.empty();) {
        const std::string_view one = rest.substr(0, rest.find('+'));
        bits |= 1u << SettingText{value.name, one}.choice(functions);
        rest.remove_prefix(std::min(one.size() + 1, rest.size()));
    }
    if (bits == 0) throw InvalidArgument(std::string(value.name) + " is view, distance, edge and normal, joined by +");
    return bits;
}

}  // namespace

const SettingsTable<RectilinearWarp::Settings>& RectilinearWarp::settings_table() {
    using S = Settings;
    static const SettingsTable<S> table{
        {{"warp", "off", "off, backward, forward or hybrid: move texels to where this analysis finds them needed"},
         setting::choice(&S::analysis, analyses)},
        {{"importance", "view+distance+edge+normal", "what makes a cell of the warp important, joined by +"},
         [](S& s, const SettingText& value) { s.functions = functions_of(value); }},
    };
    return table;
}

void RectilinearWarp::run(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs, const cl::Buffer& bounds,
                          const MapViews& small_views, std::uint32_t tables_first, MapViews& map_views) {
    const WarpPlan warp{settings_.analysis, settings_.functions, tables_first, 0};
    const std::size_t cells = std::size_t(plan.view_count) * WARP_PIECES * WARP_PIECES;
    importance_.reserve(session, cells * sizeof(cl_uint));
    session.launch(file, "rectilinear_clear", cl::Range::items(cells), cl_uint(cells), importance_);
    if (settings_.analysis != ANALYSIS_FORWARD)
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
