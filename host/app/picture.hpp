// SPDX-License-Identifier: MIT
// How the picture of a view is made, from its points to its colours: gnomon render and gnomon view have the same bits.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "cl/session.hpp"
#include "setup.hpp"

namespace gnomon::app {

/// A warning, or an error under --strict.
void warn_or_refuse(const ViewOptions& options, const std::string& what);

/// Techniques that do not test masks are warned about, and refused under --strict. Those that store depths or
/// triangles in a map test them as a map does.
void require_exact_for_cut_outs(const RenderOptions& options, const scene::Scene& scene);

/// The lights of a picture, each as the options let it shine.
struct PictureLights {
    const RenderOptions& options;
    std::vector<ChosenLight> chosen;

    std::vector<Light> lights() const;
    /// Decides the points of a view, one of each pixel, by each light. Throws Cancelled if `run` says so.
    void decide(Technique& technique, const Triangles& triangles, const View& view,
                const std::vector<Visibility>& visibilities, const RunOptions& run = {}) const;
};

/// One for each light, with room for all points of the view.
std::vector<Visibility> visibilities_for(const Device& device, const View& view, std::size_t light_count);

/// The surfaces of views: by an appearance of the whole scene where all fits, else by what a view shows.
class SceneSurfaces {
public:
    SceneSurfaces(const Device& device, const scene::Scene& scene, SurfaceTextures* textures)
        : device_(device), scene_(scene), textures_(textures) {}
    Surfaces of(const Triangles& triangles, const View& view);

private:
    const Device& device_;
    const scene::Scene& scene_;
    SurfaceTextures* textures_;
    std::optional<Appearance> appearance_;
    bool fits_ = true;
};

/// For each pixel the part of the sky's light that reaches it, by the cosines to its shading normal: float64.
cl::Buffer sky_sums_of(const Device& device, Technique& technique, const Triangles& triangles, const Points& of,
                       const Surfaces& surfaces, std::uint32_t division, const RunOptions& run = {});

/// One light without a sky and without an area is as bright as the tone curve expects it. Other exposures are metered,
/// if not given.
std::optional<double> exposure_of(const RenderOptions& options, std::size_t light_count);

/// The mean of the pictures of all samples: silhouettes and textures are as smooth as shadows. `at_first` gets the
/// first sample's surfaces. Throws Cancelled if `run` says so.
Picture smooth_picture(Technique& technique, SceneSurfaces& scene_surfaces, const PictureLights& lights,
                       const Triangles& triangles, const View& view, std::optional<double> exposure_ev,
                       const std::function<void(const Surfaces&)>& at_first = {}, const RunOptions& run = {});

}  // namespace gnomon::app
