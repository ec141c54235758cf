// SPDX-License-Identifier: MIT
// Stage shade: the picture of a view (kernels/shading/shade.cl). Its public function is shade() of gnomon.hpp.
#include <cmath>

#include "kernels/shading/shade.h"
#include "shading/received_light.hpp"
#include "shading/surface.hpp"

namespace gnomon {
namespace {

/// The sum of the lights' Lambert terms.
void add_lights(cl::Session& session, const Surfaces::Inside& of, std::span<const Visibility> visibilities,
                std::span<const Light> lights, const cl::Buffer& lambert) {
    if (lights.empty()) session.fill(lambert, 0, of.points.count() * sizeof(float));
    const PointInputs points = point_inputs(of.points);
    // Any buffer stands for what is not read.
    const cl::Buffer& spreads = of.has_shading_normals ? of.buffers->spreads : lambert;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const auto& [x, y, z, w] = lights[i].xyzw;
        const ShadeParams params{.layout = points.layout,
                                 .light = {x, y, z, w},
                                 .is_first = i == 0,
                                 .has_spreads = of.has_shading_normals,
                                 .padding = {}};
        session.launch("shading/shade.cl", "shade_light", cl::Range::items(of.points.count()), params, points.positions,
                       of.buffers->normals, spreads, visibilities[i].buffer(), lambert);
    }
}

void require_shade(const Surfaces& surfaces, std::span<const Visibility> visibilities, std::span<const Light> lights,
                   const ShadeOptions& options) {
    const std::size_t pixels = surfaces.count();
    if (lights.size() != visibilities.size())
        throw InvalidArgument("there are " + std::to_string(visibilities.size()) + " visibilities for " +
                              std::to_string(lights.size()) + " lights");
    for (const Visibility& visibility : visibilities)
        if (visibility.count() < pixels)
            throw InvalidArgument("the visibility buffer has fewer entries than the view has pixels");
    if (!options.sky_shares.empty() && options.sky_shares.size() != pixels)
        throw InvalidArgument("there are " + std::to_string(options.sky_shares.size()) + " shares of the sky for " +
                              std::to_string(pixels) + " pixels");
    if (options.sky_sums != nullptr && bytes_of(options.sky_sums) < pixels * sizeof(double))
        throw InvalidArgument("the buffer of the sky's sums has fewer entries than the view has pixels");
    if (options.exposure_ev && !std::isfinite(*options.exposure_ev))
        throw InvalidArgument("the exposure must be a finite number");
}

/// Brings the sky's shares to their buffer. False: there are none.
bool bring_sky_shares(cl::Session& session, const ShadeOptions& options, std::size_t pixels, cl::Buffer& shares) {
    shares.reserve(session, 0);
    if (options.sky_sums == nullptr && options.sky_shares.empty()) return false;
    shares.reserve(session, pixels * sizeof(float));
    if (options.sky_sums != nullptr)
        round_sums(session, options.sky_sums, pixels, shares);
    else
        session.write(shares.get(), options.sky_shares.data(), options.sky_shares.size_bytes());
    return true;
}

/// Launches a kernel that reads what a picture shows.
template <typename... Arguments>
void launch_picture(cl::Session& session, const char* name, const Surfaces::Inside& of, const PictureParams& params,
                    const Arguments&... outputs) {
    const SurfaceBuffers& buffers = *of.buffers;
    // With albedos there are no materials, and without them no albedos: any buffer stands for what is not read.
    const cl::Buffer& any = of.tables->srgb;
    const cl::Buffer& ids = of.has_albedos ? any : of.tables->triangle_material;
    const cl::Buffer& colors = of.has_albedos ? any : of.tables->base_colors;
    const cl::Buffer& albedos = of.has_albedos ? buffers.albedos : any;
    session.launch("shading/shade.cl", name, cl::Range::items(of.points.count()), params, of.points.receivers(),
                   of.buffers->normals, buffers.lambert, ids, colors, albedos, buffers.sky_shares, outputs...);
}

struct PreparedPicture {
    PictureParams params;
    double exposure_ev;
};

/// Brings what the kernels of a picture read: the lights' sums, the sky's shares and the exposure.
PreparedPicture prepare_picture(const Surfaces& surfaces, std::span<const Visibility> visibilities,
                                std::span<const Light> lights, const ShadeOptions& options) {
    const Surfaces::Inside& of = surfaces.inside();
    cl::Session& session = session_of(of.device);
    SurfaceBuffers& buffers = *of.buffers;
    const std::size_t pixels = surfaces.count();
    require_shade(surfaces, visibilities, lights, options);
    add_lights(session, of, visibilities, lights, buffers.lambert);
    PictureParams params{.layout = point_inputs(of.points).layout,
                         .has_albedos = of.has_albedos,
                         .has_sky_shares = bring_sky_shares(session, options, pixels, buffers.sky_shares),
                         .exposure = 1,
                         .is_first = 0};
    double exposure_ev = options.exposure_ev.value_or(0);
    if (!options.exposure_ev) {
        buffers.brightest.reserve(session, pixels * sizeof(float));
        launch_picture(session, "brightest_channels", of, params, buffers.brightest);
        exposure_ev = metered_ev(session, buffers, pixels);
    }
    params.exposure = static_cast<float>(std::exp2(exposure_ev));
    return {params, exposure_ev};
}

}  // namespace

double shade_into(cl_mem rgba, const Surfaces& surfaces, std::span<const Visibility> visibilities,
                  std::span<const Light> lights, const ShadeOptions& options) {
    const Surfaces::Inside& of = surfaces.inside();
    if (bytes_of(rgba) < surfaces.count() * 4)
        throw InvalidArgument("the picture's buffer has fewer than 4 bytes for each pixel of the view");
    const auto [params, exposure_ev] = prepare_picture(surfaces, visibilities, lights, options);
    launch_picture(session_of(of.device), "shade", of, params, of.tables->srgb, rgba);
    return exposure_ev;
}

Picture shade(const Surfaces& surfaces, std::span<const Visibility> visibilities, std::span<const Light> lights,
              const ShadeOptions& options) {
    const Surfaces::Inside& of = surfaces.inside();
    const cl_mem rgba = of.buffers->picture.get();
    Picture made;
    made.exposure_ev = shade_into(rgba, surfaces, visibilities, lights, options);
    made.rgba.resize(surfaces.count() * 4);
    session_of(of.device).read(rgba, made.rgba.data(), made.rgba.size());
    return made;
}

struct PictureMean::State {
    Device device;
    std::size_t pixels;
    std::uint32_t pictures, added = 0;
    cl::Buffer sums{}, picture{};
    std::shared_ptr<const ShadeTables> tables{};  ///< of the latest picture
    PictureParams params{};                       ///< the same
};

PictureMean::PictureMean(const Device& device, std::size_t pixels, std::uint32_t pictures)
    : state_(std::make_unique<State>(State{device, pixels, pictures})) {
    if (pictures == 0) throw InvalidArgument("a mean needs at least one picture");
    state_->sums.reserve(session_of(device), pixels * sizeof(Float3));
    state_->picture.reserve(session_of(device), pixels * sizeof(cl_uint));
}

PictureMean::~PictureMean() = default;

double PictureMean::add(const Surfaces& surfaces, std::span<const Visibility> visibilities,
                        std::span<const Light> lights, const ShadeOptions& options) {
    const Surfaces::Inside& of = surfaces.inside();
    if (surfaces.count() != state_->pixels)
        throw InvalidArgument("a picture of " + std::to_string(surfaces.count()) + " pixels is not one of " +
                              std::to_string(state_->pixels));
    if (state_->added == state_->pictures) throw InvalidArgument("all pictures of the mean were added before");
    auto [params, exposure_ev] = prepare_picture(surfaces, visibilities, lights, options);
    params.is_first = state_->added == 0;
    launch_picture(session_of(of.device), "shade_add", of, params, state_->sums);
    state_->tables = of.tables;
    state_->params = params;
    ++state_->added;
    return exposure_ev;
}

std::vector<std::uint8_t> PictureMean::read() const {
    if (state_->added != state_->pictures)
        throw InvalidArgument("the mean has " + std::to_string(state_->added) + " of its " +
                              std::to_string(state_->pictures) + " pictures");
    cl::Session& session = session_of(state_->device);
    PictureParams params = state_->params;
    params.exposure = 1.0f / static_cast<float>(state_->pictures);
    session.launch("shading/shade.cl", "shade_mean", cl::Range::items(state_->pixels), params, state_->sums,
                   state_->tables->srgb, state_->picture);
    return session.read_values<std::uint8_t>(state_->picture.get(), state_->pixels * 4);
}

std::vector<std::uint8_t> shade(const Device& device, const Triangles& triangles, const View& view,
                                std::span<const Visibility> visibilities, const Materials& materials,
                                std::span<const Light> lights) {
    return shade(Surfaces(device, triangles, view, materials), visibilities, lights).rgba;
}

std::vector<std::uint8_t> shade(const Device& device, const Triangles& triangles, const View& view,
                                const Visibility& visibility, const Materials& materials, const Light& light) {
    return shade(device, triangles, view, std::span(&visibility, 1), materials, std::span(&light, 1));
}

}  // namespace gnomon
