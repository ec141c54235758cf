// SPDX-License-Identifier: MIT
// Stage surface: gathers what the shown triangles have, uploads the textures of their materials, and runs the kernel
// (kernels/shading/surface.cl).
#include "shading/surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "cl/embedded_files.hpp"

namespace gnomon {
namespace {

// A program that has surfaces has their kernels before it makes its first program for a device.
[[maybe_unused]] const bool kernels_are_embedded = add_embedded_kernels(embedded_kernels_of_shading());

std::string counts(std::size_t found, const char* of, std::size_t needed, const char* for_what) {
    return "there are " + std::to_string(found) + " " + of + " for " + std::to_string(needed) + " " + for_what;
}

void require_texture(const ColorTexture& texture, std::size_t index) {
    constexpr std::uint32_t largest_side = 32768;
    const bool has_sides =
        texture.width >= 1 && texture.height >= 1 && texture.width <= largest_side && texture.height <= largest_side;
    if (!has_sides || texture.rgba.size() != std::size_t(4) * texture.width * texture.height)
        throw InvalidArgument("colour texture " + std::to_string(index) +
                              " needs sides from 1 to 32768 and 4 bytes for each texel");
}

void require_surfaces(const Triangles& triangles, const Materials& materials, const SurfaceDetail& detail) {
    const std::size_t count = triangles.count(), material_count = materials.base_color.size();
    if (materials.triangle_material.size() != count)
        throw InvalidArgument(counts(materials.triangle_material.size(), "material ids", count, "triangles"));
    for (const std::uint32_t id : materials.triangle_material)
        if (id >= material_count)
            throw InvalidArgument("a triangle names material " + std::to_string(id) + " of " +
                                  std::to_string(material_count));
    const auto require_each = [&](std::size_t size, std::size_t each, const char* what) {
        if (size != 0 && size != each * count) throw InvalidArgument(counts(size, what, count, "triangles"));
    };
    require_each(detail.texture_coordinates.size(), 6, "texture coordinates");
    require_each(detail.corner_colors.size(), 9, "corners' colours");
    require_each(detail.corner_normals.size(), 3, "corners' normals");
    if (!detail.texture_uses.empty() && detail.texture_uses.size() != material_count)
        throw InvalidArgument(counts(detail.texture_uses.size(), "uses of textures", material_count, "materials"));
    for (const ColorTextureUse& use : detail.texture_uses) {
        if (use.texture == no_texture) continue;
        if (use.texture >= detail.textures.size())
            throw InvalidArgument("a material names colour texture " + std::to_string(use.texture) + " of " +
                                  std::to_string(detail.textures.size()));
        if (detail.texture_coordinates.empty())
            throw InvalidArgument("a material has a texture, and there are no texture coordinates");
    }
    for (std::size_t i = 0; i < detail.textures.size(); ++i) require_texture(detail.textures[i], i);
}

/// The triangles that a picture shows, and the record of each pixel.
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

std::vector<SurfaceRecord> records_of(const Shown& shown, const Materials& materials, const SurfaceDetail& detail) {
    std::vector<SurfaceRecord> records(shown.triangles.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
        const std::size_t id = shown.triangles[i];
        SurfaceRecord& record = records[i] = {};
        record.material = materials.triangle_material[id];
        if (!detail.texture_coordinates.empty())
            std::copy_n(&detail.texture_coordinates[6 * id], 6, record.coordinates);
        if (!detail.corner_colors.empty()) std::copy_n(&detail.corner_colors[9 * id], 9, record.colors);
        if (!detail.corner_normals.empty()) std::copy_n(&detail.corner_normals[3 * id], 3, record.normals);
    }
    return records;
}

/// Which textures, and whether alpha weighs their texels: a texture whose texels it weighs is another one.
using TextureKeys = std::vector<std::pair<std::uint32_t, bool>>;

struct ShownTextures {
    std::vector<SurfaceMaterial> materials;
    TextureKeys textures;
};

/// The textures of the materials that a picture shows, behind those that are on the device.
ShownTextures textures_of(const std::vector<SurfaceRecord>& records, const Materials& materials,
                          const SurfaceDetail& detail, const TextureKeys& on_device) {
    std::vector<char> is_shown(materials.base_color.size(), 0);
    for (const SurfaceRecord& record : records) is_shown[record.material] = 1;
    ShownTextures shown{{}, on_device};
    std::map<std::pair<std::uint32_t, bool>, std::uint32_t> found;
    for (const auto& key : on_device) found.emplace(key, static_cast<std::uint32_t>(found.size()));
    for (std::size_t i = 0; i < materials.base_color.size(); ++i) {
        SurfaceMaterial material{};
        std::copy_n(materials.base_color[i].begin(), 3, material.base_color);
        material.texture = GN_NO_ID;
        if (is_shown[i] && !detail.texture_uses.empty() && detail.texture_uses[i].texture != no_texture) {
            const ColorTextureUse& use = detail.texture_uses[i];
            const std::pair key(use.texture, use.weigh_by_alpha);
            const auto [at, is_new] = found.try_emplace(key, static_cast<std::uint32_t>(shown.textures.size()));
            if (is_new) shown.textures.push_back(key);
            material.texture = at->second;
            material.wrap_u = static_cast<cl_uint>(use.wrap_u);
            material.wrap_v = static_cast<cl_uint>(use.wrap_v);
            material.is_nearest = use.filter == TextureFilter::nearest;
        }
        shown.materials.push_back(material);
    }
    return shown;
}
static_assert(std::uint32_t(TextureWrap::repeat) == SURFACE_REPEAT &&
              std::uint32_t(TextureWrap::mirror) == SURFACE_MIRROR &&
              std::uint32_t(TextureWrap::clamp) == SURFACE_CLAMP);

std::uint32_t side_of_level(std::uint32_t side, std::uint32_t level) { return std::max(1u, side >> level); }

SurfaceParams params_of(const Triangles& triangles, const View& view, const SurfaceDetail& detail) {
    if (!view.points.camera()) throw InvalidArgument("surfaces need a view that a camera has made");
    const Camera& camera = view.points.camera()->camera;
    SurfaceParams params{};
    params.triangles = triangle_inputs(triangles);
    params.width = view.width;
    params.height = view.height;
    params.has_colors = !detail.corner_colors.empty();
    params.has_normals = !detail.corner_normals.empty();
    const double pixel = 2 * std::tan(camera.fov_y_radians / 2) / view.height;
    for (int i = 0; i < 3; ++i) {
        params.eye[i] = camera.eye[std::size_t(i)];
        const double right = pixel * camera.right[std::size_t(i)], up = pixel * camera.up[std::size_t(i)];
        params.across[i] = static_cast<float>(right);
        params.down[i] = static_cast<float>(-up);
        params.corner[i] = static_cast<float>(camera.forward[std::size_t(i)] - (view.width - 1) / 2.0 * right +
                                              (view.height - 1) / 2.0 * up);
    }
    return params;
}

}  // namespace

std::uint32_t pack_normal(const Float3& normal) {
    const double x = normal[0], y = normal[1], z = normal[2], size = std::abs(x) + std::abs(y) + std::abs(z);
    if (!(size > 0) || !std::isfinite(size)) return 0;
    double u = x / size, v = y / size;
    if (z < 0) {
        const double folded = 1 - std::abs(v);
        v = std::copysign(1 - std::abs(u), v);
        u = std::copysign(folded, u);
    }
    const auto bits = [](double c) { return static_cast<std::uint32_t>(std::lround(c * 32767) + 32768); };
    return bits(u) | bits(v) << 16;
}

/// Textures on the device. Where they do not fit, the finest levels of all are left out.
struct SurfaceTextures::OnDevice {
    Device device;
    TextureKeys keys;
    std::vector<const std::uint8_t*> sources;  ///< of all textures
    cl::Buffer headers, texels;
    std::uint64_t bytes = 0;
    std::uint32_t left_out = 0;

    OnDevice(const Device& on, TextureKeys shown, std::span<const ColorTexture> all)
        : device(on), keys(std::move(shown)), sources(sources_of(all)) {
        constexpr std::uint32_t most_levels = 16;
        for (;; ++left_out) try {
                upload(session_of(device), all);
                return;
            } catch (const OutOfDeviceMemory&) {
                if (left_out == most_levels) throw;
            }
    }

    static std::vector<const std::uint8_t*> sources_of(std::span<const ColorTexture> all) {
        std::vector<const std::uint8_t*> sources;
        for (const ColorTexture& texture : all) sources.push_back(texture.rgba.data());
        return sources;
    }

private:
    void upload(cl::Session& session, std::span<const ColorTexture> all) {
        std::vector<SurfaceTexture> made;
        bytes = 0;
        for (const auto& [which, weighs] : keys) {
            const ColorTexture& from = all[which];
            made.push_back({bytes / 4, side_of_level(from.width, left_out), side_of_level(from.height, left_out)});
            bytes += level_bytes(from.width, from.height, left_out);
        }
        headers.reserve(session, made.size() * sizeof(SurfaceTexture));
        texels.reserve(session, bytes);
        session.write(headers.get(), made.data(), made.size() * sizeof(SurfaceTexture));
        // One texture at a time on the host.
        std::vector<std::uint8_t> levels;
        for (std::size_t i = 0; i < made.size(); ++i) {
            const auto& [which, weighs] = keys[i];
            const ColorTexture& from = all[which];
            levels.resize(level_bytes(from.width, from.height, left_out));
            write_levels(from, weighs, left_out, levels.data());
            session.write(texels.get(), levels.data(), levels.size(), made[i].first_texel * 4);
        }
    }
};

Surfaces::Surfaces(const Device& device, const Triangles& triangles, const View& view, const Materials& materials,
                   const SurfaceDetail& detail, SurfaceTextures* kept) {
    require_surfaces(triangles, materials, detail);
    cl::Session& session = session_of(device);
    auto made = std::make_shared<Inside>(device, view.points);
    const std::size_t pixels = made->points.count();
    made->geometric_normals = camera_normals(device, triangles, view);
    made->has_detail = !detail.texture_uses.empty() || !detail.corner_colors.empty() || !detail.corner_normals.empty();
    const auto upload = [&](cl::Buffer& buffer, const auto& values) {
        buffer.reserve(session, values.size() * sizeof(values[0]));
        session.write(buffer.get(), values.data(), values.size() * sizeof(values[0]));
    };
    inside_ = made;
    if (!made->has_detail) {
        upload(made->triangle_material, materials.triangle_material);
        upload(made->base_colors, materials.base_color);
        return;
    }
    const SurfaceParams params = params_of(triangles, view, detail);
    const Shown shown = shown_by(session, view.points.receivers(), pixels, triangles.count());
    const std::vector<SurfaceRecord> records = records_of(shown, materials, detail);
    SurfaceTextures textures = kept ? *kept : SurfaceTextures();
    if (textures.on_device && textures.on_device->sources != SurfaceTextures::OnDevice::sources_of(detail.textures))
        textures.on_device.reset();
    const ShownTextures shown_textures =
        textures_of(records, materials, detail, textures.on_device ? textures.on_device->keys : TextureKeys());
    cl::Buffer slots, records_on_device, materials_on_device, decoded;
    upload(slots, shown.slots);
    upload(records_on_device, records);
    upload(materials_on_device, shown_textures.materials);
    upload(decoded, linear_of_srgb());
    made->albedos.reserve(session, pixels * sizeof(Float3));
    made->has_shading_normals = params.has_normals != 0;
    if (made->has_shading_normals) {
        made->shading_normals.reserve(session, pixels * sizeof(Float3));
        made->spreads.reserve(session, pixels * sizeof(float));
    }
    if (!textures.on_device || textures.on_device->keys != shown_textures.textures) {
        textures.on_device.reset();  // its memory is needed
        if (kept) kept->on_device.reset();
        textures.on_device =
            std::make_shared<SurfaceTextures::OnDevice>(device, shown_textures.textures, detail.textures);
        if (kept) *kept = textures;
    }
    const SurfaceTextures::OnDevice& on_device = *textures.on_device;
    made->texture_bytes = on_device.keys.empty() ? 0 : on_device.bytes;
    made->left_out_levels = on_device.left_out;
    session.launch("shading/surface.cl", "surfaces", cl::Range::items(pixels), params,
                   triangle_inputs(triangles).vertices, view.points.receivers(), slots, made->geometric_normals,
                   records_on_device, materials_on_device, on_device.headers, on_device.texels, decoded, made->albedos,
                   made->has_shading_normals ? made->shading_normals : slots,
                   made->has_shading_normals ? made->spreads : slots);
    session.finish();  // the inputs' buffers go
}

std::uint64_t Surfaces::texture_bytes() const { return inside_->texture_bytes; }
std::uint32_t Surfaces::left_out_levels() const { return inside_->left_out_levels; }
cl_mem Surfaces::normals() const { return inside_->normals().get(); }

std::size_t Surfaces::count() const { return inside_->points.count(); }

SurfacesOnHost Surfaces::read(const Materials& materials) const {
    SurfacesOnHost host;
    host.normal.resize(3 * count());
    host.albedo.resize(3 * count());
    cl::Session& session = session_of(inside_->device);
    session.read(normals(), host.normal.data(), host.normal.size() * sizeof(float));
    if (inside_->has_detail) {
        session.read(inside_->albedos.get(), host.albedo.data(), host.albedo.size() * sizeof(float));
        return host;
    }
    const auto receivers = session.read_values<std::uint32_t>(inside_->points.receivers(), count());
    for (std::size_t i = 0; i < receivers.size(); ++i)
        if (receivers[i] != no_receiver)
            std::ranges::copy(materials.base_color[materials.triangle_material[receivers[i]]], &host.albedo[3 * i]);
    return host;
}

}  // namespace gnomon
