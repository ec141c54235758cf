// SPDX-License-Identifier: MIT
// Stage surface: runs the kernel of surfaces (kernels/shading/surface.cl). For one view it gathers what the shown
// triangles have. gnomon.hpp gives it the class Surfaces.
#include "shading/surface.hpp"

#include <algorithm>
#include <cmath>

namespace gnomon {
namespace {

/// The triangles that a picture shows, and the slot of each pixel.
struct Shown {
    std::vector<std::uint32_t> slots, triangles;
};

Shown shown_by(cl::Session& session, cl_mem receivers, std::size_t pixels, std::size_t triangle_count) {
    Shown shown;
    shown.slots.resize(pixels);
    session.read(receivers, shown.slots.data(), pixels * sizeof(cl_uint));
    std::vector<std::uint32_t> slot_of(triangle_count, GN_NO_ID);
    for (std::uint32_t& slot : shown.slots) {
        if (slot == no_receiver) continue;
        std::uint32_t& of = slot_of[slot];
        if (of == GN_NO_ID) {
            of = static_cast<std::uint32_t>(shown.triangles.size());
            shown.triangles.push_back(slot);
        }
        slot = of;
    }
    return shown;
}

/// The arrays of shown triangles.
struct Gathered {
    std::vector<std::uint32_t> material, normals;
    std::vector<float> coordinates, colors;

    SlotArrays arrays() const { return {material, coordinates, colors, normals}; }
};

template <typename Value>
void gather(std::span<const Value> from, std::size_t each, const Shown& shown, std::vector<Value>& to) {
    if (from.empty()) return;
    to.resize(each * shown.triangles.size());
    for (std::size_t i = 0; i < shown.triangles.size(); ++i)
        std::copy_n(&from[each * shown.triangles[i]], each, &to[each * i]);
}

Gathered gathered(const Shown& shown, const Materials& materials, const SurfaceDetail& detail) {
    Gathered made;
    gather(std::span(materials.triangle_material), 1, shown, made.material);
    gather(detail.corner_normals, 3, shown, made.normals);
    gather(detail.texture_coordinates, 6, shown, made.coordinates);
    gather(detail.corner_colors, 9, shown, made.colors);
    return made;
}

SurfaceParams params_of(const Triangles& triangles, const View& view, const SurfaceArrays& arrays) {
    const Camera& camera = view.points.camera()->camera;
    SurfaceParams params{};
    params.triangles = triangle_inputs(triangles);
    params.layout = point_inputs(view.points).layout;
    params.width = view.width;
    params.height = view.height;
    params.has_colors = arrays.has_colors;
    params.has_normals = arrays.has_normals;
    params.pixel_share = view.pixel_share;
    constexpr double units = SAMPLE_UNITS;
    const double pixel = 2 * std::tan(camera.fov_y_radians / 2) / view.height;
    for (int i = 0; i < 3; ++i) {
        params.eye[i] = camera.eye[std::size_t(i)];
        const double right = pixel * camera.right[std::size_t(i)], up = pixel * camera.up[std::size_t(i)];
        params.across[i] = static_cast<float>(right);
        params.down[i] = static_cast<float>(-up);
        params.corner[i] = static_cast<float>(camera.forward[std::size_t(i)] +
                                              (view.offset.x / units - (view.width - 1) / 2.0) * right -
                                              (view.offset.y / units - (view.height - 1) / 2.0) * up);
    }
    return params;
}

void make_surfaces(const Device& device, const Triangles& triangles, const View& view, const SurfaceArrays& arrays,
                   cl_mem slots, SurfaceBuffers& into) {
    cl::Session& session = session_of(device);
    const std::size_t pixels = view.points.count();
    into.albedos.reserve(session, pixels * sizeof(Float3));
    into.spreads.reserve(session, arrays.has_normals ? pixels * sizeof(float) : 0);
    session.launch("shading/surface.cl", "surfaces", session.block_shares(pixels), params_of(triangles, view, arrays),
                   triangle_inputs(triangles).vertices, view.points.receivers(), slots, arrays.material,
                   arrays.coordinates, arrays.colors, arrays.normals, arrays.materials,
                   arrays.textures.on_device->texels, arrays.linear_of_srgb, into.albedos, into.normals, into.spreads);
}

}  // namespace

std::shared_ptr<const Surfaces::Inside> surfaces_of(const Device& device, const Triangles& triangles, const View& view,
                                                    std::shared_ptr<const ShadeTables> tables,
                                                    const SurfaceArrays* arrays, cl_mem slots,
                                                    std::shared_ptr<SurfaceBuffers> buffers) {
    if (!view.points.camera()) throw InvalidArgument("surfaces need a view that a camera has made");
    cl::Session& session = session_of(device);
    const std::size_t pixels = view.points.count();
    camera_normals(device, triangles, view, buffers->normals);
    if (arrays) make_surfaces(device, triangles, view, *arrays, slots, *buffers);
    buffers->lambert.reserve(session, pixels * sizeof(float));
    buffers->picture.reserve(session, pixels * sizeof(cl_uint));
    const SurfaceTextures::OnDevice* textures = arrays ? arrays->textures.on_device.get() : nullptr;
    return std::make_shared<Surfaces::Inside>(Surfaces::Inside{
        device, view.points, std::move(tables), std::move(buffers), arrays != nullptr, arrays && arrays->has_normals,
        textures && !textures->keys.empty() ? textures->bytes : 0, textures ? textures->left_out : 0});
}

Surfaces::Surfaces(const Device& device, const Triangles& triangles, const View& view, const Materials& materials,
                   const SurfaceDetail& detail, SurfaceTextures* kept) {
    require_surfaces(triangles.count(), materials, detail);
    const bool is_detailed = has_detail(detail);
    const auto tables = shade_tables(device, materials, is_detailed);
    const auto buffers = std::make_shared<SurfaceBuffers>();
    if (!is_detailed) {
        inside_ = surfaces_of(device, triangles, view, tables, nullptr, nullptr, buffers);
        return;
    }
    cl::Session& session = session_of(device);
    const Shown shown = shown_by(session, view.points.receivers(), view.points.count(), triangles.count());
    cl::Buffer slots;
    session.upload(slots, shown.slots);
    constexpr std::uint32_t max_left_out = 16;
    const SurfaceArrays arrays(device, gathered(shown, materials, detail).arrays(), materials, detail, kept,
                               max_left_out);
    inside_ = surfaces_of(device, triangles, view, tables, &arrays, slots.get(), buffers);
    session.finish();  // the arrays' memory is free again
}

std::uint64_t Surfaces::texture_bytes() const { return inside_->texture_bytes; }
std::uint32_t Surfaces::left_out_levels() const { return inside_->left_out_levels; }
cl_mem Surfaces::normals() const { return inside_->buffers->normals.get(); }

std::size_t Surfaces::count() const { return inside_->points.count(); }

SurfacesOnHost Surfaces::read() const {
    SurfacesOnHost host;
    host.normal.resize(3 * count());
    host.albedo.resize(3 * count());
    cl::Session& session = session_of(inside_->device);
    session.read(normals(), host.normal.data(), host.normal.size() * sizeof(float));
    if (inside_->has_albedos) {
        session.read(inside_->buffers->albedos.get(), host.albedo.data(), host.albedo.size() * sizeof(float));
        return host;
    }
    const cl::Buffer &ids = inside_->tables->triangle_material, &colors = inside_->tables->base_colors;
    const auto material = session.read_values<std::uint32_t>(ids.get(), ids.bytes() / sizeof(std::uint32_t));
    const auto color = session.read_values<Float3>(colors.get(), colors.bytes() / sizeof(Float3));
    const auto receivers = session.read_values<std::uint32_t>(inside_->points.receivers(), count());
    for (std::size_t i = 0; i < receivers.size(); ++i)
        if (receivers[i] != no_receiver) std::ranges::copy(color[material[receivers[i]]], &host.albedo[3 * i]);
    return host;
}

}  // namespace gnomon
