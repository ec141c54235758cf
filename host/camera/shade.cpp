// SPDX-License-Identifier: MIT
// Stage shade: the picture of a view (kernels/camera/shade.cl). Its public function is shade() of gnomon.hpp.
#include <cmath>

#include "camera/camera.hpp"
#include "kernels/camera/shade.h"

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

}  // namespace

std::vector<std::uint8_t> shade(const Device& device, const Triangles& triangles, const View& view,
                                std::span<const Visibility> visibilities, const Materials& materials,
                                std::span<const Light> lights) {
    cl::Session& session = session_of(device);
    const std::size_t pixels = view.points.count();
    if (lights.size() != visibilities.size())
        throw InvalidArgument("there are " + std::to_string(visibilities.size()) + " visibilities for " +
                              std::to_string(lights.size()) + " lights");
    for (const Visibility& visibility : visibilities)
        if (visibility.count() < pixels)
            throw InvalidArgument("the visibility buffer has fewer entries than the view has pixels");
    if (materials.triangle_material.size() != triangles.count())
        throw InvalidArgument("there are " + std::to_string(materials.triangle_material.size()) + " material ids for " +
                              std::to_string(triangles.count()) + " triangles");
    for (std::uint32_t id : materials.triangle_material)
        if (id >= materials.base_color.size())
            throw InvalidArgument("a triangle names material " + std::to_string(id) + " of " +
                                  std::to_string(materials.base_color.size()));
    const std::vector<std::uint8_t> table = srgb_table();
    cl::Buffer ids(session, materials.triangle_material.size() * sizeof(cl_uint));
    cl::Buffer colors(session, materials.base_color.size() * sizeof(Float3)), table_buffer(session, table.size());
    session.write(ids.get(), materials.triangle_material.data(), materials.triangle_material.size() * sizeof(cl_uint));
    session.write(colors.get(), materials.base_color.data(), materials.base_color.size() * sizeof(Float3));
    session.write(table_buffer.get(), table.data(), table.size());
    const cl::Buffer normals = camera_normals(device, triangles, view);
    const PointInputs points = point_inputs(view.points);
    const cl::Buffer lambert(session, pixels * sizeof(float)), picture(session, pixels * 4);
    session.fill(lambert, 0, pixels * sizeof(float));
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const auto& [x, y, z, w] = lights[i].xyzw;
        session.launch("camera/shade.cl", "shade_light", cl::Range::items(pixels),
                       ShadeParams{.layout = points.layout, .light = {x, y, z, w}}, points.positions, points.receivers,
                       normals, visibilities[i].buffer(), lambert);
    }
    session.launch("camera/shade.cl", "shade", cl::Range::items(pixels), points.layout, points.receivers, normals,
                   lambert, ids, colors, table_buffer, picture);
    std::vector<std::uint8_t> rgba(pixels * 4);
    session.read(picture.get(), rgba.data(), rgba.size());
    return rgba;
}

std::vector<std::uint8_t> shade(const Device& device, const Triangles& triangles, const View& view,
                                const Visibility& visibility, const Materials& materials, const Light& light) {
    return shade(device, triangles, view, std::span(&visibility, 1), materials, std::span(&light, 1));
}

}  // namespace gnomon
