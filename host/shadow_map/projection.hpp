// SPDX-License-Identifier: MIT
// Stage projection: fits the views of a shadow map to the shading points (kernels/shadow_map/projection.cl).
#pragma once

#include "map_views.hpp"

namespace gnomon {

/// Projection x partition: makes the views of a map of size x size texels per view.
class ViewFit {
public:
    /// True if the setting is one of the fit's; throws InvalidArgument if its value is none.
    bool set(std::string_view name, std::string_view value);
    static std::vector<SettingDescription> settings();
    /// Fills map_views, texel centres included.
    void run(cl::Session& session, const FitInputs& inputs, std::uint32_t size, MapViews& map_views);

private:
    cl::Buffer basis_, bounds_;
};

}  // namespace gnomon
