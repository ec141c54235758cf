// SPDX-License-Identifier: MIT
#include "materials.hpp"

#include <cmath>

namespace gnomon::scene {
namespace {

using nlohmann::json;

/// Null if there is none, or if it is no object.
const json* object_in(const json& of, const char* name) {
    if (!of.is_object()) return nullptr;
    const auto found = of.find(name);
    return found != of.end() && found->is_object() ? &*found : nullptr;
}

/// The entry of an array of the root. Null if the index names none.
const json* entry_of(const json& root, const char* array, std::int64_t index) {
    const auto all = root.find(array);
    if (all == root.end() || !all->is_array() || index < 0 || index >= std::int64_t(all->size())) return nullptr;
    const json& entry = (*all)[std::size_t(index)];
    return entry.is_object() ? &entry : nullptr;
}

std::int64_t integer_in(const json& of, const char* name, std::int64_t otherwise) {
    const auto found = of.find(name);
    return found != of.end() && found->is_number_integer() ? found->get<std::int64_t>() : otherwise;
}

double number_in(const json& of, const char* name, double otherwise) {
    const auto found = of.find(name);
    return found != of.end() && found->is_number() ? found->get<double>() : otherwise;
}

std::array<double, 2> pair_in(const json& of, const char* name, const std::array<double, 2>& otherwise) {
    const auto found = of.find(name);
    if (found == of.end() || !found->is_array() || found->size() != 2 || !(*found)[0].is_number() ||
        !(*found)[1].is_number())
        return otherwise;
    return {(*found)[0].get<double>(), (*found)[1].get<double>()};
}

TextureWrap wrap_of(std::int64_t value) {
    return value == 33071 ? TextureWrap::clamp : value == 33648 ? TextureWrap::mirror : TextureWrap::repeat;
}

/// uv = T R S uv; a rotation turns counter-clockwise where v points down, as all viewers have it.
void read_transform(const json& info, MaterialSource& source) {
    const json* extensions = object_in(info, "extensions");
    const json* transform = extensions ? object_in(*extensions, "KHR_texture_transform") : nullptr;
    if (transform == nullptr) return;
    const double angle = number_in(*transform, "rotation", 0), c = std::cos(angle), s = std::sin(angle);
    const std::array<double, 2> scale = pair_in(*transform, "scale", {1, 1});
    source.has_transform = true;
    source.offset = pair_in(*transform, "offset", {0, 0});
    source.rows = {{{c * scale[0], s * scale[1]}, {-s * scale[0], c * scale[1]}}};
    source.coordinates = int(integer_in(*transform, "texCoord", source.coordinates));
}

void read_sampler(const json& root, const json& texture, MaterialSource& source) {
    const json* sampler = entry_of(root, "samplers", integer_in(texture, "sampler", -1));
    if (sampler == nullptr) return;
    source.wrap_u = wrap_of(integer_in(*sampler, "wrapS", 10497));
    source.wrap_v = wrap_of(integer_in(*sampler, "wrapT", 10497));
    if (integer_in(*sampler, "magFilter", 9729) == 9728) source.filter = TextureFilter::nearest;
    const std::int64_t minification = integer_in(*sampler, "minFilter", 9987);
    if (minification == 9728) source.minification = TextureMinification::nearest;
    if (minification == 9729) source.minification = TextureMinification::linear;
}

/// The image of a texture: its source, or that of EXT_texture_webp.
std::int64_t image_of(const json& texture) {
    const json* extensions = object_in(texture, "extensions");
    const json* webp = extensions ? object_in(*extensions, "EXT_texture_webp") : nullptr;
    return integer_in(webp ? *webp : texture, "source", -1);
}

void read_texture(const json& root, const json& info, MaterialSource& source, std::map<int, ImageSource>& images) {
    source.has_texture = true;
    source.coordinates = int(integer_in(info, "texCoord", 0));
    read_transform(info, source);
    const json* texture = entry_of(root, "textures", integer_in(info, "index", -1));
    if (texture == nullptr) {
        source.unreadable = "its texture is missing";
        return;
    }
    read_sampler(root, *texture, source);
    const std::int64_t index = image_of(*texture);
    const json* image = entry_of(root, "images", index);
    if (image == nullptr) {
        source.unreadable = "its texture has no image that can be read (KTX2 is not)";
        return;
    }
    ImageSource of;
    if (const auto uri = image->find("uri"); uri != image->end() && uri->is_string()) of.uri = uri->get<std::string>();
    of.buffer_view = int(integer_in(*image, "bufferView", -1));
    source.image = int(index);
    images.insert_or_assign(int(index), std::move(of));
}

}  // namespace

MaterialSources material_sources(const json& root) {
    MaterialSources sources;
    const auto materials = root.find("materials");
    if (materials == root.end() || !materials->is_array()) return sources;
    for (std::size_t i = 0; i < materials->size(); ++i) {
        const json& material = (*materials)[i];
        if (!material.is_object()) continue;
        const auto mode = material.find("alphaMode");
        MaterialSource source;
        source.is_mask = mode != material.end() && *mode == "MASK";
        source.is_blend = mode != material.end() && *mode == "BLEND";
        const json* extensions = object_in(material, "extensions");
        if (const json* glass = extensions ? object_in(*extensions, "KHR_materials_transmission") : nullptr)
            source.transmits = number_in(*glass, "transmissionFactor", 0) > 0;
        if (source.is_mask) source.cutoff = float(number_in(material, "alphaCutoff", 0.5));
        if (const json* pbr = object_in(material, "pbrMetallicRoughness")) {
            const auto factor = pbr->find("baseColorFactor");
            if (factor != pbr->end() && factor->is_array() && factor->size() == 4 && (*factor)[3].is_number())
                source.alpha_factor = float((*factor)[3].get<double>());
            if (const json* info = object_in(*pbr, "baseColorTexture"))
                read_texture(root, *info, source, sources.images);
        }
        sources.materials.emplace(int(i), std::move(source));
    }
    return sources;
}

std::vector<unsigned char> image_bytes(const std::filesystem::path& file, const tinygltf::Model& model,
                                       const ImageSource& source) {
    if (source.uri.empty()) {
        if (source.buffer_view < 0 || source.buffer_view >= int(model.bufferViews.size()))
            fail(file, "an image has neither a uri nor a bufferView");
        const tinygltf::BufferView& view = model.bufferViews[std::size_t(source.buffer_view)];
        const std::vector<unsigned char>& bytes = model.buffers[std::size_t(view.buffer)].data;
        const auto first = bytes.begin() + std::ptrdiff_t(view.byteOffset);
        return {first, first + std::ptrdiff_t(view.byteLength)};
    }
    return bytes_of_uri(file, source.uri);
}

CutOutsView::CutOutsView(const Scene& scene) : is_empty_(scene.cut_outs.empty()) {
    const SceneCutOuts& from = scene.cut_outs;
    for (const SceneCutOuts::Texture& texture : from.textures)
        textures_.push_back({texture.width, texture.height, texture.alpha});
    cut_outs_ = {from.material_of_triangle, scene.texture_coordinates, from.corner_alphas, from.materials, textures_};
}

Triangles upload(const Device& device, const Scene& scene) {
    const CutOutsView cut_outs(scene);
    return cut_outs.get() != nullptr ? Triangles::upload(device, scene.triangles, *cut_outs.get())
                                     : Triangles::upload(device, scene.triangles);
}

SurfaceDetailView::SurfaceDetailView(const Scene& scene) {
    const SceneColors& from = scene.colors;
    if (from.images)
        for (const ColorImage& image : *from.images) textures_.push_back({image.width, image.height, image.rgba});
    detail_ = {scene.texture_coordinates, from.corner_colors, from.corner_normals, from.texture_uses, textures_};
}

}  // namespace gnomon::scene
