// SPDX-License-Identifier: MIT
// Stage appearance: checks what triangles look like, and uploads it. gnomon.hpp gives it the class Appearance.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "kernels/shading/shade.h"
#include "shading/surface.hpp"

namespace gnomon {
namespace {

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

}  // namespace

void require_surfaces(std::size_t count, const Materials& materials, const SurfaceDetail& detail) {
    const std::size_t material_count = materials.base_color.size();
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

namespace {

/// The texture of a material, as a key; none: it has none.
std::optional<TextureKeys::value_type> key_of(const SurfaceDetail& detail, std::size_t material) {
    if (detail.texture_uses.empty() || detail.texture_uses[material].texture == no_texture) return std::nullopt;
    return TextureKeys::value_type(detail.texture_uses[material].texture, detail.texture_uses[material].weigh_by_alpha);
}

/// The textures of the materials that some slot has, behind those that are on the device.
TextureKeys textures_of(const SlotArrays& slots, std::size_t material_count, const SurfaceDetail& detail,
                        TextureKeys keys) {
    std::vector<char> is_used(material_count, 0);
    for (const std::uint32_t material : slots.material) is_used[material] = 1;
    std::set<TextureKeys::value_type> found(keys.begin(), keys.end());
    for (std::size_t i = 0; i < material_count; ++i)
        if (const auto key = key_of(detail, i); key && is_used[i] && found.insert(*key).second) keys.push_back(*key);
    return keys;
}

/// Materials with the textures that are on the device.
std::vector<SurfaceMaterial> materials_of(const Materials& from, const SurfaceDetail& detail,
                                          const SurfaceTextures::OnDevice& textures) {
    std::map<TextureKeys::value_type, TexturePlace> places;
    for (std::size_t i = 0; i < textures.keys.size(); ++i) places.emplace(textures.keys[i], textures.places[i]);
    std::vector<SurfaceMaterial> materials(from.base_color.size());
    for (std::size_t i = 0; i < materials.size(); ++i) {
        SurfaceMaterial& material = materials[i];
        std::ranges::copy(from.base_color[i], material.base_color);
        const auto key = key_of(detail, i);
        const auto place = key ? places.find(*key) : places.end();
        if (place == places.end()) continue;
        const ColorTextureUse& use = detail.texture_uses[i];
        material.first_texel = place->second.first_texel;
        material.width = place->second.width;
        material.height = place->second.height;
        material.wrap_u = static_cast<cl_uint>(use.wrap_u);
        material.wrap_v = static_cast<cl_uint>(use.wrap_v);
        material.is_nearest = use.filter == TextureFilter::nearest;
        material.minification = static_cast<cl_uint>(use.minification);
    }
    return materials;
}
static_assert(std::uint32_t(TextureWrap::repeat) == SURFACE_REPEAT &&
              std::uint32_t(TextureWrap::mirror) == SURFACE_MIRROR &&
              std::uint32_t(TextureWrap::clamp) == SURFACE_CLAMP);
static_assert(std::uint32_t(TextureMinification::mean) == SURFACE_MEAN &&
              std::uint32_t(TextureMinification::linear) == SURFACE_MINIFY_LINEAR &&
              std::uint32_t(TextureMinification::nearest) == SURFACE_MINIFY_NEAREST);

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

SurfaceArrays::SurfaceArrays(const Device& device, const SlotArrays& slots, const Materials& from,
                             const SurfaceDetail& detail, SurfaceTextures* kept, std::uint32_t max_left_out)
    : has_colors(!slots.colors.empty()), has_normals(!slots.normals.empty()) {
    cl::Session& session = session_of(device);
    if (kept) textures = *kept;
    if (textures.on_device && textures.on_device->sources != SurfaceTextures::OnDevice::sources_of(detail.textures))
        textures.on_device.reset();
    session.upload(material, slots.material);
    session.upload(coordinates, slots.coordinates);
    session.upload(colors, slots.colors);
    session.upload(normals, slots.normals);
    session.upload(linear_of_srgb, gnomon::linear_of_srgb());
    const TextureKeys keys = textures_of(slots, from.base_color.size(), detail,
                                         textures.on_device ? textures.on_device->keys : TextureKeys());
    if (!textures.on_device || textures.on_device->keys != keys) {
        textures.on_device.reset();  // its memory is needed
        if (kept) kept->on_device.reset();
        textures.on_device = std::make_shared<SurfaceTextures::OnDevice>(device, keys, detail.textures, max_left_out);
        if (kept) *kept = textures;
    }
    session.upload(materials, materials_of(from, detail, *textures.on_device));
}

std::shared_ptr<const ShadeTables> shade_tables(const Device& device, const Materials& materials, bool has_detail) {
    cl::Session& session = session_of(device);
    auto tables = std::make_shared<ShadeTables>();
    session.upload(tables->srgb, srgb_table());
    if (has_detail) return tables;
    session.upload(tables->triangle_material, materials.triangle_material);
    session.upload(tables->base_colors, materials.base_color);
    return tables;
}

Appearance Appearance::upload(const Device& device, const Materials& materials, const SurfaceDetail& detail,
                              SurfaceTextures* kept) {
    const std::size_t count = materials.triangle_material.size();
    require_surfaces(count, materials, detail);
    const bool is_detailed = has_detail(detail);
    Appearance made;
    made.inside_ =
        std::make_shared<Inside>(Inside{device, count, shade_tables(device, materials, is_detailed), nullptr, nullptr});
    if (!is_detailed) return made;
    const SlotArrays all{materials.triangle_material,
                         detail.texture_uses.empty() ? std::span<const float>() : detail.texture_coordinates,
                         detail.corner_colors, detail.corner_normals};
    made.inside_->arrays = std::make_shared<SurfaceArrays>(device, all, materials, detail, kept, 0);
    return made;
}

std::size_t Appearance::count() const { return inside_->count; }

std::uint64_t Appearance::texture_bytes() const {
    return inside_->arrays && !inside_->arrays->textures.on_device->keys.empty()
               ? inside_->arrays->textures.on_device->bytes
               : 0;
}

Surfaces Appearance::surfaces(const Triangles& triangles, const View& view) const {
    if (triangles.count() != count())
        throw InvalidArgument("the appearance is that of " + std::to_string(count()) + " triangles, and there are " +
                              std::to_string(triangles.count()));
    Inside& of = *inside_;
    if (of.buffers.use_count() != 1) of.buffers = std::make_shared<SurfaceBuffers>();
    return Surfaces(
        surfaces_of(of.device, triangles, view, of.tables, of.arrays.get(), view.points.receivers(), of.buffers));
}

}  // namespace gnomon
