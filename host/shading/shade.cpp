// SPDX-License-Identifier: MIT
// Stage shade: the picture of a view (kernels/shading/shade.cl). Its public function is shade() of gnomon.hpp.
#include <algorithm>
#include <cmath>

#include "kernels/shading/shade.h"
#include "shading/surface.hpp"

namespace gnomon {
namespace {

std::vector<std::uint8_t> srgb_table() {
    std::vector<std::uint8_t> table(SRGB_TABLE_SIZE);
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double linear = double(i) / double(table.size() - 1);
        const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
        table[i] = static_cast<std::uint8_t>(encoded * 255 + 0.5);
    }
    return table;
}

/// The exposure at which this part of the surfaces' pixels is no brighter than the light that the tone curve keeps.
constexpr double metered_part = 0.95, metered_light = 0.8, most_metered_ev = 8;

double metered_ev(std::vector<float> brightest) {
    std::erase_if(brightest, [](float light) { return !(light >= 0); });
    if (brightest.empty()) return 0;
    const auto at = brightest.begin() + std::ptrdiff_t(metered_part * double(brightest.size() - 1));
    std::nth_element(brightest.begin(), at, brightest.end());
    return *at > 0 ? std::clamp(std::log2(metered_light / double(*at)), -most_metered_ev, most_metered_ev) : 0;
}

/// The sum of the lights' Lambert terms.
void add_lights(cl::Session& session, const Surfaces::Inside& of, std::span<const Visibility> visibilities,
                std::span<const Light> lights, const cl::Buffer& lambert) {
    if (lights.empty()) session.fill(lambert, 0, of.points.count() * sizeof(float));
    const PointInputs points = point_inputs(of.points);
    const cl::Buffer& spreads = of.has_shading_normals ? of.spreads : lambert;  // any buffer: it is not read
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const auto& [x, y, z, w] = lights[i].xyzw;
        const ShadeParams params{.layout = points.layout,
                                 .light = {x, y, z, w},
                                 .is_first = i == 0,
                                 .has_spreads = of.has_shading_normals,
                                 .padding = {}};
        session.launch("shading/shade.cl", "shade_light", cl::Range::items(of.points.count()), params, points.positions,
                       of.normals(), spreads, visibilities[i].buffer(), lambert);
    }
}

}  // namespace

Picture shade(const Surfaces& surfaces, std::span<const Visibility> visibilities, std::span<const Light> lights,
              const ShadeOptions& options) {
    const Surfaces::Inside& of = surfaces.inside();
    cl::Session& session = session_of(of.device);
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
    if (options.exposure_ev && !std::isfinite(*options.exposure_ev))
        throw InvalidArgument("the exposure must be a finite number");
    const std::vector<std::uint8_t> table = srgb_table();
    cl::Buffer table_buffer(session, table.size()), sky_shares(session, options.sky_shares.size_bytes());
    session.write(table_buffer.get(), table.data(), table.size());
    session.write(sky_shares.get(), options.sky_shares.data(), options.sky_shares.size_bytes());
    const cl::Buffer lambert(session, pixels * sizeof(float)), picture(session, pixels * 4);
    add_lights(session, of, visibilities, lights, lambert);

    PictureParams params{.layout = point_inputs(of.points).layout,
                         .has_albedos = of.has_detail,
                         .has_sky_shares = !options.sky_shares.empty(),
                         .exposure = 1,
                         .padding = 0};
    // Without detail there are no albedos, and with it no materials: any buffer stands for what is not read.
    const cl::Buffer& any = table_buffer;
    const cl::Buffer &ids = of.has_detail ? any : of.triangle_material, &colors = of.has_detail ? any : of.base_colors;
    const cl::Buffer& albedos = of.has_detail ? of.albedos : any;
    Picture made;
    made.exposure_ev = options.exposure_ev.value_or(0);
    if (!options.exposure_ev) {
        const cl::Buffer brightest(session, pixels * sizeof(float));
        session.launch("shading/shade.cl", "brightest_channels", cl::Range::items(pixels), params,
                       of.points.receivers(), of.normals(), lambert, ids, colors, albedos, sky_shares, brightest);
        made.exposure_ev = metered_ev(session.read_values<float>(brightest.get(), pixels));
    }
    params.exposure = static_cast<float>(std::exp2(made.exposure_ev));
    session.launch("shading/shade.cl", "shade", cl::Range::items(pixels), params, of.points.receivers(), of.normals(),
                   lambert, ids, colors, albedos, sky_shares, table_buffer, picture);
    made.rgba.resize(pixels * 4);
    session.read(picture.get(), made.rgba.data(), made.rgba.size());
    return made;
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
