// SPDX-License-Identifier: MIT
// Stage projection: projection x partition, the views of a shadow map fitted to the shading points
// (kernels/rivals/shadow_map/map_projection.h, partition.clh), with the warps of a point light's faces and of
// texels (point_light_perspective.h, rectilinear_warp.h).
#pragma once

#include "kernels/rivals/shadow_map/map_projection.h"
#include "kernels/rivals/shadow_map/texel_footprint.h"
#include "query/settings_table.hpp"
#include "rivals/shadow_map/depth_pass.hpp"

namespace gnomon {

/// The inputs of a fit. Points with visibility 1 are still open.
struct FitInputs {
    TriangleInputs triangles;
    PointInputs points;
    cl_mem visibility;
    Light light;
    std::optional<PointsCamera> camera;
    bool keeps_casters = false;  ///< the map's depths reach to the casters nearest to the light, not only to receivers
};

/// The camera's steps from pixel to pixel.
PixelSteps pixel_steps(const PointsCamera& from);

/// Fills map_views.tables with the texel centres of the views.
void fill_centres(cl::Session& session, const MapViews& map_views);

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
    /// Gives the plain faces in planned_ the warp of least error over the open points. bounds_ contains the faces'
    /// bounds of the points; afterwards those of the faces are empty again.
    void warp_faces(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs);
    /// Gives the views the tables of their rectilinear warp.
    void warp_texels(cl::Session& session, const ViewPlan& plan, const FitInputs& inputs, MapViews& map_views);

    Settings settings_ = settings_table().defaults();

    MapViews small_views_;  ///< for the warp's analysis from the light
    DepthMap small_map_;
    cl::Buffer planned_, bounds_, samples_, faces_, costs_, importance_;
};

}  // namespace gnomon
