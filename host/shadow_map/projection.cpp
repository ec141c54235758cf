// SPDX-License-Identifier: MIT
#include "projection.hpp"

#include "../vectors.hpp"

namespace gnomon {
namespace {

// As in kernels/shadow_map/projection.cl.
struct LightBasis {
    float light[4];
    float right[3], up[3], forward[3], origin[3];
};
constexpr std::size_t view_bounds_bytes = 24;

void store(float* to, const Double3& v) {
    for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(v[i]);
}

LightBasis basis_of(const FitInputs& inputs) {
    LightBasis basis{};
    const auto& light = inputs.light.xyzw;
    std::copy(light.begin(), light.end(), basis.light);
    if (!inputs.light.is_directional()) {
        std::copy(light.begin(), light.begin() + 3, basis.origin);
        return basis;
    }
    Double3 forward{-double(light[0]), -double(light[1]), -double(light[2])};
    normalize(forward);
    // The world axis least along the light spans the map's first axis.
    int least = 0;
    for (int i = 1; i < 3; ++i)
        if (std::fabs(forward[i]) < std::fabs(forward[least])) least = i;
    Double3 hint{};
    hint[least] = 1;
    Double3 right = cross(forward, hint);
    normalize(right);
    store(basis.right, right);
    store(basis.up, cross(right, forward));
    store(basis.forward, forward);
    if (inputs.camera)
        store(basis.origin,
              Double3{inputs.camera->camera.eye[0], inputs.camera->camera.eye[1], inputs.camera->camera.eye[2]});
    return basis;
}

}  // namespace

bool ViewFit::set(std::string_view, std::string_view) { return false; }

std::vector<SettingDescription> ViewFit::settings() { return {}; }

void ViewFit::run(cl::Session& session, const FitInputs& inputs, std::uint32_t size, MapViews& map_views) {
    const LightBasis basis = basis_of(inputs);
    const cl_uint view_count = inputs.light.is_directional() ? 1 : 6;
    MapSet& set = map_views.set;
    set = {};
    set.view_count = view_count;
    set.texels_per_view = size * size;
    set.texels = view_count * size * size;
    if (inputs.camera) {
        set.has_camera = 1;
        for (int i = 0; i < 3; ++i) {
            set.eye[i] = inputs.camera->camera.eye[i];
            set.camera_forward[i] = static_cast<float>(inputs.camera->camera.forward[i]);
        }
    }
    map_views.views.reserve(session, view_count * sizeof(MapView));
    map_views.tables.reserve(session, std::size_t(view_count) * 2 * size * sizeof(float));
    basis_.reserve(session, sizeof(basis));
    session.write(basis_.get(), &basis, sizeof(basis));
    bounds_.reserve(session, view_count * view_bounds_bytes);
    session.launch("shadow_map/projection.cl", "projection_clear", cl::Range::items(view_count), view_count, bounds_);
    session.launch("shadow_map/projection.cl", "projection_bounds", cl::Range::groups(session.many_groups()), basis_,
                   inputs.points.layout, inputs.points.positions, inputs.visibility, bounds_);
    session.launch("shadow_map/projection.cl", "projection_uniform", cl::Range::items(view_count), basis_, view_count,
                   size, bounds_, map_views.views);
    fill_centres(session, map_views);
}

}  // namespace gnomon
