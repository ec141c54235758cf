// SPDX-License-Identifier: MIT
// Visibility, surfaces, the sky's light and the mean of samples.
#include "picture.hpp"

#include "query/inputs.hpp"
#include "terminal.hpp"

namespace gnomon::app {
namespace {

/// Patches of the sky that give light from all sides: a weight is the patch's solid angle over pi.
Lights sky_of(std::uint32_t division) {
    const Lights patches = sky_patches({0, 1, 0}, {0, 0, -1}, division);
    const std::span<const Light> lights = patches.lights();
    std::vector<float> weights;
    for (std::size_t i = 0; i < lights.size(); ++i) weights.push_back(patches.weights()[i] / lights[i].xyzw[1]);
    return Lights({lights.begin(), lights.end()}, std::move(weights));
}

}  // namespace

void warn_or_refuse(const ViewOptions& options, const std::string& what) {
    if (options.strict) throw Error(what + " (an error because of --strict)");
    print_warning(what);
}

void require_exact_for_cut_outs(const RenderOptions& options, const scene::Scene& scene) {
    const bool is_opaque = options.technique == "shadow-volumes";
    if (scene.cut_outs.empty() || (!is_opaque && options.technique != "conservative-map")) return;
    warn_or_refuse(options,
                   options.technique + (is_opaque ? " takes triangles that are cut out by their alpha for opaque ones"
                                                  : " leaves out triangles that are cut out by their alpha"));
}

std::vector<Light> PictureLights::lights() const {
    std::vector<Light> lights;
    for (const ChosenLight& one : chosen) lights.push_back(one.light);
    return lights;
}

void PictureLights::decide(Technique& technique, const Triangles& triangles, const View& view,
                           const std::vector<Visibility>& visibilities, const RunOptions& run) const {
    if (!options.sun_angle_degrees) {
        technique.run_each_light(triangles, view.points, lights(), visibilities, run);
        return;
    }
    for (std::size_t i = 0; i < visibilities.size(); ++i)
        run_mean(technique, triangles, view.points, sun_of(options, chosen[i], default_sun_samples), visibilities[i],
                 run);
}

std::vector<Visibility> visibilities_for(const Device& device, const View& view, std::size_t light_count) {
    std::vector<Visibility> visibilities;
    for (std::size_t i = 0; i < light_count; ++i) visibilities.emplace_back(device, view.points.count());
    return visibilities;
}

Surfaces SceneSurfaces::of(const Triangles& triangles, const View& view) {
    const scene::SurfaceDetailView detail(scene_);
    try {
        if (fits_ && !appearance_) appearance_ = Appearance::upload(device_, scene_.materials, detail.get(), textures_);
        if (fits_) return appearance_->surfaces(triangles, view);
    } catch (const OutOfDeviceMemory&) {
        fits_ = false;
        appearance_.reset();
    }
    return Surfaces(device_, triangles, view, scene_.materials, detail.get(), textures_);
}

cl::Buffer sky_sums_of(const Device& device, Technique& technique, const Triangles& triangles, const Points& of,
                       const Surfaces& surfaces, std::uint32_t division, const RunOptions& run) {
    // The shading normals decide the side.
    const Points points = Points::wrap(device, of.positions(), of.layout(), of.count(), of.receivers());
    cl::Buffer sums(session_of(device), of.count() * sizeof(double));
    RunOptions by_normals = run;
    by_normals.facing = Facing::normals(surfaces.normals());
    technique.run_light_table(triangles, points, sky_of(division), {.sums = sums.get(), .cosines = true}, by_normals);
    return sums;
}

std::optional<double> exposure_of(const RenderOptions& options, std::size_t light_count) {
    if (options.exposure_ev || options.is_metered) return options.exposure_ev;
    return light_count > 1 || options.sky_division != 0 || options.area_light ? std::nullopt : std::optional<double>(0);
}

Picture smooth_picture(Technique& technique, SceneSurfaces& scene_surfaces, const PictureLights& lights,
                       const Triangles& triangles, const View& view, std::optional<double> exposure_ev,
                       const std::function<void(const Surfaces&)>& at_first, const RunOptions& run) {
    const Device& device = technique.device();
    const RenderOptions& options = lights.options;
    SampleViews views(device, triangles, view, options.samples);
    PictureMean mean(device, view.points.count(), options.samples);
    const std::vector<Visibility> visibilities = visibilities_for(device, view, lights.chosen.size());
    for (std::size_t i = 0; i < views.count(); ++i) {
        const View sample = views.at(i);
        lights.decide(technique, triangles, sample, visibilities, run);
        const Surfaces surfaces = scene_surfaces.of(triangles, sample);
        if (i == 0 && at_first) at_first(surfaces);
        cl::Buffer sky;
        if (options.sky_division != 0)
            sky = sky_sums_of(device, technique, triangles, sample.points, surfaces, options.sky_division, run);
        exposure_ev =
            mean.add(surfaces, visibilities, lights.lights(), {.exposure_ev = exposure_ev, .sky_sums = sky.get()});
    }
    return {mean.read(), exposure_ev.value_or(0)};
}

}  // namespace gnomon::app
